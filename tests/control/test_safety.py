"""The safety layer: it stops in time, says why, and otherwise keeps out of the way."""

import math

import numpy as np
import pytest

from osculate import (
    CurvatureTracker,
    Late,
    Limits,
    Payload,
    PurePursuit,
    Safety,
    Sampled,
    SensorLoss,
    Sensors,
    Stepper,
    StuckSteering,
    simulate,
    simulate_batch,
)
from osculate.control.safety import REASONS
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import VEHICLES, Motion

CELLS = [(c, v) for c in CURVES for v in (0.5, 1.0, 2.0)]
WIDTH = 0.3


def guarded(*faults, law=None):
    return simulate_batch(
        [CURVES[c] for c, _ in CELLS],
        limits=[Limits(speed=v) for _, v in CELLS],
        sensors=[Sensors(seed=n) for n in range(len(CELLS))],
        controller=law or CurvatureTracker(),
        safety=Safety(half_width=WIDTH),
        faults=faults,
        record_every=10,
    )


def reasons(batch):
    column = [v.name for v in batch.variables].index("intervention")
    return {int(number) for number in np.unique(batch.record[..., column])} - {0}


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        (StuckSteering(time=2.0), "stopped: the steering does not obey"),
        (SensorLoss(sensor="pose", time=2.0), "stopped: no pose"),
    ],
    ids=["stuck", "blind"],
)
def test_it_stops_inside_the_corridor_in_every_run(fault, reason):
    batch = guarded(fault)
    assert set(batch.metrics.ended) == {"safety stop"}
    assert batch.metrics.cross_track_max.max() < WIDTH
    assert reason in {REASONS[number] for number in reasons(batch)}


def test_a_delay_that_nobody_knows_stops_only_who_would_leave():
    batch = guarded(Late(delay=0.06))
    assert batch.metrics.cross_track_max.max() < WIDTH
    assert set(batch.metrics.ended) == {"path end"}


def test_other_laws_are_guarded_as_well():
    batch = guarded(StuckSteering(time=2.0), law=PurePursuit())
    assert set(batch.metrics.ended) == {"safety stop"}
    assert batch.metrics.cross_track_max.max() < WIDTH


def test_it_keeps_out_of_the_way():
    batch = guarded()
    assert set(batch.metrics.ended) == {"path end"}
    assert not reasons(batch)


def test_no_robot_is_stopped_where_nothing_is_wrong():
    """Narrow corridors, noise, up to a fifth more mass; all that there is: benchmarks/false_stops.py."""
    cells = [(VEHICLES[r], CURVES[c]) for r in VEHICLES for c in ("slalom", "corner")] * 2
    batch = simulate_batch(
        [curve for _, curve in cells],
        [robot for robot, _ in cells],
        limits=[Limits(speed=1.5)] * len(cells),
        sensors=[Sensors(seed=n) for n in range(len(cells))],
        controller=CurvatureTracker(),
        safety=Safety(half_width=0.1),
        faults=[
            (Payload(mass=(0.01, 0.2)[2 * n // len(cells)] * robot.total_mass),)
            for n, (robot, _) in enumerate(cells)
        ],
        clock=Sampled(period=0.01, delay=0.01, duration=30.0),
        record_every=100,
    )
    assert set(batch.metrics.ended) == {"path end"}
    assert batch.metrics.cross_track_max.max() < 0.1


def test_a_run_tells_what_was_done_and_why():
    run = simulate(
        CURVES["slalom"], controller=CurvatureTracker(), limits=Limits(speed=1.0),
        safety=Safety(), faults=(StuckSteering(time=2.5),),
    )  # fmt: skip
    assert run.metrics.ended == "safety stop"
    assert "the steering does not obey" in run.verdict.sentence
    last = run.interventions[-1]
    assert last.begin > 2.5
    assert last.reason == REASONS[7]
    assert abs(run.columns["speed"][-1]) < 0.01


def test_lateral_acceleration_is_limited_whatever_the_plan_says():
    parts = {"controller": CurvatureTracker(), "limits": Limits(speed=2.0)}
    run = simulate(CURVES["lemniscate"], safety=Safety(lateral_acceleration=1.0), **parts)
    assert REASONS[1] in {i.reason for i in run.interventions}
    calm = run.columns["time"] > 2.0
    pull = np.abs(run.columns["speed"] * run.columns["yaw_rate"])[calm]
    assert np.quantile(pull, 0.99) < 1.4


def stepper_at(speed):
    curve = CURVES["slalom"]
    start = curve.at(0.0)
    motion = Motion(float(start.x), float(start.y), float(start.heading), speed, 0.0, 0.0)
    stepper = Stepper(CurvatureTracker(), curve, safety=Safety(), motion=motion)
    return stepper, motion


@pytest.mark.parametrize(
    "change",
    [
        lambda m, n: m,  # frozen
        lambda m, n: m._replace(x=math.nan),
        lambda m, n: m._replace(x=m.x + 5.0 + n),
    ],
    ids=["frozen", "missing", "jumping"],
)
def test_impossible_measurements_stop_the_robot(change):
    stepper, motion = stepper_at(0.5)
    stepper.step(motion)
    commands = [stepper.step(change(motion, n)) for n in range(60)]
    assert stepper.stopping
    assert REASONS[stepper.intervention].startswith("stopped")
    assert np.isfinite(commands).all()
