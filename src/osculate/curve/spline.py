"""Curves through or near points: interpolating and smoothing splines, and NURBS.

Splines are quintic: curvature and its derivative are continuous, and so are steering angle and rate.
"""

from functools import cached_property
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import field_validator, model_validator

from osculate.curve.arclength import ArcLength, along
from osculate.curve.contract import Curve, CurvePoint
from osculate.errors import InvalidInput, NoSolution
from osculate.spec import quantity

Array = NDArray[np.float64]
Points = tuple[tuple[float, float], ...]

DEGREE = 5
DUPLICATE = 1e-9  # of the whole extent: points closer than this are one


class Sampled(Curve):
    """A curve with a parameter of its own, behind an `ArcLength`."""

    @cached_property
    def _arc(self) -> ArcLength:
        raise NotImplementedError

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return self._arc.length

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        return self._arc.at(arc_length)


class Spline(Sampled):
    """A quintic spline through waypoints, or near them if a tolerance is given.

    The parameter is the chord length, so that uneven spacing is fine; repeated points are dropped.

    Raises:
        InvalidInput: Fewer than two different points, a point that is not finite.
        NoSolution: The tolerance cannot be kept.
    """

    kind: Literal["spline"] = "spline"
    points: Points = quantity("m", "waypoints (x, y), at least two different ones")
    loop: bool = quantity("1", "whether the last point leads back to the first", default=False)
    tolerance: float = quantity(
        "m", "largest distance from the points; 0 goes through all of them", default=0.0, ge=0
    )

    @field_validator("points")
    @classmethod
    def _enough(cls, points: Points) -> Points:
        array = np.array(points, dtype=float).reshape(-1, 2)
        if not np.isfinite(array).all():
            where = int((~np.isfinite(array).all(axis=1)).argmax())
            raise ValueError(f"must be finite everywhere; point {where} is {points[where]}")
        if len(distinct(array)) < 2:
            raise ValueError("must be at least two different points")
        return points

    @property
    def closed(self) -> bool:
        """See `Curve.closed`."""
        return self.loop

    @cached_property
    def waypoints(self) -> Array:
        """The different points (m), shape (n, 2); a loop's first point is not repeated at its end."""
        array = distinct(np.array(self.points, dtype=float))
        extent = np.ptp(array, axis=0).max()
        if self.loop and np.hypot(*(array[-1] - array[0])) <= 1e-6 * extent:
            array = array[:-1]
        if self.loop and len(array) < 3:
            raise InvalidInput("points", len(array), "a loop needs at least three different points")
        return array

    @cached_property
    def _chords(self) -> tuple[Array, Array]:
        """Chord length (m) at every point, and the points; a loop comes back to its first one."""
        points = (
            np.concatenate([self.waypoints, self.waypoints[:1]]) if self.loop else self.waypoints
        )
        chords = np.hypot(*np.diff(points, axis=0).T)
        return np.concatenate([[0.0], np.cumsum(chords)]), points

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import make_interp_spline

        u, points = self._chords
        if self.tolerance > 0.0:
            return self._smooth(u, points)
        if self.loop:
            return make_interp_spline(u, points, k=DEGREE, bc_type="periodic")
        free: Any = [(3, np.zeros(2)), (4, np.zeros(2))]  # natural ends
        return make_interp_spline(u, points, k=DEGREE, bc_type=(free, free))

    def _smooth(self, u: Array, points: Array) -> Any:
        """The smoothest spline whose distance from every point is within the tolerance.

        Noise makes the chord length of the points too long; the parameters are therefore taken from
        the first fit's own arc length, at its nearest points, and the fit is repeated.
        """
        rough = self._smoothest(u, points)
        again = self._feet(rough, u, points)
        return self._smoothest(again, points) if (np.diff(again) > 0).all() else rough

    def _smoothest(self, u: Array, points: Array) -> Any:
        from scipy.interpolate import BSpline, splprep

        fitted: Any
        best, low, high = None, 0.0, 2.0 * self.tolerance**2 * len(points)
        trial = high
        for _ in range(30):
            fitted = splprep(points.T, u=u, k=min(DEGREE, len(points) - 1), s=trial, per=self.loop)
            knots, coefficients, degree = fitted[0]
            spline = BSpline(knots, np.transpose(coefficients), degree)
            if np.hypot(*(spline(u) - points).T).max() <= self.tolerance:
                best, low = spline, trial
            else:
                high = trial
            if best is not None and high - low <= 0.02 * high:
                break
            trial = 0.5 * (low + high)
        if best is None:
            raise NoSolution(f"no smoothing spline keeps a tolerance of {self.tolerance:g} m")
        return best

    @staticmethod
    def _feet(spline: Any, u: Array, points: Array) -> Array:
        """Arc length (m) of the points of the spline that are nearest to ``points``, in order."""
        dense = np.linspace(u[0], u[-1], 32 * len(u) + 1)
        curve = spline(dense)
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve, axis=0).T))])
        reach = 64  # samples to both sides: a foot does not jump to another branch
        feet = np.empty(len(u))
        for n, place in enumerate(np.searchsorted(dense, u)):
            here = slice(max(0, place - reach), place + reach + 1)
            near = np.hypot(*(curve[here] - points[n]).T)
            feet[n] = arc[here][near.argmin()]
        feet[0], feet[-1] = 0.0, arc[-1]
        return np.maximum.accumulate(feet) + 1e-9 * arc[-1] * np.arange(len(u))

    @cached_property
    def _arc(self) -> ArcLength:
        return along(self._spline, 2048)

    @cached_property
    def deviation(self) -> tuple[float, float]:
        """Largest and root-mean-square distance (m) of the points from the curve."""
        from scipy.spatial import KDTree

        s = np.linspace(0.0, self.length, 64 * len(self.waypoints) + 1)
        point = self.at(s)
        curve = np.stack([point.x, point.y], axis=1)
        near: Any = KDTree(curve).query(self.waypoints)[1]
        foot = s[near]
        for _ in range(4):  # Newton, from the nearest sample to the foot
            point = self.at(foot)
            dx, dy = self.waypoints[:, 0] - point.x, self.waypoints[:, 1] - point.y
            cosine, sine = np.cos(point.heading), np.sin(point.heading)
            slack = np.maximum(1.0 - point.curvature * (dy * cosine - dx * sine), 0.1)
            foot = np.clip(foot + (dx * cosine + dy * sine) / slack, 0.0, self.length)
        point = self.at(foot)
        distance = np.hypot(self.waypoints[:, 0] - point.x, self.waypoints[:, 1] - point.y)
        return float(distance.max()), float(np.sqrt((distance**2).mean()))


class Nurbs(Sampled):
    """A non-uniform rational B-spline, as VDA 5050 describes a trajectory.

    Raises:
        InvalidInput: Counts that do not fit, knots that decrease, or a curvature that jumps.
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
        self._check_knots()
        return self

    def _check_knots(self) -> None:
        """At a multiple knot the curve is less smooth: refuse a jump of heading or curvature."""
        low, high = self.knots[self.degree], self.knots[-self.degree - 1]
        inner = np.unique([k for k in self.knots if low < k < high])
        sides = 1e-9 * (high - low)
        for knot in inner:
            before, after = (self._bend(np.array([knot + sign * sides])) for sign in (-1, 1))
            jump = float(after - before)
            if abs(jump) > self.curvature_jump:
                raise InvalidInput(
                    "knots", float(knot), f"the curvature jumps there by {jump:.4g} 1/m; use degree "
                    f"{max(3, self.degree)} or more and no knot more than degree − 2 times",
                )  # fmt: skip

    def _bend(self, p: Array) -> Any:
        first, second = self._derivative(p, 1)[0], self._derivative(p, 2)[0]
        return (first[0] * second[1] - first[1] * second[0]) / np.hypot(*first) ** 3

    @cached_property
    def _homogeneous(self) -> list[Any]:
        from scipy.interpolate import BSpline

        weights = np.array(self.weights or np.ones(len(self.points)))[:, None]
        lifted = np.concatenate([np.array(self.points) * weights, weights], axis=1)
        spline = BSpline(np.array(self.knots), lifted, self.degree)
        orders = [spline.derivative(n) for n in range(1, min(3, self.degree) + 1)]
        flat = [lambda p: np.zeros((len(p), 3))] * (3 - len(orders))  # beyond the degree
        return [spline, *orders, *flat]

    def _derivative(self, p: Array, order: int) -> Array:
        """Leibniz's rule on r · w: r⁽ⁿ⁾ = (A⁽ⁿ⁾ − Σ binom(n, k) w⁽ᵏ⁾ r⁽ⁿ⁻ᵏ⁾) / w."""
        lifted = [np.asarray(self._homogeneous[n](p)) for n in range(order + 1)]
        weight = [part[:, 2:] for part in lifted]
        pascal = [[1], [1, 1], [1, 2, 1], [1, 3, 3, 1]]
        results: list[Array] = []
        for n in range(order + 1):
            rest = lifted[n][:, :2]
            for k in range(1, n + 1):
                rest = rest - pascal[n][k] * weight[k] * results[n - k]
            results.append(rest / weight[0])
        return results[order]

    @cached_property
    def _arc(self) -> ArcLength:
        low, high = self.knots[self.degree], self.knots[-self.degree - 1]
        inner = sorted({k for k in self.knots if low < k < high})
        return ArcLength(self._derivative, [low, *inner, high], 1024)


def distinct(points: Array) -> Array:
    """The points without those that repeat their predecessor."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    return points[np.concatenate([[True], steps > DUPLICATE * extent])]
