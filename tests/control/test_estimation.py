"""The estimator: consistent, unbiased in the end, untroubled by late and wrong poses, bit-identical."""

import math

import numpy as np
import pytest

from osculate import (
    CurvatureTracker,
    Ekf,
    InitialState,
    InvalidInput,
    Limits,
    Payload,
    Sampled,
    Sensors,
    SteeringOffset,
    Stepper,
    Tricycle,
    WheelWear,
    simulate,
    simulate_batch,
)
from osculate.control.estimation.belief import Place
from osculate.control.estimation.filter import estimate_kinematics
from osculate.control.estimation.readings import place_then
from osculate.kernel import rebuild
from osculate.kernel.trace import plain
from osculate.plant.faults import HEARD
from osculate.plant.sensors import sense_noisily
from osculate.simulation.blocks import Block, run_block, single_block
from osculate.simulation.loop import close_loop, estimator_of
from osculate.simulation.run import make_setup
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import Motion
from osculate.vehicle.measurement import NO_FIX, Measurement
from osculate.vehicle.motion import Wheels

SEEDS = 64
CLOCK = Sampled(period=0.01, delay=0.01, duration=8.0)


def close(**parts):
    parts = {
        "controller": CurvatureTracker(), "limits": Limits(speed=1.0), "sensors": Sensors(),
        "clock": CLOCK, **parts,
    }  # fmt: skip
    return close_loop(make_setup(CURVES["lemniscate"], None, parts))


def drive(loop):
    """Truth, belief (leaves of shape (seeds,)) of many runs with seeds of their own."""
    columns = [single_block(close(**{**parts_of(loop), "sensors": s})) for s in sensors_of(loop)]
    block = Block(*(np.hstack(arrays) for arrays in zip(*columns, strict=True)))
    done = run_block(loop, block)
    clock = loop.setup.clock
    loop.decider(SEEDS).decide_block(
        done.runs, done.minds, block.thoughts, loop.tables, clock.duration, clock.period
    )
    run = rebuild(loop.initial, iter(done.runs))
    return run.state.plant, rebuild(loop.mind, iter(done.minds)).memory.belief


def parts_of(loop):
    return {
        name: part for name, part in loop.setup._asdict().items() if name in ("faults", "clock")
    }


def sensors_of(loop):
    return [loop.setup.sensors.model_copy(update={"seed": s}) for s in range(SEEDS)]


@pytest.fixture(scope="module")
def believed():
    return drive(close())


def test_what_it_claims_to_know_is_what_it_knows(believed):
    """Normalised estimation error squared of pose and speed: mean near its degrees of freedom."""
    truth, belief = believed
    names = ("x", "y", "heading", "speed")
    error = np.array([getattr(belief.mean, n) - getattr(truth, n) for n in names])
    rows = [[getattr(getattr(belief.covariance, a), b) for b in names] for a in names]
    nees = [
        e @ np.linalg.solve(p, e) for e, p in zip(error.T, np.moveaxis(rows, 2, 0), strict=True)
    ]
    assert 0.5 < np.mean(nees) / len(names) < 1.4
    assert (np.array(nees) < 25.0).all()


def test_poses_surprise_as_much_as_they_should(believed):
    _, belief = believed
    assert 0.8 < belief.evidence.surprise.mean() < 1.2
    assert np.mean(belief.fix_nis) == pytest.approx(3.0, abs=1.0)


def test_the_covariance_stays_symmetric_and_positive(believed):
    _, belief = believed
    matrix = np.moveaxis(np.array(belief.covariance), 2, 0)
    assert matrix == pytest.approx(np.swapaxes(matrix, 1, 2), abs=1e-12)
    assert (np.linalg.eigvalsh(matrix) > 0.0).all()


def test_it_learns_what_the_description_does_not_say():
    faults = (SteeringOffset(angle=0.0175), WheelWear(loss=0.02), Payload(mass=4.5))
    _, belief = drive(close(faults=faults, clock=CLOCK))
    m = belief.mean
    assert m.steering_bias.mean() == pytest.approx(0.0175, abs=2e-3)
    assert m.speed_scale.mean() == pytest.approx(1.0 / 0.98 - 1.0, abs=3e-3)
    assert m.gyro_bias.mean() == pytest.approx(Sensors().gyro_bias, abs=2e-3)


def error(sensors, **parts):
    """Mean RMS (mm) over the curves at three speeds."""
    cells = [(c, v) for c in CURVES for v in (0.5, 1.0, 2.0)]
    batch = simulate_batch(
        [CURVES[c] for c, _ in cells],
        limits=[Limits(speed=v) for _, v in cells],
        sensors=[sensors.model_copy(update={"seed": n}) for n in range(len(cells))],
        controller=CurvatureTracker(),
        initial=InitialState(settled=3.0),
        **parts,
    )
    assert (batch.metrics.ended == "path end").all()
    return 1e3 * float(batch.metrics.cross_track_rms.mean())


def test_the_tracker_stays_within_two_millimetres_on_a_robot_it_does_not_know():
    faults = (SteeringOffset(angle=0.0175), WheelWear(loss=0.02), Payload(mass=4.5))
    assert error(Sensors(), faults=faults) < 1.6


def test_late_lost_and_wrong_poses_cost_little():
    bad = Sensors(pose_latency=0.04, pose_jitter=0.03, pose_dropout=0.2, pose_outliers=0.05)
    assert error(bad) < 1.5 * error(Sensors()) + 0.3


def test_a_late_pose_meets_the_place_where_it_was_taken():
    trail = tuple(Place(1.0 - 0.1 * n, 0.2 * n, 0.01 * n) for n in range(4))
    assert place_then(trail, 2.0) == pytest.approx(trail[2])
    assert place_then(trail, 1.5) == pytest.approx((0.85, 0.3, 0.015))


def test_compiled_and_uncompiled_agree_bit_for_bit():
    loop = close()
    p, memory = loop.thought.control.estimator, loop.mind.memory
    fix = NO_FIX._replace(
        x=memory.belief.mean.x, y=0.01, heading=memory.belief.mean.heading, age=0.01
    )
    for measured in (
        Measurement(0.1, 0.12, 0.2, 0.3, fix),
        Measurement(0.1, math.nan, 0.2, 0.3, NO_FIX),
    ):
        arguments = (measured, memory.told, memory.belief, p)
        assert str(estimate_kinematics(*arguments)) == str(plain(estimate_kinematics)(*arguments))


def test_a_lane_is_the_single_run_in_any_company():
    parts = {
        "controller": CurvatureTracker(), "limits": Limits(speed=1.0),
        "clock": CLOCK.model_copy(update={"duration": 1.0}),
    }  # fmt: skip
    seeds = [9.0, 2.0, 5.0]
    batch = simulate_batch(
        CURVES["slalom"], sensors=Sensors(), vary={"sensors.seed": seeds}, record_every=1, **parts
    )
    run = simulate(CURVES["slalom"], sensors=Sensors(seed=5), **parts)
    for column, variable in enumerate(batch.variables):
        lane = batch.record[2, :, column]
        assert (lane == run.columns[variable.name][: len(lane)]).all(), variable.name
    assert (batch.record[0] != batch.record[2]).any()


def test_the_stepper_is_the_engines_pilot():
    """On a robot at rest that hears the same, both decide the same."""
    curve, sensors = CURVES["slalom"], Sensors(seed=3)
    setup = make_setup(curve, None, {"controller": CurvatureTracker(), "sensors": sensors})
    stepper = Stepper(CurvatureTracker(), curve, Tricycle(), estimator=estimator_of(setup))
    run = simulate(
        curve, controller=CurvatureTracker(), sensors=sensors,
        clock=Sampled(period=0.01, delay=0.01, duration=0.05),
    )  # fmt: skip
    p, memory = sensors.part(0.01, HEARD)
    c = run.columns
    start = Motion(
        *(float(c[n][0]) for n in ("x", "y", "heading", "speed", "yaw_rate", "steering_angle"))
    )
    measured, _ = sense_noisily(start, Wheels(0.0, 0.0), memory, p)
    command = stepper.step(measured)
    acting = np.flatnonzero(np.diff(c["commanded_steering_angle"]))[0] + 1
    assert command.steering_angle == c["commanded_steering_angle"][acting]
    assert command.torque_left == c["torque_left"][acting]
    assert stepper.belief.mean.x == c["estimated_x"][0]


def test_what_is_measured_has_to_fit():
    with pytest.raises(InvalidInput, match="must be a Measurement"):
        Stepper(CurvatureTracker(), CURVES["slalom"], estimator=Ekf()).step(Motion(*[0.0] * 6))
    with pytest.raises(InvalidInput, match=r"measured = None: must be a Motion"):
        Stepper(CurvatureTracker(), CURVES["slalom"]).step(None)
    with pytest.raises(InvalidInput, match="needs sensors"):
        simulate(CURVES["slalom"], controller=CurvatureTracker(), estimator=Ekf())
    with pytest.raises(InvalidInput, match="needs a path tracker"):
        simulate(CURVES["cycloid"], sensors=Sensors())
