"""A part that is given is used, or refused in words that say what to change."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import (
    Actuated,
    Continuous,
    CurvatureLaw,
    CurvatureTracker,
    Cycloid,
    InitialState,
    InvalidInput,
    Limits,
    Line,
    Modified,
    Natural,
    Payload,
    PurePursuit,
    SensorLoss,
    Slippery,
    SlowServo,
    Spline,
    Static,
    StuckSteering,
    WeakMotor,
    WheelWear,
    simulate,
)
from osculate.plant import Slip, world_of
from osculate.simulation.physics import _metrics
from osculate.simulation.run import make_setup
from osculate.study.scenario import Scenario

WAVE = Spline(points=((0, 0), (1.5, 0.5), (3, 0), (4.5, -0.5), (6, 0)))
times = st.floats(0.0, 20.0)


@pytest.mark.parametrize("law", [CurvatureTracker(), PurePursuit()])
def test_a_target_is_no_part_of_a_tracker(law):
    with pytest.raises(InvalidInput, match=r"target = .*a path tracker drives as limits="):
        make_setup(WAVE, None, {"controller": law, "target": Static()})


@pytest.mark.parametrize("parts", [{}, {"controller": CurvatureLaw()}])
def test_limits_are_no_part_of_a_law(parts):
    with pytest.raises(InvalidInput, match=r"limits = .*are for a path tracker"):
        make_setup(Cycloid.over(), None, {**parts, "limits": Limits()})


def test_a_scenario_gives_what_its_file_gives():
    tracked = {"curve": WAVE, "controller": {"kind": "curvature-tracker"}}
    assert "target" not in Scenario(**tracked).parts
    assert "limits" not in Scenario().parts
    with pytest.raises(InvalidInput, match="a path tracker drives as limits="):
        Scenario(**tracked, target={"kind": "modified"}).run()
    with pytest.raises(InvalidInput, match="are for a path tracker"):
        Scenario(limits={"speed": 1.0}).run()


@given(st.floats(0.0, 1e3))
def test_errors_count_from_a_place_on_the_curve(extra):
    beyond = InitialState(settled=WAVE.length + extra)
    with pytest.raises(InvalidInput, match=r"initial\.settled.*must be below the curve's length"):
        beyond.on(WAVE)
    InitialState(settled=0.999 * WAVE.length).on(WAVE)


def test_errors_of_which_none_counts_are_not_known():
    """A run that ends before `settled` was not exact: nobody looked."""
    clock = Continuous(duration=0.2)
    for settled, known in ((0.0, True), (3.0, False)):
        run = simulate(Cycloid.over(), initial=InitialState(settled=settled), clock=clock)
        columns = {
            **run.columns, "foot": np.zeros(len(run.columns["time"])),
        }  # fmt: skip
        for metrics in (run.metrics, _metrics(run.setup, columns, None, "time")):
            for name in (
                "cross_track_rms", "cross_track_max", "heading_error_rms", "heading_error_max",
            ):  # fmt: skip
                assert math.isfinite(getattr(metrics, name)) == known, name
            assert math.isfinite(metrics.energy)


def test_the_natural_profile_is_one_of_heading_for_the_modified_target():
    """On the cycloid both targets drive the same timetable; the heading turns evenly."""
    clock = Continuous(duration=4.0)
    timed, slaved = (
        simulate(Cycloid.over(), target=kind(profile=Natural()), clock=clock)
        for kind in (Static, Modified)
    )
    settled = timed.columns["time"] > 2.0
    rate = slaved.columns["yaw_rate"][settled]
    assert rate == pytest.approx(np.full(len(rate), -0.5), rel=1e-2)
    assert timed.columns["yaw_rate"][settled] == pytest.approx(rate, rel=2e-2)


@given(times, times, times, times)
def test_a_sensor_is_silent_for_as_long_as_its_losses_last_together(a, b, c, d):
    first, second = sorted((a, b)), sorted((c, d))
    losses = [
        SensorLoss(sensor="gyro", time=low, duration=high - low)
        for low, high in (first, second)
        if high > low
    ]
    if len(losses) == 2 and max(first[0], second[0]) > min(first[1], second[1]) + 1e-9:
        with pytest.raises(InvalidInput, match="must overlap or touch"):
            world_of(Actuated(), losses)
        return
    if len(losses) < 2 or max(first[0], second[0]) > min(first[1], second[1]) - 1e-9:
        return
    outage = world_of(Actuated(), losses).outages.gyro
    assert outage.begin == min(first[0], second[0])
    assert outage.end == pytest.approx(max(first[1], second[1]))


@given(st.floats(0.0, 0.99), st.floats(0.0, 0.99), times, times)
def test_losses_of_a_motor_multiply(one, other, time, later):
    faults = [WeakMotor(strength=one, time=time), WeakMotor(strength=other, time=time)]
    assert world_of(Actuated(), faults).impairment.left_strength == one * other
    apart = [faults[0], WeakMotor(strength=other, time=time + 1.0 + later)]
    with pytest.raises(InvalidInput, match="must be at the same time"):
        world_of(Actuated(), apart)
    both = world_of(Actuated(), [faults[0], WeakMotor(side="right", strength=other, time=later)])
    assert both.impairment.right_strength == other


@given(st.permutations([0, 1, 2, 3, 4, 5, 6, 7]))
def test_the_order_of_faults_does_not_matter(order):
    faults = [
        Payload(mass=1.0), Payload(mass=2.0), SlowServo(frequency=0.5), SlowServo(frequency=0.5),
        WheelWear(loss=0.1), WheelWear(loss=0.1), StuckSteering(time=3.0), StuckSteering(time=2.0),
    ]  # fmt: skip
    world = world_of(Slip(), [faults[n] for n in order])
    assert world.plant.payload == 3.0
    assert world.plant.servo == 0.25
    assert world.plant.wheel_wear == pytest.approx(0.19)
    assert world.impairment.stuck == 2.0


def test_what_the_floor_cannot_give_is_warned_of_before_the_run():
    with pytest.warns(UserWarning, match=r"exceeds µ g = 1\.96 m/s²"):
        run = simulate(
            Line(distance=0.5), controller=CurvatureTracker(), plant=Slip(),
            faults=(Slippery(friction=0.2),),
        )  # fmt: skip
    assert "may slide" in run.caution
    assert math.isfinite(run.metrics.duration)
