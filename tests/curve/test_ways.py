"""Clothoids, Dubins' paths and approaches: against formulas of others, and refused if senseless."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import fresnel

from osculate import (
    Arc,
    Chain,
    Clothoid,
    CurvatureTracker,
    Cycloid,
    InitialState,
    InvalidInput,
    Line,
    NoSolution,
    Pose,
    plan_speed,
)
from osculate.curve import segments
from osculate.curve.approach import EASES, PLACES, USABLE, _moved, _way, dubins, plan_approach
from osculate.simulation.loop import with_approach
from osculate.simulation.run import make_setup
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import VEHICLES

poses = st.builds(Pose, x=st.floats(-2, 2), y=st.floats(-2, 2), heading=st.floats(-4, 4))


@given(st.floats(0.05, 40.0), st.floats(0.1, 20.0), st.sampled_from([1.0, -1.0]))
def test_a_clothoid_is_the_fresnel_integral(bend, length, side):
    curve = Clothoid(distance=length, end_curvature=side * bend)
    s = np.linspace(0.0, length, 201)
    scale = math.sqrt(math.pi * length / bend)
    y, x = fresnel(s / scale)
    point = curve.at(s)
    assert point.x == pytest.approx(scale * x, abs=1e-12 * length)
    assert point.y == pytest.approx(side * scale * y, abs=1e-12 * length)


@given(poses, poses)
def test_fitted_clothoids_arrive_or_are_refused(start, end):
    distance = math.hypot(end.x - start.x, end.y - start.y)
    for kind in (Clothoid, Chain):
        try:
            curve = kind.between(start, end)
        except (NoSolution, InvalidInput) as error:
            told = str(error)
        else:
            told = ""
        if told:
            assert ("another place" if distance < 1e-8 else "clothoid leads from") in told
            continue
        last = curve.at(curve.length)
        assert distance <= curve.length * (1 + 1e-9) <= 10.0 * distance * (1 + 1e-6)
        assert (last.x, last.y) == pytest.approx((end.x, end.y), abs=1e-6 * distance)
        assert math.cos(float(last.heading) - end.heading) == pytest.approx(1.0)


@pytest.mark.parametrize("kind", [Clothoid, Chain])
def test_one_place_is_named_and_straight_behind_is_reached(kind):
    with pytest.raises(InvalidInput, match="must be another place than the start"):
        kind.between(Pose(x=1.0, y=2.0), Pose(x=1.0, y=2.0, heading=1.0))
    for heading in (0.0, math.pi):
        assert kind.between(Pose(), Pose(x=-2.0, heading=heading)).length < 20.0
    with pytest.raises(NoSolution, match="long for a distance of 1 m; put a pose between"):
        kind.between(Pose(), Pose(x=-1.0, heading=0.3))


class Fitted:
    """A library that returns something else than it was asked for."""

    XEnd = YEnd = 0.0

    def __init__(self, length, first, last):
        self.length, self.KappaStart, self.KappaEnd = length, first, last
        self.Clothoid = self

    def G1Hermite(self, *poses):  # noqa: N802
        return self

    def SolveG2(self, *poses):  # noqa: N802
        return [self]


@pytest.mark.parametrize("kind", [Clothoid, Chain])
@pytest.mark.parametrize(
    ("fitted", "message"),
    [
        (Fitted(2.0, 0.0, 0.0), "misses the end by 1 m"),
        (Fitted(1.0, 0.0, 0.3), "misses the end"),  # the place nearly, the heading not
        (Fitted(math.nan, 0.0, 0.0), "no clothoid leads"),
        (Fitted(0.0, 0.0, 0.0), "no clothoid leads"),
        (Fitted(1.0, math.inf, 0.0), "no clothoid leads"),
    ],
)
def test_what_a_library_returns_is_checked(monkeypatch, kind, fitted, message):
    monkeypatch.setattr(segments, "pyclothoids", lambda: fitted)
    with pytest.raises(NoSolution, match=message):
        kind.between(Pose(), Pose(x=1.0))


@pytest.mark.parametrize("kind", [Clothoid, Chain])
def test_the_heading_at_the_end_is_checked(monkeypatch, kind):
    monkeypatch.setattr(segments, "pyclothoids", lambda: Fitted(1.0, 0.0, 0.0))
    with pytest.raises(NoSolution, match=r"turned by 11\.46° from it"):
        kind.between(Pose(), Pose(x=1.0, heading=0.2))


def test_a_spiral_of_a_billion_turns_is_refused_by_its_size():
    with pytest.raises(InvalidInput, match=r"would need 2e\+09 panels"):
        Arc(radius=1.0, angle=1e9).at(1.0)


def shortest(distance, first, last):
    """Length of the shortest of Dubins' words for radius 1: both tangents, both middle circles."""
    best = math.inf
    for a, b in itertools.product((1, -1), (1, -1)):
        best = min(best, *tangent(distance, first, last, a, b), *three(distance, first, last, a))
    return best


def centres(distance, first, last, a, b):
    begin = a * 1j * np.exp(1j * first)
    return begin, distance + b * 1j * np.exp(1j * last)


def tangent(distance, first, last, a, b):
    begin, end = centres(distance, first, last, a, b)
    span = end - begin
    across = 0.0 if a == b else 2.0
    if abs(span) < across:
        return [math.inf]
    line = math.sqrt(abs(span) ** 2 - across**2)
    heading = np.angle(span) + (0.0 if a == b else a * math.atan2(2.0, line))
    turns = (a * (heading - first)) % (2 * math.pi), (b * (last - heading)) % (2 * math.pi)
    turns = [0.0 if 2 * math.pi - turn < 1e-7 else turn for turn in turns]
    return [line + sum(turns)]


def three(distance, first, last, a):
    begin, end = centres(distance, first, last, a, a)
    span = end - begin
    if not 1e-9 < abs(span) <= 4.0:
        return [math.inf]
    found = []
    for side in (1, -1):
        middle = begin + 2.0 * np.exp(1j * (np.angle(span) + side * math.acos(abs(span) / 4.0)))
        leave = np.angle(middle - begin) + a * math.pi / 2
        arrive = np.angle(middle - end) + a * math.pi / 2
        turns = a * (leave - first), -a * (arrive - leave), a * (last - arrive)
        turns = [turn % (2 * math.pi) for turn in turns]
        found.append(sum(0.0 if 2 * math.pi - turn < 1e-7 else turn for turn in turns))
    return found


@given(st.floats(0.01, 5.0), st.floats(-4.0, 4.0), st.floats(-4.0, 4.0), st.floats(0.2, 5.0))
@settings(max_examples=300)
def test_dubins_path_is_the_shortest_and_arrives(distance, first, last, radius):
    start = Pose(heading=first)
    goal = Pose(x=distance * radius, heading=last)
    legs = dubins(start, goal, radius)
    at = start
    for leg in legs:
        at = _moved(at, leg.side, leg.length, radius)
    assert (at.x, at.y) == pytest.approx((goal.x, goal.y), abs=1e-6 * radius)
    assert math.cos(at.heading - last) == pytest.approx(1.0, abs=1e-9)
    expected = shortest(distance, first, last) * radius
    assert sum(leg.length for leg in legs) == pytest.approx(expected, abs=1e-5 * radius)


@pytest.mark.parametrize("turned", [math.pi, 2.0, -2.5, 1.2])
@pytest.mark.parametrize(("curve", "tightest"), [(Cycloid.over(), 6.0), (Line(distance=20.0), 2.0)])
def test_an_approach_is_short_but_skips_little(curve, tightest, turned):
    """Of all places tried it joins at the one with the least length plus half of what it skips."""
    begin = curve.at(0.0)
    start = Pose(x=float(begin.x), y=float(begin.y) + 0.4, heading=float(begin.heading) + turned)
    way, length = plan_approach(curve, start, tightest)
    joined = way.pieces[1].start
    radius = 1.0 / (EASES[0] * tightest)
    reach = min(curve.length - 1e-3, 12.0 * radius)
    tried = {}
    for place in np.linspace(0.0, reach, PLACES + 1)[1:]:
        candidate = _way(curve, start, float(place), radius)
        bend = np.abs(candidate.at(np.linspace(0.0, candidate.length, 400)).curvature).max()
        if bend <= USABLE * tightest:
            tried[float(place)] = candidate.length + 0.5 * place
    assert tried[joined] == pytest.approx(length + 0.5 * joined)
    assert tried[joined] <= min(tried.values()) + 1e-9


@pytest.mark.parametrize("turning", [300.0, 60.0, 30.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_approach_is_as_calm_as_the_steering(turning, side):
    """On the lemniscate the first arcs that bend little enough turn the steering too fast."""
    curve, wheelbase, tightest = CURVES["lemniscate"], 0.4, 6.87
    start = InitialState(cross_track=side).on(curve)
    pose = Pose(x=start.x, y=start.y, heading=start.heading)
    way, length = plan_approach(curve, pose, tightest, 0.0, wheelbase, turning)
    point = way.at(np.linspace(0.0, length, 400))
    angle = np.arctan(wheelbase * point.curvature)
    assert np.abs(np.gradient(angle, length / 399.0)).max() <= 1.05 * turning
    with pytest.raises(NoSolution, match=r"less than 0\.001 rad/m of steering"):
        plan_approach(curve, pose, tightest, 0.0, wheelbase, 1e-3)


@pytest.mark.parametrize("name", list(VEHICLES))
def test_a_way_onto_a_curve_can_be_driven(name):
    """Its plan keeps the limits, the rate of the steering among them, from every such start."""
    for start in (InitialState(cross_track=1.0), InitialState(heading_error=3.1)):
        parts = {"controller": CurvatureTracker(), "initial": start}
        setup = with_approach(make_setup(CURVES["lemniscate"], VEHICLES[name], parts))
        assert plan_speed(setup.curve, setup.robot, setup.limits).duration > 0.0
