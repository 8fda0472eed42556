"""Statements about the control laws, Section 4."""

from typing import Any

import numpy as np

from osculate.control.lqr import yaw_regulator
from osculate.simulation import Run
from osculate.study.paper.cases import D1, D11
from osculate.study.paper.claims.claim import Claim, Condition, Evidence, observed, printed
from osculate.study.paper.measures import rms, sliding
from osculate.vehicle import Tricycle

WEIGHTS = (1.0, 100.0, 1.0)  # Q = diag(1, 100), R = 1
SWITCHING, UNCERTAINTY = 0.1, 0.2  # ε, E


def control_claims(evidence: Evidence) -> list[Claim]:
    """Yaw regulator and sliding mode."""
    return [*_regulator(evidence), *_stability(evidence), *_steering(evidence), *_sliding(evidence)]


def _regulator(evidence: Evidence) -> list[Claim]:
    heading, rate, effort = WEIGHTS
    gain = evidence.robot.yaw_gain
    solved = yaw_regulator(gain, *WEIGHTS).gain
    root = np.sqrt(heading / effort)
    where = "eqs (33)-(35), Section 5, sentence before (47)"
    return [
        printed(
            "lqr_gain_heading", "feedback gain of the heading error, √(q₁/R)", where, float(root),
            float(solved[0]), "N m/rad", 1e-9,
        ),
        printed(
            "lqr_gain_yaw_rate", "feedback gain of the yaw-rate error, √((q₂ + 2 √(q₁R)/c)/R)", where,
            float(np.sqrt((rate + 2.0 * np.sqrt(heading * effort) / gain) / effort)),
            float(solved[1]), "N m s/rad", 1e-9,
        ),
    ]  # fmt: skip


def _stability(evidence: Evidence) -> list[Claim]:
    closed = yaw_regulator(evidence.robot.yaw_gain, *WEIGHTS).closed
    growth = {
        (name, sign): float(np.linalg.eigvals(closed + sign * np.diag(gains)).real.max())
        for name, gains in (("d1", D1), ("d11", D11))
        for sign in (1.0, -1.0)
    }
    measured = "largest real part of an eigenvalue"
    return [
        observed(
            "yaw_errors_stable_d1", "the yaw errors decay under d₁ = (5y₁, 5y₂)",
            "Section 5.1, sentence 1 after (51)", "stable (by contrast with Section 5.2)",
            growth["d1", 1.0], "1/s", f"{measured} < 0", growth["d1", 1.0] < 0.0,
            Condition("the lost signs inside d₁ are minus", growth["d1", -1.0] < 0.0),
            note=f"with minus signs {growth['d1', -1.0]:.4g} 1/s",
        ),
        observed(
            "yaw_errors_unstable_d11", "the yaw errors grow under d₁₁ = (12y₁, 11.2y₂)",
            "Section 5.2, sentence 3, Figure 5", "unstable", growth["d11", 1.0], "1/s",
            f"{measured} > 0 with both signs, as the text has none",
            min(growth["d11", 1.0], growth["d11", -1.0]) > 0.0,
            Condition("the lost sign of 12y₁ is plus", growth["d11", 1.0] > 0.0),
            note=f"with minus signs {growth['d11', -1.0]:.4g} 1/s; that of 11.2y₂ does not matter beside "
            "the loop's −500 1/s",
        ),
    ]  # fmt: skip


def _steering(evidence: Evidence) -> list[Claim]:
    apart = {
        name: _drift(evidence.runs[name], evidence.robot) for name in ("modified", "modified_d12")
    }
    return [
        observed(
            "steering_from_input", "φ = arctan(a ∫c u₁ dt / v) is the steering angle of the motion",
            "eq. (36), Figure 7a", "equal to arctan(aθ̇/v)", apart["modified_d12"], "rad/s",
            "∫c u₁ dt stays within 1e-3 rad/s of θ̇ under d₁₂", apart["modified_d12"] < 1e-3,
            Condition("nothing disturbs the yaw rate", apart["modified"] < 1e-3),
            note=f"undisturbed they differ by {apart['modified']:.1e} rad/s; with d₁₂ it would leave "
            "the constraint (6), so Figure 7a cannot show (36)",
            erratum=7,
        ),
    ]  # fmt: skip


def _drift(run: Run, robot: Tricycle) -> float:
    """Largest difference (rad/s) between ∫c u₁ dt and the yaw rate."""
    c = run.columns
    rate = robot.yaw_gain * (c["torque_right"] - c["torque_left"])
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(c["time"])
    return float(np.abs(np.cumsum(steps) - (c["yaw_rate"][1:] - c["yaw_rate"][0])).max())


def _sliding(evidence: Evidence) -> list[Claim]:
    runs = evidence.runs
    z = runs["modified_d12"].columns["speed_error"]
    push = np.abs(0.1 * np.sin(runs["modified_d12"].columns["time"]) + 2.0 * z)
    covered = float((push <= SWITCHING + UNCERTAINTY * np.abs(z)).mean())
    away = float(np.abs(sliding(runs["modified_d12"])).max())
    change = {name: rms(runs[name]) / rms(runs[f"{name}_smooth"]) for name in _SWITCHED}
    after = "Section 4, after eq. (40)"
    return [
        observed(
            "uncertainty_bound", "E bounds the whole of the uncertainties", after,
            "|d₂| ≤ ε + E |z|", covered, "1", "at every sample under d₁₂", covered == 1.0,
            note="d₂ = 0.1 sin t + 2z grows with 2 per z, E is 0.2; measured: share of samples",
            erratum=6,
        ),
        observed(
            "sliding_function", "the sliding mode keeps ϝ(v) = 0 from the start", "eqs (39)-(41)", "0",
            away, "m/s", "|ϝ/G| < 1e-6 m/s under d₁₂", away < 1e-6,
            note="ϝ lacks the nominal part −∫κz dt of an integral sliding mode, and (40) the input gain",
            erratum=6,
        ),
        observed(
            "switching_helps", "the switching torque u₂₁ makes the path more exact", after,
            "smaller √(J_a/N) with it", max(change.values()), "1",
            "ratio with : without it < 1 under d₁₂ and under d₁ with minus signs",
            max(change.values()) < 1.0,
            Condition("the disturbance is d₁ with minus signs", change["modified_d1_minus"] < 1.0),
            note=_switched_note(runs),
        ),
    ]  # fmt: skip


_SWITCHED = {"modified_d1_minus": "−d₁", "modified_d12": "d₁₂"}


def _switched_note(runs: Any) -> str:
    parts = [
        f"{words}: {1e3 * rms(runs[f'{name}_smooth']):.3f} mm without, {1e3 * rms(runs[name]):.3f} mm with"
        for name, words in _SWITCHED.items()
    ]
    return "; ".join(parts)
