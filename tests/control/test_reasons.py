"""Every reason for which a robot is slowed down, stopped or kept waiting, each alone."""

import math
from functools import cache
from random import Random

import numpy as np
import pytest

from control.closed_loop import MOTION, Case
from control.kinematic import IDLE, Corrupter, Senses, Span
from osculate import CurvatureTracker, Limits, PurePursuit, Safety, Stepper
from osculate.control.reasons import REASONS
from osculate.kernel import leaves, rebuild
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import Motion
from osculate.vehicle.catalogue import PAPER

case_of = cache(Case)
PERIOD = 0.01


def drive(case, steps, spans=(), disturb=None):
    """Numbers of all interventions of a run (0 is none), and the robot."""
    robot = case.begin()
    senses, corrupter = Senses(robot, Random(2)), Corrupter(tuple(spans), Random(2))
    acting, seen = IDLE._replace(steering_angle=robot.angle), set()
    for n in range(steps):
        if disturb:
            disturb(n, robot, case.stepper)
        true = senses.measure() if case.estimates else robot.motion
        command = case.stepper.step(corrupter.spoil(true, n))
        seen.add(int(case.stepper.memory.alarm.reason))
        robot.move(acting, PERIOD)
        acting = command
    return seen, robot


def lost(*names, begin=200):
    return [Span(name, "nan", begin, 10_000, 0.0) for name in names]


def moving(curve, s, speed, aside=0.0, turned=0.0, law=CurvatureTracker, **safety):
    """A stepper after one step of a robot that moves along a curve, and its robot's motion."""
    p = CURVES[curve].at(s)
    heading = float(p.heading)
    x, y = float(p.x) - aside * math.sin(heading), float(p.y) + aside * math.cos(heading)
    bend = float(p.curvature)
    angle = math.atan(PAPER.wheelbase * bend)
    motion = Motion(x, y, heading + turned, speed, speed * bend, angle)
    stepper = Stepper(
        law(), CURVES[curve], limits=Limits(speed=2.0), motion=motion, progress=s,
        safety=Safety(**safety),
    )  # fmt: skip
    return stepper, motion


def reason_of(*place, **fields):
    stepper, motion = moving(*place, **fields)
    stepper.step(motion)
    return stepper.intervention, stepper


def test_all_is_well():
    for estimates in (True, False):
        assert drive(case_of("curvature-tracker", estimates, True), 600)[0] == {0}


def test_1_lateral_acceleration():
    place = ("lemniscate", 0.3, 1.5)
    number, stepper = reason_of(*place, lateral_acceleration=1.2)
    assert number == 1
    assert reason_of(*place)[0] == 0
    assert not stepper.stopping


def test_2_steering_rate():
    """On the ramp into a corner the servo cannot follow at 2.6 m/s."""
    assert reason_of("corner", 2.1, 2.6, law=PurePursuit)[0] == 2
    assert reason_of("corner", 2.1, 1.5, law=PurePursuit)[0] == 0


def test_3_close_to_the_border():
    number, stepper = reason_of("slalom", 1.0, 0.3, aside=0.22)
    assert number == 3
    assert not stepper.stopping


def test_4_would_leave():
    number, stepper = reason_of("slalom", 1.0, 1.5, aside=0.2, turned=0.4)
    assert number == 4
    assert stepper.stopping
    assert stepper.alarm.excess > 0.0
    assert "would leave the corridor by" in stepper.message


@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_5_no_pose(estimates):
    case = case_of("curvature-tracker", estimates, True)
    seen, robot = drive(case, 700, lost(*(("x",) if estimates else MOTION)))
    assert seen == {0, 5}
    assert robot.speed == pytest.approx(0.0, abs=1e-3)


def test_6_impossible():
    turned = [Span("heading", "jump", 200, 10_000, 1.0)]
    assert drive(case_of("curvature-tracker", False, True), 500, turned)[0] == {0, 6}


@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_7_steering_does_not_obey(estimates):
    def stick(n, robot, stepper):
        robot.stuck = n > 250

    case = case_of("curvature-tracker", estimates, True)
    seen, robot = drive(case, 700, disturb=stick)
    assert 7 in seen
    assert seen <= {0, 3, 7}
    assert robot.speed == pytest.approx(0.0, abs=1e-3)


def test_8_no_wheel_encoders():
    case = case_of("curvature-tracker", True, True)
    seen, robot = drive(case, 700, lost("left"))
    assert seen == {0, 8}
    assert robot.speed == pytest.approx(0.0, abs=1e-3)


def test_9_outside_before_the_start():
    number, stepper = reason_of("slalom", 0.0, 0.0, aside=0.35)
    assert number == 9
    assert stepper.alarm.excess == pytest.approx(0.05, abs=1e-3)


def test_10_from_outside():
    case = case_of("curvature-tracker", True, True)
    seen, _ = drive(case, 500, disturb=lambda n, robot, stepper: n == 200 and stepper.stop())
    assert seen == {0, 10}


def test_11_no_finite_decision():
    """A law that says NaN is not followed: the angle stays, and after a tenth of a second it is a stop."""
    stepper = Stepper(PurePursuit(), CURVES["slalom"], safety=Safety())
    motion = Motion(0.0, 0.0, float(CURVES["slalom"].at(0.0).heading), 0.5, 0.0, 0.0)
    before = stepper.step(motion)
    whole = stepper._part(None, 0.0).parameters
    where = rebuild(whole, iter(range(len(list(leaves(whole)))))).steer.wheelbase
    stepper._parameters[where] = math.nan
    seen = []
    for n in range(1, 40):
        at = CURVES["slalom"].at(0.005 * n)
        near = Motion(float(at.x), float(at.y), float(at.heading), 0.5, 0.0, 0.0)
        command = stepper.step(near)
        assert np.isfinite(command).all()
        assert command.steering_angle == before.steering_angle
        seen.append(stepper.intervention)
    assert set(seen[:9]) == {0}
    assert set(seen[13:]) == {11}
    assert stepper.not_finite == 39
    assert "steering law" in stepper.message


@pytest.mark.parametrize("estimates", [True, False], ids=["measurement", "motion"])
def test_12_waiting_for_a_pose(estimates):
    case = case_of("curvature-tracker", estimates, True)
    seen, robot = drive(case, 100, lost(*(("x",) if estimates else MOTION), begin=0))
    assert seen == {12}
    assert robot.speed == 0.0


@pytest.mark.parametrize(("name", "reason"), [("steering_angle", 13), ("yaw_rate", 14)])
def test_13_and_14_it_goes_on_without_what_can_be_spared(name, reason):
    case = case_of("curvature-tracker", True, True)
    seen, robot = drive(case, 700, lost(name))
    assert seen == {0, reason}
    assert robot.speed > 0.1
    assert not case.stepper.stopping


def test_15_the_end_of_the_path_is_no_alarm():
    case = case_of("curvature-tracker", False, True)
    seen, _ = drive(case, 2500)
    assert seen == {0}
    assert case.stepper.intervention == 0
    assert case.stepper.arrived


def test_every_reason_is_here():
    numbers = {part for name in globals() if name.startswith("test_") for part in name.split("_")}
    assert {str(n) for n in REASONS} <= numbers
