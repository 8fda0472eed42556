"""The safety layer: it leaves healthy robots alone and stops sick ones inside their corridor."""

import itertools
import math

import numpy as np
import pytest

from osculate import (
    Actuated,
    CurvatureTracker,
    InitialState,
    InvalidInput,
    Limits,
    Sampled,
    Stepper,
    Tricycle,
    simulate,
    simulate_batch,
)
from osculate.control import Safety
from osculate.control.safety import REASONS
from osculate.kernel.trace import plain
from osculate.plant import Late, Payload, SensorLoss, Sensors, SteeringOffset, StuckSteering
from osculate.plant import WheelWear as Wear
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import Motion
from osculate.vehicle.actuators import Steering, servo_move

LATERAL, CLOSE, LEAVING, BLIND, IMPOSSIBLE, DISOBEYED = 1, 3, 4, 5, 6, 7
HALF_WIDTH = 0.3
CLOCK = Sampled(period=0.01, delay=0.01, duration=60.0)
WORLD = {
    "controller": CurvatureTracker(), "plant": Actuated(), "sensors": Sensors(), "clock": CLOCK,
    "safety": Safety(half_width=HALF_WIDTH),
}  # fmt: skip
CELLS = [*itertools.product(CURVES.values(), (0.5, 1.0, 2.0), (1, 2, 3, 4))]
REAL = (Payload(mass=4.5), Wear(loss=0.02), SteeringOffset())


def drive_all(faults=(), **parts):
    """Every curve at every speed with a few seeds."""
    return simulate_batch(
        [curve for curve, _, _ in CELLS],
        **{**WORLD, "limits": [Limits(speed=speed) for _, speed, _ in CELLS], **parts},
        vary={"sensors.seed": [seed for _, _, seed in CELLS]},
        faults=faults, record_every=10,
    )  # fmt: skip


def column(batch, name):
    return batch.record[..., [variable.name for variable in batch.variables].index(name)]


@pytest.mark.parametrize("faults", [(), REAL], ids=["nominal", "real"])
def test_healthy_robots_are_left_alone(faults):
    batch = drive_all(faults)
    assert set(batch.metrics.ended) == {"path end"}
    assert (column(batch, "intervention") == 0.0).all()
    assert batch.metrics.cross_track_max.max() < 0.05


@pytest.mark.parametrize(
    ("fault", "reason", "aside"),
    [
        (StuckSteering(time=2.0), DISOBEYED, 0.1),
        (SensorLoss(sensor="pose", time=2.0), BLIND, 0.05),
        (Late(delay=0.06), DISOBEYED, 0.05),
    ],
    ids=["stuck", "blind", "late"],
)
def test_sick_robots_stop_inside_their_corridor(fault, reason, aside):
    batch = drive_all((fault,))
    assert set(batch.metrics.ended) == {"safety stop"}
    assert batch.metrics.cross_track_max.max() < aside < HALF_WIDTH
    assert set(column(batch, "intervention")[:, -1]) == {float(reason)}
    assert np.abs(column(batch, "speed")[:, -1]).max() < 0.03
    speeds = np.array([speed for _, speed, _ in CELLS])
    last = column(batch, "intervention") == reason
    begin = last.argmax(axis=1) * CLOCK.period
    assert (batch.metrics.duration - begin < 0.3 + speeds / 1.5).all()


def test_late_robots_stay_inside():
    batch = drive_all((Late(delay=0.04),))
    assert set(batch.metrics.ended) <= {"path end", "safety stop"}
    assert batch.metrics.cross_track_max.max() < 0.05


def test_a_stop_is_final_listed_and_explained():
    parts = {**WORLD, "limits": Limits(speed=1.0)}
    run = simulate(CURVES["slalom"], faults=(SensorLoss(sensor="pose", time=2.0),), **parts)
    (stop,) = run.interventions
    assert run.metrics.ended == "safety stop"
    assert stop.reason == REASONS[BLIND]
    patience = WORLD["safety"].patience
    assert stop.begin == pytest.approx(2.0 + patience, abs=0.03)  # the last pose is a little older
    assert stop.end == run.columns["time"][-1]
    assert run.message.startswith("ended at standstill at t = ")
    assert run.message.endswith("stopped: no pose")
    braking = run.columns["time"] > stop.begin + 0.1
    assert (np.diff(run.columns["target_speed"][braking]) <= 1e-12).all()


def test_the_corridor_alone_stops_a_robot():
    """Nobody looks at the steering: what is left is to stop before the corridor ends."""
    blunt = Safety(half_width=HALF_WIDTH, disobedience=10.0)
    batch = drive_all((StuckSteering(time=2.0),), safety=blunt)
    assert set(batch.metrics.ended) <= {"safety stop", "path end"}
    assert (batch.metrics.ended == "safety stop").mean() > 0.9
    reasons = column(batch, "intervention")
    print(
        np.unique(reasons),
        np.unique(reasons[:, -1]),
        batch.metrics.ended,
        batch.metrics.cross_track_max,
    )
    assert batch.metrics.cross_track_max.max() < HALF_WIDTH
    stopped = batch.metrics.ended == "safety stop"
    assert set(reasons[stopped, -1]) == {float(LEAVING)}
    assert (reasons[stopped] == CLOSE).any(axis=1).mean() > 0.5  # it slows down before


def test_a_short_silence_is_no_reason_to_stop():
    parts = {**WORLD, "limits": Limits(speed=1.0)}
    silence = SensorLoss(sensor="pose", time=2.0, duration=0.25)
    run = simulate(CURVES["slalom"], faults=(silence,), **parts)
    assert run.metrics.ended == "path end"
    assert run.interventions == []


def test_lateral_acceleration_is_limited():
    """A plan that asks for twice of what the safety layer allows."""
    free = drive_all(limits=Limits(speed=2.0), initial=InitialState(settled=3.0))
    guarded = drive_all(
        limits=Limits(speed=2.0), safety=Safety(half_width=HALF_WIDTH, lateral_acceleration=1.0)
    )
    strong, mild = (
        np.abs(column(batch, "speed") * column(batch, "yaw_rate")) for batch in (free, guarded)
    )
    assert (column(guarded, "intervention") == LATERAL).any()
    assert not (column(free, "intervention") == LATERAL).any()
    assert mild.mean() < 0.8 * strong.mean()
    assert mild.max() < 0.75 * strong.max()
    assert guarded.metrics.duration.mean() > free.metrics.duration.mean()
    assert set(guarded.metrics.ended) == {"path end"}
    assert guarded.metrics.cross_track_max.max() < HALF_WIDTH


def rehearse(change, seconds=4.0, safety=None):
    """A robot around a stepper; ``change`` falsifies its motion. Returns reasons, motions and commands.

    Args:
        change: (time, motion, motion before) -> what the stepper is told.
        seconds: How long.
        safety: What guards.
    """
    curve, robot, period = CURVES["slalom"], Tricycle(), 0.01
    stepper = Stepper(
        CurvatureTracker(), curve, limits=Limits(speed=1.0), safety=safety or Safety()
    )
    move, step = plain(servo_move), robot.actuators.servo(period)
    begin = curve.at(0.0)
    angle = math.atan(robot.wheelbase * float(begin.curvature))
    steering = Steering(angle, 0.0)
    motion = before = Motion(
        float(begin.x), float(begin.y), float(begin.heading), 0.0, 0.0, steering.angle
    )
    reasons, motions, commands, told, torque = [], [], [], angle, 0.0
    for n in range(round(seconds / period)):
        command = stepper.step(change(n * period, motion, before))
        reasons.append(stepper.intervention)
        motions.append(motion)
        commands.append(command)
        before = motion
        steering = move(steering, told, step)
        force = (torque - 0.1 * math.copysign(1.0, motion.speed)) / robot.wheel_radius
        speed = max(0.0, motion.speed + period * force / (robot.total_mass + 2.0))
        yaw = speed * math.tan(steering.angle) / robot.wheelbase
        heading = motion.heading + 0.5 * period * yaw
        motion = Motion(
            motion.x + period * speed * math.cos(heading),
            motion.y + period * speed * math.sin(heading),
            motion.heading + period * yaw, speed, yaw, steering.angle,
        )  # fmt: skip
        told, torque = command.steering_angle, command.torque_left + command.torque_right
    assert np.isfinite(commands).all()
    return np.array(reasons), motions, stepper


FROM = 2.0  # s, when motions become wrong


def wrong(part, **fields):
    """Motions of which some fields are wrong from some time on."""
    return lambda t, motion, before: motion._replace(**fields) if t >= FROM else motion


def jumped(t, motion, before):
    return motion._replace(y=motion.y + 0.5) if t >= FROM else motion


class Frozen:
    """A pose that stays where it was, while the robot moves."""

    kept = None

    def __call__(self, t, motion, before):
        if t < FROM:
            return motion
        self.kept = self.kept or motion
        return motion._replace(x=self.kept.x, y=self.kept.y)


@pytest.mark.parametrize(
    "change",
    [
        jumped,
        Frozen(),
        *[wrong(name, **{name: math.nan}) for name in Motion._fields if name != "yaw_rate"],
        wrong("all", **dict.fromkeys(Motion._fields, math.nan)),
        wrong("y", y=math.inf),
    ],
    ids=["jump", "frozen", "x", "y", "heading", "speed", "angle", "all", "infinite"],
)
def test_impossible_motions_stop_the_robot(change):
    reasons, motions, stepper = rehearse(change)
    patience = Safety().patience
    (first,) = np.flatnonzero(np.diff(reasons)) + 1
    assert reasons[-1] == IMPOSSIBLE
    assert first * 0.01 == pytest.approx(FROM + patience, abs=0.03)
    assert stepper.stopping
    assert motions[-1].speed < 0.02
    assert max(abs(m.y) for m in motions) < 0.9  # the slalom is half a metre wide


def test_a_yaw_rate_that_is_no_number_stops_the_robot():
    reasons, motions, _ = rehearse(wrong("yaw_rate", yaw_rate=math.nan))
    assert reasons[-1] == IMPOSSIBLE
    assert motions[-1].speed < 0.02


@pytest.mark.parametrize(
    "wrongly",
    [
        lambda m: m._replace(y=m.y + 0.5),
        lambda m: m._replace(x=math.nan),
        lambda m: m._replace(steering_angle=math.nan),
        lambda m: m._replace(yaw_rate=math.nan),
    ],
    ids=["jump", "x", "angle", "yaw_rate"],
)
def test_a_single_wrong_motion_does_nothing(wrongly):
    def once(t, motion, before):
        return wrongly(motion) if abs(t - FROM) < 1e-9 else motion

    reasons, motions, stepper = rehearse(once)
    assert (reasons == 0).all()
    assert not stepper.stopping
    assert motions[-1].speed > 0.9
    assert max(abs(m.y) for m in motions) < 0.52


def test_steering_that_does_not_obey_stops_the_robot():
    reasons, motions, _ = rehearse(wrong("angle", steering_angle=0.5))
    assert reasons[-1] == DISOBEYED
    assert motions[-1].speed < 0.02


def test_a_narrow_corridor_is_not_left():
    """The curve leaves the robot: it can only slow down and stop."""
    start = InitialState(cross_track=0.2, heading_error=0.3)
    parts = {**WORLD, "limits": Limits(speed=1.0), "initial": start}
    run = simulate(CURVES["slalom"], **{**parts, "safety": Safety(half_width=0.25)})
    assert run.metrics.cross_track_max < 0.25


@pytest.mark.parametrize("field", ["half_width", "deceleration", "patience", "jump", "friction"])
def test_limits_of_nothing_are_refused(field):
    with pytest.raises(InvalidInput, match=field):
        Safety(**{field: 0.0})


def test_a_law_without_a_path_cannot_be_guarded():
    with pytest.raises(InvalidInput, match="safety = .*needs a path tracker"):
        simulate(CURVES["cycloid"], safety=Safety())
