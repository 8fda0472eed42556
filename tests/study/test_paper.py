"""The reproduction: every claim is there, judged by what was measured, and agrees with the theory."""

import html
import json
from types import SimpleNamespace

import numpy as np
import pytest

from osculate import Cycloid, InvalidInput, Tricycle
from osculate.study.paper import CASES, Interpretation, claims, reproduce
from osculate.study.paper.cases import PRINTED, endless, run_case
from osculate.study.paper.claims.claim import FAILS, HOLDS, Condition, judge
from osculate.study.paper.claims.model import constraint_residual
from osculate.study.paper.claims.targets import acceleration_factor
from osculate.study.paper.errata import ERRATA
from osculate.study.paper.measures import path_end, rms, vertical_errors

REQUIRED = {
    "alpha",
    "beta",
    "path_length",
    "initial_heading",
    "curvature_constant",
    "lqr_gain_heading",
    "lqr_gain_yaw_rate",
    "constraint_residual",
    "dynamics_coefficient",
    "energy_drift_corrected",
    "energy_drift_printed",
    "static_initial_speed_error",
    "static_initial_yaw_rate_error",
    "printed_profile_total_turn",
    "rms_modified_nominal",
    "rms_static_nominal",
    "rms_modified_d1",
    "rms_static_d1",
    "rms_modified_d11",
    "rms_modified_d12",
    "rms_modified_d12_heading_disturbed",
    "figure_3_4",
    "figure_5",
    "dynamical_cannot_align",
    "switching_helps",
    "sum_of_squares_d12",
}


@pytest.fixture(scope="module")
def reproduction():
    return reproduce()


@pytest.fixture(scope="module")
def measured(reproduction):
    return {row.id: row.measured for row in reproduction.rows}


@pytest.fixture(scope="module")
def judged(reproduction):
    return {row.id: row.judgement for row in reproduction.rows}


def test_every_required_claim_is_judged(reproduction):
    names = [row.id for row in reproduction.rows]
    assert set(names) >= REQUIRED
    assert len(set(names)) == len(names)
    for row in reproduction.rows:
        assert row.judgement in (HOLDS, FAILS) or row.judgement.startswith("holds only if ")
        assert np.isfinite(row.measured)
        assert row.statement
        assert row.source
        assert row.criterion
        assert row.erratum is None or 1 <= row.erratum <= len(ERRATA)


def test_a_judgement_follows_from_its_checks():
    met, missed = Condition("it rains", met=True), Condition("it rains", met=False)
    assert judge(True, missed) == judge(True, met) == HOLDS
    assert judge(False, met) == "holds only if it rains"
    assert judge(False, missed) == judge(False) == FAILS


def with_columns(run, change):
    """The run with changed columns."""
    columns = {name: np.array(values) for name, values in run.columns.items()}
    change(columns)
    return SimpleNamespace(
        columns=columns, setup=run.setup, verdict=run.verdict, metrics=run.metrics, diverged=run.diverged
    )  # fmt: skip


def displaced(columns):
    columns["y"] += 3.0 * np.sin(columns["time"])
    columns["cross_track_error"] += 1.0


def hasty(columns):
    for name in ("speed_error", "yaw_rate_error", "speed", "torque_left", "yaw_rate", "heading"):
        columns[name] = columns[name] + 0.3 * np.exp(np.minimum(columns["time"], 3.0))


def calm(columns):
    """A run in which nothing is wrong: on the path, no errors, no torques, straight ahead at rest."""
    curve = CASES_CURVE
    point = curve.at(columns["foot"])
    columns["x"], columns["y"] = point.x, point.y
    for name in (
        "cross_track_error", "speed_error", "yaw_rate_error", "torque_left", "torque_right", "yaw_rate",
        "speed",
    ):  # fmt: skip
        columns[name] = np.zeros_like(columns[name])
    columns["heading"] = np.zeros_like(columns["heading"])


def as_printed(columns):
    """Shifted so far up that J_a is what the paper prints."""
    error = vertical_errors(
        SimpleNamespace(columns=columns, setup=SimpleNamespace(curve=CASES_CURVE))
    )
    terms = (len(error), 2.0 * error.sum(), (error**2).sum() - 6.3217)
    columns["y"] += max(np.roots(terms).real)


CASES_CURVE = Cycloid.over(distance=10.0, height=5.0, margin=1.0)


def spoilt(evidence):
    """Evidence that would speak otherwise: each shows that some judgements can turn out otherwise."""
    for change in (displaced, hasty, calm):
        yield evidence._replace(
            runs={name: with_columns(run, change) for name, run in evidence.runs.items()}
        )
    swapped = dict(evidence.runs)
    for name in ("modified_d1_minus", "modified_d12"):  # with and without the switching torque
        swapped[name], swapped[f"{name}_smooth"] = swapped[f"{name}_smooth"], swapped[name]
    yield evidence._replace(runs=swapped)
    names = {"modified_d12": "dynamical_d12", "dynamical_d12": "modified_d12"}
    yield evidence._replace(
        runs={**evidence.runs, **{k: evidence.runs[v] for k, v in names.items()}}
    )
    other = Tricycle(
        wheelbase=1.0, wheel_radius=0.2, track_width=0.5, body_mass=20.0, body_inertia=7.0
    )
    yield evidence._replace(curve=Cycloid.over(distance=8.0, height=4.0, margin=0.5), robot=other)
    derived = evidence.derived
    yield evidence._replace(derived=SimpleNamespace(**{
        **{name: getattr(derived, name) for name in ("delta",)},
        "speed_rate": derived.printed_speed_rate, "printed_speed_rate": derived.speed_rate,
    }))  # fmt: skip
    run = evidence.runs["modified_d12"]
    yield evidence._replace(runs={**evidence.runs, "modified_d12": with_columns(run, as_printed)})
    for agrees in (True, False):
        rows = [row._replace(premise=agrees, conclusion=agrees) for row in evidence.readings]
        yield evidence._replace(readings=rows)


#: Judged by numbers that none of the spoilt evidence touches; each has a test of its own below.
ALONE = {
    "pace_moves_curve", "holonomic_constraints", "yaw_actuator", "lqr_gain_heading", "lqr_gain_yaw_rate",
    "yaw_errors_stable_d1", "yaw_errors_unstable_d11", "target_acceleration", "printed_profile_span",
    "printed_profile_total_turn",
}  # fmt: skip


def test_every_judgement_can_turn_out_otherwise(reproduction, judged):
    """No constant judgement, no tautology: for each there is evidence that changes it."""
    turned = set()
    for evidence in spoilt(reproduction.evidence):
        with np.errstate(all="ignore"):
            rows = claims(evidence)
        turned |= {row.id for row in rows if row.judgement != judged[row.id]}
    stuck = {row.id for row in reproduction.rows} - turned - ALONE
    assert stuck == set()


def test_the_numbers_of_rows_that_stand_alone(measured, judged):
    assert measured["pace_moves_curve"] < 1e-12
    assert measured["holonomic_constraints"] == 4.0
    assert measured["yaw_actuator"] == 1.0
    assert measured["lqr_gain_heading"] == pytest.approx(1.0, abs=1e-9)
    assert measured["lqr_gain_yaw_rate"] == pytest.approx(10.0020, abs=1e-4)
    assert measured["yaw_errors_stable_d1"] == pytest.approx(4.9, abs=0.01)
    assert measured["yaw_errors_unstable_d11"] == pytest.approx(11.9, abs=0.01)
    assert judged["yaw_errors_stable_d1"].endswith("minus")
    assert judged["yaw_errors_unstable_d11"].endswith("plus")
    assert measured["target_acceleration"] == pytest.approx(1.0, abs=1e-4)
    assert measured["printed_profile_span"] == pytest.approx(6.0)
    assert measured["printed_profile_total_turn"] == -3.0
    assert judged["printed_profile_total_turn"] == FAILS


def test_numbers_agree_with_the_theory(measured):
    assert measured["alpha"] == pytest.approx(3.205645553, abs=1e-9)
    assert measured["beta"] == pytest.approx(0.512139850, abs=1e-9)
    assert measured["path_length"] == pytest.approx(24.80894892, abs=1e-8)
    assert measured["initial_heading"] == pytest.approx(1.3147264, abs=1e-7)
    assert measured["curvature_constant"] == pytest.approx(10.54762806, abs=1e-7)
    assert measured["dynamics_coefficient"] == pytest.approx(27.0)
    assert measured["torque_coefficient"] == pytest.approx(160.0 / 3.0)
    assert measured["static_initial_speed_error"] == pytest.approx(-1.6239, abs=1e-4)
    assert measured["static_initial_yaw_rate_error"] == pytest.approx(0.5, abs=1e-9)
    assert measured["static_initial_torque"] == pytest.approx(1180, abs=2)


def test_the_paths_agree_with_the_reference_table(measured, reproduction):
    runs = {name: rms(run) for name, run in reproduction.evidence.runs.items()}
    assert measured["rms_modified_nominal"] < 1e-9
    assert runs["static"] == pytest.approx(5.21e-3, rel=0.01)
    assert runs["static_d2"] == pytest.approx(5.46e-3, rel=0.01)
    assert runs["modified_d1"] == pytest.approx(0.010, rel=0.1)
    assert runs["modified_d11"] == pytest.approx(0.064, rel=0.1)
    assert runs["modified_d12"] == pytest.approx(0.769e-3, rel=0.02)
    assert runs["modified_d12_smooth"] == pytest.approx(0.624e-3, rel=0.02)
    assert runs["modified_d1_minus"] == pytest.approx(0.176e-3, rel=0.1)
    assert runs["modified_d1_minus_smooth"] == pytest.approx(0.461e-3, rel=0.02)
    assert 1.0 < runs["modified_d12_heading_disturbed"] < 4.0
    assert measured["dynamical_cannot_align"] == pytest.approx(0.99, rel=0.02)
    assert measured["steering_from_input"] == pytest.approx(0.25, rel=0.02)


def test_half_the_step_gives_the_same_errors_where_nothing_is_unstable(reproduction):
    for name, run in reproduction.evidence.runs.items():
        chatters = name in ("modified_d1_minus", "modified_d11_minus", "modified_d11")
        exact = rms(run) < 1e-8
        tolerance = 0.1 if chatters else 0.01
        assert exact or reproduction.halved[name] == pytest.approx(rms(run), rel=tolerance), name


def test_figures_3_and_4_fit_one_reading_and_figure_5_none(judged, reproduction):
    only = "holds only if the lost signs inside d₁ are minus and θ̂(0) = 0"
    assert judged["figure_3_4"] == judged["figure_4"] == only
    assert judged["figure_5"] == FAILS
    static = [r for r in reproduction.evidence.readings if (r.figure, r.sign) == (4, -1.0)]
    assert {r.origin: round(r.off, 2) for r in static} == {"start": 0.01, "printed": 0.29}


def test_the_sum_of_squares_is_small_on_the_path_and_anything_beyond(reproduction):
    for row in reproduction.evidence.square_sums:
        assert 0.003 < row.on_path < 0.007
        if row.after_end == "stop":
            assert row.whole == row.on_path
            assert row.whole_halved == pytest.approx(row.whole, rel=0.01)
        else:
            assert row.samples == 20001
            assert row.whole > 100.0 * row.on_path


def test_energy_tells_the_corrected_dynamics_from_the_printed_ones(measured):
    assert measured["energy_drift_corrected"] < 1e-10
    assert measured["energy_drift_printed"] > 0.05


def test_the_constraints_are_measured_by_what_the_robot_does(reproduction):
    run = reproduction.evidence.runs["modified_smooth"]
    robot = run.setup.robot
    assert constraint_residual(run, robot) < 1e-5

    def slide(columns):
        columns["y"] += 1e-3 * np.sin(columns["time"])

    assert constraint_residual(with_columns(run, slide), robot) > 5e-4


def test_the_targets_acceleration_is_measured(reproduction):
    run = reproduction.evidence.runs["modified"]
    assert acceleration_factor(run) == pytest.approx(1.0, abs=1e-4)


def test_the_curvature_as_a_root_is_the_curvature_of_the_path(reproduction):
    """Eq. (50) written out gives the run that the tabulated curve gives, as far as the path goes."""
    run = reproduction.evidence.runs["modified_d12"]
    beyond = run_case(CASES["modified_d12"], Interpretation(after_end="continue"))
    n = int(0.9 * len(run.columns["time"]))
    for name in ("x", "y", "heading", "speed"):
        assert beyond.columns[name][:n] == pytest.approx(run.columns[name][:n], abs=1e-6), name
    assert path_end(beyond) == pytest.approx(path_end(run), abs=1e-3)
    assert beyond.columns["time"][-1] == pytest.approx(20.0)
    assert endless(PRINTED).linear == pytest.approx(24.80894892, abs=1e-8)


def test_a_target_may_begin_to_integrate_elsewhere():
    printed = run_case(CASES["printed"], Interpretation(yaw_origin="printed"))
    begun = float(printed.columns["heading_error"][0])
    assert begun == pytest.approx(0.0, abs=1e-9)  # the robot is on the path
    assert (
        printed.columns["yaw_rate"][1] < -1e-4
    )  # and is turned back from what the law takes for an error


def test_the_papers_error_is_vertical_and_vanishes_on_the_curve(reproduction):
    run = reproduction.evidence.runs["modified"]
    point = run.setup.curve.at(run.columns["foot"])
    slope = np.cos(point.heading)
    expected = run.columns["cross_track_error"] / slope
    inner = np.abs(slope) > 0.3
    assert vertical_errors(run)[inner] == pytest.approx(expected[inner], abs=1e-10)
    assert rms(run) == pytest.approx(np.sqrt((vertical_errors(run) ** 2).mean()))


def test_what_was_chosen_is_checked():
    assert Interpretation.checked("printed", "stop") == ("printed", "stop")
    with pytest.raises(InvalidInput, match="yaw_origin = 'zero': must be one of start, printed"):
        Interpretation.checked("zero", "stop")


def test_files(reproduction, tmp_path):
    seen = []
    written = reproduction.write(tmp_path / "out", seen.append)
    assert all(path.is_file() and path.stat().st_size > 0 for path in written)
    assert {path.name for path in written} >= {f"figure{n}.png" for n in range(1, 8)}
    assert seen[-1] == 1.0
    record = json.loads((tmp_path / "out" / "claims.json").read_text(encoding="utf-8"))
    rows = record["claims"]
    assert {"id", "statement", "source", "expected", "measured", "criterion", "judgement"} <= set(
        rows[0]
    )
    assert {"version", "commit", "h", "N", "integrator", "Q", "R", "yaw_origin"} <= set(
        record["provenance"]
    )
    page = (tmp_path / "out" / "paper.html").read_text(encoding="utf-8")
    assert "http" not in page.replace("data:image", "")
    for case in CASES.values():
        assert html.escape(case.meaning) in page
    for row in rows:
        if row["erratum"]:
            assert f'href="#erratum-{row["erratum"]}"' in page
            assert f'id="erratum-{row["erratum"]}"' in page
