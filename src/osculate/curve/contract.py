"""The one contract of every curve: a length, and a `CurvePoint` at each arc length."""

from abc import abstractmethod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from osculate.spec import Spec


class CurvePoint(NamedTuple):
    """A curve at one arc length (floats, in kernels) or at many (arrays of one shape)."""

    x: Any  # m
    y: Any  # m
    heading: Any  # rad, of the tangent, unwrapped along the curve
    curvature: Any  # 1/m, dθ/ds, positive to the left
    curvature_rate: Any  # 1/m², dκ/ds


class Curve(Spec):
    """A plane curve parametrised by arc length.

    A new kind of curve states its `length` and answers `at`; everything else (table for the
    kernels, plots, feasibility) follows from these two.
    """

    @property
    @abstractmethod
    def length(self) -> float:
        """Total arc length (m)."""

    @property
    def closed(self) -> bool:
        """Whether the end continues smoothly into the start (a track)."""
        return False

    @abstractmethod
    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """The curve at the arc lengths (m, any shape, clipped to [0, length]), as arrays."""

    @property
    def total_turn(self) -> float:
        """Heading at the end minus heading at the start (rad)."""
        ends = self.at(np.array([0.0, self.length]))
        return float(ends.heading[1] - ends.heading[0])
