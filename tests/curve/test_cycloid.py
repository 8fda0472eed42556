"""The cycloid: the paper's numbers, its laws, and where it does not exist."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from curve.laws import check_frenet
from osculate import Cycloid, InvalidInput, NoSolution

pytestmark = pytest.mark.core


def test_the_papers_numbers():
    curve = Cycloid.over(distance=10, height=5, margin=1)
    assert curve.radius == pytest.approx(3.205645553, abs=1e-9)
    assert curve.truncation == pytest.approx(0.512139850, abs=1e-9)
    assert curve.length == pytest.approx(24.80894892, abs=1e-8)
    start = curve.at(0.0)
    assert float(start.heading) == pytest.approx(1.3147264, abs=1e-7)
    assert (float(start.x), float(start.y)) == pytest.approx((0.0709, 0.4111), abs=2e-4)
    assert curve.total_turn == pytest.approx(-(math.pi - curve.truncation))
    assert 1 / float(start.curvature) ** 2 == pytest.approx(10.54762806, abs=1e-8)


@given(st.floats(0.5, 100), st.floats(0.05, 0.62), st.floats(0, 0.9))
def test_any_solvable_obstacle_is_cleared_by_the_margin(distance, slope, share):
    rise = slope * distance
    curve = Cycloid.over(distance, rise * (1 - share), rise * share)
    s = curve.length * np.array([0.0, 0.5, 1.0])
    point = curve.at(s)
    assert point.x[1] - point.x[0] == pytest.approx(distance, rel=1e-9)
    assert point.y[1] - point.y[0] == pytest.approx(rise, rel=1e-9)
    assert point.y[2] == pytest.approx(point.y[0], rel=1e-9)
    assert (point.curvature < 0).all()


@given(st.floats(1, 20), st.floats(0.1, 0.6))
def test_frenet(distance, slope):
    curve = Cycloid.over(distance, slope * distance, 0.0)
    assume(curve.truncation > 0.1)
    check_frenet(curve, tolerance=1e-5)


@given(st.floats(0, 1))
def test_arc_length_and_parameter_undo_each_other(share):
    curve = Cycloid.over()
    s = share * curve.length
    assert float(curve.arc_length(curve.parameter(s))) == pytest.approx(s, abs=1e-12)


def test_the_curvature_in_the_parameter_is_the_papers():
    curve = Cycloid.over()
    t = np.linspace(0.0, 2 * np.pi - 2 * curve.truncation, 101)
    k = curve.at(curve.arc_length(t)).curvature
    assert k == pytest.approx(-1 / (4 * curve.radius * np.sin((t + curve.truncation) / 2)))


def test_an_impossible_obstacle_says_what_would_be_possible():
    with pytest.raises(NoSolution, match=r"increase distance above 12\.57 m"):
        Cycloid.over(distance=10, height=7, margin=1)


def test_outside_the_curve_its_ends_are_given():
    curve = Cycloid.over()
    assert curve.at(-1.0) == curve.at(0.0)
    assert curve.at(curve.length + 1.0) == curve.at(curve.length)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"margin": -1.0}, r"Cycloid.margin = -1.0: must be greater than or equal to 0 \(m\)"),
        ({"distance": 0.0}, "Cycloid.distance"),
        ({"height": math.nan}, "Cycloid.height = nan: must be a finite number"),
        ({"heigth": 3.0}, "unknown field; valid fields: kind, distance, height, margin"),
    ],
)
def test_bad_fields_are_explained(fields, message):
    with pytest.raises(InvalidInput, match=message):
        Cycloid(**fields)
