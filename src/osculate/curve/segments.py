"""Curves whose curvature is known over arc length: line, arc, clothoid, and chains of them."""

from functools import cached_property
from itertools import pairwise
from typing import Any, Literal, Self

import numpy as np
from pydantic import field_validator, model_validator

from osculate.curve.fitting import fitting, pyclothoids, require_arrival
from osculate.curve.spirals import Pose, Segmented, Spiral, spiral_from
from osculate.errors import InvalidInput
from osculate.spec import Spec, quantity


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
        return (spiral_from(self.start, 0.0, 0.0, self.distance),)


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
        return (spiral_from(self.start, float(bend), 0.0, abs(self.angle) * self.radius),)


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
        with fitting(start, end):
            fitted = pyclothoids().Clothoid.G1Hermite(
                start.x, start.y, start.heading, end.x, end.y, end.heading
            )
            found = cls(
                start=start,
                distance=fitted.length,
                start_curvature=fitted.KappaStart,
                end_curvature=fitted.KappaEnd,
            )
        require_arrival(found, start, end)
        return found

    @cached_property
    def spirals(self) -> tuple[Spiral, ...]:
        """See `Segmented.spirals`."""
        sharpness = (self.end_curvature - self.start_curvature) / self.distance
        return (spiral_from(self.start, self.start_curvature, sharpness, self.distance),)


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
        with fitting(start, end):
            fitted = pyclothoids().SolveG2(
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
        require_arrival(found, start, end)
        return found

    @cached_property
    def spirals(self) -> tuple[Spiral, ...]:
        """See `Segmented.spirals`."""
        spirals: list[Spiral] = []
        at: Any = self.start
        for segment in self.segments:
            sharpness = (segment.last_curvature - segment.curvature) / segment.length
            spirals.append(spiral_from(at, segment.curvature, sharpness, segment.length))
            point = spirals[-1].at(np.array([segment.length]))
            at = Pose(x=float(point.x[0]), y=float(point.y[0]), heading=float(point.heading[0]))
        return tuple(spirals)


def _most(segments: tuple[Segment, ...]) -> float:
    return max(max(abs(s.curvature), abs(s.last_curvature)) for s in segments)
