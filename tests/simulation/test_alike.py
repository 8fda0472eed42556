"""Batches of unequal runs: one shape bit for bit, standing still at the end, or refused by the part."""

import numpy as np
import pytest

from osculate import (
    Actuated,
    Continuous,
    CurvatureLaw,
    CurvatureTracker,
    Cycloid,
    Disturbance,
    Ekf,
    Exponential,
    FrictionPatch,
    Gusts,
    InvalidInput,
    Late,
    Line,
    Modified,
    Mujoco,
    Projected,
    PurePursuit,
    Reduced,
    Safety,
    Sampled,
    SampledProfile,
    SensorLoss,
    Sensors,
    Shove,
    Slip,
    Spline,
    StuckSteering,
    Tricycle,
    simulate,
    simulate_batch,
    variable_names,
    vehicle_named,
)
from osculate.simulation import loop as loops
from osculate.simulation.alike import close_alike
from osculate.simulation.run import make_setup
from osculate.simulation.variables import RATES

CURVE = Spline(points=((0, 0), (1.5, 0.5), (3, 0)))
CLOCK = Sampled(period=0.01, delay=0.01, duration=0.6)
TRACKER = {"controller": CurvatureTracker(), "clock": CLOCK}
FAST = {"clock": Sampled(period=1e-3, duration=0.1)}  # enough for the paper's gains
PUSHES = (Gusts(seed=2), Gusts(seed=2), Shove(time=0.2, along=1.0, aside=0.0))


def patches(count):
    return tuple(FrictionPatch(x=0.1 * n, y=0.1, friction=0.1 + 0.1 * n) for n in range(count))


MIXED = {
    "noisy": [
        {"sensors": Sensors(), "estimator": Ekf()},
        {
            "sensors": Sensors(seed=3, pose_latency=0.06, pose_rate=30.0),
            "estimator": Ekf(history=0.1),
            "faults": (*PUSHES, Late(delay=0.04), StuckSteering(time=0.4)),
        },
    ],
    "exact": [
        {},
        {"faults": PUSHES[1:]},
        {"faults": (*PUSHES, Late(delay=0.05), *patches(5))},
    ],
}


@pytest.mark.parametrize("name", MIXED)
def test_a_lane_that_was_filled_up_is_the_single_run_bit_for_bit(name):
    """Robots, curves of other lengths, pushes, patches, delays, latencies and histories in one batch."""
    each, plant = MIXED[name], {"exact": Slip(), "noisy": Actuated()}[name]
    clock = Sampled(period=0.02, delay=0.02, duration=0.6)
    law = {"controller": CurvatureTracker(), "clock": clock, "plant": plant}
    curves = [CURVE, Spline(points=((0, 0), (0.2, 0.05), (0.4, 0))), Line(distance=2)][: len(each)]
    robots = [Tricycle(body_mass=3.0 - 0.1 * n) for n in range(len(each))]
    parts = {
        "sensors": [own.get("sensors") for own in each],
        "estimator": [own.get("estimator") for own in each],
        "faults": [own.get("faults", ()) for own in each],
    }
    batch = simulate_batch(curves, robots, record_every=1, **parts, **law)
    for n, own in enumerate(each):
        run = simulate(curves[n], robots[n], **own, **law)
        rows = batch.time <= run.metrics.duration - 1e-9
        for column, variable in enumerate(run.columns):
            lane = batch.record[n, rows, column]
            assert (lane == run.columns[variable][: len(lane)]).all(), (n, variable)
        for metric, value in run.metrics.as_dict().items():
            assert value is None or getattr(batch.metrics, metric)[n] == value, (n, metric)


ENDING = {
    "law": {
        "curve": Cycloid.over(), "clock": Continuous(duration=9.0),
        "target": [Modified(profile=Exponential(amplitude=a)) for a in (-3.0, -2.5, -2.0)],
        "disturbance": [Disturbance(), Disturbance.internal(20, 20), Disturbance()],
    },
    "tracker": {
        "curve": [Line(distance=d) for d in (0.3, 0.6, 5.0)], "controller": CurvatureTracker(),
        "clock": Sampled(period=0.01, delay=0.01, duration=2.5),
    },
}  # fmt: skip


@pytest.mark.parametrize("every", [1, 7, 250])
@pytest.mark.parametrize("name", ENDING)
def test_records_of_ended_lanes_stand_still(name, every):
    batch = simulate_batch(**ENDING[name], record_every=every)
    names = [v.name for v in batch.variables]
    moving = [name in RATES for name in names]
    held = [name not in RATES and name != "time" for name in names]
    assert len({*batch.metrics.ended.tolist()}) > 1
    for n, end in enumerate(batch.metrics.duration):
        record = batch.record[n]
        assert (record[:, 0] == batch.time).all()
        after = record[batch.time > end + 1e-9]
        assert (after[:, moving] == 0.0).all()
        assert (after[:, held] == after[:1, held]).all()
        for row in after[:1]:
            assert row[names.index("arc_length")] == batch.metrics.travelled[n]
            far = np.hypot(
                *(row[names.index(c)] - e for c, e in zip("xy", end_of(name, n), strict=True))
            )
            assert far == pytest.approx(batch.metrics.end_position_error[n], abs=1e-12)
        before = record[(batch.time > 0.1) & (batch.time < end - 1e-9)]
        assert (before[:, names.index("speed")] != 0.0).all()


def end_of(name, n):
    curve = ENDING[name]["curve"]
    curve = curve[n] if isinstance(curve, list) else curve
    return curve.at(curve.length)[:2]


@pytest.mark.parametrize(
    ("field", "parts"),
    [
        ("target", {"target": [Modified(), Projected()]}),
        ("target", {"target": [Modified(), Modified(profile=SampledProfile.of(lambda t: -0.3 * t, 9.0))]}),
        ("controller", {"controller": [CurvatureLaw(), CurvatureTracker()], "plant": Actuated(), **FAST}),
        ("controller", {"controller": [CurvatureTracker(), PurePursuit()], "clock": CLOCK}),
        ("plant", {"plant": [Reduced(), Actuated()]}),
        ("plant", {"plant": [Actuated(), Slip()], **TRACKER}),
        ("plant", {"plant": [Actuated(), Mujoco()], **TRACKER}),
        ("plant", {"plant": Mujoco(), "runs": 2}),
        ("clock", {"clock": [CLOCK, CLOCK.but(duration=1.0)], "controller": CurvatureTracker()}),
        ("clock", {"clock": [CLOCK, CLOCK.but(delay=0.02)], "controller": CurvatureTracker()}),
        ("sensors", {"sensors": [None, Sensors()], **TRACKER}),
        ("safety", {"safety": [None, Safety()], **TRACKER}),
    ],
)  # fmt: skip
def test_what_cannot_share_machine_code_is_refused_by_its_name(field, parts):
    with pytest.raises(InvalidInput) as caught:
        simulate_batch(Cycloid.over(), **parts)
    assert caught.value.field.split(" ")[0] == field


def test_parts_that_only_work_together_are_named():
    """A lost sensor needs sensors: neither part of the second run fits the first one alone."""
    lost = (SensorLoss(sensor="pose", time=0.1),)
    with pytest.raises(InvalidInput, match=r"sensors \(run 1\)|faults \(run 1\)"):
        simulate_batch(CURVE, sensors=[None, Sensors()], faults=[(), lost], **TRACKER)


def test_robots_of_the_catalogue_share_a_batch():
    robots = [vehicle_named(name) for name in ("paper", "tugger", "forklift")]
    batch = simulate_batch(Line(distance=2), robots, controller=CurvatureTracker(), clock=CLOCK)
    assert (batch.metrics.cross_track_max < 1e-6).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"runs": 2.5}, "runs = 2.5: must be at least 1, a whole number"),
        ({"runs": True}, "runs = True: must be at least 1"),
        ({"runs": 2, "threads": 0}, "threads = 0: must be at least 1"),
        ({"runs": 2, "threads": -1}, "threads = -1: must be at least 1"),
        ({"runs": 2, "record_every": -1}, "record_every = -1: must be from 0 to 600"),
        ({"runs": 2, "record_every": 601}, "record_every = 601: must be from 0 to 600"),
        ({"runs": 2, "record_every": 0.5}, "record_every = 0.5: must be from 0 to 600"),
        ({"runs": 2, "report": 5}, "report = 5: must be a function"),
        ({"vary": {"plant.model.traction": [1.0, np.nan]}}, "= nan: must be numbers; run 1"),
        ({"vary": {"delay": [10.0, 11.0]}}, "= 11.0: must be from 0 to 10 steps"),
        ({"vary": {"delay": -1.0}, "runs": 2}, "= -1.0: must be from 0 to 10 steps"),
        ({"vary": {"control.profile.offset": [0.0, 1e9]}}, "unknown; valid"),
    ],
)
def test_arguments_of_a_batch_are_checked(arguments, message):
    with pytest.raises(InvalidInput, match=message):
        simulate_batch(CURVE, **TRACKER, **arguments)


def test_numbers_to_vary_are_those_of_the_robot_and_its_world():
    assert "delay" not in variable_names(Cycloid.over())  # a continuous law has none
    names = variable_names(CURVE, **TRACKER)
    assert "delay" in names
    assert not [
        name for name in names if name.endswith((".grid.offset", ".profile.offset", ".density"))
    ]


def test_what_is_foreseen_of_one_task_is_foreseen_once(monkeypatch):
    """It takes longer than all the rest of a closed loop."""
    asked = []
    monkeypatch.setattr(loops, "foresee_sliding", lambda plant, *_: asked.append(plant))
    plants = [Actuated(), Actuated(), Actuated(payload=1.0)]
    law = {"controller": PurePursuit()}
    close_alike(make_setup(Line(distance=2.0), None, {**law, "plant": p}) for p in plants)
    assert asked == [Actuated(), Actuated(payload=1.0)]
