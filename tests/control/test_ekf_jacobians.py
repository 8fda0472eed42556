"""The estimator's slopes are the slopes of what it computes: against central differences."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import Ekf
from osculate.control.contract import Start
from osculate.control.estimation import process, readings
from osculate.control.estimation.belief import Place
from osculate.control.estimation.contract import Told
from osculate.control.estimation.kinematics import UNITS, Kinematics, carry
from osculate.kernel import transpose
from osculate.kernel.trace import plain
from osculate.vehicle.catalogue import VEHICLES
from osculate.vehicle.measurement import Fix, Measurement

STEP = 1e-6
step_forward = plain(process.step_forward)
rows_of = plain(carry)


def among(limit):
    return st.floats(-limit, limit)


def states(slip=0.004, swerve=0.1):
    """States in which neither the servo's rate nor the wheelbase is at a limit."""
    return st.builds(
        Kinematics, among(50.0), among(50.0), among(3.0), st.floats(-0.5, 2.0), among(1.0),
        among(0.3), among(0.03), among(0.05), among(0.02), among(slip), among(0.005),
        among(swerve),
    )  # fmt: skip


def parameters(robot, period=0.01):
    start = Start(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return Ekf().part(VEHICLES[robot], start, period).parameters


def differences(function, m):
    """Slopes of a function of the state, shape (results, 12)."""
    columns = []
    for n, value in enumerate(m):
        h = STEP * max(1.0, abs(value))
        ends = [
            np.asarray(function(m._replace(**{m._fields[n]: value + side * h})))
            for side in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1]) / (2.0 * h))
    return np.stack(columns, axis=-1)


def miss(m, robot, period):
    """Slopes of one step minus its differences, shape (12, 12)."""
    p = parameters(robot, period)
    told = Told(m.steering_angle + 0.02, 0.5)
    _, slopes = step_forward(m, told, p)
    jacobian = np.array(plain(transpose)(plain(transpose)(rows_of(UNITS, slopes))))
    return jacobian - differences(lambda s: step_forward(s, told, p)[0], m)


@settings(max_examples=25)
@given(m=states(slip=0.0, swerve=0.0), robot=st.sampled_from(list(VEHICLES)))
def test_a_step_without_slip_is_linearised_to_second_order(m, robot):
    """F is that of the middle of the step: what is left falls with the square of the period."""
    most = [np.abs(miss(m, robot, t)).max() for t in (0.02, 0.01, 0.005)]
    scale = (1.0 + m.speed**2) / VEHICLES[robot].wheelbase / np.cos(m.steering_angle) ** 4
    for t, error in zip((0.02, 0.01, 0.005), most, strict=True):
        assert error < 4.0 * scale * t * t + 1e-7
    assert most[2] < 0.35 * most[0] + 1e-7


@settings(max_examples=40)
@given(m=states(), robot=st.sampled_from(list(VEHICLES)))
def test_slip_adds_no_more_than_its_own_small_part(m, robot):
    """Left out are products with slip c and swerve δ: below t v (c ∂(v ω) + v δ) each."""
    t, a = 0.01, VEHICLES[robot].wheelbase
    bend = 1.0 / np.cos(abs(m.steering_angle) + 0.05) ** 2
    scale = (1.0 + m.speed**2) / a * bend**2
    v = abs(m.speed) + 0.01
    extra = abs(m.slip) * (1.0 + v) ** 2 * bend * (1.0 / a + 1.0) + v * abs(m.swerve)
    assert np.abs(miss(m, robot, t)).max() < 4.0 * scale * t * t + 2.0 * t * v * extra + 1e-7


def check_clue(clue, m):
    """The slope of a clue is minus that of its surprise."""
    expected = -differences(lambda s: clue(s).surprise, m)
    assert np.array(clue(m).slope) == pytest.approx(expected, rel=1e-5, abs=1e-6)


@settings(max_examples=40)
@given(m=states(), acceleration=among(3.0), robot=st.sampled_from(list(VEHICLES)))
def test_the_clues_of_wheels_and_gyro(m, acceleration, robot):
    p = parameters(robot)
    z = Measurement(0.4, 0.6, 0.1, 0.2, Fix(0.0, 0.0, 0.0, 0.0))
    speed, difference = plain(readings.speed_clue), plain(readings.difference_clue)
    gyro = plain(readings.gyro_clue)
    check_clue(lambda s: speed(s, z, acceleration, p), m)
    check_clue(lambda s: difference(s, z, p), m)
    check_clue(lambda s: gyro(s, z.yaw_rate, p), m)


@settings(max_examples=25)
@given(
    m=states(),
    steps=st.tuples(among(0.05), among(0.05), among(0.1)),
    age=st.floats(0.0, 0.06),
    robot=st.sampled_from(list(VEHICLES)),
)
def test_the_clues_of_a_pose_of_any_age(m, steps, age, robot):
    p = parameters(robot)
    x, y, turn = steps
    trail = tuple(Place(-n * x, -n * y, -n * turn) for n in range(8))
    fix = Fix(m.x + 0.01, m.y - 0.02, m.heading + 0.01, age)

    def clues(s):
        off, ahead = plain(readings.fix_innovation)(s, trail, fix, p)
        return plain(readings.fix_clues)(off, ahead, True, p)

    for n in range(3):
        check_clue(lambda s, n=n: clues(s)[n], m)
