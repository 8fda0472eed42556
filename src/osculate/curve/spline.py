"""Curves through or near points: interpolating and smoothing splines.

Splines are quintic: curvature and its derivative are continuous, and so are steering angle and rate.
"""

import warnings
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator

from osculate.curve.arclength import ArcLength, along
from osculate.curve.guides import allowance, graded, place, uneven_legs
from osculate.curve.hints import hints
from osculate.curve.nurbs import Nurbs
from osculate.curve.sampled import Points, Sampled
from osculate.curve.smoothing import DEGREE, smooth
from osculate.curve.waypoints import (
    Indices,
    distances,
    distinct,
    merge,
    require_forward,
    require_measure,
    steps_of,
)
from osculate.errors import InvalidInput
from osculate.spec import quantity

Array = NDArray[np.float64]

SAMPLES = 8  # of the curve between two points, where its distance from the polyline is measured
SPLITS = 8  # times that guides are added


class PolylineError(NamedTuple):
    """How far a curve leaves the polyline through the points it was made from."""

    largest: float  # m
    rms: float  # m
    x: float  # m, where it is largest
    y: float  # m


class _Fit(NamedTuple):
    """A spline and what it goes through, or near."""

    spline: Any
    parameters: Array  # of its nodes, shape (n,)
    nodes: Array  # m, shape (n, 2): the points, guides between them, a loop's first one again
    own: Indices  # which node each point is


class Spline(Sampled):
    """A quintic spline through waypoints, or near them if a tolerance is given.

    The parameter is the chord length. Where points are so uneven that the curve would bulge beside
    short steps, guides on the long ones keep it near the polyline. Points that repeat, nearly
    coincide or jitter about one place become one; what was merged, noise and rounded coordinates are
    told in a warning when the curve is built.

    Raises:
        InvalidInput: Fewer than two different points, a point that is not finite, a list that turns
            round (says at which point).
        NoSolution: The tolerance cannot be kept.
    """

    kind: Literal["spline"] = "spline"
    points: Points = quantity("m", "waypoints (x, y), at least two different ones")
    loop: bool = quantity("1", "whether the last point leads back to the first", default=False)
    tolerance: float = quantity(
        "m",
        "largest distance from the points; 0 goes through all of them",
        default=0.0,
        ge=0,
        le=1e6,
    )

    @field_validator("points")
    @classmethod
    def _enough(cls, points: Points) -> Points:
        array = np.array(points, dtype=float).reshape(-1, 2)
        if not np.isfinite(array).all():
            where = int((~np.isfinite(array).all(axis=1)).argmax())
            raise ValueError(f"must be finite everywhere; point {where} is {points[where]}")
        if len(array) < 2 or len(distinct(array)) < 2:
            raise ValueError("must be at least two different points")
        require_measure(array)
        return points

    @property
    def closed(self) -> bool:
        """See `Curve.closed`."""
        return self.loop

    @cached_property
    def _raw_points(self) -> Array:
        return np.array(self.points, dtype=float)

    @cached_property
    def _kept(self) -> Indices:
        """Which points the curve is made from; tells what was merged and what looks wrong."""
        merged = merge(self._raw_points)
        if self.tolerance == 0.0:
            for sentence in hints(self._raw_points, merged):
                warnings.warn(sentence, stacklevel=4)
        kept = merged.kept
        places = self._raw_points[kept]
        if self.loop and len(kept) > 2:
            steps = steps_of(places)
            gap = float(np.hypot(*(places[-1] - places[0])))
            if gap <= max(0.02 * min(steps[0], steps[-1]), 1e-6 * np.ptp(places, axis=0).max()):
                kept = kept[:-1]
        if self.loop and len(kept) < 3:
            raise InvalidInput("points", len(kept), "a loop needs at least three different points")
        return kept

    @property
    def waypoints(self) -> Array:
        """The different points (m), shape (n, 2); a loop's first point is not repeated at its end."""
        return self._raw_points[self._kept]

    @cached_property
    def _corners(self) -> Array:
        """The points; a loop comes back to its first one."""
        points = self.waypoints
        corners = np.concatenate([points, points[:1]]) if self.loop else points
        if len(corners) > 2:
            require_forward(corners, self._kept, self.loop)
        return corners

    @cached_property
    def _fit(self) -> _Fit:
        corners = self._corners
        own = np.arange(len(self._kept))
        if len(corners) == 2:  # a straight line: a quintic with free ends needs three points
            corners, own = np.insert(corners, 1, corners.mean(axis=0), axis=0), 2 * own
        chords = np.concatenate([[0.0], np.cumsum(steps_of(corners))])
        if self.tolerance > 0.0 and len(self.waypoints) > DEGREE:
            spline, u = smooth(chords, corners, self.tolerance, self.loop)
            return _Fit(spline, u, corners, own)
        fit = _Fit(self._through(chords, corners), chords, corners, own)
        uneven = uneven_legs(corners, self.loop)
        if not uneven.any():
            return fit
        samples, leg = self._between(fit)
        bulges = distances(samples, corners, leg) > allowance(samples, leg, corners, self.loop)
        return self._guided(fit) if (bulges & uneven[leg]).any() else fit

    def _through(self, u: Array, points: Array) -> Any:
        from scipy.interpolate import make_interp_spline

        if self.loop:
            return make_interp_spline(u, points, k=DEGREE, bc_type="periodic")
        free: Any = [(3, np.zeros(2)), (4, np.zeros(2))]  # natural ends
        return make_interp_spline(u, points, k=DEGREE, bc_type=(free, free))

    def _guided(self, fit: _Fit) -> _Fit:
        """The spline through the points and guides between them, as many as it takes.

        Steps that grow twofold from one to the next want the square root of the chord as parameter:
        with the chord itself the quintic's ripples would grow with the steps.
        """
        corners = self._corners
        leg, along = graded(corners, self.loop)
        wish = np.asarray(fit.spline(fit.parameters[leg] + along))
        for _ in range(SPLITS):
            guides = place(corners, self.loop, leg, along, wish)
            points = np.concatenate([guides, corners[-1:]])
            u = np.concatenate([[0.0], np.cumsum(np.sqrt(steps_of(points)))])
            own = np.searchsorted(leg, np.arange(len(self._kept)))
            fit = _Fit(self._through(u, points), u, points, own)
            samples, step = self._between(fit)
            far = distances(samples, corners, leg[step])
            far_steps = np.unique(step[far > allowance(samples, leg[step], corners, self.loop)])
            if not len(far_steps):
                break
            ends = np.append(along[1:], 0.0)
            ends = np.where(ends > 0.0, ends, steps_of(corners)[leg])
            middle = 0.5 * (u[far_steps] + u[far_steps + 1])
            wish = np.insert(guides, far_steps + 1, np.asarray(fit.spline(middle)), axis=0)
            halves = 0.5 * (along + ends)[far_steps]
            along = np.insert(along, far_steps + 1, halves)
            leg = np.insert(leg, far_steps + 1, leg[far_steps])
        return fit

    @staticmethod
    def _between(fit: _Fit) -> tuple[Array, Any]:
        """Samples of a spline between its corners, shape (n, 2), and the leg of each."""
        leg = np.repeat(np.arange(len(fit.nodes) - 1), SAMPLES)
        part = np.tile((np.arange(SAMPLES) + 0.5) / SAMPLES, len(fit.nodes) - 1)
        u = fit.parameters[leg] * (1.0 - part) + fit.parameters[leg + 1] * part
        return np.asarray(fit.spline(u)), leg

    @cached_property
    def _arc(self) -> ArcLength:
        return along(self._fit.spline, 2048)

    @cached_property
    def polyline_error(self) -> PolylineError:
        """How far the curve leaves the polyline through its points."""
        samples, step = self._between(self._fit)
        leg = np.searchsorted(self._fit.own, step, side="right") - 1
        far = distances(samples, self._corners, leg)
        x, y = samples[far.argmax()]
        return PolylineError(float(far.max()), float(np.sqrt((far**2).mean())), float(x), float(y))

    @cached_property
    def deviation(self) -> tuple[float, float]:
        """Largest and root-mean-square distance (m) of the points, merged ones too, from the curve."""
        fit = self._fit
        spline, first, second = fit.spline, fit.spline.derivative(1), fit.spline.derivative(2)
        place = np.searchsorted(self._kept, np.arange(len(self._raw_points)), side="right") - 1
        foot = fit.parameters[fit.own[place]]
        away = np.hypot(*(np.asarray(spline(foot)) - self._raw_points).T)
        reach = 2.0 * away / np.hypot(*np.asarray(first(foot)).T)  # no nearer point lies beyond
        low = np.maximum(foot - reach, fit.parameters[0])
        high = np.minimum(foot + reach, fit.parameters[-1])
        for _ in range(4):  # Newton, from the parameter of a point to its foot
            off, tangent = np.asarray(spline(foot)) - self._raw_points, np.asarray(first(foot))
            square = (tangent**2).sum(axis=1)
            slope = square + (off * np.asarray(second(foot))).sum(axis=1)
            step = (off * tangent).sum(axis=1) / np.maximum(slope, 0.1 * square)
            foot = np.clip(foot - step, low, high)
        distance = np.hypot(*(np.asarray(spline(foot)) - self._raw_points).T)
        return float(distance.max()), float(np.sqrt((distance**2).mean()))


__all__ = ["DEGREE", "Nurbs", "PolylineError", "Spline"]
