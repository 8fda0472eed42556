"""Arc length of parametric curves: from derivatives in a parameter to a `CurvePoint` at each s."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.curve.contract import CurvePoint
from osculate.errors import InvalidInput

Array = NDArray[np.float64]

#: (starts, ends, shape (n,) each) -> bounds of r' between them: low and high, shape (n, 2) each.
Enclosure = Callable[[Array, Array], tuple[Array, Array]]
#: (parameters, shape (n,); order 0…3) -> that derivative of (x, y), shape (n, 2).
Derivative = Callable[[Array, int], Array]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_NEWTON_STEPS = 3
_MORE_STEPS = 12  # only where those three do not reach `_CLOSE`
_CLOSE = 1e-12  # of the whole length

# A panel is resolved when the last two of the ten Legendre coefficients at its nodes are this small
# beside its mean speed. The error of its length is then about that of the twentieth: below 1e-11.
_SPEED_TAIL = 1e-5
_TANGENT_TAIL = 1e-4
_LAST = (np.polynomial.legendre.legvander(_NODES, 9)[:, 8:] * _WEIGHTS[:, None]).T * [[8.5], [9.5]]
_SHIFT = 1e-9  # of a panel's length: how well ∫ r' dp must agree with the r at its ends
_HALVINGS = 46
_MOST_PANELS = 1 << 15  # more than at the beginning
_MOST_DOUBTS = 1 << 13  # panels up to which wide bounds of r' alone are a reason to halve


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
        self._derivative, self._enclosure = derivative, enclosure
        edges = np.asarray(breaks, dtype=float)
        self._begin = float(edges[0])
        per_piece = max(2, -(-panels // (len(edges) - 1)))
        steps = np.arange(per_piece) * (np.diff(edges) / per_piece)[:, None]
        first = np.append((edges[:-1, None] + steps).ravel(), edges[-1])
        with np.errstate(all="ignore"):
            self._require_motion(first, self._speed(first))
            self._p, lengths = self._resolved(first)
            speed = self._speed(self._p)
            self._require_motion(self._p, speed)
        self._s: Array = np.concatenate([[0.0], np.cumsum(lengths)])
        self._slope = 1.0 / speed
        self._last_slope = self._slope[1:].copy()
        self._take_left_sides(edges[1:-1])
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
        curvature, curvature_rate = _bends(r1, r2, r3)
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
        places: Array = self._s[panel] + self._length(self._p[panel], p[chosen])
        return places

    def _locate(self, arc_length: ArrayLike) -> tuple[Array, Any, Array]:
        s = np.clip(np.asarray(arc_length, dtype=float), 0.0, self.length)
        panel = np.clip(np.searchsorted(self._s, s, side="right") - 1, 0, len(self._s) - 2)
        start, end = self._p[panel], self._p[panel + 1]
        width = self._s[panel + 1] - self._s[panel]
        f = (s - self._s[panel]) / width
        first, last = self._slope[panel] * width, self._last_slope[panel] * width
        rise = end - start
        p = start + f * (
            first + f * (3.0 * rise - 2.0 * first - last + f * (first + last - 2.0 * rise))
        )
        for step in range(_NEWTON_STEPS + _MORE_STEPS):
            short = s - self._s[panel] - self._length(start, p)
            if step >= _NEWTON_STEPS and np.abs(short).max(initial=0.0) <= _CLOSE * self.length:
                break
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

    def _resolved(self, p: Array) -> tuple[Array, Array]:
        """Edges of panels that are all resolved, and the panels' lengths (m)."""
        start, end = p[:-1], p[1:]
        self._scale = 0.0
        length, good = self._panels(start, end)
        most = len(start) + _MOST_PANELS
        for _ in range(_HALVINGS):
            if good.all():
                return np.append(start, end[-1]), length
            if len(start) + np.count_nonzero(~good) > most:
                break
            middle = 0.5 * (start[~good] + end[~good])
            halves = np.append(start[~good], middle), np.append(middle, end[~good])
            fresh, fine = self._panels(*halves, len(start) + len(middle))
            order = np.argsort(np.append(start[good], halves[0]), kind="stable")
            start, end = (
                np.append(old[good], new)[order]
                for old, new in zip((start, end), halves, strict=True)
            )
            length = np.append(length[good], fresh)[order]
            good = np.append(good[good], fine)[order]
        raise self._unresolved(start, end, good)

    def _panels(self, start: Array, end: Array, count: int = 0) -> tuple[Array, Any]:
        """Lengths (m) of panels, and whether each is resolved."""
        half = 0.5 * (end - start)[:, None]
        p = 0.5 * (end + start)[:, None] + half * _NODES
        tangent = self._derivative(p.ravel(), 1).reshape(*p.shape, 2)
        speed = np.hypot(tangent[..., 0], tangent[..., 1])
        length: Array = (speed * half) @ _WEIGHTS
        mean = 0.5 * (speed @ _WEIGHTS)
        good = np.abs(speed @ _LAST.T).max(axis=1) <= _SPEED_TAIL * mean
        ends = self._derivative(np.stack([start, end]).ravel(), 0).reshape(2, -1, 2)
        self._scale = max(self._scale, float(np.abs(ends).max()))
        allowed = _SHIFT * length + 64.0 * np.finfo(float).eps * self._scale
        for n in range(2):
            part = tangent[..., n]
            good &= np.abs(part @ _LAST.T).max(axis=1) <= _TANGENT_TAIL * mean
            moved = (part * half) @ _WEIGHTS
            good &= np.abs(moved - (ends[1, :, n] - ends[0, :, n])) <= allowed
        if self._enclosure is not None and count <= _MOST_DOUBTS:
            low, high = self._enclosure(start, end)
            good &= (high - low).max(axis=1) <= 2.0 * speed.max(axis=1)
        return length, good

    def _unresolved(self, start: Array, end: Array, good: Any) -> InvalidInput:
        """What is wrong in the narrowest panel that is not resolved."""
        bad = np.flatnonzero(~good)
        width = (end - start)[bad]
        worst = bad[np.argmin(width)]
        p = 0.5 * (start[worst] + end[worst])
        inside = self._speed(np.linspace(start[worst], end[worst], 33))
        usual = float(np.median(self._speed(np.linspace(start[0], end[-1], 1001))))
        if width.min() > 1e-9 * (end[-1] - start[0]):
            what = f"is too fine to be resolved by {len(start)} panels"
        elif not np.isfinite(inside).all() or inside.max() > 1e6 * usual:
            what = "grows without bound (a pole)"
        elif inside.min() < 1e-3 * usual:
            what = "stops or turns back (a cusp)"
        else:
            what = "jumps or has a kink"
        return _no_motion(f"{what} near {self._place(p)}")

    def _require_motion(self, p: Array, speed: Array) -> None:
        """Refuse a curve that is not finite, stops or has a pole at an edge of a panel."""
        r = [self._derivative(p, order) for order in range(4)]
        self._require_finite(p, {"position": r[0], "tangent": r[1]})
        if not (speed > 1e-12 * speed.max()).all():
            usual = float(np.median(self._speed(np.linspace(p[0], p[-1], 1001))))
            if speed.max() > 1e9 * usual > 0.0:
                raise _no_motion(
                    f"grows without bound (a pole) near {self._place(p[speed.argmax()])}"
                )
            least = speed.argmin()
            place = self._place(p[least])
            raise _no_motion(f"stops (a cusp, |dr/dp| = {speed[least]:.3g}) at {place}")
        curvature, rate = _bends(r[1], r[2], r[3])
        self._require_finite(p, {"curvature": curvature, "rate of the curvature": rate})

    def _require_finite(self, p: Array, columns: dict[str, Array]) -> None:
        for what, values in columns.items():
            lost = ~np.isfinite(values.reshape(len(p), -1)).all(axis=1)
            if lost.any():
                raise _no_motion(f"its {what} is not finite at {self._place(p[lost.argmax()])}")

    def _place(self, p: float) -> str:
        """Where a parameter is, in words; arc length and point only if they are finite."""
        way = self._derivative(np.linspace(self._begin, p, 1001), 0)
        s, (x, y) = float(np.hypot(*np.diff(way, axis=0).T).sum()), way[-1]
        if not np.isfinite([s, x, y]).all():
            return f"p = {p:.9g}"
        return f"p = {p:.9g}, s = {s:.4g} m, ({x:.6g}, {y:.6g})"

    def _take_left_sides(self, breaks: Array) -> None:
        """Slopes dp/ds before the breaks at which the parameter's speed jumps."""
        if not len(breaks):
            return
        before = 1.0 / self._speed(np.nextafter(breaks, -np.inf))
        panel = np.searchsorted(self._p, breaks) - 1
        jumps = np.abs(before - self._last_slope[panel]) > 1e-6 * before
        self._last_slope[panel[jumps]] = before[jumps]


def _bends(r1: Array, r2: Array, r3: Array) -> tuple[Array, Array]:
    """Curvature and its rate over arc length from three derivatives, shape (..., 2) each."""
    square = (r1**2).sum(axis=-1)
    bend = r1[..., 0] * r2[..., 1] - r1[..., 1] * r2[..., 0]
    bend_rate = r1[..., 0] * r3[..., 1] - r1[..., 1] * r3[..., 0]
    stretch = (r1 * r2).sum(axis=-1)
    return bend / square**1.5, (bend_rate - 3.0 * bend * stretch / square) / square**2


def _no_motion(what: str) -> InvalidInput:
    return InvalidInput(
        "curve", what, "must move on everywhere: r' finite, continuous and not zero"
    )


def along(spline: Any, panels: int) -> ArcLength:
    """A SciPy spline with values in the plane, by arc length, smooth between its knots."""
    derivatives = [spline, *(spline.derivative(n) for n in (1, 2, 3))]
    knots = np.unique(spline.t[spline.k : len(spline.t) - spline.k])
    return ArcLength(lambda p, order: np.asarray(derivatives[order](p)), knots, panels)
