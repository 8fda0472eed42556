"""Readings: Figures 3 to 5 for every sign of d₁ and origin of θ̂, and J_a for every way to count it."""

import itertools
from collections.abc import Callable, Iterable
from typing import Literal, NamedTuple

import numpy as np

from osculate.plant import Disturbance
from osculate.simulation import Continuous, InitialState, Run, simulate
from osculate.study.paper.cases import (
    CASES,
    CURVE,
    D1,
    D11,
    DURATION,
    PRINTED,
    ROBOT,
    STEP,
    Case,
    Interpretation,
    endless,
    internal,
    run_case,
)
from osculate.study.paper.measures import lost_at, path_end, speed_errors, sum_of_squares
from osculate.study.paper.unending import Unending

Origin = Literal["start", "printed"]
ORIGINS: tuple[Origin, ...] = ("start", "printed")
ORIGIN_WORDS = {"start": "θ̂(0) = θ(0)", "printed": "θ̂(0) = 0"}
SIGN_WORDS = {1.0: "plus", -1.0: "minus"}
SMALL = 0.05  # m/s or rad/s, speed errors that are "sufficiently small"
NEAR = 0.02  # m, the paper's own bound for "accurately"
FAR = 0.1  # m, half the distance between the wheels: "deviates significantly"
UNSTABLE = 1.0  # 1/s, growth of errors that are "unstable"


class Reading(NamedTuple):
    """One figure in one reading: does what it starts from hold, and what it concludes?"""

    figure: int
    sign: float  # of the lost signs inside d₁
    origin: Origin
    speed_error: float  # largest after the first second, m/s or rad/s
    growth: float  # 1/s, of the speed errors
    off: float  # m, largest distance from the path until s = l
    lost: float | None  # s, when it is 2 m off the path
    premise: bool
    conclusion: bool

    @property
    def agrees(self) -> bool:
        """Whether premise and conclusion both hold."""
        return self.premise and self.conclusion


#: Figure to the experiment without sign and its gains.
SHOWN = {3: ("modified_d1", D1), 4: ("static_d1", D1), 5: ("modified_d11", D11)}


def matrix_of_readings(report: Callable[[float], None] | None = None) -> list[Reading]:
    """Figures 3, 4 and 5 over 20 s, for both signs and both origins."""
    rows = []
    for figure, sign, origin in itertools.product(SHOWN, SIGN_WORDS, ORIGINS):
        name, gains = SHOWN[figure]
        case = Case(CASES[name].target, internal(gains, sign), CASES[name].meaning)
        run = run_case(case, Interpretation(origin, "continue"))
        rows.append(judged_reading(figure, sign, origin, run))
        if report:
            report(len(rows) / (len(SHOWN) * len(SIGN_WORDS) * len(ORIGINS)))
    return rows


def judged_reading(figure: int, sign: float, origin: Origin, run: Run) -> Reading:
    """Premise and conclusion of a figure, in numbers."""
    errors = speed_errors(run)
    end = path_end(run)
    on_path = run.columns["time"] <= (np.inf if end is None else end)
    off = float(np.abs(run.columns["cross_track_error"][on_path]).max())
    first = abs(float(run.columns["speed_error"][0]))
    premise, conclusion = {
        3: (errors.largest < SMALL, off < NEAR),
        4: (first > 1.0 and errors.growth < UNSTABLE, off > FAR),
        5: (errors.growth > UNSTABLE and not run.diverged, off < NEAR),
    }[figure]
    return Reading(
        figure, sign, origin, errors.largest, errors.growth, off, lost_at(run), premise, conclusion
    )


def agreeing(rows: Iterable[Reading], *figures: int) -> set[tuple[float, Origin]]:
    """The readings in which all these figures agree with what is said of them."""
    fits: list[set[tuple[float, Origin]]] = [
        {(row.sign, row.origin) for row in rows if row.figure == figure and row.agrees}
        for figure in figures
    ]
    return set.intersection(*fits)


def in_words(readings: Iterable[tuple[float, Origin]]) -> str:
    """Signs and origins of readings, as a condition."""
    words = [
        f"the lost signs inside d₁ are {SIGN_WORDS[sign]} and {ORIGIN_WORDS[origin]}"
        for sign, origin in sorted(readings)
    ]
    return ", or ".join(words)


class SquareSum(NamedTuple):
    """J_a of Figure 6 in one reading."""

    origin: Origin
    after_end: Literal["stop", "continue"]
    constants: Literal["exact", "printed"]
    end: float  # s, when s = l
    on_path: float  # m², J_a until s = l
    whole: float  # m², J_a of the whole run
    whole_halved: float  # m², the same with h / 2, times one half
    samples: int  # N of the whole run


#: The constants of eq. (50) and α of eq. (46), with the four decimals that are printed.
ROUNDED = Unending(profile=PRINTED.profile, constant=10.5476, linear=24.8089)  # type: ignore[arg-type]
ROUNDED_RADIUS = 3.2056  # m


def square_sums(report: Callable[[float], None] | None = None) -> list[SquareSum]:
    """J_a under d₁₂ for every origin, with and without what comes after s = l."""
    kinds: list[tuple[Literal["stop", "continue"], Literal["exact", "printed"]]] = [
        ("stop", "exact"), ("continue", "exact"), ("continue", "printed"),
    ]  # fmt: skip
    rows = []
    for origin, (after_end, constants) in itertools.product(ORIGINS, kinds):
        runs = [_run(origin, after_end, constants, step) for step in (STEP, STEP / 2.0)]
        radius = ROUNDED_RADIUS if constants == "printed" else CURVE.radius
        end = path_end(runs[0]) or runs[0].columns["time"][-1]
        count = int((runs[0].columns["time"] <= end).sum())
        whole, finer = (sum_of_squares(run, radius) for run in runs)
        part = sum_of_squares(runs[0], radius, count)
        rows.append(SquareSum(
            origin, after_end, constants, float(end), part, whole, 0.5 * finer,
            len(runs[0].columns["time"]),
        ))  # fmt: skip
        if report:
            report(len(rows) / (len(ORIGINS) * len(kinds)))
    return rows


def _run(origin: Origin, after_end: str, constants: str, step: float) -> Run:
    target = PRINTED if after_end == "stop" else endless(PRINTED)
    return simulate(
        CURVE, ROBOT, target=ROUNDED if constants == "printed" else target,
        disturbance=Disturbance.external(), clock=Continuous(step=step, duration=DURATION),
        initial=InitialState(target_heading=0.0 if origin == "printed" else None),
    )  # fmt: skip


def square_sum_words(rows: Iterable[SquareSum], printed: float) -> str:
    """Why J_a cannot be reproduced to its digits, with the numbers of all readings."""
    table = list(rows)
    on_path = [row.on_path for row in table]
    beyond = {row.whole for row in table if row.after_end == "continue"}
    finer = [row.whole_halved / row.whole for row in table if row.after_end == "continue"]
    return (
        f"J_a = {printed} cannot be reproduced to its digits: the text leaves open θ̂(0), constants, "
        f"integrator and what happens after s = l. Until then it is {min(on_path):.2g} to "
        f"{max(on_path):.2g} m². N = 20/h needs 20 s, in which the robot goes on to the cusp of the "
        f"cycloid, where the curve is vertical: then {min(beyond):.2g} to {max(beyond):.2g} m², and "
        f"{min(finer):.2g} to {max(finer):.2g} times as much with h/2."
    )
