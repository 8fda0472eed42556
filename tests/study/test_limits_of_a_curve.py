"""The speeds at which a curve reaches the limits of a robot, against the steering angle itself."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import vehicle_named
from osculate.study.comparison.suite import CURVES
from osculate.study.feasibility import inspect_curve


def turning(curve, robot, s):
    """dφ/ds (rad/m) by central differences of φ = arctan(a κ)."""
    step = 1e-5
    angles = [np.arctan(robot.wheelbase * curve.at(s + d).curvature) for d in (-step, step)]
    return np.abs(angles[1] - angles[0]) / (2.0 * step)


@settings(max_examples=6)
@given(
    name=st.sampled_from(["slalom", "lemniscate", "cycloid"]),
    robot=st.sampled_from(["paper", "tugger", "forklift"]),
    speed=st.floats(0.2, 4.0),
)
def test_at_the_speed_of_the_steering_rate_the_steering_turns_at_its_limit(name, robot, speed):
    curve, body = CURVES[name], vehicle_named(robot)
    report = inspect_curve(curve, body, speed)
    limit = body.actuators.steering_rate_limit
    s = np.linspace(2e-5, curve.length - 2e-5, 8001)
    most = turning(curve, body, s)
    assert report.rate_speed == pytest.approx(limit / most.max(), rel=1e-3)
    if 0.01 < report.rate_place < curve.length - 0.01:
        there = float(turning(curve, body, report.rate_place))
        assert report.rate_speed * there == pytest.approx(limit, rel=1e-3)
    bend = np.abs(curve.at(s).curvature).max()
    assert report.tipping_speed**2 * bend == pytest.approx(body.tipping_acceleration, rel=1e-3)
