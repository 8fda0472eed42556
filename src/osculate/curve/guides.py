"""Unevenly spaced points: guides on long legs, so that a curve does not bulge beside short ones."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.curve.waypoints import steps_of

Array = NDArray[np.float64]

UNEVEN = 2.5  # times its neighbour: a leg from which on a bulge counts as one
CORNER = 0.6  # of the shorter leg at a point: how far a curve may leave the polyline there,
WIDENING = 0.02  # m per m of distance from the point more than that,
WIDEST = 0.2  # m, but never more than this
LARGE = 0.1  # or this part of the shorter leg
USED = 0.9  # part of what is allowed that the guides use
REACH = 5.0  # times the shorter leg at a corner: how far from it guides leave the polyline
GROWTH = 2.0  # of the steps between guides


def scales(corners: Array, loop: bool) -> Array:
    """The shorter leg (m) at every corner, shape (n,); a loop ends with its first corner."""
    legs = steps_of(corners)
    before, after = np.append(np.inf, legs), np.append(legs, np.inf)
    if loop:
        before[0], after[-1] = legs[-1], legs[0]
    shorter: Array = np.minimum(before, after)
    return shorter


def uneven_legs(corners: Array, loop: bool) -> Any:
    """Which legs are much longer than one beside them, shape (n − 1,)."""
    scale = scales(corners, loop)
    return steps_of(corners) > UNEVEN * np.minimum(scale[:-1], scale[1:])


def allowance(samples: Array, leg: Any, corners: Array, loop: bool) -> Array:
    """How far (m) from the polyline samples that belong to legs may lie, shape (n,)."""
    scale = scales(corners, loop)
    ends = []
    for n in (leg, leg + 1):
        near = CORNER * scale[n] + WIDENING * np.hypot(*(samples - corners[n]).T)
        ends.append(np.minimum(near, np.maximum(WIDEST, LARGE * scale[n])))
    least: Array = np.minimum(*ends)
    return least


def graded(corners: Array, loop: bool) -> tuple[Any, Array]:
    """Guides on the legs, so that no step is much longer than the one before it.

    Returns:
        Every corner but the last and every guide in order: its leg, and the distance (m) from the
        start of the leg, shape (m,) each.
    """
    legs, scale = steps_of(corners), scales(corners, loop)
    marks = [
        np.append(0.0, _marks(float(length), float(scale[n]), float(scale[n + 1])))
        for n, length in enumerate(legs)
    ]
    return np.repeat(np.arange(len(legs)), [len(own) for own in marks]), np.concatenate(marks)


def place(corners: Array, loop: bool, leg: Any, along: Array, wish: Array) -> Array:
    """Where guides lie: as far towards ``wish``, shape (m, 2), as is allowed beside the polyline."""
    way = np.diff(corners, axis=0)[leg] / steps_of(corners)[leg, None]
    across = np.stack([-way[:, 1], way[:, 0]], axis=1)
    feet = corners[leg] + along[:, None] * way
    most = USED * allowance(feet, leg, corners, loop) * _nearness(feet, leg, corners, loop)
    aside = np.clip(((wish - feet) * across).sum(axis=1), -most, most)
    guides: Array = feet + (aside * (along > 0.0))[:, None] * across
    return guides


def _nearness(feet: Array, leg: Any, corners: Array, loop: bool) -> Array:
    """1 at a corner, falling over a few times its scale; there is no corner at the ends of a list."""
    scale = REACH * scales(corners, loop)
    if not loop:
        scale[[0, -1]] = 0.0
    shares = []
    for n in (leg, leg + 1):
        away = np.hypot(*(feet - corners[n]).T)
        shares.append(scale[n] ** 2 / (scale[n] ** 2 + away**2 + 1e-300))
    nearest: Array = np.maximum(*shares)
    return nearest


def _marks(length: float, first: float, last: float) -> Array:
    """Distances (m) of the guides from the start of a leg: steps that grow from both ends."""

    def from_end(scale: float) -> list[float]:
        marks, step = [0.0], scale
        while length > GROWTH * scale and marks[-1] + GROWTH * step < 0.5 * length:
            step *= GROWTH
            marks.append(marks[-1] + step)
        return marks[1:]

    return np.array(from_end(first) + [length - mark for mark in from_end(last)[::-1]])
