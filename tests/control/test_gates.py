"""What passes a gate, and what a refused reading is: missing."""

import math
from functools import cache
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.closed_loop import Case
from control.kinematic import IDLE, Senses
from osculate.control.gate import PATIENCE, GateMemory, GateParameters, gate_command
from osculate.control.reasons import EXTERNAL, Alarm
from osculate.control.standstill import DRIVING, REST, StopParameters, come_to_rest, oppose
from osculate.kernel.trace import plain
from osculate.vehicle.measurement import NO_FIX
from osculate.vehicle.motion import Command

anything = st.floats(allow_nan=True, allow_infinity=True)
P = GateParameters(1.2, 0.03, 5.0, 0.01)
gate, brake = plain(gate_command), plain(oppose)


@given(
    decided=st.builds(Command, anything, anything, anything, anything),
    last=st.floats(-1.2, 1.2), sound=st.booleans(),
)  # fmt: skip
def test_whatever_is_decided_leaves_the_gate_within_all_limits(decided, last, sound):
    before = GateMemory(Command(last, 1.0, 2.0, 0.5), 0.0, 0.0)
    command, after = gate(decided, sound, before, P)
    assert np.isfinite(command).all()
    assert abs(command.steering_angle) <= 1.2
    assert abs(command.steering_angle - last) <= 0.03 + 1e-12
    assert max(abs(command.torque_left), abs(command.torque_right)) <= 5.0
    assert 0.0 <= command.brake <= 1.0
    good = np.isfinite(decided).all() and sound
    assert after.missed == (0.0 if good else 1.0)
    assert (after.undecided > 0.0) == (not good)
    if not np.isfinite(decided).all():
        assert command == before.last
    assert P.period < PATIENCE


@given(torque=st.floats(-100.0, 100.0), speed=st.floats(-3.0, 3.0))
def test_a_torque_that_brakes_never_drives(torque, speed):
    out = brake(torque, speed)
    assert out * speed <= 0.0
    assert out in (0.0, torque)


@given(speed=st.floats(-3.0, 3.0), wheel=st.sampled_from((0.0, 1.0)))
def test_every_stop_comes_to_rest_in_time(speed, wheel):
    """Also when the speed that is reported never falls."""
    p = StopParameters(0.01, 0.3, 0.3, 2.0, 0.0, 0.0, 9.0, 1.0, 0.1)
    now, steps = come(Alarm(EXTERNAL, 0.0, 0.0), speed, DRIVING, p), 1
    while not now.resting and steps < 1000:
        now, steps = come(Alarm(0.0, 0.0, 0.0), speed * wheel, now, p), steps + 1
    assert now.resting
    assert steps * 0.01 <= 1.5 * abs(speed) / 2.0 + 0.6
    again = come(Alarm(0.0, 0.0, 0.0), 1.0, now, p)
    assert again.resting
    assert again.alarm.reason == EXTERNAL
    assert steps > 1 or abs(speed) < REST


def come(alarm, speed, now, p):
    return plain(come_to_rest)(alarm, speed, True, 0.0, 1.0, now, p)


case_of = cache(Case)
WRONG = {
    "wheels": lambda z: z._replace(left=z.left + 3.0),
    "both wheels": lambda z: z._replace(left=z.left - 2.0, right=z.right - 2.0),
    "gyro": lambda z: z._replace(yaw_rate=50.0),
    "steering": lambda z: z._replace(steering_angle=z.steering_angle - 0.9),
    "steering beyond its lock": lambda z: z._replace(steering_angle=3.0),
    "pose aside": lambda z: z._replace(fix=z.fix._replace(x=z.fix.x - 0.4, y=z.fix.y + 0.4)),
    "heading": lambda z: z._replace(fix=z.fix._replace(heading=z.fix.heading + 0.6)),
    "pose in the future": lambda z: z._replace(fix=z.fix._replace(age=-1e-3)),
    "pose too old": lambda z: z._replace(fix=z.fix._replace(age=0.2)),
    "pose of no age": lambda z: z._replace(fix=z.fix._replace(age=math.nan)),
    "pose too far": lambda z: z._replace(fix=z.fix._replace(x=1e300)),
}
MISSING = {
    "wheels": {"left": math.nan, "right": math.nan}, "gyro": {"yaw_rate": math.nan},
    "steering": {"steering_angle": math.nan}, "pose": {"fix": NO_FIX},
}  # fmt: skip
CHANNEL = {"both wheels": "wheels", "steering beyond its lock": "steering"}


@pytest.fixture(scope="module")
def on_the_way():
    """A stepper in the middle of a run, and a measurement with a pose that comes next."""
    case = case_of("curvature-tracker", True, True)
    robot = case.begin()
    senses, acting = Senses(robot, Random(5)), IDLE
    for _ in range(300):
        command = case.stepper.step(senses.measure())
        robot.move(acting, 0.01)
        acting = command
    return case, case.stepper._memory.copy(), senses.measure()


@pytest.mark.parametrize("name", WRONG)
def test_a_reading_that_is_refused_counts_as_missing(on_the_way, name):
    case, memory, z = on_the_way
    assert z.fix.x == z.fix.x
    channel = CHANNEL.get(name, name if name in MISSING else "pose")
    answers = []
    for measured in (WRONG[name](z), z._replace(**MISSING[channel]), z):
        case.stepper._memory = memory.copy()
        command = case.stepper.step(measured)
        belief = case.stepper.belief
        answers.append((command, belief.mean, belief.covariance, belief.evidence))
    wrong, missing, right = answers
    assert wrong[:3] == missing[:3]
    assert wrong[3]._replace(surprise=0.0) == missing[3]._replace(surprise=0.0)
    assert wrong[1] != right[1]
