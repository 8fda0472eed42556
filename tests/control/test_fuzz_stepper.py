"""Whatever is measured: finite, within limits, inside the corridor; and a stop is a stop.

`make fuzz` does the same with all trackers, for ten million steps.
"""

import itertools
import math
from functools import cache
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.closed_loop import MOTION, SENSED, SPEEDS, Case, episode, faults_of, run
from control.kinematic import KINDS, Corrupter, Senses, Span
from osculate import InvalidInput
from osculate.vehicle.measurement import NO_FIX

case_of = cache(Case)
TRACKERS = ("curvature-tracker", "lqr-preview", "pure-pursuit")
COMBINATIONS = list(itertools.product(TRACKERS, (True, False), (True, False)))
STEPS = 1200


@pytest.mark.parametrize(("law", "estimates", "guarded"), COMBINATIONS)
def test_nothing_that_is_measured_leads_astray(law, estimates, guarded):
    @settings(max_examples=8)
    @given(seed=st.integers(0, 2**32))
    def drive(seed):
        watch, corrupter = episode(case_of(law, estimates, guarded), seed, STEPS)
        assert not faults_of(watch), corrupter.spans

    drive()


EVERY = [(name, kind) for name in SENSED for kind in KINDS]


@pytest.mark.parametrize("robot", SPEEDS)
@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_no_single_fault_leads_out_of_the_corridor(robot, estimates):
    """Each kind of fault in each field, for good, on every robot."""
    case = case_of("curvature-tracker", estimates, True, robot)
    names = SENSED if estimates else MOTION
    random = Random(f"{robot}{estimates}")
    for name, kind in random.sample(list(itertools.product(names, KINDS)), 20):
        size = random.choice((-1.0, 1.0)) * {"x": 1.0, "y": 1.0}.get(name, 0.8)
        span = Span(name, kind, random.randint(50, 500), STEPS, size)
        robot_driven = case.begin()
        corrupter = Corrupter((span,), random)
        watch = run(case, robot_driven, Senses(robot_driven, random), corrupter, STEPS)
        assert not faults_of(watch), span


def watched(case, steps, disturb=None, spans=(), seed=1):
    robot = case.begin()
    corrupter = Corrupter(tuple(spans), Random(seed))
    return run(case, robot, Senses(robot, Random(seed)), corrupter, steps, disturb)


@pytest.mark.parametrize("robot", SPEEDS)
@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_a_stop_from_outside_ends_at_rest_without_drive(robot, estimates):
    case = case_of("curvature-tracker", estimates, True, robot)

    def disturb(n, driven, stepper):
        if n == 300:
            assert driven.speed > 0.2
            stepper.stop()

    watch = watched(case, 900, disturb)
    assert not faults_of(watch)
    assert watch.rested
    assert watch.last.torque_left == watch.last.torque_right == 0.0
    assert watch.robot.speed == pytest.approx(0.0, abs=1e-3)
    assert "from outside" in case.stepper.message


@pytest.mark.parametrize("robot", SPEEDS)
def test_a_stop_never_pushes_against_blocked_wheels(robot):
    case = case_of("curvature-tracker", True, True, robot)

    def disturb(n, driven, stepper):
        driven.blocked = n > 300
        if n == 302:
            stepper.stop()

    watch = watched(case, 900, disturb)
    assert not faults_of(watch)
    assert watch.rested
    assert watch.last.torque_left == watch.last.torque_right == 0.0


@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_the_end_of_the_path_is_a_standstill(estimates):
    case = case_of("curvature-tracker", estimates, True)
    watch = watched(case, 2500)
    assert not faults_of(watch)
    assert case.stepper.arrived
    assert watch.rested
    assert watch.robot.speed == pytest.approx(0.0, abs=1e-3)
    assert math.hypot(watch.robot.x - case.ends[1][0], watch.robot.y - case.ends[1][1]) < 0.2


@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_nothing_moves_before_the_first_pose(estimates):
    case = case_of("curvature-tracker", estimates, True)
    names = ("x",) if estimates else MOTION
    watch = watched(case, 200, spans=[Span(name, "nan", 0, 200, 0.0) for name in names])
    assert not faults_of(watch)
    assert case.stepper.message.startswith("waiting for a pose")
    assert watch.robot.speed == 0.0
    case.stepper.step(case.begin().motion if not estimates else measured(case, watch.robot))
    assert not case.stepper.standing


def measured(case, robot):
    return Senses(robot, Random(1)).measure()


@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_only_a_reset_at_rest_ends_a_stop(estimates):
    case = case_of("curvature-tracker", estimates, True)
    watched(case, 300)
    case.stepper.stop()
    with pytest.raises(InvalidInput, match="the robot moves"):
        case.stepper.reset()
    watch = watched(case, 900, lambda n, driven, stepper: n == 300 and stepper.stop())
    assert case.stepper.stopping
    case.stepper.reset(watch.robot.motion._replace(speed=0.0))
    assert not case.stepper.stopping
    assert case.stepper.intervention == 0
    fresh = case.stepper._memory
    assert np.isfinite(fresh).all()
    for _ in range(5):
        case.stepper.step(measured(case, watch.robot) if estimates else watch.robot.motion)
    assert not case.stepper.stopping


def test_a_missing_pose_is_none_or_not_a_number():
    """Both say the same."""
    case = case_of("curvature-tracker", True, True)
    commands = []
    for nothing in (None, NO_FIX):
        robot = case.begin()
        senses = Senses(robot, Random(3))
        case.stepper.step(senses.measure())
        commands.append(
            [
                case.stepper.step(senses.measure()._replace(fix=nothing, left=None))
                for _ in range(40)
            ]
        )
    assert commands[0] == commands[1]


@pytest.mark.parametrize(
    ("kind", "begin"),
    [("frozen", 60), ("frozen", 120), ("frozen", 180), ("nan", 260), ("nan", 300)],
)
@pytest.mark.parametrize("curve", ["slalom", "lemniscate", "corner"])
def test_a_speed_that_is_not_known_drives_nothing(curve, kind, begin):
    case = case_of("curvature-tracker", False, True, "paper", curve, 1.5)
    slowest = []
    watch = watched(
        case, 900, lambda n, driven, stepper: slowest.append(driven.speed),
        [Span("speed", kind, begin, 9999, 0.0)],
    )  # fmt: skip
    assert not faults_of(watch)
    backwards = -0.01 * sum(speed for speed in slowest if speed < 0.0)
    assert backwards < 0.01  # m


@pytest.mark.parametrize("fix", [5, "x", (1.0,), (1.0, 2.0, 3.0, 0.0, 9.0), ("a", 0.0, 0.0, 0.0)])
def test_a_stop_is_asked_for_whatever_is_measured(fix):
    """What is no measurement is refused in words; the stop that came with it is kept."""
    case = case_of("curvature-tracker", True, True)
    good = Senses(case.begin(), Random(3)).measure()
    with pytest.raises(InvalidInput, match="must hold numbers"):
        case.stepper.step(good._replace(fix=fix), stop=True)
    case.stepper.step(good)
    assert case.stepper.stopping
    assert "from outside" in case.stepper.message
