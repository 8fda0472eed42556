"""Single runs: exactness, events, errors, and the record."""

import json
import math

import numpy as np
import pytest

from osculate import (
    Continuous,
    CurvatureLaw,
    CurvatureTracker,
    Cycloid,
    Disturbance,
    Dynamical,
    Exponential,
    InitialState,
    InvalidInput,
    Line,
    Modified,
    Natural,
    Parametric,
    Projected,
    Sampled,
    SampledProfile,
    Scene,
    SlidingMode,
    Static,
    Tricycle,
    Wall,
    YawRegulator,
    simulate,
    simulate_batch,
)

CURVE = Cycloid.over()
PRINTED = Modified(profile=Exponential(amplitude=-3.0))


@pytest.fixture(scope="module")
def nominal():
    return simulate(CURVE, Tricycle(), scene=Scene(obstacles=(Wall(),)))


@pytest.mark.core
def test_the_nominal_run_is_exact_to_the_integrator(nominal):
    assert nominal.metrics.cross_track_rms < 1e-8
    assert nominal.metrics.ended == "time"
    assert nominal.metrics.duration == pytest.approx(20.0)
    assert nominal.metrics.end_position_error == pytest.approx(0.0043, abs=2e-4)


def test_the_record_holds_the_kinematics(nominal):
    c = nominal.columns
    assert c["time"] == pytest.approx(np.arange(20001) * 1e-3)
    assert np.gradient(c["x"], c["time"])[5:-5] == pytest.approx(
        (c["speed"] * np.cos(c["heading"]))[5:-5], abs=1e-4
    )
    moving = c["speed"] > 0.01
    assert c["yaw_rate"][moving] == pytest.approx(
        (c["speed"] * np.tan(c["steering_angle"]) / 0.4)[moving]
    )


def test_the_foot_point_is_the_nearest_point(nominal):
    for n in (100, 3000, 9000):
        s = np.linspace(nominal.columns["foot"][n] - 0.01, nominal.columns["foot"][n] + 0.01, 2001)
        point = CURVE.at(s)
        distance = np.hypot(point.x - nominal.columns["x"][n], point.y - nominal.columns["y"][n])
        assert abs(s[distance.argmin()] - nominal.columns["foot"][n]) < 2e-5


def test_convergence_is_of_fourth_order():
    """A smooth loop: no switching term, halved steps."""
    law = CurvatureLaw(
        yaw=YawRegulator(rate_weight=0.01), speed=SlidingMode(gain=20, switching=0, uncertainty=0)
    )
    ends = []
    for step in (8e-3, 4e-3, 2e-3, 5e-4):
        run = simulate(
            CURVE, target=Modified(), controller=law, clock=Continuous(step=step, duration=4)
        )
        ends.append([run.columns[name][-1] for name in ("x", "y", "heading", "speed")])
    errors = np.abs(np.array(ends[:-1]) - ends[-1]).max(axis=1)
    orders = np.log2(errors[:-1] / errors[1:])
    assert (orders > 3.5).all(), (errors, orders)


def test_the_path_end_is_an_event():
    run = simulate(CURVE, target=PRINTED)
    assert run.metrics.ended == "path end"
    assert run.columns["arc_length"][-1] == pytest.approx(CURVE.length, abs=1e-9)
    assert run.metrics.duration == pytest.approx(7.245, abs=2e-3)
    assert run.columns["speed"][-1] == pytest.approx(0.471, abs=2e-3)
    assert (np.diff(run.columns["time"]) > 0).all()
    assert run.columns["time"][-1] == pytest.approx(run.metrics.duration)


@pytest.mark.parametrize(
    ("target", "disturbance", "low", "high"),
    [
        (Dynamical(), Disturbance(), 0, 1e-8),
        (Projected(), Disturbance(), 0, 1e-8),
        (Static(profile=Natural()), Disturbance(), 3e-3, 6e-3),
        (PRINTED, Disturbance.internal(5, 5), 3e-3, 1.2e-2),
        (PRINTED, Disturbance.internal(12, 11.2), 2e-2, 7e-2),
        (PRINTED, Disturbance.external(), 3e-4, 9e-4),
        (PRINTED, Disturbance.external(acts_on="robot"), 1.5, 4),
    ],
)
def test_the_papers_cases(target, disturbance, low, high):
    run = simulate(CURVE, target=target, disturbance=disturbance)
    assert low <= run.metrics.cross_track_rms <= high


def test_a_diverging_run_stops_and_keeps_what_it_had():
    run = simulate(
        CURVE, target=Static(profile=Natural()), disturbance=Disturbance.internal(20, 20)
    )
    assert run.diverged
    assert run.verdict.sentence.startswith("diverged after t = ")
    assert all(np.isfinite(values).all() for values in run.columns.values())
    assert run.metrics.duration == pytest.approx(run.columns["time"][-1])
    assert len(run.columns["time"]) > 500


def test_a_timetable_ends_when_it_is_complete():
    run = simulate(CURVE, target=Static(profile=Natural()))
    assert run.metrics.ended == "path end"
    assert run.verdict.sentence.startswith("completed its timetable at t = 5.259 s")
    assert run.metrics.duration == pytest.approx(2 * math.pi - 2 * CURVE.truncation, abs=1e-12)


def test_a_run_that_ends_where_a_chunk_of_steps_ends_is_left_alone():
    """The engine is called chunk by chunk; a finished run must not be taken up again."""
    from osculate.simulation.blocks import CHUNK

    duration = 2 * math.pi - 2 * CURVE.truncation
    parts = {
        "target": Static(profile=Natural()),
        "clock": Continuous(step=duration / CHUNK, duration=2 * duration),
    }
    run = simulate(CURVE, **parts)
    assert run.metrics.ended == "path end"
    assert run.columns["time"][-1] == pytest.approx(duration)
    assert len(run.columns["time"]) == CHUNK + 1
    batch = simulate_batch(CURVE, runs=2, **parts)
    assert run.metrics.torque_travel == batch.metrics.torque_travel[1]
    assert run.metrics.cross_track_rms == batch.metrics.cross_track_rms[1]


def test_a_profile_of_the_users_own():
    own = SampledProfile.of(lambda t: -0.6573632 * t * math.exp(-t / 2), 20.0, samples=2001)
    run = simulate(CURVE, target=Modified(profile=own))
    assert run.metrics.cross_track_rms < 1e-8
    assert run.metrics.travelled == pytest.approx(CURVE.length, abs=0.05)


def test_straights_and_inflections_with_the_projected_target():
    wave = Parametric(x="p", y="sin(p)", end=4 * math.pi)
    run = simulate(wave, target=Projected())
    assert run.metrics.cross_track_rms < 1e-8


def test_a_start_beside_the_curve_is_kept_in_the_record():
    run = simulate(CURVE, initial=InitialState(cross_track=0.3, heading_error=0.1))
    assert run.columns["cross_track_error"][0] == pytest.approx(0.3, abs=1e-6)
    assert run.columns["heading_error"][0] == pytest.approx(0.1, abs=1e-6)
    assert run.metrics.cross_track_max > 0.2  # the paper's law knows no pose


def test_walls_stand_where_they_are_meant_though_a_way_onto_the_curve_comes_first():
    wall = Scene(obstacles=(Wall(distance=1.5, height=1.0, width=0.5),))
    start = InitialState(cross_track=-3.0)
    clock = Sampled(period=0.01, delay=0.01, duration=0.5)
    parts = {"controller": CurvatureTracker(), "initial": start, "clock": clock}
    seen = simulate(Line(distance=3.0), scene=wall, **parts)
    fixed = simulate(Line(distance=3.0), scene=wall.fixed((0.0, 0.0)), **parts)
    assert seen.setup.curve != Line(distance=3.0)
    assert seen.metrics.clearance_min == fixed.metrics.clearance_min
    assert seen.metrics.clearance_min == pytest.approx(math.hypot(1.25, 3.0), abs=0.5)  # not 1.25 m


def gentle(duration=8.0, **clock):
    law = CurvatureLaw(
        yaw=YawRegulator(rate_weight=1e-3, heading_weight=1e-2),
        speed=SlidingMode(gain=10, switching=0, uncertainty=0),
    )
    return simulate(CURVE, controller=law, clock=Sampled(duration=duration, **clock))


def test_a_sampled_law_tends_to_the_continuous_one():
    errors = [gentle(period=p).metrics.cross_track_rms for p in (0.02, 0.01, 0.005)]
    assert errors[0] > 1.5 * errors[1] > 2.0 * errors[2]
    assert errors[2] < 0.01


def test_a_delay_shifts_what_the_robot_does():
    prompt = gentle(duration=0.1, period=0.01)
    late = gentle(duration=0.1, period=0.01, delay=0.025)
    torque = prompt.columns["torque_left"] + prompt.columns["torque_right"]
    delayed = late.columns["torque_left"] + late.columns["torque_right"]
    assert torque[0] != 0.0
    assert (delayed[:25] == 0.0).all()
    assert delayed[25] == pytest.approx(torque[0])
    held = prompt.columns["torque_left"]
    assert (held[1:10] == held[0]).all()
    assert held[10] != held[0]


def test_the_data_are_labelled(nominal):
    data = nominal.data
    assert data.x.attrs == {"units": "m", "long_name": "position of O, x"}
    assert all("units" in data[name].attrs for name in data.variables)
    assert data.sizes == {"time": 20001}
    assert json.loads(data.attrs["setup"])["curve"]["kind"] == "cycloid"


@pytest.mark.core
def test_netcdf_round_trip(nominal, tmp_path):
    import xarray

    path = nominal.save(tmp_path / "run.nc")
    with xarray.open_dataset(path) as data:
        assert data.speed.attrs["units"] == "m/s"
        assert data.target_speed_drift.attrs["units"] == "m/s²"
        assert (data.x.values == nominal.columns["x"]).all()
        assert (data.time.values == nominal.columns["time"]).all()


@pytest.mark.core
def test_the_overview_has_all_panels(nominal):
    figure = nominal.plot()
    path, *series = figure.axes
    assert path.get_title(loc="left").replace("\n", " ") == f"✓ {nominal.verdict}"
    assert [ax.get_title() for ax in series] == [
        "Speeds",
        "Cross-track error",
        "Steering angle",
        "Drive torque",
    ]
    assert all(ax.get_xlabel() and ax.get_ylabel() for ax in figure.axes)


def test_progress_is_reported():
    seen = []
    simulate(CURVE, clock=Continuous(duration=5.0), report=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert len(seen) >= 3


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"clock": Continuous(step=0.02)}, r"clock.step = 0.02: too large.*must be below 0.0046"),
        ({"clock": Sampled(period=0.02)}, r"clock.period = 0.02: too long.*must be below 0.0033"),
        ({"target": CURVE}, "target = .*must be a Target"),
        ({"contoller": 1}, "contoller = 1: unknown part; valid: robot, target, controller"),
    ],
)
def test_parts_that_do_not_fit_are_refused(parts, message):
    with pytest.raises(InvalidInput, match=message):
        simulate(CURVE, **parts)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sampled(period=0.0015), "Sampled.period = 0.0015: must be a multiple of step"),
        (lambda: Sampled(delay=-0.1), "Sampled.delay"),
        (lambda: Continuous(duration=0), "Continuous.duration"),
        (lambda: Continuous(duration=-1.0), "Continuous.duration"),
        (lambda: Sampled(duration=float("nan")), "Sampled.duration"),
        (lambda: Continuous(duration=1e-4), "Continuous.duration = 0.0001: must be at least step"),
        (lambda: Continuous(step=float("nan")), "Continuous.step"),
    ],
)
def test_bad_clocks_are_explained(make, message):
    with pytest.raises(InvalidInput, match=message):
        make()
