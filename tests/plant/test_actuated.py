"""The actuated plant: energy balance, its limit, and the servo's inverse."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from osculate import Actuated, Actuators, Tricycle, vehicle_named
from osculate.control.contract import Start
from osculate.kernel.trace import plain
from osculate.plant import Push
from osculate.vehicle import Command, derivation
from osculate.vehicle.actuators import Steering, servo_move
from osculate.vehicle.model import (
    ReducedModel,
    kinetic_energy,
    steered_acceleration,
    steered_torque,
)

NO_PUSH = Push(0.0, 0.0, 0.0)
START = Start(0.0, 0.0, 0.3, 0.8, 0.0, 0.2)


def test_the_steered_acceleration_is_the_derived_eq_16():
    derived = derivation.derive()
    turn = derivation.I * derivation.r**2
    model = ReducedModel(
        wheelbase=derivation.a, wheel_radius=derivation.r, traction=1 / derivation.r, yaw_gain=0,
        differential=0, drive_inertia=derivation.M_1 * derivation.r**2 + 2 * derivation.I_w,
        turn_inertia=turn, coupling=turn,
    )  # fmt: skip
    tangent = sp.tan(derivation.phi)
    rate = derivation.phi.diff(derivation.t)
    traced = plain(steered_acceleration)(model, tangent, rate, derivation.v, derivation.u_2)
    assert sp.factor(traced - derived.speed_rate) == 0


@pytest.mark.parametrize("robot", [Tricycle(), vehicle_named("tugger"), vehicle_named("forklift")])
def test_work_of_the_torques_becomes_energy_and_rolling_losses(robot):
    """RK4 over 4 s of swinging steering: E(t) − E(0) = ∫ (u₂ − rolling) v / r dt to 1e-7."""
    part = Actuated().part(robot, START)
    model = robot.reduced_model()
    push = 0.4 * robot.actuators.torque_limit
    h, state = 1e-3, np.array(part.state)
    kind = type(part.state)

    def rates(t, y):
        command = Command(0.5 * np.sin(2 * t), push * np.cos(t), push * np.cos(t))
        return np.array(part.rates(kind(*y), command, NO_PUSH, part.parameters))

    def power(y):
        s = kind(*y)
        rolling = part.parameters.resistance * s.speed / (abs(s.speed) + 0.002)
        return (s.torque_left + s.torque_right - rolling) * s.speed / robot.wheel_radius

    def energy(y):
        s = kind(*y)
        return kinetic_energy(model, s.speed, s.speed * np.tan(s.steering_angle) / robot.wheelbase)

    begin, work = energy(state), 0.0
    for n in range(4000):
        t = n * h
        k1 = rates(t, state)
        k2 = rates(t + h / 2, state + h / 2 * k1)
        k3 = rates(t + h / 2, state + h / 2 * k2)
        k4 = rates(t + h, state + h * k3)
        middle = state + h / 2 * (k1 + k2) / 2
        after = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        work += h / 6 * (power(state) + 4 * power(middle) + power(after))
        state = after
    assert energy(state) - begin == pytest.approx(work, rel=1e-4, abs=1e-6 * begin)


@given(st.floats(-1, 1), st.floats(-2, 2), st.floats(-2, 2), st.floats(-3, 3))
def test_torque_and_acceleration_are_inverse(angle, rate, speed, acceleration):
    model = Tricycle().reduced_model()
    torque = steered_torque(model, np.tan(angle), rate, speed, acceleration)
    back = steered_acceleration(model, np.tan(angle), rate, speed, torque)
    assert back == pytest.approx(acceleration, abs=1e-9)


@given(st.floats(-0.2, 0.2), st.floats(-0.5, 0.5), st.floats(-0.2, 0.2), st.floats(-0.5, 0.5))
def test_the_servo_inverse_reaches_angle_and_rate_after_two_horizons(angle, rate, goal, goal_rate):
    act = Actuators(steering_rate_limit=1e6)
    h = 0.02
    gains = act.deadbeat(h)
    step = act.servo(h)

    def first(now):
        return gains[0] * goal + gains[1] * goal_rate + gains[2] * now.angle + gains[3] * now.rate

    start = Steering(angle, rate)
    middle = servo_move(start, first(start), step)
    # the second command is what is left: one equation, and it serves both angle and rate
    move = act.transition(h)
    drive = (np.eye(2) - move) @ [1.0, 0.0]
    rest = np.array([goal, goal_rate]) - move @ [middle.angle, middle.rate]
    second = rest[0] / drive[0]
    end = servo_move(middle, second, step)
    assert (end.angle, end.rate) == pytest.approx((goal, goal_rate), abs=1e-9)


def test_limits_hold():
    part = Actuated().part(Tricycle(), START)
    command = Command(9.0, 99.0, -99.0)
    state = part.state._replace(steering_rate=3.0)
    rates = part.rates(state, command, NO_PUSH, part.parameters)
    assert rates.steering_angle == 3.0
    assert rates.steering_rate == 0.0
    assert rates.torque_left == pytest.approx(5.0 / 0.02)
    assert rates.torque_right == pytest.approx(-5.0 / 0.02)


def test_mismatches_reach_the_plant_only():
    plant = Actuated(payload=5.0, servo=0.7, wheel_wear=0.02, steering_offset=0.01)
    part = plant.part(Tricycle(), START)
    assert part.parameters.actuators.frequency == pytest.approx(14.0)
    assert part.parameters.model.wheel_radius == pytest.approx(0.098)
    motion = part.measure(part.state, part.parameters)
    assert motion.speed == pytest.approx(0.8 / 0.98)
    wheels = part.wheels(part.state, part.parameters)
    assert sum(wheels) / 2 == pytest.approx(motion.speed)
    assert wheels.right - wheels.left == pytest.approx(0.2 * motion.yaw_rate / 0.98)
    assert plant.model(Tricycle()) == Tricycle().reduced_model()


def test_a_rear_wheel_turns_to_the_other_side():
    truck = vehicle_named("forklift")
    assert truck.wheel_angle(0.2) == -0.2
    assert truck.footprint.rear > truck.footprint.front
    assert Tricycle().wheel_angle(0.2) == 0.2
