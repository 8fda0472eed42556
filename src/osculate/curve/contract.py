"""The one contract of every curve: a length, and a `CurvePoint` at each arc length."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.spec import Spec

Array = NDArray[np.float64]


class CurvePoint(NamedTuple):
    """A curve at one arc length (floats, in kernels) or at many (arrays of one shape)."""

    x: Any  # m
    y: Any  # m
    heading: Any  # rad, of the tangent, unwrapped along the curve
    curvature: Any  # 1/m, dθ/ds, positive to the left
    curvature_rate: Any  # 1/m², dκ/ds


def at_joined(
    lengths: Sequence[float], at: Callable[[int, Array], CurvePoint], arc_length: ArrayLike
) -> CurvePoint:
    """Points of pieces that are joined end to start.

    Args:
        lengths: Lengths of the pieces (m).
        at: Number of a piece and arc lengths on it (m), shape (n,), to its points.
        arc_length: Arc lengths on the whole (m), any shape; clipped to it.
    """
    ends = np.cumsum(lengths)
    s = np.clip(np.asarray(arc_length, dtype=float), 0.0, ends[-1])
    flat = s.ravel()
    which = np.minimum(np.searchsorted(ends, flat, side="right"), len(ends) - 1)
    columns = np.empty((5, flat.size))
    for n in np.unique(which):
        here = which == n
        columns[:, here] = at(int(n), flat[here] - (ends[n] - lengths[n]))
    return CurvePoint(*(column.reshape(s.shape) for column in columns))


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

    def speed_limit(self, arc_length: ArrayLike) -> Array | None:
        """The curve's own largest speeds (m/s) at arc lengths (m), or None if it says none."""
        return None

    @property
    def tight_places(self) -> Array:
        """Arc lengths (m) at which it bends most, shape (n,), where even samples may miss them."""
        return np.empty(0)

    @property
    def total_turn(self) -> float:
        """Heading at the end minus heading at the start (rad)."""
        ends = self.at(np.array([0.0, self.length]))
        return float(ends.heading[1] - ends.heading[0])
