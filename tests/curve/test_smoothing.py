"""Smoothing of many noisy points: within the tolerance, or refused with what can be kept, and soon."""

import numpy as np
import pytest

from osculate import NoSolution, Spline
from osculate.curve import smoothing


def wave(count: int, noise: float, step: float = 0.05):
    x = step * np.arange(count)
    y = 3.0 * np.sin(x / 15.0) + np.random.default_rng(0).normal(0.0, noise, count)
    return np.stack([x, y], axis=1)


@pytest.mark.parametrize("count", [4 * smoothing.ROUGH // 5, 12 * smoothing.ROUGH // 5])
def test_many_noisy_points_become_the_smooth_curve_they_were_made_from(count):
    points = wave(count, 0.005)
    curve = Spline(points=tuple(map(tuple, points.tolist())), tolerance=0.03)
    assert curve.deviation[0] <= 0.03
    place = curve.at(np.linspace(0.1, 0.9, 400) * curve.length)
    bend = np.abs(3.0 / 225.0 * np.sin(place.x / 15.0)) / (
        1.0 + (0.2 * np.cos(place.x / 15.0)) ** 2
    ) ** 1.5  # fmt: skip
    assert np.abs(np.abs(place.curvature) - bend).max() < 0.004
    assert len(curve._fit.spline.t) < count / 20


def test_a_tolerance_below_the_noise_of_many_points_is_refused_with_what_can_be_kept(monkeypatch):
    monkeypatch.setattr(smoothing, "PIECES", 500)
    points = tuple(map(tuple, wave(4000, 0.005).tolist()))
    with pytest.raises(
        NoSolution, match=r"0.008 m at 4000 points with 500 pieces; they leave 0.01"
    ):
        _ = Spline(points=points, tolerance=0.008).length
    assert Spline(points=points, tolerance=0.03).deviation[0] <= 0.03
