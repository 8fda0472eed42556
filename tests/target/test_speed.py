"""Speed plans: every limit is kept, some limit binds everywhere, and errors say where."""

import math

import numpy as np
import pytest

from osculate import (
    Actuators,
    Cycloid,
    Limits,
    Line,
    NoSolution,
    Parametric,
    Spline,
    Tricycle,
    plan_speed,
    vehicle_named,
)
from osculate.study.comparison.suite import CURVES
from osculate.target.speed import plan as planning

CASES = [(name, robot) for name in CURVES for robot in ("paper", "tugger", "forklift")]


@pytest.mark.parametrize(("name", "robot"), CASES)
def test_all_limits_are_kept(name, robot):
    curve, body, limits = CURVES[name], vehicle_named(robot), Limits(speed=2.0)
    plan = plan_speed(curve, body, limits)
    s, v = plan.arc_length, plan.speed
    point = curve.at(s)
    slack = 1.0 + 1e-6
    moving = v > 1.01 * limits.creep
    assert (v <= limits.speed * slack).all()
    lateral = v**2 * np.abs(point.curvature)
    assert (lateral <= limits.lateral_acceleration * slack).all()
    assert (lateral <= limits.tipping * body.tipping_acceleration * slack).all()
    a = body.wheelbase
    turning = v * a * np.abs(point.curvature_rate) / (1 + (a * point.curvature) ** 2)
    allowed = limits.steering * body.actuators.steering_rate_limit
    assert (turning[moving] <= allowed * slack).all()
    along = np.diff(plan.energy) / s[1]
    assert along.max() <= limits.acceleration * slack
    assert along.min() >= -limits.deceleration * slack
    middle_v = np.sqrt(plan.energy[1:] + plan.energy[:-1])
    k = 0.5 * (point.curvature[1:] + point.curvature[:-1])
    dk = np.diff(point.curvature) / s[1]
    inertia = body.total_mass + 2 * body.wheel_inertia / body.wheel_radius**2
    force = (inertia + body.turn_inertia * k**2) * along + body.turn_inertia * k * dk * middle_v**2
    force += body.actuators.rolling_resistance * body.weight
    most = 2 * limits.torque * body.actuators.torque_limit / body.wheel_radius
    assert np.abs(force).max() <= most + 1e-6 * most + body.weight * 0.02
    if body.actuators.power_limit:
        power = force * middle_v
        assert power.max() <= limits.torque * body.actuators.power_limit * 1.02


def test_some_limit_binds_everywhere():
    plan = plan_speed(CURVES["corner"], Tricycle(), Limits(speed=2.0))
    assert set(plan.shares()) >= {"acceleration", "deceleration", "lateral acceleration", "jerk"}
    assert sum(plan.shares().values()) == pytest.approx(1.0)


def test_a_straight_is_driven_as_the_textbook_says():
    """Trapezoids of the acceleration: v / a + a / j for each change of the speed."""
    limits = Limits(speed=1.0, acceleration=0.5, deceleration=0.4, jerk=2.0)
    plan = plan_speed(Line(distance=12.0), Tricycle(), limits)
    change, mean = 1.0 - limits.creep, 0.5 * (1.0 + limits.creep)
    times = [change / a + a / limits.jerk for a in (limits.acceleration, limits.deceleration)]
    expected = sum(times) + (12.0 - mean * sum(times)) / 1.0
    assert plan.duration == pytest.approx(expected, rel=5e-3)


def test_tighter_limits_take_longer():
    durations = [
        plan_speed(Cycloid.over(), Tricycle(), Limits(speed=2.0, **change)).duration
        for change in ({}, {"jerk": 1.0}, {"acceleration": 0.3}, {"lateral_acceleration": 0.3})
    ]
    assert min(durations[1:]) > durations[0]


def test_a_closed_track_starts_as_it_ends():
    loop = Spline(points=((0, 0), (4, -1), (6, 2), (2, 4)), loop=True)
    plan = plan_speed(loop, Tricycle(), Limits(speed=3.0))
    assert plan.energy[0] == pytest.approx(plan.energy[-1], rel=1e-6)
    assert plan.speed.min() > 0.5


def test_a_curve_that_is_too_tight_says_where():
    stiff = Tricycle(actuators=Actuators(steering_angle_limit=math.radians(20)))
    with pytest.raises(NoSolution, match=r"at s = 2\.\d+ m it bends with .* the limit is 20°"):
        plan_speed(CURVES["corner"], stiff)


def test_motors_too_weak_for_the_rolling_resistance_are_named():
    weak = Tricycle(actuators=Actuators(torque_limit=0.01))
    with pytest.raises(NoSolution, match="the motors cannot hold the slowest speed"):
        plan_speed(CURVES["corner"], weak)


def test_a_tight_place_between_the_nodes_is_seen():
    """Hundreds of tips of a micrometre, on a curve whose nodes are 15 cm apart."""
    with pytest.raises(NoSolution, match=r"bends with -?9e\+06 1/m"):
        plan_speed(Parametric(x="p", y="sin(3000 * p)"), Tricycle())


@pytest.mark.parametrize("speed", [2.0, 12.0])
def test_long_plans_start_from_a_bound_that_changes_nothing(monkeypatch, speed):
    """The programme without that bound is the oracle."""
    a = np.linspace(0, 2 * np.pi, 180, endpoint=False)
    r = 140 + 10 * np.sin(9 * a) + 5 * np.sin(13 * a)
    track = Spline(points=tuple(zip(r * np.cos(a), r * np.sin(a), strict=True)), loop=True)
    limits = Limits(speed=speed)
    monkeypatch.setattr(planning, "LONG", 10)
    quick = plan_speed(track, Tricycle(), limits)
    monkeypatch.setattr(planning, "LONG", 10**9)
    exact = plan_speed(track, Tricycle(), limits)
    assert quick.energy == pytest.approx(exact.energy, rel=1e-7)
    assert quick.duration == pytest.approx(exact.duration, rel=1e-9)
