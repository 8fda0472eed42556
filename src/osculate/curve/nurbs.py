"""Non-uniform rational B-splines, as VDA 5050 describes trajectories."""

from functools import cached_property
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from osculate.curve.arclength import ArcLength
from osculate.curve.sampled import Points, Sampled
from osculate.errors import InvalidInput
from osculate.spec import quantity

Array = NDArray[np.float64]


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
