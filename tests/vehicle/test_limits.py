"""What actuators and balance allow, against what physics says."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import Actuated, InvalidInput, Slip, Tricycle
from osculate.kernel.trace import plain
from osculate.vehicle.actuators import Actuators, Steering, servo_move
from osculate.vehicle.catalogue import VEHICLES

move = plain(servo_move)
ACT = Actuators()


@given(
    angle=st.floats(-1.2, 1.2), rate=st.floats(-10.0, 10.0), command=st.floats(-1.2, 1.2),
    step=st.sampled_from((0.001, 0.005, 0.02)),
)  # fmt: skip
def test_no_servo_moves_faster_than_its_rate_limit(angle, rate, command, step):
    after = move(Steering(angle, rate), command, ACT.servo(step))
    assert abs(after.angle - angle) <= ACT.steering_rate_limit * step + 1e-12
    assert abs(after.rate) <= ACT.steering_rate_limit


@given(angle=st.floats(-1.0, 1.0), away=st.floats(-0.02, 0.02), rate=st.floats(-0.2, 0.2))
def test_below_its_limits_a_servo_is_of_second_order(angle, away, rate):
    p = ACT.servo(0.01)
    once = move(Steering(angle, rate), angle + away, p)
    exact = ACT.transition(0.01) @ np.array([-away, rate])
    assert once.angle == pytest.approx(angle + away + exact[0], abs=1e-12)
    assert once.rate == pytest.approx(exact[1], abs=1e-12)


@given(
    ahead=st.floats(0.0, 0.999), height=st.floats(0.05, 1.0), track=st.floats(0.1, 1.0),
    pull=st.floats(0.1, 10.0),
)  # fmt: skip
def test_tipping_is_where_the_inner_wheel_carries_nothing(ahead, height, track, pull):
    """Loads of three wheels from the balance of forces and of both moments, independently."""
    robot = Tricycle(
        centre_ahead=ahead * 0.4, centre_height=height, track_width=track, body_inertia=1.0
    )
    a, d, g, x = robot.wheelbase, robot.track_width, robot.gravity, robot.centre_ahead
    # unknowns: steered, inner, outer load per mass; a pull to the outside acts at the centre's height
    balance = np.array([[1.0, 1.0, 1.0], [a, 0.0, 0.0], [0.0, -d / 2, d / 2]])
    _, inner, _ = np.linalg.solve(balance, [g, g * x, pull * height])
    assert (inner > 0.0) == (pull < robot.tipping_acceleration) or math.isclose(
        pull, robot.tipping_acceleration, rel_tol=1e-9
    )


@pytest.mark.parametrize("name", VEHICLES)
def test_a_centre_nearer_to_the_steered_wheel_tips_earlier(name):
    robot = VEHICLES[name]
    nearer = robot.model_copy(update={"centre_ahead": robot.centre_ahead + 0.05})
    assert nearer.tipping_acceleration < robot.tipping_acceleration


@given(
    name=st.sampled_from(sorted(VEHICLES)), share=st.floats(-0.5, 1.5), inertia=st.floats(1e-3, 2.0)
)
def test_robots_that_cannot_be_are_refused(name, share, inertia):
    """Point masses at the wheels and at the body's middle, and a rod: no centre is out of their reach."""
    robot = VEHICLES[name]
    a, x = robot.wheelbase, share * robot.wheelbase
    changed = {"centre_ahead": x, "body_inertia": inertia * robot.body_inertia}
    mass = robot.body_mass + 3.0 * robot.wheel_mass
    about_axle = changed["body_inertia"] + a**2 * (robot.body_mass / 4.0 + robot.wheel_mass)
    if not 0.0 <= x < a:
        with pytest.raises(InvalidInput, match=r"centre_ahead.*between axle and steered wheel"):
            robot.but(**changed)
    elif about_axle <= mass * x**2:
        with pytest.raises(InvalidInput, match=r"body_inertia.*must be above"):
            robot.but(**changed)
    else:
        made = robot.but(**changed)
        assert made.tipping_acceleration > 0.0
        assert Slip().parameters(made).yaw_inertia > 0.0


@given(st.sampled_from(sorted(VEHICLES)), st.floats(0.0, 1e5))
def test_a_load_makes_no_robot_impossible(name, load):
    robot = VEHICLES[name]
    loaded = Actuated(payload=load).real(robot)
    between = sorted((robot.centre_ahead, robot.wheelbase / 2.0))
    assert between[0] - 1e-12 <= loaded.centre_ahead <= between[1] + 1e-12
