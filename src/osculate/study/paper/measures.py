"""The paper's measures of a run: vertical errors, J_a, √(J_a/N), and when it has left the path."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve import Cycloid
from osculate.simulation import Run

LOST = 2.0  # m off the path; what comes after it is unstable growth, other for every step size


def vertical_errors(run: Run, radius: float | None = None) -> NDArray[np.float64]:
    """y_a − ŷ(x_a) (m) at every sample: the paper's error, at equal x instead of the nearest point.

    The cycloid's parameter w solves w − sin w = x / α; it lies within 1 of x / α, and bisection
    finds it everywhere, also where the robot has left the curve's ends.

    Args:
        run: A run on a cycloid.
        radius: α (m) of the cycloid that is compared with; by default that of the run.
    """
    curve = run.setup.curve
    assert isinstance(curve, Cycloid)
    alpha = curve.radius if radius is None else radius
    along = run.columns["x"] / alpha
    low, high = along - 1.0, along + 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        short = middle - np.sin(middle) < along
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    error: NDArray[np.float64] = run.columns["y"] - alpha * (1.0 - np.cos(low))
    return error


def sum_of_squares(run: Run, radius: float | None = None, count: int | None = None) -> float:
    """J_a (m²), the paper's sum of squared errors over the first ``count`` samples, or over all."""
    return float((vertical_errors(run, radius)[:count] ** 2).sum())


def lost_at(run: Run) -> float | None:
    """Time (s) at which the robot is 2 m off the path, or nothing if it never is."""
    n = _kept(run)
    return float(run.columns["time"][n]) if n < len(run.columns["time"]) else None


def rms(run: Run) -> float:
    """√(J_a / N) (m), up to where the robot is 2 m off the path."""
    kept = max(_kept(run), 1)
    return float(np.sqrt((vertical_errors(run)[:kept] ** 2).mean()))


def _kept(run: Run) -> int:
    """Number of samples before the robot is 2 m off the path."""
    off = np.abs(run.columns["cross_track_error"]) >= LOST
    return int(off.argmax()) if off.any() else len(off)


def path_end(run: Run) -> float | None:
    """Time (s) at which the travelled distance reaches the path's length, or nothing."""
    over = run.columns["arc_length"] >= run.setup.curve.length - 1e-9
    return float(run.columns["time"][over.argmax()]) if over.any() else None


class SpeedErrors(NamedTuple):
    """How the speed errors of a run develop."""

    largest: float  # of |z| (m/s) and |y₂| (rad/s), after the first second
    growth: float  # 1/s, slope of ln √(z² + y₂²) fitted over the second half of the run


def speed_errors(run: Run) -> SpeedErrors:
    """Size and growth of z = v − v̂ and y₂ = θ̇ − θ̂̇."""
    c = run.columns
    size = np.hypot(c["speed_error"], c["yaw_rate_error"])
    late = c["time"] >= min(1.0, 0.5 * c["time"][-1])
    half = c["time"] >= 0.5 * c["time"][-1]
    slope = np.polyfit(c["time"][half], np.log(np.maximum(size[half], 1e-300)), 1)[0]
    return SpeedErrors(float(size[late].max()), float(slope))


def sliding(run: Run) -> NDArray[np.float64]:
    """ϝ / G = v − v(0) − ∫v̂̇ dt (m/s) at every sample: with eq. (39), z(t) − z(0)."""
    error = run.columns["speed_error"]
    drift: NDArray[np.float64] = error - error[0]
    return drift
