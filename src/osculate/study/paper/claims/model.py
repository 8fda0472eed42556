"""Statements about constraints and dynamics, Section 2 and Appendix A."""

from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from osculate.simulation import Run
from osculate.study.paper.claims.claim import Claim, Condition, Evidence, observed, printed
from osculate.vehicle import Tricycle, derivation

DRIFT = 1e-9  # relative, below which an energy counts as kept; the integration keeps 1e-12


def model_claims(evidence: Evidence) -> list[Claim]:
    """Constraints, equation of motion, energy."""
    return [*_constraints(evidence), *_dynamics(evidence), *_inputs(evidence)]


def _constraints(evidence: Evidence) -> list[Claim]:
    run, robot = evidence.runs["modified_smooth"], evidence.robot
    residual = constraint_residual(run, robot)
    sideways = float(np.abs(robot.wheelbase * _rates(run)["heading"]).max())
    rank = _rank(robot)
    return [
        observed(
            "constraint_residual", "the motion respects every constraint: F(q) dq/dt = 0",
            "eqs (8)-(10)", "0", residual, "m/s", "largest entry over the run < 1e-5 m/s",
            residual < 1e-5,
            note="by finite differences of x, y and θ of an undisturbed run without switching, whose kinks "
            "they would show; F S = 0 is also proved symbolically",
        ),
        observed(
            "sideways_speed", "the speed of P across OP must be zero", "after eq. (5), sentence 1",
            "0", sideways, "m/s", "largest over the undisturbed run < 1e-3 m/s", sideways < 1e-3,
            note="it is aθ̇: zero across the front wheel, not across the rod", erratum=8,
        ),
        observed(
            "holonomic_constraints", "F(q) holds all constraints of the rolling wheels",
            "eqs (3), (8), sentence before (8)", "rank of F: 3", float(rank), "1",
            "adding θ̇ = (r/d)(θ̇_l − θ̇_r) of eq. (3) to F leaves its rank at 3", rank == 3,
            note="it is missing in F; with it the robot has one degree of freedom, not two. Of the two "
            "constraints called holonomic only this one is",
            erratum=3,
        ),
    ]  # fmt: skip


def _dynamics(evidence: Evidence) -> list[Claim]:
    derived, robot = evidence.derived, evidence.robot
    scale = _scale(derived, robot)
    coefficient = derivation.steering_coefficient(derived.speed_rate).subs(_numbers(robot))
    sine = derived.delta.coeff(sp.sin(derivation.phi) ** 2).subs(_numbers(robot))
    drift = {form: _energy_drift(evidence, form) for form in ("corrected", "printed")}
    paths = "derived from the paper's own energies (A3)-(A5)"
    return [
        printed(
            "dynamics_coefficient", "factor of φ̇ tan φ v in eq. (47)", "eqs (16), (47), (A10)",
            10.8, float(coefficient) / scale, "1", 0.05, note=f"I r² instead of I a r²: {paths}",
            erratum=1,
        ),
        printed(
            "denominator", "constant in the denominator 37 cos² φ + 27 of eq. (47)", "eq. (47)", 27.0,
            float(sine) / scale, "1", 0.05,
        ),
        printed(
            "torque_coefficient", "factor of cos² φ u₂ in eq. (47)", "eq. (47)", 53.33,
            robot.wheel_radius * robot.wheelbase**2 / scale, "1", 0.005,
        ),
        printed("yaw_gain", "c = r / (d I_w)", "eqs (16), (47)", 50.0, robot.yaw_gain, "1/(kg m²)", 0.5),
        observed(
            "energy_drift_corrected",
            "without drive torque the kinetic energy stays what it is (corrected dynamics)",
            "eq. (16) with I r²", "0", drift["corrected"], "1", f"relative drift < {DRIFT:g}",
            drift["corrected"] < DRIFT,
            note="in 10 s with φ = 0.6 sin 2t; zero is also proved symbolically", erratum=1,
        ),
        observed(
            "energy_drift_printed",
            "without drive torque the kinetic energy stays what it is (dynamics as printed)",
            "eqs (16), (47), (A10)", "0", drift["printed"], "1", f"relative drift < {DRIFT:g}",
            drift["printed"] < DRIFT,
            note="the same run with I a r²; the energy's rate is "
            "I (1 − a) v² φ̇ tan φ (1 + tan² φ) / a²", erratum=1,
        ),
    ]  # fmt: skip


def _inputs(evidence: Evidence) -> list[Claim]:
    robot = evidence.robot
    end, centre = derivation.rod_inertia()
    rod = {derivation.M_b: robot.body_mass, derivation.a: robot.wheelbase}
    about_end, about_centre = float(end.subs(rod)), float(centre.subs(rod))
    free = 5 - _rank(robot)
    imposed = robot.track_width * robot.wheel_inertia / robot.wheel_radius
    return [
        printed(
            "rod_inertia", "I_b is what (A7) adds (a²/4) M_b to: the inertia about the rod's centre",
            "Table 1, (A7)", robot.body_inertia, about_centre, "kg m²", 1e-3,
            Condition(
                "I_b is read about O and (a²/4) M_b is not added to it again",
                abs(about_end - robot.body_inertia) < 1e-3,
            ),
            note=f"about O a rod of this mass and length has {about_end:.2g} kg m²", erratum=2,
        ),
        observed(
            "yaw_actuator", "u₁ = T_l − T_r can be chosen freely", "eqs (16)-(17), (34)",
            "two free inputs", float(free), "1",
            "the robot has two degrees of freedom besides the steering angle", free == 2,
            Condition(
                "T_l − T_r = (d I_w / r) θ̈, what an open differential leaves",
                abs(imposed * robot.yaw_gain - 1.0) < 1e-12,
            ),
            note="measured: its degrees of freedom, 5 − rank of the whole F; given the steering, eq. (16) "
            "is exact for no other difference (proved symbolically)",
            erratum=3,
        ),
    ]  # fmt: skip


def _rank(robot: Tricycle) -> int:
    """Rank of F with the missing row of eq. (3), at a configuration without symmetry."""
    a, r, d = robot.wheelbase, robot.wheel_radius, robot.track_width
    heading, angle = 0.3, 0.4
    rows = np.array([
        [-np.sin(heading), np.cos(heading), 0.0, 0.0, 0.0],
        [np.cos(heading), np.sin(heading), 0.0, -r / 2.0, -r / 2.0],
        [-np.tan(angle), 0.0, a * np.cos(heading), 0.0, 0.0],
        [0.0, 0.0, 1.0, -r / d, r / d],
    ])  # fmt: skip
    return int(np.linalg.matrix_rank(rows))


def _scale(derived: derivation.Derivation, robot: Tricycle) -> float:
    """Factor between Δ of eq. (16) and the denominator 37 cos² φ + 27 of eq. (47), by its 37."""
    cosine = derived.delta.coeff(sp.cos(derivation.phi) ** 2)
    sine = derived.delta.coeff(sp.sin(derivation.phi) ** 2)
    return float((cosine - sine).subs(_numbers(robot))) / 37.0


def _numbers(robot: Tricycle) -> dict[Any, float]:
    """The values of the symbols of the derivation."""
    return {
        derivation.a: robot.wheelbase,
        derivation.r: robot.wheel_radius,
        derivation.d: robot.track_width,
        derivation.I_w: robot.wheel_inertia,
        derivation.M_1: robot.total_mass,
        derivation.I: robot.turn_inertia,
    }


def _energy_drift(evidence: Evidence, form: str) -> float:
    """Largest relative change of the kinetic energy while the front wheel swings and nothing drives.

    Integrates eq. (16) with a prescribed steering angle, by SciPy, from the derivation's expression.
    """
    derived, robot = evidence.derived, evidence.robot
    rate = derived.speed_rate if form == "corrected" else derived.printed_speed_rate
    speed, angle, swing = sp.symbols("speed angle swing")
    named = rate.subs(derivation.phi.diff(derivation.t), swing)
    named = named.subs({derivation.phi: angle, derivation.v: speed, derivation.u_2: 0})
    acceleration = sp.lambdify((speed, angle, swing), named.subs(_numbers(robot)), "math")

    def steering(t: float) -> tuple[float, float]:
        return 0.6 * np.sin(2.0 * t), 1.2 * np.cos(2.0 * t)

    times = np.linspace(0.0, 10.0, 1001)
    solved = solve_ivp(
        lambda t, y: [acceleration(y[0], *steering(t))], (0.0, 10.0), [1.0],
        method="DOP853", t_eval=times, rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    v = solved.y[0]
    mass = robot.total_mass + 2.0 * robot.wheel_inertia / robot.wheel_radius**2
    turn = v * np.tan(0.6 * np.sin(2.0 * times)) / robot.wheelbase
    energy = 0.5 * mass * v**2 + 0.5 * robot.turn_inertia * turn**2
    return float(np.abs(energy / energy[0] - 1.0).max())


def _rates(run: Run) -> dict[str, np.ndarray]:
    """Time derivatives of x, y and θ: central differences of the record, over its equal steps."""
    c = run.columns
    return {
        name: (c[name][2:-1] - c[name][:-3]) / (c["time"][2:-1] - c["time"][:-3])
        for name in ("x", "y", "heading")
    }


def constraint_residual(run: Run, robot: Tricycle) -> float:
    """Largest entry of F(q) dq/dt (m/s), with dq/dt by finite differences of the record."""
    inner = {name: values[1:-2] for name, values in run.columns.items()}
    rates = _rates(run)
    sine, cosine = np.sin(inner["heading"]), np.cos(inner["heading"])
    r, d = robot.wheel_radius, robot.track_width
    left = inner["speed"] / r + d / (2.0 * r) * inner["yaw_rate"]
    right = inner["speed"] / r - d / (2.0 * r) * inner["yaw_rate"]
    residuals = [
        -rates["x"] * sine + rates["y"] * cosine,
        rates["x"] * cosine + rates["y"] * sine - r / 2.0 * (left + right),
        -rates["x"] * np.tan(inner["steering_angle"]) + robot.wheelbase * cosine * rates["heading"],
    ]
    return float(np.abs(residuals).max())
