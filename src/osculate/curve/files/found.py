"""What a reader is asked and what it answers: the records that all formats share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.errors import InvalidInput

Array = NDArray[np.float64]
Choice = tuple[int | str, int | str]


class Wishes(NamedTuple):
    """What the user said about a file."""

    scale: float = 1.0  # factor on all coordinates
    loop: bool | None = None  # closed or open; None: the file decides
    tolerance: float = 0.0  # m, largest distance from the points
    columns: Choice | None = None  # x and y: numbers of columns, from 1, or names
    take: str = ""  # which path, topic, vehicle type, road …, where a file holds several
    on_progress: Callable[[float], None] = lambda fraction: None  # told the fraction read


@dataclass(frozen=True)
class Found:
    """What a file holds: points or a whole curve, and how it was understood."""

    format: str  # as users call it
    points: Array | None = None  # m, shape (n, 2), before the scale
    curve: Curve | None = None  # instead of points, the scale already applied
    rows: tuple[tuple[str, str], ...] = ()  # label and value: columns, message, edges …
    units: str = "m"  # what the numbers were taken for
    closed: tuple[bool, str] | None = None  # if the format says so, and in which words
    speeds: Array | None = None  # m/s, shape (n,)
    speed_name: str = ""  # how the file calls the speeds
    places: Sequence[int] = ()  # where each point stands in the file
    place: str = "point"  # what `places` counts: line, point, message …
    warnings: tuple[str, ...] = field(default=())  # what may be wrong

    def where(self, point: int) -> str:
        """Where a point stands in the file, in words."""
        if not len(self.places):
            return f"point {point}"
        return f"{self.place} {self.places[point]}"


def refuse(label: str, message: str, where: str = "") -> InvalidInput:
    """The error of a file that cannot be read, with the place in it."""
    return InvalidInput("path", f"{label}, {where}" if where else label, message)
