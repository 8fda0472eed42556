"""The robot in MuJoCo against our own equations, and the tracker on it."""

import numpy as np
import pytest

from osculate import (
    Actuated,
    Arc,
    Continuous,
    CurvatureTracker,
    InitialState,
    InvalidInput,
    Limits,
    Mujoco,
    Sampled,
    Sensors,
    Tricycle,
    compare,
    simulate,
    simulate_batch,
    variable_names,
    vehicle_named,
)
from osculate.control.contract import Start
from osculate.plant import Push
from osculate.study.comparison.suite import CURVES, conditions, starts
from osculate.vehicle import Command

pytest.importorskip("mujoco")

CLOCK = Sampled(period=0.01, delay=0.01, duration=60.0)
ROBOTS = {
    "paper": Tricycle(),
    "tugger": vehicle_named("tugger"),
    "forklift": vehicle_named("forklift"),
}
H = 1e-3


def both(robot, start, command, seconds):
    """The same command on MuJoCo's robot and on ours (RK4): motions at the end, and the worst slip."""
    engine = Mujoco().robot(robot, start, H)
    part = Actuated().part(robot, start)
    kind, state = type(part.state), np.array(part.state)
    push = Push(0.0, 0.0, 0.0)

    def rates(y):
        return np.array(part.rates(kind(*y), command, push, part.parameters))

    slip = 0.0
    for _ in range(round(seconds / H)):
        engine.step(command)
        slip = max(slip, abs(engine.lateral_speed))
        k1 = rates(state)
        k2 = rates(state + H / 2 * k1)
        k3 = rates(state + H / 2 * k2)
        state = state + H / 6 * (k1 + 2 * k2 + 2 * k3 + rates(state + H * k3))
    return engine.measure(), part.measure(kind(*state), part.parameters), slip


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
@pytest.mark.core
def test_straight_ahead_the_torques_accelerate_as_ours_do(robot):
    push = 0.9 * robot.actuators.torque_limit
    start = Start(0.0, 0.0, 0.4, 0.0, 0.0, 0.0)
    theirs, ours, slip = both(robot, start, Command(0.0, push, push), 1.5)
    assert theirs.speed == pytest.approx(ours.speed, rel=0.02)
    assert (theirs.x, theirs.y) == pytest.approx((ours.x, ours.y), rel=0.03, abs=2e-3)
    assert slip < 1e-3


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_in_a_turn_the_wheels_roll_without_slipping(robot):
    bend = 0.5 / robot.wheelbase
    start = Start(0.0, 0.0, 0.0, 0.5, 0.0, bend)
    angle = float(np.arctan(robot.wheelbase * bend))
    rolling = robot.actuators.rolling_resistance * robot.weight * robot.wheel_radius / 2
    theirs, ours, slip = both(robot, start, Command(angle, rolling, rolling), 1.0)
    assert theirs.steering_angle == pytest.approx(angle, abs=5e-3)
    curvature = np.tan(theirs.steering_angle) / robot.wheelbase
    assert theirs.yaw_rate == pytest.approx(theirs.speed * curvature, rel=0.02)
    assert theirs.heading == pytest.approx(ours.heading, rel=0.05)
    assert slip < 0.02


def test_the_tracker_is_exact_on_a_robot_that_nobody_here_wrote():
    result = compare(
        {"ours": CurvatureTracker()}, start=starts(["on-path"]), condition=conditions(["mujoco"])
    )
    rms = [cell["cross_track_rms"] for cell in result.cells]
    assert not any(cell["failed"] for cell in result.cells)
    assert np.mean(rms) < 0.12e-3
    assert max(cell["cross_track_max"] for cell in result.cells) < 3e-3


def test_a_run_is_like_every_run(tmp_path):
    seen = []
    run = simulate(
        CURVES["slalom"], plant=Mujoco(), controller=CurvatureTracker(), clock=CLOCK,
        limits=Limits(speed=1.0), initial=InitialState(cross_track=0.2, settled=3.0),
        report=seen.append,
    )  # fmt: skip
    assert run.metrics.ended == "path end"
    assert run.metrics.cross_track_rms < 0.3e-3
    assert run.columns["cross_track_error"][0] == pytest.approx(0.2, abs=1e-6)
    assert run.data.sizes["time"] == len(run.columns["time"])
    assert run.save(tmp_path / "run.nc").is_file()
    assert seen == sorted(seen)
    ours = simulate(
        CURVES["slalom"], plant=Actuated(), controller=CurvatureTracker(), clock=CLOCK,
        limits=Limits(speed=1.0), initial=InitialState(cross_track=0.2, settled=3.0),
    )  # fmt: skip
    assert run.metrics.duration == pytest.approx(ours.metrics.duration, abs=0.05)


@pytest.mark.parametrize("seen", [{}, {"sensors": Sensors()}], ids=["exact", "noisy"])
def test_the_heading_goes_on_over_several_turns(seen):
    """Twice around: record, target and estimate turn as those of our own plant do."""
    circle = Arc(radius=0.7, angle=-4.0 * np.pi)
    clock, limits = Sampled(period=0.01, delay=0.01, duration=20.0), Limits(speed=1.0)
    theirs, ours = (
        simulate(circle, plant=p, controller=CurvatureTracker(), clock=clock, limits=limits, **seen)
        for p in (Mujoco(), Actuated())
    )
    assert theirs.metrics.ended == "path end"
    assert theirs.metrics.heading_error_max < 0.05
    names = ["heading", "target_heading", *(["estimated_heading"] if seen else [])]
    for name in names:
        turned = theirs.columns[name]
        assert np.abs(np.diff(turned[1:])).max() < 0.05, name
        assert turned[-1] - turned[1] == pytest.approx(-4.0 * np.pi, abs=0.05), name
    assert theirs.columns["heading"][-1] == pytest.approx(ours.columns["heading"][-1], abs=0.02)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda parts: simulate(CURVES["corner"], **parts, clock=Continuous()), "must be Sampled"),
        (lambda parts: simulate(Arc(radius=2, angle=1), plant=Mujoco()), "must be a path tracker"),
        (lambda parts: simulate_batch(CURVES["corner"], runs=2, clock=CLOCK, **parts), "one robot"),
        (lambda parts: simulate_batch(CURVES["corner"], runs=2, plant=Mujoco()), "one robot at a"),
        (lambda parts: variable_names(CURVES["corner"], plant=Mujoco()), "one robot at a time"),
    ],
)
def test_what_does_not_fit_is_explained(call, message):
    with pytest.raises(InvalidInput, match=message):
        call({"plant": Mujoco(), "controller": CurvatureTracker()})
