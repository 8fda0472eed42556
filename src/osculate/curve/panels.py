"""Panels in a curve's parameter: halved until the curve is resolved on each, or refused where it is not."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.errors import InvalidInput

Array = NDArray[np.float64]

#: (starts, ends, shape (n,) each) -> bounds of r' between them: low and high, shape (n, 2) each.
Enclosure = Callable[[Array, Array], tuple[Array, Array]]
#: (parameters, shape (n,); order 0…3) -> that derivative of (x, y), shape (n, 2).
Derivative = Callable[[Array, int], Array]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)

# A panel is resolved when the last two of the ten Legendre coefficients at its nodes are this small
# beside its mean speed. The error of its length is then about that of the twentieth: below 1e-11.
_SPEED_TAIL = 1e-5
_TANGENT_TAIL = 1e-4
_LAST = (np.polynomial.legendre.legvander(_NODES, 9)[:, 8:] * _WEIGHTS[:, None]).T * [[8.5], [9.5]]
_SHIFT = 1e-9  # of a panel's length: how well ∫ r' dp must agree with the r at its ends
_HALVINGS = 46
_SLOW = 0.1  # of the largest speed in a panel: there may be a stop near
_STEPS = 40
_MOST_PANELS = 1 << 15  # more than at the beginning
_MOST_DOUBTS = 1 << 13  # panels up to which wide bounds of r' alone are a reason to halve


class Panels:
    """A regular parametric curve r(p) cut into panels that ten-point Gauss–Legendre quadrature resolves.

    Panels are halved until speed and tangent are resolved and ∫ r' dp is what r really moves; bounds
    of r', where they can be had, show what lies between the nodes.

    Args:
        derivative: r and its first three derivatives.
        first: Edges to begin with, increasing, shape (n,).
        enclosure: Bounds of r'.

    Raises:
        InvalidInput: r' vanishes, is not finite or is not resolved somewhere (a cusp, a stop, a pole, a
            jump; says where).
    """

    def __init__(self, derivative: Derivative, first: Array, enclosure: Enclosure | None) -> None:
        self._derivative, self._enclosure = derivative, enclosure
        self._begin, self._scale = float(first[0]), 0.0
        with np.errstate(all="ignore"):
            self._require_motion(first, self.speed(first))
            self.p, self.lengths = self._resolved(first)  # edges, shape (n,); m, shape (n − 1,)
            slowest = np.union1d(self.p, self._slowest())
            self._require_motion(slowest, self.speed(slowest))

    def speed(self, p: Array) -> Array:
        """|r'| at parameters of any shape (m)."""
        tangent = self._derivative(p.ravel(), 1)
        speed: Array = np.hypot(tangent[:, 0], tangent[:, 1]).reshape(p.shape)
        return speed

    def length(self, start: Array, end: Array) -> Array:
        """Arc lengths (m) between parameters that lie in one panel each, shape of the arguments."""
        half = 0.5 * (end - start)[..., None]
        middle = 0.5 * (end + start)[..., None]
        length: Array = (self.speed(middle + half * _NODES) * half) @ _WEIGHTS
        return length

    def _slowest(self) -> Array:
        """Parameters of least speed in panels whose speed varies much.

        A stop between the nodes may be smooth, or so near to an edge that the nodes do not see its kink.
        """
        middle, half = 0.5 * (self.p[1:] + self.p[:-1]), 0.5 * np.diff(self.p)
        nodes = middle[:, None] + half[:, None] * np.concatenate([[-1.0], _NODES, [1.0]])
        speed = self.speed(nodes)
        slow = np.flatnonzero(speed.min(axis=1) < _SLOW * speed.max(axis=1))
        p = nodes[slow, speed[slow].argmin(axis=1)]
        for _ in range(
            _STEPS
        ):  # Gauss–Newton on r' = 0, linear in convergence where r'' is 0 as well
            tangent, change = self._derivative(p, 1), self._derivative(p, 2)
            step = (tangent * change).sum(axis=1) / (change**2).sum(axis=1)
            p = np.clip(p - np.nan_to_num(step), self.p[slow], self.p[slow + 1])
        return p

    def _resolved(self, p: Array) -> tuple[Array, Array]:
        """Edges of panels that are all resolved, and the panels' lengths (m)."""
        start, end = p[:-1], p[1:]
        length, good = self._examine(start, end)
        most = len(start) + _MOST_PANELS
        for _ in range(_HALVINGS):
            if good.all() or len(start) + np.count_nonzero(~good) > most:
                break
            middle = 0.5 * (start[~good] + end[~good])
            halves = np.append(start[~good], middle), np.append(middle, end[~good])
            fresh, fine = self._examine(*halves, len(start) + len(middle))
            order = np.argsort(np.append(start[good], halves[0]), kind="stable")
            start, end = (
                np.append(old[good], new)[order]
                for old, new in zip((start, end), halves, strict=True)
            )
            length = np.append(length[good], fresh)[order]
            good = np.append(good[good], fine)[order]
        if not good.all():
            raise self._unresolved(start, end, good)
        return np.append(start, end[-1]), length

    def _examine(self, start: Array, end: Array, count: int = 0) -> tuple[Array, Any]:
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
        inside = self.speed(np.linspace(start[worst], end[worst], 33))
        usual = float(np.median(self.speed(np.linspace(start[0], end[-1], 1001))))
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
            usual = float(np.median(self.speed(np.linspace(p[0], p[-1], 1001))))
            if speed.max() > 1e9 * usual > 0.0:
                raise _no_motion(
                    f"grows without bound (a pole) near {self._place(p[speed.argmax()])}"
                )
            least = speed.argmin()
            place = self._place(p[least])
            raise _no_motion(f"stops (a cusp, |dr/dp| = {speed[least]:.3g}) at {place}")
        curvature, rate = bends_of(r[1], r[2], r[3])
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


def bends_of(r1: Array, r2: Array, r3: Array) -> tuple[Array, Array]:
    """Curvature and its rate over arc length from three derivatives, shape (..., 2) each."""
    with np.errstate(all="ignore"):  # curves too large for a square of their size are straight
        square = (r1**2).sum(axis=-1)
        bend = r1[..., 0] * r2[..., 1] - r1[..., 1] * r2[..., 0]
        bend_rate = r1[..., 0] * r3[..., 1] - r1[..., 1] * r3[..., 0]
        stretch = (r1 * r2).sum(axis=-1)
        return bend / square**1.5, (bend_rate - 3.0 * bend * stretch / square) / square**2


def _no_motion(what: str) -> InvalidInput:
    return InvalidInput(
        "curve", what, "must move on everywhere: r' finite, continuous and not zero"
    )
