"""Formulas: read without being run, exact derivatives, resolved where they need it or refused there."""

import importlib.util
import random
import re
import tracemalloc
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import InvalidInput, Parametric
from osculate.curve.formula import FUNCTIONS, Formula
from osculate.errors import OsculateError

ROOT = Path(__file__).parent.parent.parent
spec = importlib.util.spec_from_file_location("fuzz", ROOT / "benchmarks" / "fuzz_formulas.py")
fuzz = importlib.util.module_from_spec(spec)
spec.loader.exec_module(fuzz)

HIGH = {name: getattr(mpmath, name) for name in FUNCTIONS}
places = st.floats(0.05, 1.4)


def high(text, p):
    return eval(text.replace("^", "**"), {**HIGH, "pi": mpmath.pi, "E": mpmath.e, "p": p})


@pytest.mark.parametrize(
    "text",
    [
        *(f"{name}(0.3 + p * p)" for name in FUNCTIONS),
        "p**3", "p^2", "(1 + p)**-2", "(2 + p)**0.5", "2**p", "(1 + p)**p", "3", "-p / (1 + p)",
        "sin(cos(p) * exp(-p))", "E**(pi * p) - p", "+p * 1e3 / 7",
    ],
)  # fmt: skip
@given(p=places)
def test_derivatives_are_those_of_high_precision(text, p):
    formula = Formula("x", text)
    with mpmath.workdps(40):
        for order in range(4):
            expected = float(mpmath.diff(lambda q: high(text, q) * mpmath.mpf(1), p, order))
            got = formula(np.array([p]), order)[0]
            assert got == pytest.approx(expected, rel=1e-11, abs=1e-11)


@given(st.integers(0, 10**9), places, st.floats(0.0, 0.3))
def test_bounds_hold_all_slopes_between(seed, start, width):
    text = fuzz.formula(random.Random(seed))
    formula, end = Formula("x", text), start + width
    low, high = formula.enclose(np.array([start]), np.array([end]))
    slopes = formula(np.linspace(start, end, 201), 1)
    slopes = slopes[np.isfinite(slopes)]
    room = 1e-9 * (1.0 + np.abs(slopes))
    assert (slopes >= low[0] - room).all()
    assert (slopes <= high[0] + room).all()


@settings(max_examples=15)
@given(st.floats(0.1, 0.9), st.sampled_from([1e2, 1e4, 1e6]), st.sampled_from([0.3, 5.0]))
def test_steps_and_bumps_of_any_width_are_found(place, steepness, height):
    """A step adds its height, a bump twice that; their flanks make up for little of it."""
    u = f"({steepness} * (p - {place}))"
    for y, climbed in ((f"{height} * tanh{u}", 2.0), (f"{height} * exp(-{u}**2)", 2.0)):
        length = Parametric(x="p", y=y).length
        assert max(1.0, 0.97 * climbed * height) <= length <= 1.0 + climbed * height


@pytest.mark.parametrize(
    ("y", "expected"),
    [
        ("atan(1e6 * (p - 0.37))", 4.138203802484),
        ("exp(-(1e6 * (p - 0.37))**2)", 2.99999195979),
        ("sin(3000 * p)", 1909.779267281),
        ("sqrt((p - 0.4)**2 + 1e-12)", None),
    ],
)
def test_lengths_converge(y, expected):
    """Against quadrature of high precision between places that are told to it."""
    curve = Parametric(x="p", y=y)
    if expected is None:
        a, b = mpmath.mpf("0.4"), mpmath.mpf("1e-12")
        near = [0, 0.399, 0.39999, 0.399999, 0.4, 0.400001, 0.40001, 0.401, 1]
        square = lambda p: (p - a) ** 2 / ((p - a) ** 2 + b)  # noqa: E731
        expected = float(mpmath.quad(lambda p: mpmath.sqrt(1 + square(p)), near))
    assert curve.length == pytest.approx(expected, rel=1e-9)


def test_positions_belong_to_their_arc_lengths():
    curve = Parametric(x="p", y="atan(1e6 * (p - 0.37))")
    s = np.linspace(0.0, curve.length, 4001)
    point = curve.at(s)
    steps = np.hypot(np.diff(point.x), np.diff(point.y))
    assert steps.max() <= s[1] * (1.0 + 1e-7)
    assert steps.min() > 0.7 * s[1]  # across the corners
    assert np.median(steps) == pytest.approx(s[1], rel=1e-12)
    assert curve._arc.parameter(s) == pytest.approx(np.sort(curve._arc.parameter(s)))


@pytest.mark.parametrize(
    ("x", "y"),
    [
        ("exp(tanh(p) + p - 37000 * p)", "p"),
        ("p", "cos(5050 * exp(0 - p))"),
        ("p", "exp(-4509 * p) * 1.2"),
        ("cos(sin(E) - 2 * p)**2", "0"),
    ],
)
def test_what_the_fuzzer_found(x, y):
    """Speeds that fall by factors within a panel; a last halving that resolves everything."""
    assert fuzz.examine(x, y).kind in ("accepted", "refused")


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ("p", "1 / (p - 0.37123)", r"grows without bound \(a pole\) near p = 0\.37123"),
        ("p", "tan(9 * p)", r"a pole\) near p = 0\.1745"),
        ("(p - 0.3)**2", "(p - 0.3)**3", r"stops .* p = 0\.3"),
        ("cos(7 * p)", "0", r"p = "),
        ("(p - 0.3456)**2", "0", r"(stops|turns back).* p = 0\.3456"),
        ("p", "((p - 0.41)**2)**0.5", r"p = 0\.41"),
        ("p", "sqrt(p - 0.5)", r"position is not finite at p = 0"),
        ("p", "9**9**9", r"position is not finite"),
        ("p", "p**1.5", r"curvature is not finite at p = 0"),
        ("sin(1e9 * p)", "p", r"too fine to be resolved by \d+ panels"),
    ],
)  # fmt: skip
def test_what_is_no_smooth_curve_says_where(x, y, message):
    with pytest.raises(InvalidInput, match=message):
        _ = Parametric(x=x, y=y).length


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"x": "p", "y": "p**2", "end": 1.0}, "ends 1.414 m from its start"),
        ({"x": "sin(p)", "y": "sin(2 * p)", "end": 3.14159265358979}, "corner|ends"),
    ],
)
def test_a_loop_must_close(fields, message):
    with pytest.raises(InvalidInput, match=message):
        _ = Parametric(**fields, loop=True).length


@pytest.mark.parametrize("text", fuzz.SEEDS)
def test_no_formula_costs_more_than_it_may(text):
    tracemalloc.start()
    told = ""
    try:
        Parametric(x=text, y="p")
    except OsculateError as error:
        told = str(error)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1e8
    assert "\n" not in told
    assert len(told) < 300


def test_fuzz():
    assert fuzz.main(200, seed=3) == 0


@settings(max_examples=40)
@given(
    stop=st.floats(-0.95, 0.95).map(lambda p: round(p, 6)),
    powers=st.sampled_from([(2, 3), (3, 4), (2, 5), (3, 5), (2, 2), (3, 3)]),
    form=st.sampled_from(["formula", "function"]),
)
def test_a_stop_between_the_nodes_is_found_wherever_it_is(stop, powers, form):
    a, b = powers
    formulas = {"x": f"1 + (p - ({stop}))**{a}", "y": f"(p - ({stop}))**{b} - 2"}
    functions = {"x": lambda p: 1 + (p - stop) ** a, "y": lambda p: (p - stop) ** b - 2}
    with pytest.raises(InvalidInput, match=r"cusp|jumps or has a kink") as refused:
        Parametric(**(formulas if form == "formula" else functions), start=-1, end=1).length  # noqa: B018
    place = re.search(r"p = ([-+.\de]+?),", str(refused.value))
    assert float(place.group(1)) == pytest.approx(stop, abs=1e-4)


@given(least=st.floats(1e-6, 0.5), phase=st.floats(-3, 3))
def test_a_curve_that_slows_down_and_does_not_stop_passes(least, phase):
    x, y = f"p - {1 - least!r}*sin(p + {phase!r})", f"{1 - least!r}*cos(p + {phase!r})"
    curve = Parametric(x=x, y=y, start=-4, end=4)
    p = np.linspace(-4, 4, 400_001)
    steps = np.hypot(
        np.diff(p - (1 - least) * np.sin(p + phase)), np.diff((1 - least) * np.cos(p + phase))
    )
    assert curve.length == pytest.approx(steps.sum(), rel=1e-6)
