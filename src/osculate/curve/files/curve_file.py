"""A curve that a file describes, as a field of a scenario or an argument of a function."""

from functools import cached_property
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from osculate.curve.contract import Curve, CurvePoint
from osculate.curve.files.found import Array
from osculate.curve.files.reading import Reading, read_file
from osculate.errors import InvalidInput
from osculate.spec import quantity

DENSE = 16  # samples of the curve for each point, when the points are looked up on it,
LEAST = 4  # or fewer where there are many points,
MANY = 200_000  # so that there are no more samples than this
CHUNK = 2048  # points that are looked up at once
REACH = 48  # samples to both sides of where a point is expected


class CurveFile(Curve):
    """A curve read from a file.

    Formats, told apart by their content: tables (CSV and its kin; waypoints, TUMFTM tracks, f1tenth
    race lines, TUM trajectories, ROS logs), VDA 5050 orders and trajectories, LIF layouts, ROS 2
    messages (YAML, JSON, MCAP), GeoJSON, GPX, KML, OpenDRIVE.

    Raises:
        InvalidInput: No such file, unknown format, a line that is no point (says which one).
    """

    kept_when_pickled: ClassVar[tuple[str, ...]] = ("reading",)
    kind: Literal["file"] = "file"
    path: str
    scale: float = quantity("1", "factor on all coordinates", default=1.0, gt=0)
    loop: bool | None = quantity(
        "1", "whether it is closed; by default its ends decide", default=None
    )
    tolerance: float = quantity(
        "m",
        "largest distance from the (scaled) points; 0 goes through them",
        default=0.0,
        ge=0,
        le=1e6,
    )
    columns: tuple[int | str, int | str] | None = quantity(
        "1", "columns of x and y: numbers from 1, or names; by default found", default=None
    )
    take: str = quantity(
        "1", "which path, topic, vehicle type or road, where a file holds several", default=""
    )
    speeds: bool = quantity("1", "whether the file's speeds are a limit", default=False)

    @cached_property
    def reading(self) -> Reading:
        """What was understood of the file."""
        return self.read()

    def read(self, on_progress: object = None) -> Reading:
        """Read the file, once.

        Raises:
            InvalidInput: See `read_file`; or its speeds are asked for and there are none.
        """
        if "reading" in self.__dict__:
            return self.reading
        reading = read_file(
            self.path, self.scale, self.loop, self.tolerance, self.columns, self.take,
            on_progress if callable(on_progress) else None,
        )  # fmt: skip
        if self.speeds and reading.speeds is None:
            raise InvalidInput("speeds", True, f"{self.path} has no column or field of speeds")
        if self.speeds and reading.speeds is not None and reading.speeds.min() < 0.0:
            raise InvalidInput("speeds", True, f"{self.path} has negative speeds")
        self.__dict__["reading"] = reading
        return reading

    @property
    def curve(self) -> Curve:
        """The curve that the file describes."""
        return self.reading.curve

    @property
    def closed(self) -> bool:
        """See `Curve.closed`."""
        return self.curve.closed

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return self.curve.length

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        return self.curve.at(arc_length)

    def speed_limit(self, arc_length: ArrayLike) -> Array | None:
        """See `Curve.speed_limit`: the file's speeds (m/s), if `speeds` asks for them."""
        if not self.speeds:
            return None
        places, speeds = self._speed_table
        limit: Array = np.interp(np.asarray(arc_length, dtype=float), places, speeds)
        return limit

    @cached_property
    def _speed_table(self) -> tuple[Array, Array]:
        """Arc lengths of the points (m) and the speeds there (m/s)."""
        reading = self.reading
        assert reading.points is not None
        assert reading.speeds is not None
        places = along(reading.curve, reading.points)
        if not reading.closed:
            return places, reading.speeds
        return np.append(places, self.length), np.append(reading.speeds, reading.speeds[0])


def along(curve: Curve, points: Array) -> Array:
    """Arc length (m) of the places of a curve that are nearest to its points, in their order.

    Args:
        curve: Goes through the points or near them, closed or open.
        points: Shape (n, 2).
    """
    around = np.concatenate([points, points[:1]]) if curve.closed else points
    chords = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(around, axis=0).T))])
    count = len(around) * max(LEAST, min(DENSE, MANY // len(around)))
    s = np.linspace(0.0, curve.length, count + 1)
    point = curve.at(s)
    guess = np.rint(chords[: len(points)] / chords[-1] * (len(s) - 1)).astype(int)
    feet = []
    for first in range(0, len(points), CHUNK):
        here = guess[first : first + CHUNK, None] + np.arange(-REACH, REACH + 1)
        here = np.clip(here, 0, len(s) - 1)
        apart = np.hypot(
            *(np.stack([point.x[here], point.y[here]]) - points[first : first + CHUNK].T[..., None])
        )
        feet.append(s[np.take_along_axis(here, apart.argmin(axis=1)[:, None], axis=1)[:, 0]])
    return np.maximum.accumulate(np.concatenate(feet))


def read_curve(
    path: str | Path, scale: float = 1.0, loop: bool | None = None, tolerance: float = 0.0
) -> Curve:
    """Read a curve from a file; see `CurveFile`, and `read_file` for what was understood."""
    return read_file(path, scale, loop, tolerance).curve
