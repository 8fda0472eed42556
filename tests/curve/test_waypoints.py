"""Splines through points as people have them: uneven, repeated, jittering, rounded, noisy, reversed."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import InvalidInput, Spline
from osculate.curve.waypoints import distances

lengths = st.floats(-3.0, 5.0).map(lambda power: 10.0**power)
angles = st.floats(-math.pi, math.pi)


def spline(points, **fields):
    return Spline(points=tuple(map(tuple, np.asarray(points, dtype=float))), **fields)


def wave(count, length=12.0, height=0.8):
    x = np.linspace(0.0, length, count)
    return np.stack([x, height * np.sin(2 * np.pi * x / 6.0)], axis=1)


def quiet(curve):
    """Its curvature, where building it must warn of nothing."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return curve.at(np.linspace(0.0, curve.length, 4001)).curvature


def told(curve):
    """What building it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        _ = curve.length
    return "; ".join(str(warning.message) for warning in caught)


@given(lengths, angles, angles, st.booleans())
def test_two_points_are_a_straight_line(length, direction, bearing, smooth):
    start = 0.3 * length * np.array([math.cos(bearing), math.sin(bearing)])
    end = start + length * np.array([math.cos(direction), math.sin(direction)])
    curve = spline([start, end], tolerance=0.01 * length if smooth else 0.0)
    assert curve.length == pytest.approx(length, rel=1e-12)
    point = curve.at(np.linspace(0.0, length, 33))
    assert np.cos(point.heading - direction) == pytest.approx(1.0)
    assert np.abs(point.curvature).max() * length < 1e-9
    assert curve.polyline_error.largest < 1e-12 * length


@given(
    st.floats(4.0, 40.0), st.floats(4.0, 40.0), st.floats(0.04, 0.1), st.floats(0.4, math.pi / 2),
    st.integers(1, 3), st.sampled_from([1.0, -1.0]),
)  # fmt: skip
@settings(max_examples=25)
def test_uneven_points_do_not_bulge(before, after, short, turn, count, side):
    """Long legs before and after short ones around a corner."""
    short *= max(before, after)
    out = np.array([math.cos(side * turn), math.sin(side * turn)])
    corner = np.array([before + count * short, 0.0])
    points = [
        (0.0, 0.0),
        *((before + n * short, 0.0) for n in range(count + 1)),
        corner + after * out,
    ]
    curve = spline(points)
    assert curve.polyline_error.largest <= max(0.21, 0.11 * short)
    assert curve.deviation[0] < 1e-9
    ends = curve.at(np.array([0.0, curve.length]))
    assert math.cos(float(ends.heading[0])) > 0.9
    assert math.cos(float(ends.heading[1]) - side * turn) > 0.9
    assert curve.length < before + count * short + after + 0.5
    assert np.abs(curve.at(np.linspace(0.0, curve.length, 2001)).curvature).max() < 5.0 / short


def test_far_from_a_corner_a_long_leg_is_straight():
    curve = spline([(0, 0), (25, 0), (26, 0), (26, 1), (26, 26)])
    assert curve.polyline_error.largest > 0.1
    middle = curve.at(np.linspace(5.0, 15.0, 101))
    assert np.abs(middle.y).max() < 0.1
    assert np.abs(curve.at(curve.length - np.linspace(5.0, 15.0, 101)).x - 26.0).max() < 0.1


def test_uneven_loops_do_not_bulge():
    curve = spline([(0, 0), (20, 0), (20.4, 0), (20.4, 0.4), (20.4, 15), (0, 15)], loop=True)
    s = np.linspace(0.0, curve.length, 20001)
    point = curve.at(s)
    assert point.x.max() < 20.4 + 0.21
    assert curve.at(0.0).curvature == pytest.approx(curve.at(curve.length).curvature, abs=1e-6)
    assert curve.deviation[0] < 1e-9
    assert curve.total_turn == pytest.approx(2 * math.pi)


@given(st.integers(6, 200), st.floats(0.1, 2.0), st.floats(0.1, 1e3))
@settings(max_examples=25)
def test_even_points_are_left_alone(count, height, size):
    """Nothing is told, nothing is merged, and the parameter is the chord length."""
    from scipy.interpolate import make_interp_spline

    points = size * wave(count, height=height)
    curve = spline(points)
    quiet(curve)
    chords = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    if np.ptp(np.diff(chords)) < 0.5 * chords[1]:
        free = [(3, np.zeros(2)), (4, np.zeros(2))]
        plain = make_interp_spline(chords, points, k=5, bc_type=(free, free))
        middle = 0.5 * (chords[1:] + chords[:-1])
        assert (curve._fit.spline(middle) == plain(middle)).all()
    assert (curve.waypoints == points).all()


@given(st.sets(st.integers(2, 46), min_size=1, max_size=6), st.floats(1e-5, 2e-3), angles)
def test_points_that_nearly_coincide_are_merged_and_named(places, gap, direction):
    places = sorted(p for p in places if p + 1 not in places)
    clean = wave(49)
    aside = gap * np.array([math.cos(direction), math.sin(direction)])
    doubled = np.insert(clean, [p + 1 for p in places], clean[places] + aside, axis=0)
    curve = spline(doubled)
    words = told(curve)
    assert str(places[0] + 1) in words
    assert "tolerance" in words
    assert len(curve.waypoints) == 49
    assert curve.deviation[0] <= gap * (1 + 1e-9)
    assert curve.length == pytest.approx(spline(clean).length, abs=0.05 * gap * 49)


@given(st.integers(5, 40), st.integers(20, 300), st.integers(0, 10**6), st.floats(1e-4, 0.02))
@settings(max_examples=25)
def test_a_standstill_is_one_point(place, count, seed, jitter):
    clean = wave(49)
    noise = np.random.default_rng(seed).normal(0.0, jitter, (count, 2))
    curve = spline(np.insert(clean, place, clean[place] + noise, axis=0))
    assert "stand still" in told(curve)
    straight = spline(clean)
    assert curve.length == pytest.approx(straight.length, abs=0.2)
    near = np.abs(curve.at(np.linspace(0, curve.length, 4001)).curvature).max()
    assert near < 3.0


def test_exact_standstills_are_silent():
    clean = wave(49)
    repeated = np.repeat(clean, np.where(np.arange(49) % 7 == 3, 50, 1), axis=0)
    assert quiet(spline(repeated)) == pytest.approx(quiet(spline(clean)))


@given(st.floats(3e6, 6e6), st.floats(3e5, 6e5))
@settings(max_examples=20)
def test_single_precision_is_noticed(north, east):
    points = (wave(120) + [east, north]).astype(np.float32)
    words = told(spline(points))
    assert "y takes only multiples of 0." in words
    assert "single precision" in words


def test_single_precision_names_a_tolerance_that_helps():
    points = (wave(97) + [388096.0, 3948996.0]).astype(np.float32)
    words = told(spline(points))
    tolerance = float(words.split("a tolerance of ")[1].split()[0])
    fair = spline(points, tolerance=tolerance)
    assert np.abs(fair.at(np.linspace(0.5, fair.length - 0.5, 2001)).curvature).max() < 2.0


@given(st.floats(2e5, 9e5), st.floats(1e6, 9e6))
@settings(max_examples=20)
def test_six_digits_are_noticed(east, north):
    points = [tuple(float(f"{v:g}") for v in point) for point in wave(49) + [east, north]]
    words = told(spline(points))
    assert "y takes only multiples of 10 m, all equal: rounded to 6 digits" in words or (
        "rounded to 6 digits" in words
    )


@given(st.integers(0, 10**6), st.floats(0.002, 0.02), st.integers(300, 800))
@settings(max_examples=8)
def test_noise_is_told_with_a_tolerance_that_helps(seed, noise, count):
    points = wave(count) + np.random.default_rng(seed).normal(0.0, noise, (count, 2))
    words = told(spline(points))
    assert "noisy" in words
    tolerance = float(words.split("a tolerance of ")[1].split()[0])
    assert 2.0 * noise < tolerance < 12.0 * noise
    fair = spline(points, tolerance=tolerance)
    inner = np.linspace(0.5, fair.length - 0.5, 2001)
    quiet(fair)
    assert np.abs(fair.at(inner).curvature).max() < 2.5


@given(st.integers(1, 20), st.integers(1, 20), st.floats(0.1, 2.0), st.floats(-0.3, 0.3))
def test_a_list_that_turns_round_is_refused_at_its_point(forward, back, step, bend):
    there = [(n * step, 0.0) for n in range(forward + 1)]
    way = np.pi + bend
    here = [
        (forward * step + n * step * math.cos(way), n * step * math.sin(way))
        for n in range(1, back + 1)
    ]
    curve = spline([*there, *here])
    message = rf"point {forward} = .*at s = {forward * step:.4g} m"
    with pytest.raises(InvalidInput, match=message.replace("+", r"\+")):
        _ = curve.length


def test_a_loop_that_turns_round_at_its_first_point_is_refused():
    points = [(0, 0), (1, 0), (2, 0.2), (3, 1), (2.5, 2), (2, 0.5), (1, 0.1)]
    with pytest.raises(InvalidInput, match="point 0"):
        _ = spline(points, loop=True).length


def test_a_loop_closed_up_to_rounding_is_closed():
    diamond = [(0, 0), (1, -1), (2, 0), (1, 1)]
    exact, nearly = spline(diamond, loop=True), spline([*diamond, (0.0001, 0)], loop=True)
    assert nearly.length == pytest.approx(exact.length)
    assert nearly.deviation[0] < 1.1e-4


@given(st.integers(0, 10**6), st.floats(0.02, 0.05))
@settings(max_examples=5)
def test_deviation_is_the_distance_to_the_nearest_point_of_the_curve(seed, noise):
    points = wave(150) + np.random.default_rng(seed).normal(0.0, 0.3 * noise, (150, 2))
    curve = spline(points, tolerance=noise)
    point = curve.at(np.linspace(0.0, curve.length, 30001))
    curve_points = point.x + 1j * point.y
    nearest = [np.abs(curve_points - complex(*p)).min() for p in points]
    assert curve.deviation[0] == pytest.approx(max(nearest), abs=1e-5)
    assert curve.deviation[1] == pytest.approx(np.sqrt(np.mean(np.square(nearest))), abs=1e-5)


@pytest.mark.filterwarnings("ignore:the points look noisy")
@given(st.integers(4, 12), st.integers(0, 10**6))
@settings(max_examples=20)
def test_the_polyline_error_is_the_distance_from_the_polyline(count, seed):
    rng = np.random.default_rng(seed)
    turns, steps = rng.uniform(-1, 1, count), rng.uniform(0.5, 2.0, count)
    way = np.cumsum(turns)
    points = np.cumsum(steps[:, None] * np.stack([np.cos(way), np.sin(way)], axis=1), axis=0)
    curve = spline(points)
    point = curve.at(np.linspace(0.0, curve.length, 2001))
    samples = np.stack([point.x, point.y], axis=1)
    legs = [distances(samples, points, np.full(2001, n)) for n in range(count - 1)]
    assert curve.polyline_error.largest == pytest.approx(np.min(legs, axis=0).max(), rel=0.1)
    x, y = curve.polyline_error[2:]
    assert np.hypot(point.x - x, point.y - y).min() < 0.01


def test_long_lists_stay_quick_to_judge():
    """The judgement of a curve evaluates it at fewer places than building it does."""
    curve = spline(wave(3000))
    _ = curve.length
    counted = []
    plain = curve._fit.spline

    class Counting:
        def __call__(self, u):
            counted.append(len(u))
            return plain(u)

        def derivative(self, n):
            return lambda u: (counted.append(len(u)), plain.derivative(n)(u))[1]

    curve.__dict__["_fit"] = curve._fit._replace(spline=Counting())
    assert curve.deviation[0] < 1e-12
    assert sum(counted) < 20 * 3000  # two panels of ten nodes between two points
