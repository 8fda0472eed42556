"""The smoothest quintic near points: for noisy ones."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.errors import NoSolution

Array = NDArray[np.float64]

DEGREE = 5
PIECES = 10_000  # of a smooth spline; more would follow the noise, and their number is what costs
CLOSE = 0.05  # of the sum of squares: nearer to the smoothest is not looked for
ROUGH = 5_000  # points that the first fit needs at most: only its arc length is used


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
        NoSolution: The tolerance cannot be kept, or not with `PIECES` pieces (says what can be).
    """
    some = np.append(np.arange(0, len(u) - 1, -(-len(u) // ROUGH)), len(u) - 1)
    rough = _smoothest(u[some], points[some], tolerance, loop)
    again = _feet(rough, u, points)
    if not (np.diff(again) > 0).all():
        return rough if len(some) == len(u) else _smoothest(u, points, tolerance, loop), u
    return _smoothest(again, points, tolerance, loop), again


def _smoothest(u: Array, points: Array, tolerance: float, loop: bool) -> Any:
    from scipy.interpolate import BSpline, splprep

    best, low, high = None, 0.0, 2.0 * tolerance**2 * len(points)
    trial, degree = high, min(DEGREE, len(points) - 1)
    nest = min(len(points) + 2 * degree, PIECES)  # what FITPACK needs at most
    for _ in range(30):
        fitted: Any = splprep(
            points.T, u=u, k=degree, s=trial, per=loop, nest=nest, full_output=True
        )
        (knots, coefficients, _), status = fitted[0][0], fitted[2]
        spline = BSpline(knots, np.transpose(coefficients), degree)
        largest = float(np.hypot(*(spline(u) - points).T).max())
        if largest <= tolerance:
            best, low = spline, trial
        elif status == 1 and nest == PIECES:  # no knots are left: less smoothness brings no more
            break
        else:
            high = trial
        if best is not None and high - low <= CLOSE * high:
            break
        trial = 0.25 * high if best is None else 0.5 * (low + high)
    if best is None:
        raise _too_tight(tolerance, largest, len(points), nest)
    return best


def _too_tight(tolerance: float, largest: float, count: int, nest: int) -> NoSolution:
    message = f"no smoothing spline keeps a tolerance of {tolerance:g} m"
    if nest == PIECES:
        message += (
            f" at {count} points with {PIECES} pieces; they leave {largest:.3g} m: "
            "the points are noisier, give a larger tolerance or fewer points"
        )
    return NoSolution(message)


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
