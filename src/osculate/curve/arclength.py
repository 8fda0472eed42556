"""Arc length of parametric curves: from derivatives in a parameter to a `CurvePoint` at each s."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.curve.contract import CurvePoint
from osculate.curve.panels import Derivative, Enclosure, Panels, bends_of

Array = NDArray[np.float64]

_NEWTON_STEPS = 3
_MORE_STEPS = 20  # where the speed varies so much within a panel that three leave more than
_CLOSE = 1e-12  # of the whole length


class ArcLength:
    """A regular parametric curve r(p), reparametrised by arc length.

    The length of every panel between two knots comes from ten-point Gauss–Legendre quadrature;
    panels are halved until speed and tangent are resolved and ∫ r' dp is what r really moves. The
    inverse starts from a cubic in s and is polished by Newton steps on the same quadrature.

    Args:
        derivative: r and its first three derivatives.
        breaks: Increasing parameters between which r is smooth (at least its two ends).
        panels: Panels to begin with, spread over the pieces.
        enclosure: Bounds of r', where they can be had: they show what lies between the nodes.

    Raises:
        InvalidInput: r' vanishes, is not finite or is not resolved somewhere (a cusp, a stop, a
            pole, a jump; says where).
    """

    def __init__(
        self,
        derivative: Derivative,
        breaks: ArrayLike,
        panels: int = 1024,
        enclosure: Enclosure | None = None,
    ) -> None:
        self._derivative = derivative
        edges = np.asarray(breaks, dtype=float)
        per_piece = max(2, -(-panels // (len(edges) - 1)))
        steps = np.arange(per_piece) * (np.diff(edges) / per_piece)[:, None]
        first = np.append((edges[:-1, None] + steps).ravel(), edges[-1])
        self._panels = Panels(derivative, first, enclosure)
        self._p = self._panels.p
        self._s: Array = np.concatenate([[0.0], np.cumsum(self._panels.lengths)])
        self._slope = 1.0 / self._panels.speed(self._p)
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
        curvature, curvature_rate = bends_of(r1, r2, r3)
        raw = np.arctan2(r1[..., 1], r1[..., 0])
        near = (1.0 - fraction) * self._heading[panel] + fraction * self._heading[panel + 1]
        return CurvePoint(
            x=r0[..., 0],
            y=r0[..., 1],
            heading=raw + 2.0 * np.pi * np.round((near - raw) / (2.0 * np.pi)),
            curvature=curvature,
            curvature_rate=curvature_rate,
        )

    def tight_places(self, most: int = 256) -> Array:
        """Arc lengths (m) of the largest local maxima of |κ| on the resolved panels, at most so many."""
        p = np.append(self._p, 0.5 * (self._p[1:] + self._p[:-1]))
        p.sort()
        first, second = self._derivative(p, 1), self._derivative(p, 2)
        bend = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
        bend /= np.hypot(*first.T) ** 3
        padded = np.concatenate([[-1.0], bend, [-1.0]])
        peaks = np.flatnonzero((bend >= padded[:-2]) & (bend >= padded[2:]))
        chosen = np.sort(peaks[np.argsort(-bend[peaks])[:most]])
        panel = np.clip(np.searchsorted(self._p, p[chosen], side="right") - 1, 0, len(self._p) - 2)
        places: Array = self._s[panel] + self._panels.length(self._p[panel], p[chosen])
        return places

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
        for step in range(_NEWTON_STEPS + _MORE_STEPS):
            short = s - self._s[panel] - self._panels.length(start, p)
            if step >= _NEWTON_STEPS and np.abs(short).max(initial=0.0) <= _CLOSE * self.length:
                break
            p = np.clip(p + short / self._panels.speed(p), start, end)
        return p, panel, f


def along(spline: Any, panels: int) -> ArcLength:
    """A SciPy spline with values in the plane, by arc length, smooth between its knots."""
    derivatives = [spline, *(spline.derivative(n) for n in (1, 2, 3))]
    knots = np.unique(spline.t[spline.k : len(spline.t) - spline.k])
    return ArcLength(lambda p, order: np.asarray(derivatives[order](p)), knots, panels)
