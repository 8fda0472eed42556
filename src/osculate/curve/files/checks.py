"""What is wrong with points as a path, or may be: places that turn round, wrong units, far jumps."""

from typing import NamedTuple

import numpy as np

from osculate.curve.files.found import Array, Found, refuse
from osculate.curve.waypoints import FARTHEST_PLACE, SMALLEST

HUGE = 2e4  # m, extent beyond which coordinates look like millimetres
TINY = 0.2  # m, extent below which coordinates far from the origin look like degrees
FAR_JUMP = 50.0  # median steps
ROUND = ((1, 160.0), (3, 140.0), (10, 100.0))  # points to both sides, degrees between the two
MANY = 20  # points: with fewer the sides may be shorter than that
STRAIGHT = 0.6  # of the way: a side that wanders more is noise around a standstill
THIN = 0.5  # of the usual step: nearer points say nothing about the direction


class Turn(NamedTuple):
    """Where a path turns round."""

    point: int
    place: float  # m along the points


def check_places(points: Array, label: str) -> None:
    """At least two different points, none of them beyond all measure.

    Raises:
        InvalidInput: Fewer, or one too far away.
    """
    far = np.abs(points).max(axis=1, initial=0.0) > FARTHEST_PLACE
    if far.any():
        raise refuse(
            label, f"is further than {FARTHEST_PLACE:g} m away", f"point {int(far.argmax())}"
        )
    if len(points) < 2 or not np.ptp(points, axis=0).any():
        raise refuse(label, f"must hold at least two different points, it has {len(points)}")
    if np.ptp(points, axis=0).max() < SMALLEST:
        raise refuse(label, f"must extend over at least {SMALLEST:g} m; is the scale right?")


def check_flat(points: Array, label: str) -> None:
    """A loop encloses something.

    Raises:
        InvalidInput: All points lie on one line.
    """
    apart = points - points[0]
    if np.linalg.matrix_rank(apart, tol=1e-9 * float(np.abs(apart).max())) < 2:
        raise refuse(label, "all its points lie on one line: that is no loop")


def check_reversal(points: Array, found: Found, label: str, tolerance: float) -> None:
    """No point at which the path goes back on itself.

    Raises:
        InvalidInput: There is one; says which, and where in the file.
    """
    turn = turning(points, tolerance)
    if turn is None:
        return
    line = f" ({found.where(turn.point)})" if len(found.places) and found.place != "point" else ""
    x, y = points[turn.point]
    raise refuse(
        label, f"the path turns round at point {turn.point}{line} = ({x:.6g}, {y:.6g}), "
        f"s = {turn.place:.4g} m; reversing is not supported, split it there",
    )  # fmt: skip


def turning(points: Array, tolerance: float = 0.0) -> Turn | None:
    """The first point at which the direction turns round and stays so, or None.

    Args:
        points: Shape (n, 2).
        tolerance: Noise (m): nearer points say nothing about the direction.
    """
    steps = np.hypot(*np.diff(points, axis=0).T)
    usual = float(np.percentile(steps[steps > 0.0], 75)) if steps.any() else 0.0
    kept = _thinned(points, max(THIN * usual, 2.0 * tolerance))
    thin = points[kept]
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(thin, axis=0).T))])
    edge = 1 if len(thin) < MANY else ROUND[1][0]
    suspects = np.arange(edge, len(thin) - edge)
    for reach, degrees in ROUND[: 2 if len(thin) < MANY else 3]:
        before = np.maximum(suspects - reach, 0)
        after = np.minimum(suspects + reach, len(thin) - 1)
        a, b = thin[suspects] - thin[before], thin[after] - thin[suspects]
        cross, dot = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)
        straight = np.minimum(
            np.hypot(*a.T) / (arc[suspects] - arc[before]),
            np.hypot(*b.T) / (arc[after] - arc[suspects]),
        )
        back = np.abs(np.arctan2(cross, dot)) > np.radians(degrees)
        suspects = suspects[back & (straight > STRAIGHT)]
    if not len(suspects):
        return None
    point = int(kept[suspects[0]])
    return Turn(point, float(steps[:point].sum()))


def _thinned(points: Array, spacing: float) -> Array:
    """Numbers of points that are at least this far apart (m)."""
    kept, last = [0], points[0]
    for n, point in enumerate(points):
        if (point[0] - last[0]) ** 2 + (point[1] - last[1]) ** 2 >= spacing**2 and n:
            kept.append(n)
            last = point
    return np.array(kept)


def doubts(points: Array, found: Found, label: str) -> list[str]:
    """What may be wrong with the numbers, in words."""
    said = []
    extent = float(np.ptp(points, axis=0).max())
    far = len(points) > 2 and extent < TINY and bool((np.abs(points) > 1.0).any())
    if extent > HUGE and "degrees" not in found.units:
        said.append(
            f"{label}: {extent:.3g} m wide; are the coordinates in millimetres? (scale: 0.001)"
        )
    elif far and bool((np.abs(points) <= 180.0).all()) and "degrees" not in found.units:
        said.append(
            f"{label}: {extent:.3g} m wide, far from the origin; are these degrees of latitude and "
            "longitude? Name the columns lat and lon, osculate projects them"
        )
    steps = np.hypot(*np.diff(points, axis=0).T)
    moving = steps[steps > 0.0]
    worst = int(steps.argmax())
    if len(moving) > 10 and steps[worst] > FAR_JUMP * float(np.median(moving)):
        said.append(
            f"{label}: jumps by {steps[worst]:.4g} m from {found.where(worst)} to "
            f"{found.where(worst + 1)}; the usual step is {float(np.median(moving)):.3g} m"
        )
    if found.speeds is not None and (found.speeds < 0.0).any():
        n = int((found.speeds < 0.0).argmax())
        said.append(
            f"{label}: {found.speed_name} is negative from {found.where(n)} on; reversing is not "
            "supported, the sign is not used"
        )
    return said
