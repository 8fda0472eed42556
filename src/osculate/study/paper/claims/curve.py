"""Statements about the target curve, Sections 3 and 5."""

import numpy as np

from osculate.study.paper.claims.claim import Claim, Evidence, observed, printed


def curve_claims(evidence: Evidence) -> list[Claim]:
    """The curve's numbers, and what its parameters do."""
    curve = evidence.curve
    radius, truncation = curve.radius, curve.truncation
    constant = 16.0 * radius**2 * np.sin(truncation / 2.0) ** 2
    moved = _moved_by_pace(radius, truncation)
    return [
        printed("alpha", "radius of the rolling circle, α", "eq. (46)", 3.2056, radius, "m"),
        printed("beta", "truncation of the cycloid, β", "eq. (46)", 0.5121, truncation, "rad"),
        printed("path_length", "length of the path, l", "eqs (28), (50)", 24.8089, curve.length, "m"),
        printed(
            "initial_heading", "initial heading, θ(0) = π/2 − β/2", "Section 5, sentence before (45)",
            1.3147, float(curve.at(0.0).heading), "rad",
        ),
        printed(
            "curvature_constant", "constant 16 α² sin²(β/2) under the root of k(s)", "eq. (50)",
            10.5476, constant, "m²",
        ),
        observed(
            "pace_moves_curve", "μ pulls the target curve left and right",
            "Section 3, after eq. (18), sentence 6", "the curve depends on μ", moved, "m",
            "the curve for μ = 2 leaves that for μ = 1 by > 1 mm", moved > 1e-3,
            note="μ only says when a point is reached; D moves the curve", erratum=8,
        ),
    ]  # fmt: skip


def _moved_by_pace(radius: float, truncation: float) -> float:
    """Largest distance (m) between the curves (18) for μ = 1 and μ = 2, at equal fractions of time."""
    curves = []
    for pace in (1.0, 2.0):
        w = pace * np.linspace(0.0, (2.0 * np.pi - 2.0 * truncation) / pace, 501) + truncation
        curves.append(radius * np.array([w - np.sin(w), 1.0 - np.cos(w)]))
    return float(np.hypot(*(curves[1] - curves[0])).max())
