"""Exact pieces one after the other: joined where they are smooth, rounded within a tolerance."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from osculate.curve.composite import Composite
from osculate.curve.contract import Curve
from osculate.curve.files.found import Array, Wishes, refuse

GAP = 1e-3  # m, of position: what writing millimetres makes
CORNER = 2e-3  # rad
JUMP = 1e-3  # 1/m, of curvature
FINEST = 5000  # points at most that a rounded piece is taken at


class Piece(NamedTuple):
    """One piece and its name in the file."""

    name: str
    curve: Curve

    @property
    def start(self) -> tuple[float, float]:
        """First point (m)."""
        point = self.curve.at(0.0)
        return float(point.x), float(point.y)

    @property
    def end(self) -> tuple[float, float]:
        """Last point (m)."""
        point = self.curve.at(self.curve.length)
        return float(point.x), float(point.y)


def joined(
    pieces: Sequence[Piece], label: str, wishes: Wishes
) -> tuple[Array | None, Curve | None]:
    """One curve of all pieces; or, if a tolerance is allowed, points close together along them.

    Raises:
        InvalidInput: A gap, a corner, or a jump of curvature; names both pieces, the place and the size.
    """
    place = 0.0
    for before, after in pairwise(pieces):
        place += before.curve.length
        _check(before, after, place, label, rounded=wishes.tolerance > 0.0)
    if wishes.tolerance > 0.0 and len(pieces) > 1:
        return _points(pieces, wishes), None
    if wishes.loop:
        raise refuse(label, "is driven once from its first to its last piece; --loop is for points")
    if len(pieces) == 1:
        return None, pieces[0].curve
    curves = tuple(piece.curve for piece in pieces)
    return None, Composite(
        pieces=curves, position_jump=GAP, heading_jump=CORNER, curvature_jump=JUMP
    )


def _check(before: Piece, after: Piece, place: float, label: str, *, rounded: bool) -> None:
    a, b = before.curve.at(before.curve.length), after.curve.at(0.0)
    gap = float(np.hypot(b.x - a.x, b.y - a.y))
    where = f"between {before.name} and {after.name} at s = {place:.4g} m"
    if gap > GAP:
        raise refuse(label, f"there is a gap of {gap:.4g} m {where}")
    if rounded:
        return
    turn = float(np.angle(np.exp(1j * (b.heading - a.heading))))
    jump = float(b.curvature - a.curvature)
    hint = "; --tolerance 0.05 rounds it within 0.05 m"
    if abs(turn) > CORNER:
        raise refuse(label, f"the heading jumps by {np.degrees(turn):.4g}° {where}{hint}")
    if abs(jump) > JUMP:
        raise refuse(label, f"the curvature jumps by {jump:.4g} 1/m {where}{hint}")


def _points(pieces: Sequence[Piece], wishes: Wishes) -> Array:
    """Points along all pieces (before the scale), shape (n, 2)."""
    parts: list[Array] = []
    for piece in pieces:
        step = max(wishes.tolerance, piece.curve.length / FINEST)
        count = max(4, int(np.ceil(piece.curve.length / step)))
        point = piece.curve.at(np.linspace(0.0, piece.curve.length, count + 1))
        parts.append(np.stack([point.x, point.y], axis=1)[bool(parts) :])
    return np.concatenate(parts) / wishes.scale
