"""Inspecting curves before driving them."""

import math

import pytest

from osculate import Arc, InvalidInput, Spline, Tricycle, vehicle_named
from osculate.study.feasibility import draw, inspect_curve, load_curve
from osculate.study.scenario import write_template


def test_an_arc_is_what_it_is():
    report = inspect_curve(Arc(radius=2.0, angle=1.0), Tricycle(), speed=1.0)
    assert report.length == pytest.approx(2.0)
    assert report.radius == pytest.approx(2.0)
    assert report.steering_angle == pytest.approx(math.atan(0.4 / 2.0))
    assert report.lateral_speed == pytest.approx(2.0)
    assert report.feasible
    assert "at 1 m/s everywhere" in report.conclusion


def test_a_curve_too_tight_is_refused_with_place_and_angle():
    report = inspect_curve(Arc(radius=0.2, angle=1.0), vehicle_named("forklift"))
    assert not report.feasible
    assert "cannot follow" in report.conclusion
    assert "its limit is 80.21°" in report.conclusion


def test_a_curve_too_fast_says_how_slow():
    report = inspect_curve(load_curve("corner"), vehicle_named("tugger"), speed=2.0)
    assert report.feasible
    assert "slow down to" in report.conclusion


def test_sources(tmp_path):
    assert load_curve("slalom").length > 12
    scenario = write_template(tmp_path / "scenario.yaml")[0]
    assert load_curve(str(scenario)).length > 6
    with pytest.raises(InvalidInput, match="must be a file or one of"):
        load_curve("nothing")


def test_the_figure(tmp_path):
    curve = load_curve("lemniscate")
    path = draw(curve, inspect_curve(curve, Tricycle()), tmp_path / "a" / "b")
    assert path.stat().st_size > 10_000


def test_the_template_is_a_scenario_and_is_never_overwritten(tmp_path):
    from osculate import Scenario

    path, schema = write_template(tmp_path / "scenario.yaml")
    scenario = Scenario.load(path)
    assert scenario.controller.kind == "curvature-tracker"
    assert '"curvature-tracker"' in schema.read_text()
    with pytest.raises(InvalidInput, match="exists already"):
        write_template(path)


def test_a_straight_line_has_no_tightest_place(tmp_path):
    far = Spline(points=((5e5, 5e6), (5e5 + 3, 5e6 + 4)))
    report = inspect_curve(far, Tricycle())
    rows = dict(report.rows())
    assert rows["tightest place"] == "none, it is straight"
    assert not {"steering angle", "tips at"} & set(rows)
    assert draw(far, report, tmp_path).exists()
    bent = Spline(points=((5e5, 5e6), (5e5 + 1, 5e6), (5e5 + 1, 5e6 + 1)))
    rows = dict(inspect_curve(bent, Tricycle()).rows())
    x, y = map(float, rows["largest near"].strip("()").split(","))
    assert (x, y) == pytest.approx((bent.polyline_error.x, bent.polyline_error.y), abs=6e-4)
