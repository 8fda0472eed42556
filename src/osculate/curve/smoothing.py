"""The smoothest quintic near points: for noisy ones."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.errors import NoSolution

Array = NDArray[np.float64]

DEGREE = 5


def smooth(u: Array, points: Array, tolerance: float, loop: bool) -> tuple[Any, Array]:
    """The smoothest spline whose distance from every point is within the tolerance.

    Noise makes the chord length of the points too long; the parameters are therefore taken from
    the first fit's own arc length, at its nearest points, and the fit is repeated.

    Args:
        u: Parameters of the points, increasing, shape (n,).
        points: Shape (n, 2), m; a loop ends with its first one.
        tolerance: Largest distance (m).
        loop: Whether it is closed.

    Returns:
        The spline and the parameters of the points on it.

    Raises:
        NoSolution: The tolerance cannot be kept.
    """
    rough = _smoothest(u, points, tolerance, loop)
    again = _feet(rough, u, points)
    if not (np.diff(again) > 0).all():
        return rough, u
    return _smoothest(again, points, tolerance, loop), again


def _smoothest(u: Array, points: Array, tolerance: float, loop: bool) -> Any:
    from scipy.interpolate import BSpline, splprep

    fitted: Any
    best, low, high = None, 0.0, 2.0 * tolerance**2 * len(points)
    trial = high
    for _ in range(30):
        fitted = splprep(points.T, u=u, k=min(DEGREE, len(points) - 1), s=trial, per=loop)
        knots, coefficients, degree = fitted[0]
        spline = BSpline(knots, np.transpose(coefficients), degree)
        if np.hypot(*(spline(u) - points).T).max() <= tolerance:
            best, low = spline, trial
        else:
            high = trial
        if best is not None and high - low <= 0.02 * high:
            break
        trial = 0.5 * (low + high)
    if best is None:
        raise NoSolution(f"no smoothing spline keeps a tolerance of {tolerance:g} m")
    return best


def _feet(spline: Any, u: Array, points: Array) -> Array:
    """Arc length (m) of the points of the spline that are nearest to ``points``, in order."""
    dense = np.linspace(u[0], u[-1], 32 * len(u) + 1)
    curve = spline(dense)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve, axis=0).T))])
    reach = 64  # samples to both sides: a foot does not jump to another branch
    feet = np.empty(len(u))
    for n, middle in enumerate(np.searchsorted(dense, u)):
        here = slice(max(0, middle - reach), middle + reach + 1)
        near = np.hypot(*(curve[here] - points[n]).T)
        feet[n] = arc[here][near.argmin()]
    feet[0], feet[-1] = 0.0, arc[-1]
    return np.maximum.accumulate(feet) + 1e-9 * arc[-1] * np.arange(len(u))
