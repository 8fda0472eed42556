"""Better, equal or worse: one controller against each of the others, from paired results.

Two controllers meet the same curve, speed, start and random numbers. The logarithm of the ratio of their
RMS errors, averaged over the random numbers, is one observation for every combination of curve, speed and
start; Student's t gives the confidence interval of its mean.
"""

import itertools
import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from osculate.study.comparison.compare import Comparison, log_rms

CONFIDENCE = 0.95
PAIR = ("curve", "speed", "start", "seed")


class PairedComparison(NamedTuple):
    """One controller against another under one condition."""

    condition: str
    controller: str  # the one that is judged
    other: str
    ratio: float  # geometric mean of the other's RMS over the controller's; above 1 is better
    low: float  # its confidence interval
    high: float
    cells: int  # combinations in which both arrived
    failed: int  # runs of the controller that failed
    other_failed: int
    runs: int  # of each

    @property
    def word(self) -> str:
        """``better``, ``worse`` or ``equal``: what the interval allows to say."""
        if self.low > 1.0:
            return "better"
        return "worse" if self.high < 1.0 else "equal"

    @property
    def sentence(self) -> str:
        """The comparison in words."""
        fails = _failures(self)
        if self.cells < 2:
            return f"{self.condition}: against {self.other} nothing can be said; {fails}."
        low, high = self.low, self.high
        if self.word == "worse":
            low, high = 1.0 / high, 1.0 / low
        span = f"95 % CI {low:.2f} to {high:.2f}, {self.cells} pairs"
        times = self.ratio if self.ratio >= 1.0 else 1.0 / self.ratio
        what = {
            "better": f"better than {self.other}, whose error is {times:.2f} times as large",
            "worse": f"worse than {self.other}, its error is {times:.2f} times as large",
            "equal": f"not to be told from {self.other}, whose error is {self.ratio:.2f} times its own",
        }[self.word]
        return f"{self.condition}: {self.controller} is {what} ({span}); {fails}."


def _failures(v: PairedComparison) -> str:
    if v.failed == v.other_failed == 0:
        return "none of them failed"
    return f"it failed in {v.failed} and {v.other} in {v.other_failed} of {v.runs} runs"


def paired_comparisons(comparison: Comparison, controller: str) -> list[PairedComparison]:
    """The controller against all others, under every condition in order."""
    found = []
    kinds = dict.fromkeys(cell["plant"] for cell in comparison.cells)
    others = [name for name in comparison.controllers if name != controller]
    for kind, other in itertools.product(kinds, others):
        ours = _cells(comparison, controller, kind)
        theirs = _cells(comparison, other, kind)
        if ours and theirs:
            found.append(_judge(kind, controller, other, ours, theirs))
    return found


def _cells(comparison: Comparison, controller: str, kind: str) -> list[dict[str, Any]]:
    return [cell for cell in comparison.of(controller) if cell["plant"] == kind]


def _judge(
    kind: str, name: str, other: str, ours: list[dict[str, Any]], theirs: list[dict[str, Any]]
) -> PairedComparison:
    by_pair = {tuple(cell[key] for key in PAIR): cell for cell in theirs}
    logs: dict[Any, list[float]] = {}
    for cell in ours:
        pair = tuple(cell[key] for key in PAIR)
        match = by_pair[pair]
        if cell["arrived"] and match["arrived"]:
            ratio = log_rms(match) - log_rms(cell)
            logs.setdefault(pair[:-1], []).append(ratio)
    means = np.array([np.mean(values) for values in logs.values()])
    middle, half = _interval(means)
    failed, other_failed = (sum(c["failed"] for c in cells) for cells in (ours, theirs))
    return PairedComparison(
        kind, name, other, math.exp(middle), math.exp(middle - half), math.exp(middle + half),
        len(means), failed, other_failed, len(ours),
    )  # fmt: skip


def _interval(values: Any) -> tuple[float, float]:
    """Mean, and half of its confidence interval."""
    from scipy.stats import t

    if len(values) < 2:
        return (float(values.mean()) if len(values) else math.nan), math.inf
    spread = values.std(ddof=1) / math.sqrt(len(values))
    return float(values.mean()), float(t.ppf(0.5 + CONFIDENCE / 2.0, len(values) - 1) * spread)


def condition_table(comparison: Comparison, controller: str) -> list[list[str]]:
    """Mean RMS (mm) of every controller under every condition, and who beats it; header first.

    A ``+`` marks errors significantly larger than the controller's, ``−`` smaller ones, ``=`` what cannot
    be told apart; failures stand in brackets.
    """
    judged = {(v.condition, v.other): v for v in paired_comparisons(comparison, controller)}
    names = [controller, *(n for n in comparison.controllers if n != controller)]
    rows = [["condition", *names]]
    for kind in dict.fromkeys(cell["plant"] for cell in comparison.cells):
        row = [kind]
        for name in names:
            mark = judged.get((kind, name))
            row.append(_entry(_cells(comparison, name, kind), mark))
        rows.append(row)
    return rows


def _entry(cells: list[dict[str, Any]], pair: PairedComparison | None) -> str:
    alive = [cell["cross_track_rms"] for cell in cells if cell["arrived"]]
    failed = sum(cell["failed"] for cell in cells)
    stopped = [cell["cross_track_max"] for cell in cells if cell["ended"] == "safety stop"]
    text = f"{1e3 * float(np.mean(alive)):.3g}" if alive else "–"
    if stopped:
        known = [largest for largest in stopped if not math.isnan(largest)]
        bound = f", ≤ {1e3 * max(known):.0f} mm" if known else ""
        return f"{len(stopped)} of {len(cells)} stopped{bound}"
    if pair is not None and pair.cells > 1:
        text += {"better": " +", "worse": " −", "equal": " ="}[pair.word]
    return f"{text} ({failed} of {len(cells)} failed)" if failed else text


def summary(found: Iterable[PairedComparison]) -> str:
    """How often the controller is better, equal and worse, in words."""
    words = [pair.word for pair in found if pair.cells > 1]
    counts = {word: words.count(word) for word in ("better", "equal", "worse")}
    return (
        f"Over {len(words)} comparisons the controller is better in {counts['better']}, "
        f"not to be told apart in {counts['equal']} and worse in {counts['worse']}."
    )
