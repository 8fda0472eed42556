"""The elementary functions: accuracy, laws, vectorisation, and the same bits without compilation."""

import json
import math
import platform
import re

import mpmath
import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate.kernel import maths
from uncompiled import run_uncompiled

pytestmark = pytest.mark.core

mpmath.mp.prec = 200
angles = st.floats(-1e5, 1e5)


def ulps(value, exact):
    """Distance of a float from an exact value in units in the last place."""
    return float(abs(mpmath.mpf(value) - exact) / math.ulp(float(exact)))


def worst(function, reference, points):
    return max(
        ulps(function(*point), exact)
        for point in points
        if (exact := reference(*map(mpmath.mpf, point))) != 0
    )


def uniform(low, high, count=3000):
    return [(x,) for x in np.random.default_rng(1).uniform(low, high, count).tolist()]


@pytest.mark.parametrize(
    ("function", "reference", "points", "bound"),
    [
        (maths.sin, mpmath.sin, uniform(-10, 10), 1.4),
        (maths.cos, mpmath.cos, uniform(-10, 10), 1.4),
        (maths.sin, mpmath.sin, uniform(-1e5, 1e5), 2.0),
        (maths.cos, mpmath.cos, uniform(-1e5, 1e5), 2.0),
        (maths.tan, mpmath.tan, uniform(-10, 10), 3.0),
        (maths.exp, mpmath.exp, uniform(-2, 2), 1.0),
        (maths.exp, mpmath.exp, uniform(-700, 700), 1.0),
        (maths.log, mpmath.log, uniform(0.0, 3.0), 1.0),
        (maths.log, mpmath.log, uniform(0.0, 1e300), 1.0),
        (maths.log, mpmath.log, [(10.0**x,) for (x,) in uniform(-307, 308)], 1.0),
        (maths.atan, mpmath.atan, uniform(-5, 5), 1.0),
        (maths.atan, mpmath.atan, uniform(-1e6, 1e6), 1.0),
    ],
)
def test_accuracy(function, reference, points, bound):
    assert worst(function, reference, points) <= bound


def test_accuracy_of_atan2():
    points = np.random.default_rng(2).uniform(-3, 3, (3000, 2)).tolist()
    assert worst(maths.atan2, mpmath.atan2, points) <= 1.5


@given(angles)
def test_sine_and_cosine_are_on_the_unit_circle(x):
    sine, cosine = maths.sincos(x)
    assert abs(sine * sine + cosine * cosine - 1.0) <= 4e-16
    assert maths.sin(-x) == -sine
    assert maths.cos(-x) == cosine


@given(st.floats(-3.1, 3.1))
def test_atan2_undoes_sincos(x):
    sine, cosine = maths.sincos(x)
    assert maths.atan2(sine, cosine) == pytest.approx(x, abs=1e-15)


@given(st.floats(-1e300, 1e300))
def test_atan_is_odd_increasing_and_bounded(x):
    assert maths.atan(-x) == -maths.atan(x)
    assert abs(maths.atan(x)) <= math.pi / 2
    assert maths.atan(np.nextafter(x, np.inf)) >= maths.atan(x) - 1e-15


@given(st.floats(-300, 300), st.floats(-300, 300))
def test_exp_turns_sums_into_products(a, b):
    assert maths.exp(a) * maths.exp(b) == pytest.approx(maths.exp(a + b), rel=1e-12)


def test_exp_at_its_ends():
    assert maths.exp(0.0) == 1.0
    assert maths.exp(710.0) == math.inf
    assert maths.exp(math.inf) == math.inf
    assert maths.exp(-709.0) == 0.0
    assert maths.exp(-math.inf) == 0.0
    assert math.isnan(maths.exp(math.nan))
    assert 0.0 < maths.exp(-708.0) < 1e-307


@given(st.floats(1e-150, 1e150), st.floats(1e-150, 1e150))
def test_log_turns_products_into_sums(a, b):
    assert maths.log(a) + maths.log(b) == pytest.approx(maths.log(a * b), abs=2e-13)


@given(st.floats(-700, 700))
def test_log_undoes_exp(x):
    assert maths.log(maths.exp(x)) == pytest.approx(x, rel=1e-15, abs=1e-15)


def test_log_at_its_ends():
    assert maths.log(1.0) == 0.0
    assert maths.log(np.nextafter(1.0, 0.0)) == -(2.0**-53)
    assert maths.log(0.0) == maths.log(-0.0) == maths.log(5e-324) == -math.inf
    assert maths.log(2.2250738585072014e-308) == math.log(2.2250738585072014e-308)
    assert maths.log(1.7976931348623157e308) == math.log(1.7976931348623157e308)
    assert maths.log(math.inf) == math.inf
    for x in (-1.0, -5e-324, -math.inf, math.nan):
        assert math.isnan(maths.log(x))


@pytest.mark.parametrize(
    ("y", "x", "angle"),
    [
        (0.0, 0.0, 0.0),
        (0.0, 1.0, 0.0),
        (0.0, -1.0, math.pi),
        (1.0, 0.0, math.pi / 2),
        (-1.0, 0.0, -math.pi / 2),
        (1.0, -1.0, 3 * math.pi / 4),
        (-1.0, -1.0, -3 * math.pi / 4),
    ],
)
def test_atan2_knows_the_quadrants(y, x, angle):
    assert maths.atan2(y, x) == pytest.approx(angle, abs=1e-15)


@given(st.floats(-1e4, 1e4))
def test_wrapped_angles_are_the_same_direction(x):
    wrapped = maths.wrap_angle(x)
    assert abs(wrapped) <= math.pi + 1e-9
    assert math.cos(wrapped - x) == pytest.approx(1.0, abs=1e-12)


@given(st.floats(), st.floats(-5, 0), st.floats(0, 5))
def test_clip_stays_inside(x, low, high):
    clipped = maths.clip(x, low, high)
    assert low <= clipped <= high
    if low <= x <= high:
        assert clipped == x
    if math.isnan(x):
        assert clipped == low


def test_sign():
    assert [maths.sign(x) for x in (-2.0, -0.0, 0.0, 1e-300)] == [-1.0, 0.0, 0.0, 1.0]


ONE_ARGUMENT = ["sin", "cos", "tan", "exp", "log", "atan", "wrap_angle"]


def test_uncompiled_functions_give_the_same_bits():
    code = """
        import json
        from osculate.kernel import maths
        xs = [(-1) ** n * 1.37 ** n * 1e-4 for n in range(45)] + [0.0, 1.0, 0.5, 3.0]
        print(json.dumps({f: [getattr(maths, f)(x).hex() for x in xs]
                          for f in %s} | {"xs": xs}))
    """
    there = json.loads(run_uncompiled(code % ONE_ARGUMENT))
    xs = there.pop("xs")
    for name, values in there.items():
        assert values == [getattr(maths, name)(x).hex() for x in xs], name


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="reads x86 assembly")
@pytest.mark.parametrize("name", ONE_ARGUMENT)
def test_a_loop_over_lanes_is_vectorised(name):
    function = getattr(maths, name)

    @numba.njit(error_model="numpy")
    def lanes(x, y):
        for n in range(x.shape[0]):
            y[n] = function(x[n])

    x = np.linspace(-1.0, 1.0, 64)
    y = np.empty(64)
    lanes(x, y)
    np.testing.assert_array_equal(y, [function(v) for v in x])
    assembly = "\n".join(lanes.inspect_asm().values())
    assert re.search(r"\bv?mulpd\b", assembly)
    assert not re.search(rf"\$?\b{name}\b", assembly.split("_ZN7cpython")[0].split(".globl")[0])
