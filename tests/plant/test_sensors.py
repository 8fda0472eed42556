"""Sensors: reproducible whatever the company, as noisy as stated, late and lost as stated."""

import math

import numba
import numpy as np
import pytest

from osculate import (
    Actuated,
    CurvatureTracker,
    InvalidInput,
    Limits,
    Sampled,
    simulate,
    simulate_batch,
)
from osculate.control import Safety
from osculate.kernel import leaves
from osculate.plant import Sensors
from osculate.plant.faults import HEARD, SILENT
from osculate.plant.sensors import Outage, sense_noisily
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import Motion
from osculate.vehicle.motion import Wheels

PERIOD = 0.01
WORLD = {
    "controller": CurvatureTracker(), "plant": Actuated(), "safety": Safety(),
    "limits": Limits(speed=1.0), "clock": Sampled(period=PERIOD, delay=0.01, duration=1.5),
}  # fmt: skip
EXACT = Sensors(
    position_noise=0, heading_noise=0, wheel_noise=0, steering_noise=0, gyro_noise=0, gyro_bias=0
)
LATE = {"pose_latency": 0.06, "pose_jitter": 0.05}


@numba.njit
def record(memory, p, out):
    """Measurements of a robot that is at x = number of the instant and stands."""
    for n in range(len(out)):
        motion = Motion(float(n), 2.0, 0.3, 0.4, 0.5, 0.6)
        seen, memory = sense_noisily(motion, Wheels(0.7, 0.8), memory, p)
        fix = seen.fix
        out[n] = (
            seen.left, seen.right, seen.steering_angle, seen.yaw_rate,
            fix.x, fix.y, fix.heading, fix.age,
        )  # fmt: skip


def heard(sensors, instants, outages=HEARD):
    """Columns: left, right, steering angle, yaw rate, x, y, heading and age of the pose."""
    parameters, memory = sensors.part(PERIOD, outages)
    out = np.empty((instants, 8))
    record(memory, parameters, out)
    return out.T


def poses(columns):
    """Instants of arrival, instants at which they were taken, and ages in instants."""
    x, age = columns[4], columns[7]
    (arrived,) = np.nonzero(~np.isnan(x))
    return arrived, np.rint(x[arrived]).astype(int), np.rint(age[arrived] / PERIOD).astype(int)


def test_a_run_depends_on_its_seed_alone():
    """Not on the number of runs around it, nor on its place among them."""
    seeds = [7, 3, 5, 3, *range(100, 162)]  # a full block and a part of one
    parts = {**WORLD, "sensors": Sensors(seed=1)}
    batch, turned = (
        simulate_batch(CURVES["corner"], vary={"sensors.seed": s}, record_every=1, **parts)
        for s in (seeds, seeds[::-1])
    )
    assert (batch.record == turned.record[::-1]).all()
    assert (batch.record[1] == batch.record[3]).all()
    assert (batch.record[0] != batch.record[1]).any()
    for n in (1, 65):
        run = simulate(CURVES["corner"], **{**parts, "sensors": Sensors(seed=seeds[n])})
        for column, name in enumerate(run.columns):
            lane = batch.record[n, :, column]
            assert (lane == run.columns[name][: len(lane)]).all(), name


def test_noises_are_what_the_fields_say():
    sensors, count = Sensors(gyro_bias=0.02, seed=4), 20_000
    left, right, steering, gyro, x, y, heading, _ = heard(sensors, count)
    at, taken, _ = poses([None] * 4 + [x, None, None, np.zeros(count)])
    assert (at == taken).all()
    errors = {
        "wheel_noise": (left - 0.7, right - 0.8),
        "steering_noise": (steering - 0.6,),
        "gyro_noise": (gyro - 0.5 - 0.02,),
        "position_noise": (x[at] - at, y[at] - 2.0),
        "heading_noise": (heading[at] - 0.3,),
    }
    flat = []
    for name, parts in errors.items():
        for error in parts:
            deviation, room = getattr(sensors, name), 4.0 / math.sqrt(len(error))
            assert error.std() == pytest.approx(deviation, rel=room), name
            assert abs(error.mean()) < room * deviation, name
            white = np.corrcoef(error[1:], error[:-1])[0, 1]
            assert abs(white) < room, name
            flat.append(error[: len(at)] if len(error) == len(at) else error[at])
    between = np.corrcoef(flat) - np.eye(len(flat))
    assert np.abs(between).max() < 4.0 / math.sqrt(len(at))


@pytest.mark.parametrize("rate", [100.0, 50.0, 30.0, 7.0])
def test_poses_come_at_their_rate(rate):
    arrived, taken, age = poses(heard(EXACT.model_copy(update={"pose_rate": rate}), 1000))
    assert len(arrived) == math.ceil(10.0 * rate)
    assert (arrived == taken).all()
    assert (age == 0).all()
    steps = np.diff(taken)
    assert steps.max() - steps.min() <= 1


def test_poses_more_often_than_instants():
    with pytest.raises(InvalidInput, match=r"pose_rate = 200.*must not exceed .* 100 Hz"):
        Sensors(pose_rate=200.0).part(PERIOD, HEARD)
    with pytest.raises(InvalidInput, match=r"sensors\.pose_rate"):
        simulate(CURVES["corner"], **WORLD, sensors=Sensors(pose_rate=101.0))


def test_latency_delays_every_pose_by_the_same():
    arrived, taken, age = poses(heard(EXACT.model_copy(update={"pose_latency": 0.06}), 1000))
    assert (age == 6).all()
    assert (arrived - taken == 6).all()
    assert (np.diff(taken) == 2).all()


@pytest.mark.parametrize("rate", [20.0, 50.0, 100.0])
@pytest.mark.parametrize("jitter", [0.015, 0.05, 0.2])
def test_every_pose_arrives_once_in_any_order(rate, jitter):
    late = {"pose_rate": rate, "pose_latency": 0.02, "pose_jitter": jitter}
    sensors, count = EXACT.model_copy(update=late), 4000
    arrived, taken, age = poses(heard(sensors, count))
    assert (arrived - taken == age).all()
    assert age.min() >= 2
    assert len(set(taken)) == len(taken)
    settled = np.arange(0.0, count - 100, 100.0 / rate)
    assert set(np.ceil(settled - 1e-9).astype(int)) <= set(taken)
    if rate < 100.0:  # else every instant is taken, and poses queue
        if jitter > 1.5 / rate:
            assert (np.diff(taken) < 0).mean() > 0.05  # some overtake others
        assert age.mean() * PERIOD == pytest.approx(0.02 + 0.5 * jitter, abs=1.5 * PERIOD)


def test_dropouts_and_outliers_are_as_frequent_as_stated():
    update = {"pose_dropout": 0.2, "pose_outliers": 0.05, "outlier_size": 0.4}
    count = 20_000
    columns = heard(EXACT.model_copy(update=update), count)
    here = ~np.isnan(columns[4])
    share = here.sum() / (count / 2)
    assert share == pytest.approx(0.8, abs=4.0 * math.sqrt(0.16 / (count / 2)))
    off = columns[4][here] - np.flatnonzero(here), columns[5][here] - 2.0
    size = np.hypot(*off)
    wrong = size > 1e-9
    assert size[wrong] == pytest.approx(0.4)
    assert wrong.mean() == pytest.approx(0.05, abs=4.0 * math.sqrt(0.05 / here.sum()))
    way = np.arctan2(off[1][wrong], off[0][wrong])
    assert abs(np.exp(1j * way).mean()) < 4.0 / math.sqrt(wrong.sum())  # in all directions


@pytest.mark.parametrize(
    ("sensor", "columns"),
    [("wheels", [0, 1]), ("steering", [2]), ("gyro", [3]), ("pose", [4, 5, 6])],
)
def test_a_silent_sensor_reports_no_number(sensor, columns):
    outages = HEARD._replace(**{sensor: Outage(2.0, 3.0)})
    always = EXACT.model_copy(update={"pose_rate": 100.0})
    gone = np.isnan(heard(always, 500, outages))
    for n in range(7):
        assert gone[n].sum() == (100 if n in columns else 0)
        assert gone[n, 200:300].all() == (n in columns)


def test_a_robot_without_gyro():
    columns = heard(EXACT.model_copy(update={"gyro": False}), 100)
    assert np.isnan(columns[3]).all()
    assert not np.isnan(columns[:3]).any()
    assert HEARD.gyro == SILENT


def test_the_compiled_sensors_are_the_python_ones_bit_for_bit():
    from osculate.kernel.trace import plain

    sensors = Sensors(**LATE, pose_dropout=0.1, pose_outliers=0.1)
    compiled = heard(sensors, 60)
    parameters, memory = sensors.part(PERIOD, HEARD)
    sense = plain(sense_noisily)
    for n in range(60):
        motion = Motion(float(n), 2.0, 0.3, 0.4, 0.5, 0.6)
        seen, memory = sense(motion, Wheels(0.7, 0.8), memory, parameters)
        assert np.array_equal([*leaves(seen)], compiled[:, n], equal_nan=True)
