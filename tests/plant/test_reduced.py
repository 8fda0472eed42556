"""The reduced plant: kinematics, energy, and the disturbance that acts on it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import Cycloid, Disturbance, InitialState, InvalidInput, Reduced, Tricycle
from osculate.control import Errors
from osculate.plant import Push
from osculate.plant.disturbance import DisturbanceMemory, disturb, perceive
from osculate.vehicle import Command, Motion

pytestmark = pytest.mark.core

ROBOT = Tricycle()
START = InitialState(speed=1.0).on(Cycloid.over())
STILL = Push(0.0, 0.0, 0.0)


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3), st.floats(-1, 1), st.floats(-1, 1))
def test_the_robot_moves_where_it_points(heading, speed, yaw_rate, left, right):
    part = Reduced().part(ROBOT, START)
    state = part.state._replace(heading=heading, speed=speed, yaw_rate=yaw_rate)
    rate = part.rates(state, Command(0.0, left, right), STILL, part.parameters)
    assert -rate.x * math.sin(heading) + rate.y * math.cos(heading) == pytest.approx(0.0, abs=1e-12)
    assert rate.x * math.cos(heading) + rate.y * math.sin(heading) == pytest.approx(speed)
    assert rate.heading == yaw_rate
    assert rate.yaw_rate == pytest.approx(50.0 * (right - left))


def test_the_steering_angle_follows_from_the_motion():
    part = Reduced().part(ROBOT, START)
    state = part.state._replace(speed=2.0, yaw_rate=1.0)
    motion = part.measure(state, part.parameters)
    assert motion.yaw_rate == pytest.approx(
        motion.speed * math.tan(motion.steering_angle) / ROBOT.wheelbase
    )
    resting = part.measure(state._replace(speed=0.0, yaw_rate=0.0), part.parameters)
    assert math.tan(resting.steering_angle) / ROBOT.wheelbase == pytest.approx(START.curvature)


def test_the_wheels_roll():
    part = Reduced().part(ROBOT, START)
    wheels = part.wheels(part.state._replace(speed=2.0, yaw_rate=1.0), part.parameters)
    assert wheels == pytest.approx((1.9, 2.1))


def test_disturbances_act_where_they_say():
    errors = Errors(heading=0.2, yaw_rate=-0.1, speed=0.3)
    push, rate = disturb(1.0, errors, Disturbance.internal(5, 5).parameters())
    assert push.yaw_acceleration == pytest.approx(-0.5)
    assert push.acceleration == pytest.approx(0.1 * math.sin(1.0) + 0.6)
    assert push.yaw_rate == 0.0
    assert rate.heading_drift == pytest.approx(1.0)
    push, rate = disturb(1.0, errors, Disturbance.external(acts_on="robot").parameters())
    assert push.yaw_rate == pytest.approx(math.sin(4.0))
    assert push.yaw_acceleration == pytest.approx(math.cos(4.0))
    assert rate.heading_drift == 0.0
    seen = perceive(Motion(0.0, 0.0, 1.0, 0.0, 0.0, 0.0), DisturbanceMemory(0.5))
    assert seen.heading == 1.5


def test_nothing_disturbs_by_default():
    push, rate = disturb(1.0, Errors(1.0, 1.0, 1.0), Disturbance().parameters())
    assert (push, rate) == (Push(0.0, 0.0, 0.0), DisturbanceMemory(0.0))


def test_bad_choices_are_explained():
    with pytest.raises(InvalidInput, match=r"Reduced\.form = 'exact'.*'corrected' or 'printed'"):
        Reduced(form="exact")
