"""The experiments of Section 5, each in every reading that the printed text allows."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve import Cycloid
from osculate.plant import Disturbance
from osculate.simulation import Run, simulate
from osculate.target import Exponential, Modified, Natural, Static, Target
from osculate.vehicle import Tricycle

CURVE = Cycloid.over(distance=10.0, height=5.0, margin=1.0)
ROBOT = Tricycle()

CONSISTENT = Modified()  # ∫θ̂̇ dt is the curve's own total turn, −(π − β)
PRINTED = Modified(profile=Exponential(amplitude=-3.0))  # eq. (50): θ̂̇ = −¾ t e^{−t/2}
STATIC = Static(profile=Natural())  # eq. (51)


class Case(NamedTuple):
    """One experiment."""

    target: Target
    disturbance: Disturbance
    meaning: str


D1, D11 = (5.0, 5.0), (12.0, 11.2)


def _internal(gains: tuple[float, float], sign: float) -> Disturbance:
    return Disturbance.internal(sign * gains[0], sign * gains[1])


#: All experiments by name; "plus" and "minus" are the two readings of the signs inside d₁.
CASES = {
    "modified": Case(CONSISTENT, Disturbance(), "modified target, undisturbed"),
    "printed": Case(PRINTED, Disturbance(), "modified target as printed (¾), undisturbed"),
    "static": Case(STATIC, Disturbance(), "static target, undisturbed"),
    "modified_d1": Case(PRINTED, _internal(D1, 1.0), "modified target, d₁ = (5y₁, 5y₂)"),
    "modified_d1_minus": Case(PRINTED, _internal(D1, -1.0), "modified target, d₁ = −(5y₁, 5y₂)"),
    "static_d1": Case(STATIC, _internal(D1, 1.0), "static target, d₁ = (5y₁, 5y₂)"),
    "static_d1_minus": Case(STATIC, _internal(D1, -1.0), "static target, d₁ = −(5y₁, 5y₂)"),
    "modified_d11": Case(PRINTED, _internal(D11, 1.0), "modified target, d₁₁ = (12y₁, 11.2y₂)"),
    "modified_d11_minus": Case(
        PRINTED, _internal(D11, -1.0), "modified target, d₁₁ = −(12y₁, 11.2y₂)"
    ),
    "modified_d12": Case(
        PRINTED, Disturbance.external(), "modified target, d₁₂ = (sin 4t, cos 4t)"
    ),
    "modified_d12_consistent": Case(
        CONSISTENT, Disturbance.external(), "the same with the consistent profile, 20 s long"
    ),
    "modified_d12_heading_disturbed": Case(
        PRINTED,
        Disturbance.external(acts_on="robot"),
        "modified target, d₁₂ turning the robot itself",
    ),
}


def run_cases(report: Callable[[float], None] | None = None) -> dict[str, Run]:
    """Run all experiments with the paper's robot, gains, h = 1 ms and 20 s."""
    runs = {}
    for done, (name, case) in enumerate(CASES.items(), start=1):
        runs[name] = simulate(CURVE, ROBOT, target=case.target, disturbance=case.disturbance)
        if report:
            report(done / len(CASES))
    return runs


def vertical_errors(run: Run) -> NDArray[np.float64]:
    """y_a − ŷ(x_a) (m) at every sample: the paper's error, at equal x instead of the nearest point.

    The cycloid's parameter w solves w − sin w = x / α; it lies within 1 of x / α, and bisection
    finds it everywhere, also where the robot has left the curve's ends.
    """
    curve = run.setup.curve
    assert isinstance(curve, Cycloid)
    along = run.columns["x"] / curve.radius
    low, high = along - 1.0, along + 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        short = middle - np.sin(middle) < along
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    error: NDArray[np.float64] = run.columns["y"] - curve.radius * (1.0 - np.cos(low))
    return error


def sum_of_squares(run: Run) -> float:
    """J_a (m²), the paper's sum of squared errors over all samples."""
    return float((vertical_errors(run) ** 2).sum())


def rms(run: Run) -> float:
    """√(J_a / N) (m)."""
    return float(np.sqrt((vertical_errors(run) ** 2).mean()))
