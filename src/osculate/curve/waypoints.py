"""What lists of points are like before a curve goes through them: repeats, jitter, noise, turning back.

Everything here takes and returns plain arrays; indices count the points as they were given.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.errors import InvalidInput

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

FARTHEST_PLACE = 1e11  # m, where doubles resolve 0.02 mm
SMALLEST = 1e-9  # m, extent of a path
DUPLICATE = 1e-9  # of the whole extent: points closer than this are one
NEAR = 0.02  # of both neighbouring steps: a step shorter than this joins one point with itself
END = 0.1  # of the next step: what a step at an end of the list is compared with
JITTER = np.radians(100.0)  # a robot that moves on turns less from one step to the next
NOISE = 0.02  # of all points: where more of them turn like that, none of them is a reversal
ROUND = np.radians(150.0)  # a turn that no forward motion makes on the spot
FEWEST_TURNS = 5  # of that kind beside each other that make a standstill; noise has fewer
FARTHEST = 6  # points from one such turn to the next within a standstill
FEWEST = 16  # points from which on noise can be told from shape


class Merged(NamedTuple):
    """Which points remain."""

    kept: Indices  # indices of the points that remain, increasing, shape (k,)
    near: Indices  # points dropped because they lie beside their predecessor
    still: list[tuple[int, int, float]]  # first and last point of every standstill, its radius (m)


def steps_of(points: Array) -> Array:
    """Distances (m) from point to point, shape (n − 1,)."""
    lengths: Array = np.hypot(*np.diff(points, axis=0).T)
    return lengths


def turns_of(points: Array) -> Array:
    """Angles (rad, −π…π) by which the polyline turns at its inner points, shape (n − 2,)."""
    way = np.diff(points, axis=0) @ np.array([1.0, 1.0j])
    angles: Array = np.angle(way[1:] * way[:-1].conj())
    return angles


def require_measure(points: Array) -> None:
    """Points that arithmetic can tell apart and hold.

    Raises:
        ValueError: One of them is too far away, or all are nearly in one place.
    """
    far = np.abs(points).max(axis=1) > FARTHEST_PLACE
    if far.any():
        raise ValueError(f"must be at most {FARTHEST_PLACE:g} m away; point {far.argmax()} is not")
    if np.ptp(points, axis=0).max() < SMALLEST:
        raise ValueError(f"must extend over at least {SMALLEST:g} m")


def distinct(points: Array) -> Array:
    """The points without those that repeat their predecessor."""
    return points[_different(points)]


def _different(points: Array) -> Indices:
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    return np.flatnonzero(np.append(True, steps_of(points) > DUPLICATE * extent))


def merge(points: Array) -> Merged:
    """Make one point of points that repeat, nearly coincide, or jitter about one place.

    Args:
        points: Shape (n, 2), m.
    """
    kept = _different(points)
    still: list[tuple[int, int, float]] = []
    for first, last in _standstills(points[kept]):
        radius = _radius(points[kept[first : last + 1]])
        still.append((int(kept[first]), int(kept[last]), radius))
    for begin, end, _ in still:
        here = (kept >= begin) & (kept <= end)
        if not here.any():  # one of two that overlap
            continue
        place = points[kept[here]]
        middle = kept[here][np.hypot(*(place - place.mean(axis=0)).T).argmin()]
        kept = kept[~here | (kept == middle)]
    near = _beside(points[kept])
    return Merged(np.delete(kept, near), kept[near], still)


def _beside(points: Array) -> Indices:
    """Points whose step from their predecessor is far shorter than the steps around it."""
    steps = steps_of(points)
    if len(steps) < 2:
        return np.empty(0, dtype=np.intp)
    before, after = np.append(END * steps[1], steps[:-1]), np.append(steps[1:], END * steps[-2])
    short = np.flatnonzero(steps < NEAR * np.minimum(before, after))
    return np.where(short == len(steps) - 1, short, short + 1)  # the last point stays


def _standstills(points: Array) -> list[tuple[int, int]]:
    """First and last points of the places where the polyline goes to and fro."""
    back = np.flatnonzero(np.abs(turns_of(points)) > JITTER) + 1
    if len(back) < FEWEST_TURNS:
        return []
    groups = np.split(back, np.flatnonzero(np.diff(back) > FARTHEST) + 1)
    ends = [(int(g[0]), int(g[-1])) for g in groups if len(g) >= FEWEST_TURNS]
    places = [
        (a, b) for a, b in ends if np.count_nonzero((back >= a) & (back <= b)) > 0.3 * (b - a)
    ]
    driven = np.ones(len(points) - 1, dtype=bool)
    for first, last in places:
        driven[first:last] = False
    usual = float(np.median(steps_of(points)[driven])) if driven.any() else 0.0
    return [_widened(points, a, b) for a, b in places if _radius(points[a : b + 1]) <= usual]


def _widened(points: Array, first: int, last: int) -> tuple[int, int]:
    """A standstill with the points before and after that lie no farther from its middle."""
    place = points[first : last + 1]
    away = np.hypot(*(points - place.mean(axis=0)).T) <= 1.2 * _radius(place)
    while first > 0 and away[first - 1]:
        first -= 1
    while last < len(points) - 1 and away[last + 1]:
        last += 1
    return first, last


def _radius(points: Array) -> float:
    return float(np.hypot(*(points - points.mean(axis=0)).T).max())


def require_forward(points: Array, names: Indices, loop: bool) -> None:
    """Refuse a list that turns round at one of its points.

    A single sharp turn between smooth parts is a reversal; many of them are noise.

    Args:
        points: Shape (n, 2), m; a loop ends with its first point.
        names: The points' indices as the user counts them.
        loop: Whether the list is closed.

    Raises:
        InvalidInput: Names the point and its arc length along the polyline.
    """
    around = np.concatenate([points[-2:-1], points, points[1:2]]) if loop else points
    turns = np.abs(turns_of(around))
    if np.count_nonzero(turns > JITTER) > max(3, NOISE * len(turns)):
        return
    sharp = np.flatnonzero(turns > ROUND)
    for n in sharp.tolist():
        beside = np.delete(turns[max(0, n - 1) : n + 2], min(n, 1))
        wide = around[[max(0, n - 2), n + 1, min(len(around) - 1, n + 4)]]
        if (beside < 1.0).all() and np.abs(turns_of(wide))[0] > 2.0:
            place = n if loop else n + 1
            along = float(steps_of(points[: place + 1]).sum())
            x, y = points[place]
            raise InvalidInput(
                "points", f"point {names[place % len(names)]} = ({x:.6g}, {y:.6g})",
                f"the path turns round there, at s = {along:.4g} m, by "
                f"{np.degrees(turns[n]):.4g}°: split it there, each part is driven in one direction",
            )  # fmt: skip


def distances(samples: Array, corners: Array, leg: Indices) -> Array:
    """Distance (m) of samples from a polyline near a leg.

    Args:
        samples: Shape (n, 2), m.
        corners: Of the polyline, shape (m, 2), m.
        leg: The leg each sample belongs to, shape (n,); two legs to both sides are looked at too.
    """
    x, y = samples.T
    corner_x, corner_y = corners.T
    way_x, way_y = np.diff(corner_x), np.diff(corner_y)
    square = np.maximum(way_x**2 + way_y**2, 1e-300)
    least = np.full(len(samples), np.inf)
    for offset in range(-2, 3):
        n = np.clip(leg + offset, 0, len(square) - 1)
        dx, dy, across, up = x - corner_x[n], y - corner_y[n], way_x[n], way_y[n]
        t = np.clip((dx * across + dy * up) / square[n], 0.0, 1.0)
        least = np.minimum(least, (dx - t * across) ** 2 + (dy - t * up) ** 2)
    nearest: Array = np.sqrt(least)
    return nearest
