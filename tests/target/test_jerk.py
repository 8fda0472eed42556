"""The jerk of a speed plan: kept everywhere, and used where it is what limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import Limits, plan_speed, vehicle_named
from osculate.study.comparison.suite import CURVES


def jerks(plan):
    """d³s/dt³ = v d²(v²/2)/ds² (m/s³) at the inner nodes, from the plan's own energies."""
    s, energy = plan.arc_length, plan.energy
    before, after = np.diff(s)[:-1], np.diff(s)[1:]
    slope = np.diff(energy) / np.diff(s)
    return np.abs(np.diff(slope) / (0.5 * (before + after))) * plan.speed[1:-1]


@settings(max_examples=5)
@given(
    name=st.sampled_from(["slalom", "corner", "cycloid"]),
    robot=st.sampled_from(["paper", "tugger", "forklift"]),
    jerk=st.floats(0.3, 3.0),
    speed=st.floats(0.5, 2.0),
)
def test_the_jerk_is_kept_and_used(name, robot, jerk, speed):
    limits = Limits(speed=speed, jerk=jerk)
    plan = plan_speed(CURVES[name], vehicle_named(robot), limits)
    moving = plan.speed[1:-1] > 2.0 * limits.creep
    found = jerks(plan)[moving]
    assert found.max() <= 1.25 * jerk  # the programme is linear around the iterate before
    if "jerk" in plan.shares():
        assert found.max() >= 0.8 * jerk


def test_ten_times_the_jerk_is_another_plan():
    curve, robot = CURVES["slalom"], vehicle_named("paper")
    quiet, quick = (plan_speed(curve, robot, Limits(speed=1.0, jerk=j)) for j in (0.3, 3.0))
    assert "jerk" in quiet.shares()
    assert quiet.duration > 1.02 * quick.duration
    assert jerks(quiet)[quiet.speed[1:-1] > 0.1].max() == pytest.approx(0.3, rel=0.2)
