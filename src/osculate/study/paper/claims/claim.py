"""One statement of the paper, and the checks that judge it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from osculate.curve import Cycloid
from osculate.simulation import Run
from osculate.study.paper.readings import Reading, SquareSum
from osculate.vehicle import Tricycle
from osculate.vehicle.derivation import Derivation

HOLDS, FAILS = "holds", "does not hold"


class Evidence(NamedTuple):
    """What the statements are judged by."""

    curve: Cycloid
    robot: Tricycle
    derived: Derivation
    runs: Mapping[str, Run]  # by the names of the experiments
    readings: Sequence[Reading]  # of Figures 3 to 5
    square_sums: Sequence[SquareSum]  # of Figure 6


@dataclass(frozen=True)
class Claim:
    """One statement of the paper and what became of it."""

    id: str
    statement: str
    source: str  # where in the paper: equation or section, and sentence
    expected: float | str  # what the paper says
    measured: float
    unit: str
    criterion: str  # what had to be true for "holds"
    judgement: str  # "holds", "does not hold" or "holds only if ..."
    note: str = ""
    erratum: int | None = None  # number of the erratum that says more

    @property
    def expected_text(self) -> str:
        """The paper's value, readable."""
        return self.expected if isinstance(self.expected, str) else text(self.expected, self.unit)

    @property
    def measured_text(self) -> str:
        """Our value, readable."""
        return text(self.measured, self.unit)


class Condition(NamedTuple):
    """Under what a statement holds that does not hold as it stands."""

    words: str
    met: bool  # whether it really does then


def text(value: float, unit: str) -> str:
    """A number with its unit, readable."""
    number = f"{value:.6g}" if 1e-3 <= abs(value) < 1e6 or value == 0 else f"{value:.2e}"
    return f"{number} {unit}" if unit not in ("", "1") else number


def judge(holds: bool, condition: Condition | None = None) -> str:
    """The judgement that follows from a check and, where it fails, from the check of a condition."""
    if holds:
        return HOLDS
    return f"holds only if {condition.words}" if condition and condition.met else FAILS


def printed(
    name: str, statement: str, source: str, expected: float, measured: float, unit: str,
    tolerance: float = 1e-4, condition: Condition | None = None, **more: str | int,
) -> Claim:  # fmt: skip
    """A number that the paper prints; the default tolerance is one unit of the fourth decimal."""
    agrees = abs(measured - expected) <= tolerance
    return _claim(
        name, statement, source, expected, measured, unit,
        f"|ours − paper's| ≤ {text(tolerance, unit)}", judge(agrees, condition), more,
    )  # fmt: skip


def observed(
    name: str, statement: str, source: str, expected: str, measured: float, unit: str,
    criterion: str, holds: bool, condition: Condition | None = None, **more: str | int,
) -> Claim:  # fmt: skip
    """A statement in words, with the criterion that it is measured by."""
    judgement = judge(bool(holds), condition)
    return _claim(name, statement, source, expected, measured, unit, criterion, judgement, more)


def _claim(
    name: str, statement: str, source: str, expected: float | str, measured: float, unit: str,
    criterion: str, judgement: str, more: Mapping[str, str | int],
) -> Claim:  # fmt: skip
    erratum = more.get("erratum")
    return Claim(
        name, statement, source, expected, float(measured), unit, criterion, judgement,
        str(more.get("note", "")), None if erratum is None else int(erratum),
    )  # fmt: skip
