"""The regulator and its preview: published gains, optimality, and two ways that must agree."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from osculate.control.lqr import exponential_preview, sampled_preview, yaw_regulator
from osculate.target.contract import SampledYaw

SOLVED = yaw_regulator(50.0, 1.0, 100.0, 1.0)


def test_the_papers_gains():
    assert SOLVED.gain == pytest.approx([1.0, 10.0020], abs=1e-4)


def test_the_riccati_equation_holds():
    a = np.array([[0.0, 1.0], [0.0, 0.0]])
    b = np.array([[0.0], [50.0]])
    p = SOLVED.riccati
    residual = p @ a + a.T @ p - p @ b @ b.T @ p + np.diag([1.0, 100.0])
    assert np.abs(residual).max() < 1e-9
    assert (np.linalg.eigvals(SOLVED.closed).real < 0).all()


def test_the_closed_form_preview_is_the_integrated_one():
    decay, amplitude = 0.5, -2.6294528
    t = np.linspace(0.0, 90.0, 90001)
    height = amplitude * decay**2
    rate = height * t * np.exp(-decay * t)
    acceleration = height * (1 - decay * t) * np.exp(-decay * t)
    by_rate, by_acceleration = exponential_preview(SOLVED, decay)
    closed = by_rate * rate + by_acceleration * acceleration
    sampled = sampled_preview(SOLVED, SampledYaw(t[1], acceleration))
    assert sampled[:-1, 0] == pytest.approx(closed[:-1], abs=1e-8)
    slope = np.gradient(sampled[:, 0], t)
    assert sampled[10:-10, 1] == pytest.approx(slope[10:-10], abs=1e-6)


def cost(solved, preview, acceleration, horizon=8.0):
    """∫ Yᵀ Q Y + R u² of the error system under feedback and a given preview input."""
    t = np.linspace(0.0, horizon, 4001)

    def rate(now, state):
        y = state[:2]
        u = -solved.gain @ y + np.interp(now, t, preview)
        return [
            y[1],
            50.0 * u - np.interp(now, t, acceleration),
            y[0] ** 2 + 100 * y[1] ** 2 + u**2,
        ]

    return solve_ivp(rate, (0, horizon), [0, 0, 0], max_step=0.01, rtol=1e-8, atol=1e-12).y[2, -1]


def test_the_preview_is_optimal():
    t = np.linspace(0.0, 8.0, 4001)
    acceleration = 0.5 * np.exp(-((t - 3.0) ** 2)) * (t - 3.0)
    best = sampled_preview(SOLVED, SampledYaw(t[1], acceleration))[:, 0]
    least = cost(SOLVED, best, acceleration)
    assert cost(SOLVED, 0.0 * best, acceleration) > 1.5 * least
    for bump in (np.sin(t), np.cos(3 * t), np.exp(-t)):
        for size in (1e-3, -1e-3):
            assert cost(SOLVED, best + size * bump, acceleration) > least
