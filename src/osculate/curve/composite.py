"""Curves made of curves: pieces one after the other, and laps of a closed one."""

from functools import cached_property
from itertools import pairwise
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import SerializeAsAny, field_validator, model_validator

from osculate.curve.contract import Array, Curve, CurvePoint, at_joined
from osculate.errors import InvalidInput
from osculate.spec import quantity


def as_curve(value: Any) -> Curve:
    """A curve from a curve or from plain data such as a YAML file holds."""
    if isinstance(value, Curve):
        return value
    from osculate.curve import parse_curve  # it knows all kinds, this one among them

    return parse_curve(value)


#: Largest jumps that rounded numbers make; at a larger one no robot stays on the curve.
FOLLOWABLE = {"position_jump": 0.01, "heading_jump": 0.01, "curvature_jump": 0.05}


def require_followable(field: str, jump: float) -> None:
    """Refuse to allow a jump that no steering follows.

    Raises:
        InvalidInput: Says what to do about a larger one.
    """
    most = FOLLOWABLE[field]
    if jump > most:
        raise InvalidInput(
            field, jump, f"must be at most {most:g}: no robot follows a larger jump; join the pieces by a "
            "clothoid, or take points and a tolerance that rounds it",
        )  # fmt: skip


class Composite(Curve):
    """Curves joined end to start, checked for jumps of position, heading and curvature.

    The jumps that may be allowed are those of rounded numbers, at most 1 cm, 0.01 rad and 0.05 1/m.

    Raises:
        InvalidInput: A join is not smooth enough; says which one, where and how much it jumps.
    """

    kind: Literal["composite"] = "composite"
    pieces: tuple[SerializeAsAny[Curve], ...]
    position_jump: float = quantity("m", "largest jump of position allowed", default=1e-6, ge=0)
    heading_jump: float = quantity("rad", "largest jump of heading allowed", default=1e-6, ge=0)
    curvature_jump: float = quantity("1/m", "largest jump of curvature allowed", default=1e-4, ge=0)

    @field_validator("pieces", mode="before")
    @classmethod
    def _parsed(cls, pieces: Any) -> Any:
        if not isinstance(pieces, (list, tuple)) or not pieces:
            raise ValueError("must be a list of at least one curve")
        return tuple(as_curve(piece) for piece in pieces)

    @model_validator(mode="after")
    def _joined(self) -> Self:
        for name in FOLLOWABLE:
            require_followable(name, getattr(self, name))
        place = 0.0
        for n, (before, after) in enumerate(pairwise(self.pieces)):
            place += before.length
            check_join(
                before, after, f"pieces.{n + 1}", place,
                (self.position_jump, self.heading_jump, self.curvature_jump),
            )  # fmt: skip
        return self

    @cached_property
    def _turns(self) -> list[float]:
        """Whole turns to add to the headings of each piece so that they continue."""
        turns = [0.0]
        for before, after in pairwise(self.pieces):
            end = float(before.at(before.length).heading) + turns[-1]
            turns.append(
                float(2.0 * np.pi * np.round((end - float(after.at(0.0).heading)) / (2.0 * np.pi)))
            )
        return turns

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return float(sum(piece.length for piece in self.pieces))

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""

        def piece(n: int, s: Array) -> CurvePoint:
            point = self.pieces[n].at(s)
            return point._replace(heading=point.heading + self._turns[n])

        return at_joined([part.length for part in self.pieces], piece, arc_length)

    def speed_limit(self, arc_length: ArrayLike) -> Array | None:
        """See `Curve.speed_limit`: those of the pieces; where two meet, the lower one."""
        s = np.asarray(arc_length, dtype=float)
        limit = np.full(s.shape, np.inf)
        begin = 0.0
        for piece in self.pieces:
            end = begin + piece.length
            here = (s >= begin - 1e-9) & (s <= end + 1e-9)
            own = piece.speed_limit(np.clip(s[here] - begin, 0.0, piece.length))
            if own is not None:
                limit[here] = np.minimum(limit[here], own)
            begin = end
        return limit if np.isfinite(limit).any() else None


class Laps(Curve):
    """A closed curve, driven around several times."""

    kind: Literal["laps"] = "laps"
    track: SerializeAsAny[Curve]
    count: int = quantity("1", "number of laps", default=2, ge=1)

    @field_validator("track", mode="before")
    @classmethod
    def _parsed(cls, track: Any) -> Any:
        return as_curve(track)

    @model_validator(mode="after")
    def _closed(self) -> Self:
        track = self.track
        if not track.closed:
            ends = track.at(np.array([0.0, track.length]))
            gap = float(np.hypot(*np.diff([ends.x, ends.y])[:, 0]))
            raise InvalidInput(
                "track", type(track).__name__, f"must be a closed curve; its end is {gap:.4g} m from its "
                "start and does not lead into it (loop: true closes a spline or a file)",
            )  # fmt: skip
        check_join(track, track, "track", track.length, (1e-6 * max(1.0, track.length), 1e-6, 1e-4))
        return self

    @property
    def closed(self) -> bool:
        """See `Curve.closed`."""
        return True

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return self.track.length * self.count

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        s = np.clip(np.asarray(arc_length, dtype=float), 0.0, self.length)
        lap = np.minimum(np.floor(s / self.track.length), self.count - 1)
        point = self.track.at(s - lap * self.track.length)
        return point._replace(heading=point.heading + lap * self.track.total_turn)

    def speed_limit(self, arc_length: ArrayLike) -> Array | None:
        """See `Curve.speed_limit`: that of the track, in every lap."""
        return self.track.speed_limit(np.asarray(arc_length, dtype=float) % self.track.length)


class Part(Curve):
    """A part of a curve."""

    kind: Literal["part"] = "part"
    curve: SerializeAsAny[Curve]
    start: float = quantity("m", "arc length at which it begins", default=0.0, ge=0)
    end: float = quantity("m", "arc length at which it ends", gt=0)

    @field_validator("curve", mode="before")
    @classmethod
    def _parsed(cls, curve: Any) -> Any:
        return as_curve(curve)

    @model_validator(mode="after")
    def _inside(self) -> Self:
        if not self.start < self.end <= self.curve.length * (1.0 + 1e-12):
            raise InvalidInput(
                "end", self.end, f"must be above start and at most {self.curve.length:.6g} m"
            )
        return self

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return self.end - self.start

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        s = np.clip(np.asarray(arc_length, dtype=float), 0.0, self.length)
        return self.curve.at(self.start + s)

    def speed_limit(self, arc_length: ArrayLike) -> Array | None:
        """See `Curve.speed_limit`."""
        return self.curve.speed_limit(self.start + np.asarray(arc_length, dtype=float))


def check_join(
    before: Curve, after: Curve, field: str, place: float, allowed: tuple[float, float, float]
) -> None:
    """Refuse a jump from the end of one curve to the start of the next.

    Raises:
        InvalidInput: Says where (arc length, m), how much, and how much is allowed.
    """
    end, start = before.at(before.length), after.at(0.0)
    turn = float(start.heading) - float(end.heading)
    jumps = (
        ("position", float(np.hypot(start.x - end.x, start.y - end.y)), "m"),
        ("heading", abs(turn - 2.0 * np.pi * round(turn / (2.0 * np.pi))), "rad"),
        ("curvature", abs(float(start.curvature) - float(end.curvature)), "1/m"),
    )
    for (what, jump, unit), limit in zip(jumps, allowed, strict=True):
        if jump > limit:
            raise InvalidInput(
                field,
                type(after).__name__,
                f"its {what} jumps by {jump:.4g} {unit} at s = {place:.6g} m; at most {limit:g} {unit}",
            )
