"""Curves that have a parameter of their own."""

from functools import cached_property

from numpy.typing import ArrayLike

from osculate.curve.arclength import ArcLength
from osculate.curve.contract import Array, Curve, CurvePoint

Points = tuple[tuple[float, float], ...]


class Sampled(Curve):
    """A curve with a parameter of its own, behind an `ArcLength`."""

    @cached_property
    def _arc(self) -> ArcLength:
        raise NotImplementedError

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return self._arc.length

    @property
    def tight_places(self) -> Array:
        """See `Curve.tight_places`."""
        return self._arc.tight_places()

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        return self._arc.at(arc_length)
