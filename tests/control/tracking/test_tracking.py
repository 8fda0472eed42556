"""Path tracking: how exact, from where, on which robots; and that every way to call it is the same."""

import math

import numpy as np
import pytest

from osculate import (
    Actuated,
    Continuous,
    CurvatureTracker,
    Cycloid,
    InitialState,
    InvalidInput,
    Limits,
    NoSolution,
    PreviewLqr,
    Reduced,
    Sampled,
    SpeedLoop,
    Stepper,
    Tricycle,
    compare,
    simulate,
    simulate_batch,
    vehicle_named,
)
from osculate.control.tracking import TRACKERS
from osculate.study.comparison.suite import CURVES, STARTS, conditions
from osculate.vehicle import VEHICLES, Motion

CLOCK = Sampled(period=0.01, delay=0.01, duration=120.0)
TEXTBOOK = ("pure-pursuit", "stanley", "kanayama", "lqr")


def drive(curve, law=None, **parts):
    parts = {"plant": Actuated(), "clock": CLOCK, "limits": Limits(speed=1.0), **parts}
    return simulate(curve, controller=law or CurvatureTracker(), **parts)


@pytest.fixture(scope="module")
def nominal():
    return compare(start={"on-path": STARTS["on-path"]})


def rms(cells):
    return np.array([cell["cross_track_rms"] for cell in cells])


def test_the_tracker_is_as_exact_as_promised(nominal):
    cells = nominal.of("curvature-tracker")
    assert not any(cell["failed"] for cell in cells)
    assert rms(cells).mean() < 0.12e-3
    assert rms(cells).max() < 0.4e-3
    assert max(cell["cross_track_max"] for cell in cells) < 1.4e-3


def test_it_beats_every_textbook_law_in_every_cell(nominal):
    ours = rms(nominal.of("curvature-tracker"))
    others = np.array([rms(nominal.of(name)) for name in TEXTBOOK])
    assert (ours < others.min(axis=0)).all()
    assert others.mean(axis=1).min() > 10 * ours.mean()


def test_baselines_are_fair_opponents(nominal):
    """Tuned, none of them loses the path on the ideal robot."""
    for name in TEXTBOOK:
        cells = nominal.of(name)
        assert sum(cell["failed"] for cell in cells) == 0, name
        assert rms(cells).mean() < 10e-3, name


@pytest.mark.parametrize("start", ["offset", "metre", "across"])
def test_starts_far_off_are_made_good(start):
    law = {"curvature-tracker": CurvatureTracker()}
    cells = compare(law, start={start: STARTS[start]}).cells
    assert not any(cell["failed"] for cell in cells)
    assert rms(cells).mean() < 0.15e-3


@pytest.mark.parametrize(("name", "bound"), [("slow-servo", 1.4e-3), ("late", 1.6e-3)])
def test_robots_that_the_law_does_not_know(name, bound):
    law = {"curvature-tracker": CurvatureTracker()}
    start = {"on-path": STARTS["on-path"]}
    cells = compare(law, start=start, condition=conditions([name])).cells
    assert not any(cell["failed"] for cell in cells)
    assert rms(cells).mean() < bound


@pytest.mark.parametrize("robot", ["tugger", "forklift"])
def test_other_vehicles(robot):
    run = drive(CURVES["slalom"], robot=vehicle_named(robot))
    assert run.metrics.ended == "path end"
    assert run.metrics.cross_track_rms < 0.2e-3


@pytest.mark.parametrize("robot", VEHICLES)
@pytest.mark.parametrize(("aside", "speed"), [(0.6, 1.5), (-0.6, 0.5), (1.2, 1.0)])
def test_lqr_preview_with_its_default_weights_comes_back_from_far_aside(robot, aside, speed):
    run = drive(
        CURVES["slalom"], PreviewLqr(), robot=VEHICLES[robot], limits=Limits(speed=speed),
        initial=InitialState(cross_track=aside, settled=4.0),
    )  # fmt: skip
    assert run.metrics.ended == "path end"
    assert np.abs(run.columns["cross_track_error"]).max() < abs(aside) + 1e-3
    assert run.metrics.cross_track_max < 1e-3
    assert run.metrics.duration < run.plan.duration + 8.0


def test_tracks_nobody_tuned_for(shared_data):
    from osculate import CurveFile

    for path in sorted((shared_data / "tracks").glob("*.csv")):
        track = CurveFile(path=str(path), scale=0.1, tolerance=0.02)
        run = drive(
            track, limits=Limits(speed=3.0), clock=CLOCK.model_copy(update={"duration": 900.0})
        )
        assert run.metrics.ended == "path end"
        assert run.metrics.cross_track_rms < 0.5e-3


def test_a_track_that_crosses_itself_is_followed_in_order():
    run = drive(CURVES["lemniscate"])
    foot = run.columns["foot"]
    assert np.diff(foot).min() > -1e-6
    assert np.diff(foot).max() < 0.01


@pytest.mark.parametrize("turned", [math.pi, -2.4])
def test_from_behind_it_plans_a_way_onto_the_curve(turned):
    run = drive(CURVES["slalom"], initial=InitialState(heading_error=turned, cross_track=0.3))
    assert run.setup.curve.kind == "composite"
    assert run.metrics.ended == "path end"
    assert run.metrics.cross_track_rms < 1e-3


def test_an_approach_can_be_refused():
    with pytest.raises(InvalidInput, match="cannot be recovered by tracking alone"):
        drive(CURVES["slalom"], initial=InitialState(heading_error=3.0, approach=False))


@pytest.mark.parametrize(
    "switching", ["boundary-layer", "twisting-layer", "super-twisting", "discontinuous"]
)
def test_every_switching_term_holds_the_speed(switching):
    law = CurvatureTracker(speed=SpeedLoop(switching=switching))
    run = drive(CURVES["slalom"], law, plant=Actuated(payload=5.0))
    cruise = (run.columns["foot"] > 3) & (run.columns["foot"] < 9)
    speed = run.columns["speed"][cruise]
    assert speed.mean() == pytest.approx(1.0, abs=0.005)
    chatter = 0.1 if switching == "discontinuous" else 0.02
    assert speed == pytest.approx(1.0, abs=chatter)


def test_layers_do_not_chatter():
    def ripple(switching):
        law = CurvatureTracker(speed=SpeedLoop(switching=switching))
        return drive(CURVES["slalom"], law).metrics.torque_travel

    assert ripple("discontinuous") > 20 * ripple("twisting-layer")


def test_tightness_trades_distance_for_effort():
    start = InitialState(cross_track=0.2)
    loose, tight = (
        drive(CURVES["slalom"], CurvatureTracker(tightness=t), initial=start) for t in (0.4, 1.2)
    )
    assert tight.metrics.cross_track_rms < loose.metrics.cross_track_rms
    assert tight.metrics.steering_angle_max > loose.metrics.steering_angle_max


def test_a_lane_is_the_single_run_is_the_stepper():
    curve, law, start = CURVES["corner"], CurvatureTracker(), InitialState(cross_track=0.1)
    clock = Sampled(period=0.01, delay=0.01, duration=1.0)
    run = drive(curve, law, initial=start, clock=clock)
    batch = simulate_batch(
        curve, controller=law, plant=Actuated(), clock=clock, limits=Limits(speed=1.0), runs=3,
        vary={"initial.plant.y": [run.columns["y"][0]] * 3}, initial=start, record_every=1,
    )  # fmt: skip
    for n, name in enumerate(run.columns):
        assert (batch.record[1, :, n] == run.columns[name][: len(batch.time)]).all(), name

    stepper = Stepper(law, curve, limits=Limits(speed=1.0))
    names = ("x", "y", "heading", "speed", "yaw_rate", "steering_angle")
    for n in range(0, 900, 10):
        command = stepper.step(Motion(*(run.columns[name][n] for name in names)))
        if n + 10 < 900:  # what is decided now acts one period later
            assert command.steering_angle == run.columns["commanded_steering_angle"][n + 10]
            assert command.torque_left == run.columns["torque_left"][n + 10]
    assert 0.0 < stepper.progress < 1.0
    assert not stepper.finished


UNCOMPILED = """
    import json
    from osculate import *
    from osculate.study.comparison.suite import CURVES
    run = simulate(CURVES["corner"], controller=CurvatureTracker(), plant=Actuated(),
                   clock=Sampled(period=0.01, delay=0.01, duration=0.05), limits=Limits(speed=1.0))
    print(json.dumps({name: values.tolist() for name, values in run.columns.items()}))
"""


def test_the_compiled_tracker_is_the_python_one_bit_for_bit():
    import json

    from uncompiled import run_uncompiled

    plain = json.loads(run_uncompiled(UNCOMPILED))
    run = drive(CURVES["corner"], clock=Sampled(period=0.01, delay=0.01, duration=0.05))
    for name, values in run.columns.items():
        assert values.tolist() == plain[name], name


@pytest.mark.parametrize(
    ("parts", "error", "message"),
    [
        ({"clock": Continuous()}, InvalidInput, r"must be Sampled"),
        ({"plant": Reduced()}, InvalidInput, r"must be Actuated"),
        ({"initial": InitialState(arc_length=99.0)}, InvalidInput, "below the curve's length"),
        ({"limits": Limits(speed=0.01)}, InvalidInput, r"limits\.creep = 0\.05"),
        ({"robot": Tricycle(wheelbase=4.0)}, NoSolution, "cannot follow the curve: at s ="),
    ],
)
def test_what_does_not_fit_is_explained(parts, error, message):
    with pytest.raises(error, match=message):
        drive(CURVES["corner"], **parts)


def test_by_default_a_tracker_drives_the_actuated_robot():
    run = simulate(CURVES["corner"], controller=CurvatureTracker())
    assert run.setup.plant == Actuated()
    assert run.setup.clock.delay == 0.01
    assert run.metrics.ended == "path end"


def test_a_stepper_needs_whole_periods():
    with pytest.raises(InvalidInput, match="must be a multiple of period"):
        Stepper(CurvatureTracker(), Cycloid.over(), delay=0.015)


def test_all_trackers_have_names_and_ranges():
    for name, law in TRACKERS.items():
        assert law.kind == name
        for field, (low, high) in law.tunable.items():
            assert low <= getattr(law, field) <= high, (name, field)
