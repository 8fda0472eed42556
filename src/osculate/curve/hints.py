"""What a list of points gives away about how it came about: noise, rounding, standstills."""

import numpy as np
from numpy.typing import NDArray

from osculate.curve.waypoints import FEWEST, Merged, steps_of, turns_of

Array = NDArray[np.float64]

COARSER = 4  # points are compared with every fourth of them
COARSE = 0.2  # of the points' own step: rounding that shows
DIGITS = 6  # that ``%g`` writes
NAMED = 5  # points named one by one; of more the number is told


def hints(points: Array, merged: Merged) -> list[str]:
    """Sentences about points that a curve may well go through, but should perhaps not.

    Args:
        points: As given, shape (n, 2), m.
        merged: Which of them remain.
    """
    kept = points[merged.kept]
    found = [
        f"points {first} to {last} stand still within {radius:.2g} m and are taken as one"
        for first, last, radius in merged.still
    ]
    if len(merged.near):
        steps = np.append(steps_of(points), np.inf)
        gap = float(np.minimum(steps[merged.near - 1], steps[merged.near]).max())
        places = ", ".join(str(n) for n in merged.near[:NAMED])
        more = f" and {len(merged.near) - NAMED} more" if len(merged.near) > NAMED else ""
        found.append(
            f"points {places}{more} lie within {gap:.2g} m of their neighbours, far less than the "
            f"steps around them, and are left out (or give tolerance: {_rounded_up(gap):g})"
        )
    found += rounding(points)
    noise = noise_of(kept)
    if noise is not None:
        bend, tolerance = noise
        found.append(
            f"the points look noisy: the curvature through them changes sign from point to point, up "
            f"to {bend:.3g} 1/m; a tolerance of {tolerance:g} m would let the curve pass between them"
        )
    return found


def rounding(points: Array) -> list[str]:
    """Sentences about coordinates that were rounded to steps as coarse as the points' own."""
    if len(points) < FEWEST:  # a few whole metres are nothing strange
        return []
    steps = steps_of(points)
    step = float(np.median(steps[steps > 0.0]))
    found = []
    for name, values in zip("xy", points.T, strict=True):
        largest = float(np.abs(values).max())
        if not 0.0 < largest < 1e30:
            continue
        single = float(np.spacing(np.float32(largest)))
        decimal = float(10.0 ** (np.floor(np.log10(largest)) - DIGITS + 1.0))
        grids = {single: "single precision", decimal: f"{DIGITS} digits"}
        coarse = [
            grid
            for grid in grids
            if grid >= COARSE * step
            and np.allclose(values / grid, np.round(values / grid), rtol=0.0, atol=1e-6)
        ]
        if coarse:
            grid, equal = max(coarse), ", all equal" if np.ptp(values) == 0.0 else ""
            found.append(
                f"{name} takes only multiples of {grid:g} m{equal}: rounded to {grids[grid]}, while the "
                f"points are {step:.2g} m apart; write more digits, or subtract an origin first"
            )
    return found


def noise_of(points: Array) -> tuple[float, float] | None:
    """The curvature (1/m) that noise makes, and a tolerance (m) that would remove it."""
    if len(points) < FEWEST:
        return None
    turns, fine = turns_of(points), _curvatures(points)
    coarse = [_curvatures(points[first::COARSER]) for first in range(COARSER)]
    real = np.sqrt(np.mean(np.concatenate(coarse) ** 2))
    turning = turns[np.abs(turns) > 1e-6]
    flips = np.count_nonzero(turning[1:] * turning[:-1] < 0.0)
    bend = float(np.abs(fine).max())
    shaky = np.sqrt(np.mean(fine**2)) > 3.0 * real and np.sqrt(np.mean(turns**2)) > 0.02
    if not (shaky and bend > 0.1 and flips > 0.4 * len(turning)):
        return None
    spread = np.sqrt((np.diff(points, 4, axis=0) ** 2).mean() / 70.0)  # 70: Σ of (4 over k)²
    return bend, _rounded_up(3.5 * float(spread))


def _curvatures(points: Array) -> Array:
    steps = np.maximum(steps_of(points), 1e-300)
    bends: Array = turns_of(points) / (0.5 * (steps[1:] + steps[:-1]))
    return bends


def _rounded_up(value: float) -> float:
    """With one digit, upwards."""
    unit = 10.0 ** np.floor(np.log10(max(value, 1e-12)))
    return float(f"{np.ceil(value / unit) * unit:.1g}")
