"""The paper's model derived by SymPy, from its constraints and energies: eqs (1)–(16), (A1)–(A10).

The derivation uses nothing but the constraints and the kinetic energies. It proves the coefficients of
`osculate.vehicle.model`, which the simulations run, and the errata of the printed equations.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from osculate.kernel.trace import plain
from osculate.vehicle.model import ReducedModel, speed_rate

# lengths, masses and inertias of Table 1
a, r, d, M_b, M_w, I_w, I_wd, I_b = sp.symbols("a r d M_b M_w I_w I_wd I_b", positive=True)
M_1, M_2, I = sp.symbols("M_1 M_2 I", positive=True)  # noqa: E741 (of (A7))
T_l, T_r, u_1, u_2 = sp.symbols("T_l T_r u_1 u_2", real=True)
t = sp.Symbol("t", real=True)
x, y, theta, theta_l, theta_r, phi, v, omega = (
    sp.Function(name)(t)
    for name in ("x", "y", "theta", "theta_l", "theta_r", "varphi", "v", "omega")
)
q = sp.Matrix([x, y, theta, theta_l, theta_r])


@dataclass(frozen=True)
class Derivation:
    """Every step from the constraints to the reduced dynamics, as SymPy expressions."""

    constraints: sp.Matrix  # F, shape (3, 5), eq. (9)
    motions: sp.Matrix  # S, shape (5, 2), eq. (11)
    energy: sp.Expr  # kinetic energy T = T_w + T_b + T_f, (A3)–(A5)
    mass: sp.Matrix  # A, shape (5, 5), (A7)
    velocity_forces: sp.Matrix  # U q̇, shape (5, 1), (A7)
    total_mass: sp.Expr  # M₁
    turn_inertia: sp.Expr  # I
    delta: sp.Expr  # Δ of eq. (16), in M₁ and I
    yaw_gain: sp.Expr  # c
    speed_rate: sp.Expr  # v̇ of eq. (16), in M₁ and I
    yaw_acceleration: sp.Expr  # θ̈ of eq. (16)
    printed_speed_rate: sp.Expr  # v̇ as (16) and (A10) print it

    @property
    def front_mass(self) -> sp.Expr:
        """M₂ of (A7): mass times distance ahead of O, per a."""
        return sp.expand(self.mass[1, 2] / (a * sp.cos(theta)))

    def _in_short(self, matrix: sp.Matrix) -> sp.Matrix:
        """Write M₁, M₂ and I in a matrix of (A7)."""

        def short(entry: sp.Expr) -> sp.Expr:
            if entry in (self.total_mass, self.turn_inertia):
                return M_1 if entry == self.total_mass else I
            share = sp.cancel(entry / self.front_mass)
            return entry if share.has(M_b) else share * M_2

        return matrix.applyfunc(short)

    def constraint_residual(self) -> sp.Matrix:
        """F S, which must vanish: the motions S V respect every constraint, eq. (13)."""
        return (self.constraints * self.motions).applyfunc(_tidy)

    def energy_rate(self, rate: sp.Expr) -> sp.Expr:
        """Rate of ½ (M₁ + 2 I_w / r²) v² + ½ I ω² minus the power u₂ v / r, if v̇ is ``rate``.

        Zero for the derived dynamics; erratum 1 is that it is not for the printed ones.
        """
        turn = v * sp.tan(phi) / a
        stored = (M_1 + 2 * I_w / r**2) * v**2 / 2 + I * turn**2 / 2
        change = stored.diff(t).subs(v.diff(t), rate) - u_2 * v / r
        return sp.factor(_by_tangent(change))

    def differential_residual(self) -> sp.Expr:
        """What eq. (16) leaves out of a real robot's balance of force, per d tan φ / (2 a r) (erratum 3).

        On a robot both rear wheels roll, so that θ̇ = v tan φ / a in every row of S and one motion
        remains. Its equation of motion minus the first line of (16) is this difference of torques,
        (d I_w / r) θ̈ − u₁: it vanishes for u₁ = θ̈ / c and for no other u₁.
        """
        turn = sp.tan(phi) / a
        one = self.motions[:, 0] + self.motions[:, 1] * turn
        whole = _reduce(self.mass, self.velocity_forces, one, sp.Matrix([v]))
        part = _reduce(self.mass, self.velocity_forces, self.motions[:, 0], sp.Matrix([v]))
        missing = (whole - one.T * _torques()) - (part - self.motions[:, 0].T * _torques())
        half = {T_l: (u_1 + u_2) / 2, T_r: (u_2 - u_1) / 2}
        return sp.factor(_by_tangent(missing[0].subs(half) * 2 * a * r / (d * sp.tan(phi))))

    def solved_speed_rate(self, form: str = "corrected") -> sp.Expr:
        """V̇ with φ̇ = a (ω̇ v − ω v̇) / (v² + a² ω²) put in and solved for, in ω, ω̇ and v."""
        rate = self.speed_rate if form == "corrected" else self.printed_speed_rate
        unknown = sp.Symbol("dv")
        steering_rate = a * (omega.diff(t) * v - omega * unknown) / (v**2 + a**2 * omega**2)
        implicit = _by_tangent(rate).subs({phi.diff(t): steering_rate, sp.tan(phi): a * omega / v})
        return sp.factor(sp.solve(sp.Eq(unknown, implicit), unknown)[0])

    def kernel_residual(self, form: str = "corrected") -> sp.Expr:
        """The kernel that simulations run, traced on symbols, minus `solved_speed_rate`: zero."""
        turn = I * r**2
        model = ReducedModel(
            wheelbase=a,
            wheel_radius=r,
            traction=1 / r,
            yaw_gain=r / (d * I_w),
            differential=d * I_w / r,
            drive_inertia=M_1 * r**2 + 2 * I_w,
            turn_inertia=turn,
            coupling=turn if form == "corrected" else turn * a,
        )
        traced = plain(speed_rate)(model, omega / v, omega.diff(t), u_2)
        return sp.factor(traced - self.solved_speed_rate(form))

    def latex(self) -> str:
        """The model as LaTeX: constraints, energies, mass matrix and reduced dynamics."""
        lines = [
            ("constraints  F(q) dq/dt = 0, eq. (9)", r"F = " + _latex(self.constraints)),
            ("motions  dq/dt = S(q) V, V = (v, omega), eq. (11)", r"S = " + _latex(self.motions)),
            ("kinetic energy, (A3)-(A5)", r"T = " + _latex(self.energy)),
            ("mass matrix, (A7)", r"A = " + _latex(self._in_short(self.mass))),
            (
                "velocity forces, (A7)",
                r"U\,\dot{q} = " + _latex(self._in_short(self.velocity_forces)),
            ),
            ("masses and inertias", r"M_1 = " + _latex(self.total_mass)),
            ("", r"M_2 = " + _latex(self.front_mass)),
            ("", r"I = " + _latex(self.turn_inertia)),
            ("reduced dynamics, eq. (16), corrected", r"\Delta = " + _latex(self.delta)),
            ("", r"\dot{v} = " + _latex(_with_delta(self.speed_rate, self.delta))),
            ("", r"\ddot{\theta} = c\,u_{1}, \qquad c = " + _latex(self.yaw_gain)),
            ("solved for the speed rate", r"\dot{v} = " + _latex(self.solved_speed_rate())),
        ]
        return "\n".join(f"% {title}\n{text}" if title else text for title, text in lines)


@cache
def derive() -> Derivation:
    """Derive the reduced dynamics from constraints and energies."""
    constraints, motions = _constraints(), _motions()
    energy = _energy()
    rates = q.diff(t)
    mass = sp.hessian(energy, list(rates)).applyfunc(_tidy)
    velocity_forces = sp.Matrix(
        [
            energy.diff(rate).diff(t) - energy.diff(position)
            for position, rate in zip(q, rates, strict=True)
        ]
    )
    velocity_forces = (velocity_forces - mass * q.diff(t, 2)).applyfunc(_tidy)

    reduced = _reduce(mass, velocity_forces, motions, sp.Matrix([v, omega]))
    half = {T_l: (u_1 + u_2) / 2, T_r: (u_2 - u_1) / 2}
    balance = (reduced - motions.T * _torques()).subs(half)
    solved = sp.solve(list(balance), [v.diff(t), omega.diff(t)], dict=True)[0]
    total_mass, turn_inertia = sp.expand(mass[0, 0]), sp.expand(mass[2, 2])
    short = {
        I_b: sp.solve(sp.Eq(I, turn_inertia), I_b)[0],
        M_b: sp.solve(sp.Eq(M_1, total_mass), M_b)[0],
    }
    rate = _by_tangent(solved[v.diff(t)].subs(I_b, short[I_b]).subs(M_b, short[M_b]))
    delta = (
        M_1 * a**2 * r**2 * sp.cos(phi) ** 2
        + 2 * I_w * a**2 * sp.cos(phi) ** 2
        + I * r**2 * sp.sin(phi) ** 2
    )
    driven = r * a**2 * sp.cos(phi) ** 2 / delta * u_2
    printed = driven - I * a * r**2 * phi.diff(t) * sp.tan(phi) / delta * v
    return Derivation(
        constraints, motions, energy, mass, velocity_forces, total_mass, turn_inertia,
        delta, r / (d * I_w), rate, sp.cancel(solved[omega.diff(t)]), printed,
    )  # fmt: skip


def steering_coefficient(rate: sp.Expr) -> sp.Expr:
    """The factor of φ̇ sin φ / (Δ cos φ) · v in −v̇: I r² derived, I a r² printed (erratum 1)."""
    factor = sp.diff(rate, phi.diff(t)) / v * derive().delta / sp.tan(phi)
    return sp.factor(_by_tangent(-factor))


def rod_inertia() -> tuple[sp.Expr, sp.Expr]:
    """Inertia of a uniform rod about its end O and about its centre (erratum 2)."""
    place = sp.Symbol("xi")
    about_end = sp.integrate(M_b / a * place**2, (place, 0, a))
    about_centre = sp.integrate(M_b / a * place**2, (place, -a / 2, a / 2))
    return about_end, about_centre


def _constraints() -> sp.Matrix:
    """No lateral slip; rolling of the rear wheels; steering, eqs (1), (3), (6)."""
    return sp.Matrix(
        [
            [-sp.sin(theta), sp.cos(theta), 0, 0, 0],
            [sp.cos(theta), sp.sin(theta), 0, -r / 2, -r / 2],
            [-sp.tan(phi), 0, a * sp.cos(theta), 0, 0],
        ]
    )


def _motions() -> sp.Matrix:
    half = d / (2 * r)
    return sp.Matrix(
        [
            [sp.cos(theta), 0],
            [sp.sin(theta), 0],
            [sp.tan(phi) / a, 0],
            [1 / r, half],
            [1 / r, -half],
        ]
    )


def _energy() -> sp.Expr:
    """The kinetic energies of the rear wheels, the rod and the front wheel from their positions."""
    side = sp.Matrix([sp.sin(theta), -sp.cos(theta)]) * d / 2
    ahead = sp.Matrix([sp.cos(theta), sp.sin(theta)])
    middle = sp.Matrix([x, y])

    def squared(point: sp.Matrix) -> Any:
        return (point.diff(t).T * point.diff(t))[0]

    spin = theta.diff(t)
    wheels = (
        M_w * (squared(middle + side) + squared(middle - side)) / 2
        + I_w * (theta_l.diff(t) ** 2 + theta_r.diff(t) ** 2) / 2
        + I_wd * spin**2
    )
    rod = M_b * squared(middle + ahead * a / 2) / 2 + I_b * spin**2 / 2
    front = (M_w + I_w / r**2) * squared(middle + ahead * a) / 2
    return _tidy(wheels + rod + front)


def _torques() -> sp.Matrix:
    return sp.Matrix([0, 0, 0, T_l, T_r])


def _reduce(
    mass: sp.Matrix, velocity_forces: sp.Matrix, motions: sp.Matrix, speeds: sp.Matrix
) -> sp.Matrix:
    """Sᵀ (A d(S V)/dt + U S V): the multipliers drop out because F S = 0, eq. (A9)."""
    rates = motions * speeds
    accelerations = rates.diff(t).subs(theta.diff(t), rates[2])
    forces = velocity_forces.subs(dict(zip(q.diff(t), rates, strict=True)))
    return (motions.T * (mass * accelerations + forces)).applyfunc(_tidy)


def _tidy(expression: sp.Expr) -> sp.Expr:
    """Multiply out and use sin² θ = 1 − cos² θ."""
    return sp.expand(sp.expand(expression).subs(sp.sin(theta) ** 2, 1 - sp.cos(theta) ** 2))


def _by_tangent(expression: sp.Expr) -> sp.Expr:
    """A rational function of tan φ: sin φ = tan φ cos φ and cos² φ = 1 / (1 + tan² φ)."""
    tangent = sp.Symbol("tangent")
    inside = expression.subs(sp.sin(phi), sp.tan(phi) * sp.cos(phi)).subs(sp.tan(phi), tangent)
    inside = inside.subs(sp.cos(phi) ** 2, 1 / (1 + tangent**2))
    return sp.cancel(sp.together(inside)).subs(tangent, sp.tan(phi))


def _with_delta(rate: sp.Expr, delta: sp.Expr) -> sp.Expr:
    """The rate as the paper writes it, with Δ for the denominator."""
    short = sp.Symbol("Delta")
    coupling = -steering_coefficient(rate) * phi.diff(t) * sp.sin(phi) / (short * sp.cos(phi)) * v
    torque = sp.factor(_by_tangent(sp.diff(rate, u_2) * delta * (1 + sp.tan(phi) ** 2)))
    return coupling + torque * sp.cos(phi) ** 2 / short * u_2


def _latex(expression: Any) -> str:
    dotted = {}
    for function in (x, y, theta, theta_l, theta_r, phi, v, omega):
        name = sp.latex(function.func)
        dotted[function.diff(t)] = sp.Symbol(rf"\dot{{{name}}}")
        dotted[function] = sp.Symbol(name)
    return str(sp.latex(expression.subs(dotted)))
