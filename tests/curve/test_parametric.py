"""Curves of the user's own, as formulas and as functions."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curve.laws import check_frenet
from osculate import Cycloid, InvalidInput, NoSolution, Parametric

CIRCLE = {"x": "2 * cos(p)", "y": "2 * sin(p)", "end": 2 * math.pi}


def functions(curve):
    a, b = curve.radius, curve.truncation
    return {
        "x": lambda w: a * (w - math.sin(w)),
        "y": lambda w: a * (1 - math.cos(w)),
        "start": b,
        "end": 2 * math.pi - b,
    }


def test_a_circle_has_constant_curvature():
    curve = Parametric(**CIRCLE)
    assert curve.length == pytest.approx(4 * math.pi, rel=1e-14)
    point = curve.at(np.linspace(0, curve.length, 50))
    assert point.curvature == pytest.approx(0.5)
    assert point.curvature_rate == pytest.approx(0.0, abs=1e-12)
    assert curve.total_turn == pytest.approx(2 * math.pi)


def test_functions_and_formulas_agree_with_the_closed_form():
    exact = Cycloid.over()
    curve = Parametric(**functions(exact))
    s = np.linspace(0, exact.length, 501)
    assert curve.length == pytest.approx(exact.length, abs=1e-12)
    for mine, theirs, tolerance in zip(
        curve.at(s), exact.at(s), (1e-12, 1e-12, 1e-10, 1e-9, 1e-7), strict=True
    ):
        assert mine == pytest.approx(theirs, abs=tolerance)


@given(st.floats(0.2, 2), st.floats(-1, 1), st.floats(0.5, 3))
def test_frenet(height, shift, frequency):
    curve = Parametric(x="p", y=f"{height} * sin({frequency} * p + {shift})", end=6.0)
    check_frenet(curve, tolerance=1e-4)


def test_the_parameter_of_an_arc_length():
    curve = Parametric(x="p**2", y="p**2", start=1.0, end=2.0)
    s = math.sqrt(2) * (1.5**2 - 1)
    assert float(curve._arc.parameter(s)) == pytest.approx(1.5, abs=1e-12)


@pytest.mark.parametrize(
    ("fields", "error", "message"),
    [
        ({"x": "foo", "y": "p"}, InvalidInput, "must be a formula in p"),
        ({"x": "p +", "y": "p"}, InvalidInput, "must be a formula in p"),
        ({"x": "__import__('os').getcwd()", "y": "p"}, InvalidInput, "must be a formula in p"),
        ({"x": "p**2", "y": "p**3"}, InvalidInput, "must move on everywhere"),
        ({"x": "p", "y": "1 / (p - 0.5)"}, InvalidInput, "finite"),
        ({"x": lambda p: p, "y": lambda p: abs(p - 0.3)}, NoSolution, "must be smooth"),
        ({"x": lambda p: p, "y": lambda p: math.nan}, InvalidInput, "not finite at p"),
        ({"x": "p", "y": "p", "end": -1.0}, InvalidInput, "greater than start"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero", "ignore:invalid value")
def test_bad_curves_are_explained(fields, error, message):
    with pytest.raises(error, match=message):
        _ = Parametric(**fields).at(0.1)
