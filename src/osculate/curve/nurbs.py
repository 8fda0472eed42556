"""Non-uniform rational B-splines, as VDA 5050 describes trajectories."""

from functools import cached_property
from itertools import pairwise
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from osculate.curve.arclength import ArcLength
from osculate.curve.pieces import Pieces, nodes_of
from osculate.curve.sampled import Points, Sampled
from osculate.errors import InvalidInput
from osculate.spec import quantity

Array = NDArray[np.float64]

HEADING_JUMP = 1e-6  # rad
STOPPED = 1e-9  # of the largest |r'|
SAME = 1e-12  # of the extent: control points closer than this coincide
PASCAL = [[1], [1, 1], [1, 2, 1], [1, 3, 3, 1]]


class Nurbs(Sampled):
    """A non-uniform rational B-spline, as VDA 5050 describes a trajectory.

    A knot may be multiple, as in the circle of rational quadratics, if heading and curvature have the
    same limits from both sides.

    Raises:
        InvalidInput: Counts that do not fit, knots that decrease or occur too often, coincident control
            points at which the curve stops, a heading or curvature that jumps, a cusp (says where).
    """

    kind: Literal["nurbs"] = "nurbs"
    degree: int = quantity("1", "degree, at least 1", default=3, ge=1, le=9)
    knots: tuple[float, ...] = quantity("1", "knot vector: points + degree + 1 numbers")
    points: Points = quantity("m", "control points (x, y)")
    weights: tuple[float, ...] | None = quantity("1", "weights, by default 1", default=None)
    curvature_jump: float = quantity("1/m", "largest jump that is allowed", default=1e-3, ge=0)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        count = len(self.points)
        if len(self.knots) != count + self.degree + 1:
            raise InvalidInput(
                "knots",
                len(self.knots),
                f"must be {count + self.degree + 1} numbers (points + degree + 1)",
            )
        if not (np.diff(self.knots) >= 0).all() or not self.knots[-1] > self.knots[0]:
            raise InvalidInput("knots", self.knots, "must not decrease")
        if self.weights is not None and (len(self.weights) != count or min(self.weights) <= 0):
            raise InvalidInput("weights", self.weights, f"must be {count} positive numbers")
        self._check_multiplicity()
        if not self._is_line:
            self._check_ends()
            self._check_joins()
        return self

    def _check_multiplicity(self) -> None:
        values, counts = np.unique(self.knots, return_counts=True)
        most = int(counts.max())
        if most > self.degree + 1:
            fitting = len(self.knots) - most
            raise InvalidInput(
                "knots", float(values[counts.argmax()]),
                f"occurs {most} times, at most degree + 1 = {self.degree + 1} "
                f"(the knots fit degree {most - 1} with {fitting} points)",
            )  # fmt: skip
        if not self._breaks[-1] > self._breaks[0]:
            raise InvalidInput("knots", self.knots, "leave no parameter between the ends")

    def _check_ends(self) -> None:
        """Refuse a curve that stops at one of its ends, and name the points that make it do so."""
        count, square = len(self.points), float((self._sides(1)[0] ** 2).sum(axis=1).max())
        for side, pair in ((0, (0, 1)), (1, (count - 2, count - 1))):
            tangent = self._sides(1)[side][-side]
            if (tangent**2).sum() <= STOPPED**2 * square:
                raise InvalidInput(
                    "points", f"points {pair[0]} and {pair[1]} = {self.points[pair[0]]}",
                    "must not coincide: the curve would stop there (r' = 0); leave one of them out and "
                    "lower the knots' count by one",
                )  # fmt: skip

    def _check_joins(self) -> None:
        """Compare the limits from both sides of every knot."""
        right, left = (
            [self._sides(order)[side] for order in range(3)] for side in (0, 1)
        )  # fmt: skip
        extent = float(np.ptp(np.array(self.points), axis=0).max())
        slowest = STOPPED * float(np.hypot(*right[1].T).max())
        for n, knot in enumerate(self._breaks[1:-1]):
            before, after = [part[n] for part in left], [part[n + 1] for part in right]
            turn = _angle(before[1], after[1])
            bend = _bend(*after[1:]) - _bend(*before[1:])
            if np.hypot(*(after[0] - before[0])) > 1e-9 * extent:
                what = f"the curve jumps by {np.hypot(*(after[0] - before[0])):.4g} m"
            elif min(np.hypot(*before[1]), np.hypot(*after[1])) <= slowest:
                what = "the curve stops there (a cusp, r' = 0): too many control points coincide"
            elif abs(turn) > np.pi - HEADING_JUMP:
                what = "the curve turns back on itself there (a cusp)"
            elif not abs(turn) <= HEADING_JUMP:
                what = f"the heading jumps there by {np.degrees(turn):.4g}°: round the corner off"
            elif not abs(bend) <= self.curvature_jump:
                what = (
                    f"the curvature jumps there by {bend:.4g} 1/m; use degree "
                    f"{max(3, self.degree)} or more and no knot more than degree − 2 times"
                )
            else:
                continue
            x, y = np.round(after[0] / extent, 12) * extent + 0.0
            place = f"{knot:.6g}, s = {self._length_to(n + 1):.4g} m, ({x:.6g}, {y:.6g})"
            raise InvalidInput("knots", place, what)

    def _length_to(self, piece: int) -> float:
        """Arc length (m) before a break."""
        p = np.concatenate([np.linspace(a, b, 257) for a, b in pairwise(self._breaks[: piece + 1])])
        points = self._derivative(p, 0)
        return float(np.hypot(*np.diff(points, axis=0).T).sum())

    @cached_property
    def _breaks(self) -> Array:
        """The different knots of the curve itself."""
        low, high = self.knots[self.degree], self.knots[-self.degree - 1]
        inner = sorted({k for k in self.knots if low < k < high})
        return np.array([low, *inner, high])

    @cached_property
    def _is_line(self) -> bool:
        """Whether coincident control points lie on one straight line, in order."""
        points = np.array(self.points)
        way = points[-1] - points[0]
        length = float(np.hypot(*way))
        if not length > 0.0:
            return False
        along, across = points @ way / length, points @ np.array([-way[1], way[0]]) / length
        repeated = (np.hypot(*np.diff(points, axis=0).T) <= SAME * length).any()
        straight = np.ptp(across) <= SAME * max(length, float(np.abs(points).max()))
        return bool(repeated and straight and (np.diff(along) >= -SAME * length).all())

    @cached_property
    def _homogeneous(self) -> Pieces:
        from scipy.interpolate import BSpline

        weights = np.array(self.weights or np.ones(len(self.points)))[:, None]
        lifted = np.concatenate([np.array(self.points) * weights, weights], axis=1)
        spline = BSpline(np.array(self.knots), lifted, self.degree)
        nodes, transform = nodes_of(self._breaks, self.degree)
        return Pieces(self._breaks, np.einsum("ij,njk->nik", transform, spline(nodes)))

    def _sides(self, order: int) -> tuple[Array, Array]:
        """A derivative's limits at the start and the end of every piece, shape (pieces, 2) each."""
        start, end = zip(*(self._homogeneous.ends(n) for n in range(order + 1)), strict=True)
        return _divide(list(start)), _divide(list(end))

    def _derivative(self, p: Array, order: int) -> Array:
        return _divide([self._homogeneous(p, n) for n in range(order + 1)])

    @cached_property
    def _arc(self) -> ArcLength:
        if not self._is_line:
            return ArcLength(self._derivative, self._breaks, 1024)
        begin, end = self._derivative(self._breaks[[0, -1]], 0)

        def line(p: Array, order: int) -> Array:
            steps = [p, np.ones_like(p), np.zeros_like(p), np.zeros_like(p)]
            return np.asarray(begin * (order == 0) + np.outer(steps[order], end - begin))

        return ArcLength(line, [0.0, 1.0], 2)


def _divide(lifted: list[Array]) -> Array:
    """Leibniz's rule on r · w: r⁽ⁿ⁾ = (A⁽ⁿ⁾ − Σ binom(n, k) w⁽ᵏ⁾ r⁽ⁿ⁻ᵏ⁾) / w.

    Args:
        lifted: (A, w) and its derivatives up to n, shape (points, 3) each.
    """
    weight = [part[:, 2:] for part in lifted]
    results: list[Array] = []
    for n, part in enumerate(lifted):
        rest = part[:, :2]
        for k in range(1, n + 1):
            rest = rest - PASCAL[n][k] * weight[k] * results[n - k]
        results.append(rest / weight[0])
    return results[-1]


def _angle(before: Array, after: Array) -> float:
    """The angle (rad) from one vector to another."""
    turned: Any = complex(*after) * complex(*before).conjugate()
    return float(np.angle(turned)) if turned else np.pi


def _bend(first: Array, second: Array) -> float:
    size = float(np.hypot(*first)) or np.nan
    return float(first[0] * second[1] - first[1] * second[0]) / size**3
