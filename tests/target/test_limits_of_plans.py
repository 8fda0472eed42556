"""A plan keeps every limit, between its nodes too; or it is refused with what is impossible.

The oracle knows nothing of the planner: it reads the plan as the kernels do, differentiates it in time,
and takes the forces from the vehicle's own model.
"""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from osculate import (
    Chain,
    Laps,
    Limits,
    Line,
    NoSolution,
    Parametric,
    Spline,
    plan_speed,
    vehicle_named,
)
from osculate.vehicle.model import steered_torque

SLACK = 1.0 + 1e-6
FINE = 40  # samples of a cell

WAVE = Spline(points=((0, 0), (1.5, 0.5), (3, 0), (4.5, -0.5), (6, 0)))
RING = Spline(points=((0, 0), (4, -1), (6, 2), (2, 4)), loop=True)

coordinates = st.floats(-2.0, 2.0)
waypoints = st.lists(coordinates, min_size=4, max_size=8).map(
    lambda ys: Spline(points=tuple((2.5 * n, y) for n, y in enumerate(ys)))
)
corners = st.builds(
    lambda turn, radius, straight: Chain.corner(
        turn=turn, radius=radius, ramp=0.6 * turn * radius, straight=straight
    ),
    st.floats(0.4, 2.0), st.floats(1.5, 4.0), st.floats(0.5, 6.0),
)  # fmt: skip
waves = st.builds(
    lambda height, end: Parametric(x="3 * p", y=f"{height} * sin(p)", end=end),
    st.floats(0.1, 2.0), st.floats(1.0, 9.0),
)  # fmt: skip
rings = st.builds(
    lambda a, b: Spline(points=((a, 0), (0, b), (-a, 0), (0, -b)), loop=True),
    st.floats(3.0, 9.0), st.floats(3.0, 9.0),
)  # fmt: skip
lines = st.builds(lambda d: Line(distance=d), st.floats(0.3, 30.0))
curves = st.one_of(waypoints, corners, waves, rings, lines, rings.map(lambda r: Laps(track=r)))
robots = st.builds(
    lambda name, torque, power, rolling: _changed(vehicle_named(name), torque, power, rolling),
    st.sampled_from(("paper", "tugger", "forklift")),
    st.floats(0.3, 1.5), st.sampled_from((None, 0.3, 1.0)), st.floats(0.0, 0.02),
)  # fmt: skip
limits = st.builds(
    Limits,
    speed=st.floats(0.3, 4.0),
    lateral_acceleration=st.floats(0.05, 3.0),
    acceleration=st.floats(0.1, 2.0),
    deceleration=st.floats(0.1, 2.0),
    jerk=st.floats(0.1, 30.0),
    steering=st.floats(0.1, 1.0),
    torque=st.floats(0.5, 1.0),
    tipping=st.floats(0.1, 1.0),
    creep=st.floats(0.01, 0.1),
)
shares = st.one_of(st.none(), st.floats(0.0, 1.0))


def _changed(robot, torque, power, rolling):
    act = robot.actuators
    power = None if power is None else power * torque * act.torque_limit / robot.wheel_radius
    return robot.but(
        actuators=act.but(
            torque_limit=torque * act.torque_limit, power_limit=power, rolling_resistance=rolling
        )
    )


def used(plan, curve, robot, task):
    """Largest use of every limit, 1 where it binds."""
    s = np.linspace(0.0, curve.length, FINE * (len(plan.arc_length) - 1) + 1)
    energy = CubicHermiteSpline(plan.arc_length, plan.energy, plan.acceleration)(s)
    step = s[1]
    speed = np.sqrt(2.0 * energy)
    a = np.diff(energy) / step
    jerk = np.abs(np.diff(a)) / step * speed[1:-1]
    bend = curve.at(s)
    wheelbase, act = robot.wheelbase, robot.actuators
    tangent = wheelbase * bend.curvature
    rate = wheelbase * bend.curvature_rate * speed / (1.0 + tangent**2)
    model = robot.reduced_model()
    slope = np.concatenate([a[:1], 0.5 * (a[1:] + a[:-1]), a[-1:]])
    torque = steered_torque.py_func(model, tangent, rate, speed, slope)
    torque = torque + act.rolling_resistance * robot.weight * robot.wheel_radius
    uses = {
        "speed": speed / task.speed,
        "lateral": speed**2 * np.abs(bend.curvature) / task.lateral_acceleration,
        "tipping": speed**2 * np.abs(bend.curvature) / task.tipping / robot.tipping_acceleration,
        "steering rate": np.abs(rate) / task.steering / act.steering_rate_limit,
        "acceleration": a / task.acceleration,
        "deceleration": -a / task.deceleration,
        "jerk": jerk / task.jerk,
        "torque": np.abs(torque) / task.torque / (2.0 * act.torque_limit),
    }
    if act.power_limit is not None:
        power = torque * speed / robot.wheel_radius
        uses["power"] = power / task.torque / act.power_limit
    return {name: float(np.max(values)) for name, values in uses.items()}


def planned(curve, robot, task):
    """The plan and no message, or no plan and why."""
    try:
        return plan_speed(curve, robot, task), ""
    except NoSolution as refusal:
        return None, str(refusal)


@settings(max_examples=20, deadline=None)
@given(curves, robots, limits, shares, shares)
def test_every_limit_is_kept_between_the_nodes_too(curve, robot, task, first, last):
    task = task.but(
        start_speed=None if first is None else first * task.speed,
        end_speed=None if last is None else last * task.speed,
    )
    plan, refusal = planned(curve, robot, task)
    if plan is None:
        assert re.search("lower|raise|the limit is", refusal)
        return
    uses = used(plan, curve, robot, task)
    assert max(uses.values()) <= SLACK, uses
    for place, given_speed in ((0, task.start_speed), (-1, task.end_speed)):
        if given_speed is not None:
            assert plan.speed[place] == pytest.approx(max(given_speed, task.creep), rel=1e-6)
        if given_speed is not None or not curve.closed:
            assert abs(plan.acceleration[place]) < 1e-7
