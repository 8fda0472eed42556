"""Arc length of parametric curves: from derivatives in a parameter to a `CurvePoint` at each s."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.curve.contract import CurvePoint
from osculate.errors import InvalidInput

Array = NDArray[np.float64]

#: (parameters, shape (n,); order 0…3) -> that derivative of (x, y), shape (n, 2).
Derivative = Callable[[Array, int], Array]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_NEWTON_STEPS = 3


class ArcLength:
    """A regular parametric curve r(p), reparametrised by arc length.

    The length of every panel between two knots comes from ten-point Gauss–Legendre quadrature; the
    inverse starts from a cubic in s and is polished by Newton steps on the same quadrature.

    Args:
        derivative: r and its first three derivatives.
        breaks: Increasing parameters between which r is smooth (at least its two ends).
        panels: Panels in total, spread over the pieces.

    Raises:
        InvalidInput: r' vanishes or is not finite somewhere (a cusp or a stop; says where).
    """

    def __init__(self, derivative: Derivative, breaks: ArrayLike, panels: int = 1024) -> None:
        self._derivative = derivative
        edges = np.asarray(breaks, dtype=float)
        per_piece = max(2, -(-panels // (len(edges) - 1)))
        pieces = [np.linspace(a, b, per_piece, endpoint=False) for a, b in pairwise(edges)]
        self._p: Array = np.concatenate([*pieces, edges[-1:]])
        speed = self._speed(self._p)
        bad = ~(speed > 1e-12 * np.nanmax(speed)) | ~np.isfinite(speed)
        if bad.any():
            raise InvalidInput(
                "curve", f"|dr/dp| = {speed[bad.argmax()]:.3g} at p = {self._p[bad.argmax()]:.6g}",
                "must move on everywhere: r' finite and not zero",
            )  # fmt: skip
        steps = self._length(self._p[:-1], self._p[1:])
        self._s: Array = np.concatenate([[0.0], np.cumsum(steps)])
        self._slope = 1.0 / speed
        tangent = derivative(self._p, 1)
        self._heading: Array = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))

    @property
    def length(self) -> float:
        """Total arc length (m)."""
        return float(self._s[-1])

    def parameter(self, arc_length: ArrayLike) -> Array:
        """The parameters p at the arc lengths (m), shape of the argument."""
        return self._locate(arc_length)[0]

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """The curve at the arc lengths (m), clipped to [0, length]."""
        p, panel, fraction = self._locate(arc_length)
        flat = p.ravel()
        r0, r1, r2, r3 = (self._derivative(flat, n).reshape(*p.shape, 2) for n in range(4))
        square = (r1**2).sum(axis=-1)
        bend = r1[..., 0] * r2[..., 1] - r1[..., 1] * r2[..., 0]
        bend_rate = r1[..., 0] * r3[..., 1] - r1[..., 1] * r3[..., 0]
        stretch = (r1 * r2).sum(axis=-1)
        raw = np.arctan2(r1[..., 1], r1[..., 0])
        near = (1.0 - fraction) * self._heading[panel] + fraction * self._heading[panel + 1]
        return CurvePoint(
            x=r0[..., 0],
            y=r0[..., 1],
            heading=raw + 2.0 * np.pi * np.round((near - raw) / (2.0 * np.pi)),
            curvature=bend / square**1.5,
            curvature_rate=(bend_rate - 3.0 * bend * stretch / square) / square**2,
        )

    def _locate(self, arc_length: ArrayLike) -> tuple[Array, Any, Array]:
        s = np.clip(np.asarray(arc_length, dtype=float), 0.0, self.length)
        panel = np.clip(np.searchsorted(self._s, s, side="right") - 1, 0, len(self._s) - 2)
        start, end = self._p[panel], self._p[panel + 1]
        width = self._s[panel + 1] - self._s[panel]
        f = (s - self._s[panel]) / width
        first, last = self._slope[panel] * width, self._slope[panel + 1] * width
        rise = end - start
        p = start + f * (
            first + f * (3.0 * rise - 2.0 * first - last + f * (first + last - 2.0 * rise))
        )
        for _ in range(_NEWTON_STEPS):
            short = s - self._s[panel] - self._length(start, p)
            p = np.clip(p + short / self._speed(p), start, end)
        return p, panel, f

    def _speed(self, p: Array) -> Array:
        tangent = self._derivative(p.ravel(), 1)
        speed: Array = np.hypot(tangent[:, 0], tangent[:, 1]).reshape(p.shape)
        return speed

    def _length(self, start: Array, end: Array) -> Array:
        half = 0.5 * (end - start)[..., None]
        middle = 0.5 * (end + start)[..., None]
        length: Array = (self._speed(middle + half * _NODES) * half) @ _WEIGHTS
        return length
