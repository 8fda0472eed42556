"""NURBS: circles of rational quadratics pass, corners, cusps and knots that do not fit are named."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from curve.laws import check_frenet
from osculate import InvalidInput, Nurbs

COORDINATES = st.floats(-10.0, 10.0)
SQUARE = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0))


def arcs(count, radius, step):
    """A circular arc of ``count`` pieces of ``step`` radians: degree 2, every inner knot double."""
    points, weights = [], []
    for n in range(2 * count + 1):
        middle = n % 2 == 1
        size = radius / math.cos(step / 2) if middle else radius
        points.append((size * math.cos(n * step / 2), size * math.sin(n * step / 2)))
        weights.append(math.cos(step / 2) if middle else 1.0)
    inner = [float(n) for n in range(1, count) for _ in range(2)]
    return Nurbs(
        degree=2, knots=(0, 0, 0, *inner, *(float(count),) * 3), points=points, weights=weights
    )


@given(st.integers(1, 6), st.floats(0.1, 50.0), st.floats(0.1, 2.5))
def test_arcs_of_rational_quadratics_are_circles(count, radius, step):
    curve = arcs(count, radius, step)
    assert curve.length == pytest.approx(count * step * radius, rel=1e-12)
    point = curve.at(np.linspace(0.0, curve.length, 501))
    assert point.curvature * radius == pytest.approx(1.0, rel=1e-9)
    assert np.hypot(point.x, point.y) == pytest.approx(radius, rel=1e-12)
    assert curve.total_turn == pytest.approx(count * step)


def test_the_whole_circle_of_a_textbook():
    w = math.sqrt(0.5)
    curve = Nurbs(
        degree=2, knots=(0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4), points=SQUARE,
        weights=(1, w, 1, w, 1, w, 1, w, 1),
    )  # fmt: skip
    assert curve.length == pytest.approx(2 * math.pi, rel=1e-12)


@given(
    st.lists(st.tuples(COORDINATES, COORDINATES), min_size=3, max_size=3, unique=True),
    st.floats(0.3, 3.0),
)
def test_arcs_at_different_speeds_join(points, ratio):
    """A straight line in two pieces whose parameters run at different speeds."""
    a, b = np.array(points[0]), np.array(points[1])
    if np.hypot(*(b - a)) < 0.1:
        return
    middle = a + (b - a) / (1.0 + ratio)
    curve = Nurbs(degree=1, knots=(0, 0, 0.5, 1, 1), points=(tuple(a), tuple(middle), tuple(b)))
    s = np.linspace(0.0, curve.length, 101)
    point = curve.at(s)
    assert curve.length == pytest.approx(float(np.hypot(*(b - a))))
    assert np.hypot(point.x - a[0], point.y - a[1]) == pytest.approx(s, abs=1e-11)


@given(st.floats(0.01, 3.1), st.sampled_from([1, -1]), st.floats(0.5, 20.0), st.floats(0.5, 20.0))
def test_a_corner_is_refused_with_angle_and_place(turn, side, before, after):
    corner = (before, 0.0)
    end = (before + after * math.cos(turn), side * after * math.sin(turn))
    with pytest.raises(InvalidInput, match="heading jumps") as told:
        Nurbs(degree=1, knots=(0, 0, 0.5, 1, 1), points=((0.0, 0.0), corner, end))
    assert f"{math.degrees(side * turn):.4g}°" in str(told.value)
    assert f"s = {before:.4g} m" in str(told.value)


KNOTS = (0, 0, 0, 0, 0.5, 1, 1, 1, 1)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            {"degree": 2, "knots": (0, 0, 0, 0, 1, 1, 1, 1), "points": [(n, 0) for n in range(5)]},
            r"occurs 4 times, at most degree \+ 1 = 3 \(the knots fit degree 3 with 4 points\)",
        ),
        ({"degree": 2.7, "knots": (0, 0, 0, 1, 1, 1), "points": [(0, 0), (1, 0), (2, 1)]}, "integer"),
        (
            {"degree": 3, "knots": KNOTS, "points": [(0, 0), (0, 0), (2, 0), (4, 1), (5, 1)]},
            "points 0 and 1 = .* must not coincide",
        ),
        (
            {"degree": 3, "knots": KNOTS, "points": [(0, 0), (1, 0), (2, 0), (4, 1), (4, 1)]},
            "points 3 and 4 = .* must not coincide",
        ),
        (
            {"degree": 3, "knots": KNOTS, "points": [(0, 0), (2, 0), (2, 0), (2, 0), (4, 1)]},
            r"s = 2 m, \(2, 0\)': the curve stops there \(a cusp",
        ),
        (
            {"degree": 1, "knots": (0, 0, 0.5, 1, 1), "points": [(0, 0), (3, 0), (1, 0)]},
            r"s = 3 m, \(3, 0\)': the curve turns back on itself there \(a cusp\)",
        ),
        (
            {"degree": 3, "knots": (0, 0, 0, 0, 1, 1, 1, 1), "points": [(0, 0), (1, 1), (0, 1), (1, 0)]},
            r"a cusp, .* s = 0\.9142 m, \(0\.5, 0\.75\)",
        ),
        (
            {"degree": 2, "knots": (0, 0, 0, 1, 1, 1, 2, 2, 2), "points": [(n, n // 3) for n in range(6)]},
            "the curve jumps by 1.414 m",
        ),
        ({"degree": 2, "knots": (0, 0, 0, 1, 1, 1), "points": [(0, 0)] * 3}, "must not coincide"),
    ],
)  # fmt: skip
def test_what_is_no_smooth_curve_says_why_and_where(fields, message):
    with pytest.raises(InvalidInput, match=message):
        _ = Nurbs(**fields).length


@given(st.lists(st.tuples(COORDINATES, COORDINATES), min_size=2, max_size=2, unique=True))
def test_straight_edges_may_repeat_their_ends(points):
    """A cubic whose control points coincide in pairs: how straight edges are often written."""
    a, b = points
    distance = math.hypot(b[0] - a[0], b[1] - a[1])
    if distance < 1e-3:
        return
    curve = Nurbs(degree=3, knots=(0, 0, 0, 0, 1, 1, 1, 1), points=(a, a, b, b))
    assert curve.length == pytest.approx(distance, rel=1e-12)
    assert np.abs(curve.at(np.linspace(0, distance, 9)).curvature).max() * distance < 1e-9


FOUR = {"min_size": 4, "max_size": 4}


@given(st.lists(st.floats(-0.4, 0.4), **FOUR), st.lists(st.floats(0.5, 2.0), **FOUR))
@settings(max_examples=20)
def test_frenet(heights, weights):
    points = [(n, h) for n, h in enumerate(heights)]
    curve = Nurbs(degree=3, knots=(0, 0, 0, 0, 1, 1, 1, 1), points=points, weights=weights)
    check_frenet(curve, tolerance=1e-4)
