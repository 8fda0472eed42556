"""Pieces whose curvature changes linearly with arc length, and curves made of them."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.curve.contract import Curve, CurvePoint, at_joined
from osculate.errors import InvalidInput
from osculate.spec import Spec, quantity

Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
MOST_TURN = 1e6  # rad, in one piece: more is a mistake, and would not fit into memory
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


def spiral_from(start: Pose, curvature: float, sharpness: float, length: float) -> Spiral:
    """A spiral from a pose, refused if it turns more than any curve that is meant."""
    turn = abs(curvature) * length + abs(sharpness) * length**2
    if not turn <= MOST_TURN:
        raise InvalidInput(
            "curve", f"a piece that turns by up to {turn:.3g} rad over {length:.4g} m",
            f"must turn by at most {MOST_TURN:g} rad; it would need {turn / PANEL_TURN:.3g} panels",
        )  # fmt: skip
    return Spiral(start.x, start.y, start.heading, curvature, sharpness, length)
