"""Laws that every curve obeys."""

import numpy as np


def check_frenet(curve, tolerance=1e-6, samples=1001):
    """Position, heading, curvature and its slope belong together (central differences)."""
    s = np.linspace(0.0, curve.length, samples)
    h = curve.length * 1e-5
    inner = s[(s > 2 * h) & (s < curve.length - 2 * h)]
    here, before, after = curve.at(inner), curve.at(inner - h), curve.at(inner + h)
    size = max(1.0, float(np.abs(here.curvature).max())) ** 3

    def slope(name):
        return (getattr(after, name) - getattr(before, name)) / (2 * h)

    assert np.abs(slope("x") - np.cos(here.heading)).max() < tolerance * size
    assert np.abs(slope("y") - np.sin(here.heading)).max() < tolerance * size
    assert np.abs(slope("heading") - here.curvature).max() < tolerance * size
    scale = max(1.0, float(np.abs(here.curvature_rate).max()))
    assert np.abs(slope("curvature") - here.curvature_rate).max() < 1e-4 * scale * size
