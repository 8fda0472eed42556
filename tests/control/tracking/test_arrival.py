"""At the end of an open path the robot stands: in the simulator, and on a robot of the tests' own."""

import math
from functools import cache
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.closed_loop import Case
from control.kinematic import IDLE, Senses
from osculate import (
    Actuated,
    Chain,
    CurvatureTracker,
    Limits,
    PurePursuit,
    Sampled,
    Segment,
    Sensors,
    Slope,
    Stanley,
    Stepper,
    simulate,
    simulate_batch,
)
from osculate.control.tracking.arrival import LEAST, ArrivalParameters, arrival_speed
from osculate.simulation.loop import ROLLED
from osculate.study.comparison.tuned import trackers_for
from osculate.vehicle import VEHICLES

STANDS = 1e-3  # m/s
LAWS = ("curvature-tracker", "pure-pursuit")
PERIOD = 0.01  # s
#: The longest way (s) of the last centimetre. A robot of known mass takes less than half of that.
LAST = {0.01: 0.6, 0.04: 0.8}


def bend(straight, sharpness, turn):
    """A line, a clothoid, and an arc on which the path ends."""
    curvature = sharpness * turn
    return Chain(
        segments=(
            Segment(length=straight),
            Segment(length=turn, end_curvature=curvature),
            Segment(length=0.5 * turn, curvature=curvature),
        )
    )


numbers = st.floats
parameters = st.builds(
    ArrivalParameters, numbers(0.0, 50.0), numbers(0.05, 3.0), numbers(0.05, 0.5)
)


@given(parameters, numbers(0.0, 5.0))
def test_the_speed_falls_to_the_end_no_harder_than_the_deceleration(p, left):
    speed, later = arrival_speed(p.end - left, p), arrival_speed(p.end - left + 1e-4, p)
    assert speed >= later >= LEAST
    braking = (speed**2 - later**2) / 2e-4
    assert braking <= p.deceleration * (1.0 + 1e-6) + 1e-9
    assert speed <= math.sqrt(2.0 * p.deceleration * left) + LEAST


@given(parameters)
def test_both_parts_of_the_speed_join_with_the_same_slope(p):
    joint = p.deceleration * p.time**2
    if joint / p.time < 2.0 * LEAST:
        return
    before, at, after = (arrival_speed(p.end - joint * (1.0 + d), p) for d in (1e-4, 0.0, -1e-4))
    assert at == pytest.approx(p.deceleration * p.time, rel=1e-9)
    assert before - at == pytest.approx(at - after, rel=1e-2, abs=1e-9)


def test_a_robot_that_passes_the_end_is_not_bounded():
    assert arrival_speed(1e3, ArrivalParameters(math.inf, 0.8, 0.1)) == math.inf


def last_way(run, distance):
    """Time (s) for the last ``distance`` (m) of the path."""
    time, left = run.columns["time"], run.setup.curve.length - run.columns["foot"]
    return float(time[-1] - time[np.argmax(left < distance)])


def arrived(run):
    """Distance from the end along the path (m) of a run that ended there; negative before it."""
    assert run.metrics.ended == "path end"
    assert abs(run.columns["speed"][-1]) < STANDS
    return float(run.columns["foot"][-1] - run.setup.curve.length)


@pytest.mark.parametrize("name", VEHICLES)
@pytest.mark.parametrize(("law", "delay"), [(LAWS[0], 0.01), (LAWS[0], 0.04), (LAWS[1], 0.01)])
def test_a_robot_comes_to_rest_at_the_end(name, law, delay):
    robot = VEHICLES[name]

    @settings(max_examples=5)
    @given(
        straight=numbers(0.5, 3.0), turn=numbers(0.5, 2.0), sharpness=numbers(-0.2, 0.2),
        speed=numbers(0.2, 2.0), load=st.sampled_from((0.0, 0.2)), lag=numbers(0.5, 2.0),
    )  # fmt: skip
    def drive(straight, turn, sharpness, speed, load, lag):
        body = robot.but(actuators=robot.actuators.but(motor_lag=lag * robot.actuators.motor_lag))
        run = simulate(
            bend(straight, sharpness, turn), body, controller=trackers_for(robot)[law],
            plant=Actuated(payload=load * robot.total_mass), limits=Limits(speed=speed),
            clock=Sampled(period=PERIOD, delay=delay, duration=60.0),
        )  # fmt: skip
        assert abs(arrived(run)) < 1e-3
        assert run.metrics.duration < run.plan.duration + 1.5
        assert last_way(run, 0.01) < (1.5 if load else LAST[delay])

    drive()


@pytest.mark.parametrize("name", VEHICLES)
def test_seen_through_noise_it_is_within_five_millimetres(name):
    robot, curve = VEHICLES[name], bend(1.5, 0.1, 1.0)
    for seed, load in ((1, 0.0), (2, 0.2), (3, 0.0)):
        run = simulate(
            curve, robot, controller=CurvatureTracker(), limits=Limits(speed=1.0),
            plant=Actuated(payload=load * robot.total_mass), sensors=Sensors(seed=seed),
        )  # fmt: skip
        assert abs(arrived(run)) < 5e-3
        assert last_way(run, 0.01) < 1.5


case_of = cache(Case)


def closed_loop(case, noise=0.0):
    """The tests' own robot a second after the stepper says that it stands at the end."""
    robot = case.begin()
    senses, acting, later = Senses(robot, Random(1), noise=noise), [IDLE] * 5, 0
    slots = round(case.delay / PERIOD)
    for _ in range(4000):
        measured = senses.measure() if case.estimates else robot.motion
        acting = [case.stepper.step(measured), *acting[:4]]
        robot.move(acting[slots], PERIOD)
        if case.stepper.finished:
            assert case.stepper.standing
            later += 1
        if later == 100:
            break
    return robot


def beyond(case, robot):
    """Distance along the path (m) by which a robot stands beyond the end."""
    end = case.path.at(case.path.length)
    dx, dy, heading = robot.x - float(end.x), robot.y - float(end.y), float(end.heading)
    return dx * math.cos(heading) + dy * math.sin(heading)


@pytest.mark.parametrize("robot", VEHICLES)
@pytest.mark.parametrize("delay", [0.01, 0.04])
def test_a_robot_of_ones_own_stands_at_the_end(robot, delay):
    case = case_of("curvature-tracker", False, False, robot, "corner", 1.0, delay)
    driven = closed_loop(case)
    assert case.stepper.finished
    assert abs(driven.speed) < STANDS
    assert abs(beyond(case, driven)) < 1e-3


@pytest.mark.parametrize("robot", VEHICLES)
def test_a_robot_of_ones_own_with_noise_stands_within_five_millimetres(robot):
    case = case_of("curvature-tracker", True, True, robot, "corner")
    driven = closed_loop(case, noise=1.0)
    assert case.stepper.finished
    assert abs(driven.speed) < STANDS
    assert abs(beyond(case, driven)) < 5e-3


def test_a_speed_at_the_end_is_passed_with_that_speed():
    run = simulate(
        bend(2.0, 0.1, 1.0), controller=CurvatureTracker(), limits=Limits(speed=1.0, end_speed=0.4)
    )
    assert run.metrics.ended == "path end"
    assert run.columns["speed"][-1] == pytest.approx(0.4, abs=0.02)
    assert run.columns["foot"][-1] == pytest.approx(run.setup.curve.length, abs=1e-6)


def test_an_end_speed_of_zero_is_rest():
    run = simulate(bend(2.0, 0.1, 1.0), controller=CurvatureTracker(), limits=Limits(end_speed=0.0))
    assert abs(arrived(run)) < 1e-3


def test_a_stepper_that_passes_the_end_is_finished_moving():
    curve = bend(1.0, 0.0, 0.5)
    stepper = Stepper(CurvatureTracker(), curve, limits=Limits(end_speed=0.4))
    case = case_of("curvature-tracker", False, False)
    robot, acting = case.begin(), IDLE
    robot.x, robot.y, robot.heading, robot.angle = 0.0, 0.0, 0.0, 0.0
    while not stepper.finished:
        assert robot.x < curve.length + 0.02
        command = stepper.step(robot.motion)
        robot.move(acting, PERIOD)
        acting = command
    assert robot.speed == pytest.approx(0.4, abs=0.05)
    assert not stepper.standing


def test_lanes_come_to_rest_as_single_runs_do():
    curve, law, speeds = bend(1.0, 0.1, 0.8), CurvatureTracker(), (0.5, 1.0)
    many = simulate_batch(
        [curve] * 2, controller=law, plant=Actuated(), limits=[Limits(speed=v) for v in speeds],
        clock=Sampled(period=PERIOD, delay=PERIOD, duration=20.0),
    )  # fmt: skip
    for n, speed in enumerate(speeds):
        alone = simulate(curve, controller=law, limits=Limits(speed=speed))
        assert many.metrics.ended[n] == alone.metrics.ended == "path end"
        assert many.metrics.duration[n] == alone.metrics.duration
        assert many.metrics.end_position_error[n] == alone.metrics.end_position_error


@pytest.mark.parametrize("law", [CurvatureTracker(), Stanley(), PurePursuit()])
def test_a_closed_curve_is_done_after_its_length_moving(law):
    from osculate.study.comparison.suite import CURVES

    run = simulate(CURVES["lemniscate"], controller=law)
    assert run.metrics.ended == "path end"
    assert run.columns["speed"][-1] > 0.3


def test_a_robot_without_a_brake_that_rolls_away_downhill_is_not_followed_for_ever():
    run = simulate(bend(1.0, 0.0, 0.5), controller=CurvatureTracker(), faults=(Slope(grade=-0.02),))
    assert run.metrics.ended == "path end"
    assert run.columns["foot"][-1] <= run.setup.curve.length + ROLLED + 1e-6
