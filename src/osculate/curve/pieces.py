"""Piecewise Chebyshev polynomials: exact derivatives, and exact limits from both sides of a break."""

from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Pieces:
    """Piecewise Chebyshev polynomials and their derivatives; at a break the right-hand one counts.

    Args:
        breaks: Increasing, shape (pieces + 1,).
        coefficients: Shape (pieces, degree + 1) or (pieces, degree + 1, components).
        orders: Highest derivative.
    """

    def __init__(self, breaks: Array, coefficients: Array, orders: int = 3) -> None:
        self.breaks = breaks
        self._orders: list[Any] = [coefficients]
        half = (0.5 * np.diff(breaks)).reshape(-1, *[1] * (coefficients.ndim - 1))
        for _ in range(orders):
            self._orders.append(chebyshev.chebder(self._orders[-1], axis=1) / half)

    def __call__(self, p: Array, order: int) -> Array:
        """A derivative at parameters, shape (n,) or (n, components)."""
        piece = np.clip(np.searchsorted(self.breaks, p, side="right") - 1, 0, len(self.breaks) - 2)
        a, b = self.breaks[piece], self.breaks[piece + 1]
        local = (2.0 * p - a - b) / (b - a)
        chosen = np.moveaxis(self._orders[order][piece], 1, 0)
        local = local.reshape(-1, *[1] * (chosen.ndim - 2))
        values: Array = chebyshev.chebval(local, chosen, tensor=False)
        return values

    def ends(self, order: int) -> tuple[Array, Array]:
        """A derivative's limits at the start and at the end of every piece."""
        coefficients = np.moveaxis(self._orders[order], 1, 0)
        signs = (-1.0) ** np.arange(len(coefficients))
        return np.tensordot(signs, coefficients, 1), coefficients.sum(axis=0)


def nodes_of(breaks: Array, degree: int) -> tuple[Array, Any]:
    """Where to sample each piece, shape (pieces, degree + 1), and what makes coefficients of values.

    The coefficients are ``transform @ values`` along the axis of the nodes.
    """
    nodes = chebyshev.chebpts1(degree + 1)
    transform = np.linalg.inv(chebyshev.chebvander(nodes, degree))
    middle, half = 0.5 * (breaks[1:] + breaks[:-1]), 0.5 * np.diff(breaks)
    return middle[:, None] + half[:, None] * nodes, transform
