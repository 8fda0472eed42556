"""Curves whose curvature is known over arc length: line, arc, clothoid, and chains of them."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import field_validator, model_validator

from osculate.curve.contract import Curve, CurvePoint, at_joined
from osculate.errors import InvalidInput, InvalidScenario, MissingExtra, NoSolution
from osculate.spec import Spec, quantity

Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
MOST_TURN = 1e6  # rad, in one piece: more is a mistake, and would not fit into memory
DETOUR = 10.0  # times the distance: a fitted clothoid that is longer goes round in circles
PANEL_TURN = 0.5  # rad, turn of one panel of quadrature: its error is below 1e-15 of its length


class Pose(Spec):
    """A place and a direction in the map frame."""

    x: float = quantity("m", "position, x", default=0.0)
    y: float = quantity("m", "position, y", default=0.0)
    heading: float = quantity("rad", "counter-clockwise from x", default=0.0)


class Spiral(NamedTuple):
    """A clothoid from its start: κ(s) = curvature + sharpness · s; arc and line are special cases."""

    x: float  # m
    y: float  # m
    heading: float  # rad
    curvature: float  # 1/m, at the start
    sharpness: float  # 1/m², dκ/ds
    length: float  # m

    def at(self, arc_length: Array) -> CurvePoint:
        """The spiral at arc lengths (m), shape (n,), by Gauss–Legendre quadrature of its heading."""
        turn = abs(self.curvature) * self.length + abs(self.sharpness) * self.length**2
        panels = max(1, int(np.ceil(turn / PANEL_TURN)))
        edges = np.linspace(0.0, self.length, panels + 1)
        steps = self._displacement(edges[:-1], edges[1:])
        corners = np.concatenate([[[self.x, self.y]], [self.x, self.y] + np.cumsum(steps, axis=0)])
        panel = np.clip(np.searchsorted(edges, arc_length, side="right") - 1, 0, panels - 1)
        place = corners[panel] + self._displacement(edges[panel], arc_length)
        return CurvePoint(
            place[:, 0],
            place[:, 1],
            self._heading(arc_length),
            self.curvature + self.sharpness * arc_length,
            np.full(len(arc_length), self.sharpness),
        )

    def _heading(self, s: Array) -> Array:
        return self.heading + self.curvature * s + 0.5 * self.sharpness * s * s

    def _displacement(self, start: Array, end: Array) -> Array:
        half = 0.5 * (end - start)[:, None]
        heading = self._heading(0.5 * (end + start)[:, None] + half * _NODES)
        parts = [(np.cos(heading) * half) @ _WEIGHTS, (np.sin(heading) * half) @ _WEIGHTS]
        return np.stack(parts, axis=1)


class Segmented(Curve):
    """A curve that consists of spirals, one after the other."""

    @cached_property
    def spirals(self) -> tuple[Spiral, ...]:
        """The spirals in order; the end of each is the start of the next."""
        raise NotImplementedError

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return float(sum(spiral.length for spiral in self.spirals))

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        lengths = [spiral.length for spiral in self.spirals]
        return at_joined(lengths, lambda n, s: self.spirals[n].at(s), arc_length)


class Line(Segmented):
    """A straight line."""

    kind: Literal["line"] = "line"
    start: Pose = Pose()
    distance: float = quantity("m", "length of the line", gt=0)

    @classmethod
    def between(cls, a: tuple[float, float], b: tuple[float, float]) -> Self:
        """From point ``a`` to point ``b`` (m)."""
        dx, dy = b[0] - a[0], b[1] - a[1]
        start = Pose(x=a[0], y=a[1], heading=float(np.arctan2(dy, dx)))
        return cls(start=start, distance=float(np.hypot(dx, dy)))

    @cached_property
    def spirals(self) -> tuple[Spiral, ...]:
        """See `Segmented.spirals`."""
        return (_spiral(self.start, 0.0, 0.0, self.distance),)


class Arc(Segmented):
    """A circular arc; a positive angle turns left."""

    kind: Literal["arc"] = "arc"
    start: Pose = Pose()
    radius: float = quantity("m", "radius", gt=0)
    angle: float = quantity("rad", "turn, left is positive")

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if self.angle == 0.0:
            raise InvalidInput("angle", self.angle, "must not be 0; use a line")
        return self

    @cached_property
    def spirals(self) -> tuple[Spiral, ...]:
        """See `Segmented.spirals`."""
        bend = np.sign(self.angle) / self.radius
        return (_spiral(self.start, float(bend), 0.0, abs(self.angle) * self.radius),)


class Clothoid(Segmented):
    """A curve whose curvature changes linearly with arc length (Euler spiral)."""

    kind: Literal["clothoid"] = "clothoid"
    start: Pose = Pose()
    distance: float = quantity("m", "length", gt=0)
    start_curvature: float = quantity("1/m", "curvature at the start", default=0.0)
    end_curvature: float = quantity("1/m", "curvature at the end", default=0.0)

    @classmethod
    def between(cls, start: Pose, end: Pose) -> Self:
        """The one clothoid from pose to pose (G1 Hermite fit, Bertolazzi and Frego).

        Raises:
            InvalidInput: Start and end are the same place.
            NoSolution: The clothoid found is no sensible way: it goes round in large circles.
            MissingExtra: The library that fits is not installed.
        """
        with _fitting(start, end):
            fitted = _pyclothoids().Clothoid.G1Hermite(
                start.x, start.y, start.heading, end.x, end.y, end.heading
            )
            found = cls(
                start=start,
                distance=fitted.length,
                start_curvature=fitted.KappaStart,
                end_curvature=fitted.KappaEnd,
            )
        _require_arrival(found, start, end)
        return found

    @cached_property
    def spirals(self) -> tuple[Spiral, ...]:
        """See `Segmented.spirals`."""
        sharpness = (self.end_curvature - self.start_curvature) / self.distance
        return (_spiral(self.start, self.start_curvature, sharpness, self.distance),)


class Segment(Spec):
    """One piece of a `Chain`: its curvature changes linearly over its length."""

    length: float = quantity("m", "length", gt=0)
    curvature: float = quantity("1/m", "curvature at its start, left is positive", default=0.0)
    end_curvature: float | None = quantity(
        "1/m", "curvature at its end; by default as at its start", default=None
    )

    @property
    def last_curvature(self) -> float:
        """Curvature at its end (1/m)."""
        return self.curvature if self.end_curvature is None else self.end_curvature


class Chain(Segmented):
    """Lines, arcs and clothoids one after the other, each starting where the last one ended.

    Raises:
        InvalidInput: The curvature jumps from one segment to the next (says where and how much).
    """

    kind: Literal["chain"] = "chain"
    start: Pose = Pose()
    segments: tuple[Segment, ...]
    curvature_jump: float = quantity("1/m", "largest jump that is allowed", default=1e-9, ge=0)

    @field_validator("segments")
    @classmethod
    def _some(cls, segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
        if not segments:
            raise ValueError("must be at least one segment")
        return segments

    @model_validator(mode="after")
    def _smooth(self) -> Self:
        place = 0.0
        for n, (before, after) in enumerate(pairwise(self.segments)):
            place += before.length
            jump = after.curvature - before.last_curvature
            if abs(jump) > self.curvature_jump:
                raise InvalidInput(
                    f"segments.{n + 1}.curvature",
                    after.curvature,
                    f"jumps by {jump:.4g} 1/m at s = {place:.4g} m; must continue with "
                    f"{before.last_curvature:.6g} 1/m (put a clothoid between)",
                )
        return self

    @classmethod
    def corner(
        cls, turn: float, radius: float, ramp: float, straight: float, start: Pose | None = None
    ) -> Self:
        """A corner: straight, clothoid ramp, arc, ramp, straight.

        Args:
            turn: Whole turn (rad), left is positive.
            radius: Radius of the arc (m).
            ramp: Length of each ramp (m).
            straight: Length of the straights before and after (m).
            start: Where it begins.

        Raises:
            InvalidInput: The ramps alone turn further than that.
        """
        bend = float(np.sign(turn)) / radius
        arc = abs(turn) * radius - ramp
        if not arc > 0:
            raise InvalidInput("ramp", ramp, f"must be below {abs(turn) * radius:.4g} m")
        segments = (
            Segment(length=straight),
            Segment(length=ramp, curvature=0.0, end_curvature=bend),
            Segment(length=arc, curvature=bend),
            Segment(length=ramp, curvature=bend, end_curvature=0.0),
            Segment(length=straight),
        )
        return cls(start=start or Pose(), segments=segments)

    @classmethod
    def between(cls, start: Pose, end: Pose, curvatures: tuple[float, float] = (0.0, 0.0)) -> Self:
        """Three clothoids from pose to pose with given curvatures at both ends (G2 Hermite fit).

        Raises:
            InvalidInput: Start and end are the same place.
            NoSolution: The clothoids found are no sensible way: they go round in large circles.
            MissingExtra: The library that fits is not installed.
        """
        with _fitting(start, end):
            fitted = _pyclothoids().SolveG2(
                start.x, start.y, start.heading, curvatures[0],
                end.x, end.y, end.heading, curvatures[1],
            )  # fmt: skip
            segments = tuple(
                Segment(length=part.length, curvature=part.KappaStart, end_curvature=part.KappaEnd)
                for part in fitted
            )
            found = cls(
                start=start, segments=segments, curvature_jump=1e-6 * max(1.0, _most(segments))
            )
        _require_arrival(found, start, end)
        return found

    @cached_property
    def spirals(self) -> tuple[Spiral, ...]:
        """See `Segmented.spirals`."""
        spirals: list[Spiral] = []
        at: Any = self.start
        for segment in self.segments:
            sharpness = (segment.last_curvature - segment.curvature) / segment.length
            spirals.append(_spiral(at, segment.curvature, sharpness, segment.length))
            point = spirals[-1].at(np.array([segment.length]))
            at = Pose(x=float(point.x[0]), y=float(point.y[0]), heading=float(point.heading[0]))
        return tuple(spirals)


def _spiral(start: Pose, curvature: float, sharpness: float, length: float) -> Spiral:
    turn = abs(curvature) * length + abs(sharpness) * length**2
    if not turn <= MOST_TURN:
        raise InvalidInput(
            "curve", f"a piece that turns by up to {turn:.3g} rad over {length:.4g} m",
            f"must turn by at most {MOST_TURN:g} rad; it would need {turn / PANEL_TURN:.3g} panels",
        )  # fmt: skip
    return Spiral(start.x, start.y, start.heading, curvature, sharpness, length)


def _most(segments: tuple[Segment, ...]) -> float:
    return max(max(abs(s.curvature), abs(s.last_curvature)) for s in segments)


@contextmanager
def _fitting(start: Pose, end: Pose) -> Iterator[None]:
    """Refuse poses at one place, and turn what the library or its results raise into one sentence."""
    distance = float(np.hypot(end.x - start.x, end.y - start.y))
    if not distance > 1e-9 * max(1.0, abs(start.x), abs(start.y)):
        raise InvalidInput(
            "end", f"({end.x:g}, {end.y:g})", "must be another place than the start: no clothoid "
            "turns on the spot",
        )  # fmt: skip
    try:
        yield
    except (RuntimeError, InvalidInput, InvalidScenario) as error:
        raise NoSolution(f"no clothoid leads {_between(start, end)} ({error})") from None


def _require_arrival(found: Segmented, start: Pose, end: Pose) -> None:
    """Check what a library returned: it must end at the end, and not by a large detour."""
    distance = float(np.hypot(end.x - start.x, end.y - start.y))
    last = found.at(found.length) if found.length <= DETOUR * distance else None
    if last is None:
        raise NoSolution(
            f"no sensible clothoid leads {_between(start, end)}: the one found is {found.length:.4g} m "
            f"long for a distance of {distance:.4g} m; put a pose between"
        )
    miss = float(np.hypot(last.x - end.x, last.y - end.y))
    turned = abs(np.angle(np.exp(1j * (float(last.heading) - end.heading))))
    if not (miss <= 1e-6 * distance and turned <= 1e-6):
        raise NoSolution(
            f"no clothoid leads {_between(start, end)}: the one found misses the end by {miss:.4g} m and "
            f"is turned by {np.degrees(turned):.4g}° from it"
        )


def _between(start: Pose, end: Pose) -> str:
    first, last = (f"({p.x:g}, {p.y:g}, {p.heading:.4g} rad)" for p in (start, end))
    return f"from {first} to {last}"


def _pyclothoids() -> Any:
    try:
        import pyclothoids
    except ImportError:
        raise MissingExtra("clothoids", "pyclothoids") from None
    return pyclothoids
