"""Comparison and tuning: cells, pairs, files; and a search that improves on other curves."""

import json
import math

import numpy as np
import pytest

from osculate import (
    CurvatureTracker,
    InitialState,
    InvalidInput,
    Limits,
    Line,
    NoSolution,
    PurePursuit,
    Sampled,
    compare,
    simulate,
    tune,
)
from osculate.control.tracking import PathTracker
from osculate.simulation.batch import LANES
from osculate.study.comparison import curves, quick_search, training_curves
from osculate.study.comparison.compare import Comparison
from osculate.study.comparison.report import cell_table, ranking_table
from osculate.study.comparison.suite import CURVES, STARTS, conditions, starts
from osculate.study.comparison.tune import PLANTS


@pytest.fixture(scope="module")
def comparison():
    laws = {"ours": CurvatureTracker(), "pursuit": PurePursuit(lookahead=0.5)}
    two = {name: CURVES[name] for name in ("slalom", "corner")}
    return compare(laws, two, speeds=(1.0,), start=starts(["on-path", "offset"]))


def test_there_is_a_cell_for_every_combination(comparison):
    assert len(comparison.cells) == 2 * 2 * 1 * 2
    keys = {
        (c["controller"], c["curve"], c["speed"], c["start"], c["plant"]) for c in comparison.cells
    }
    assert len(keys) == 8
    for cell in comparison.cells:
        assert isinstance(cell["failed"], bool)
        assert cell["cross_track_rms"] <= cell["cross_track_max"]
        assert cell["energy"] > 0.0


def test_a_cell_is_the_run_that_its_names_say(comparison):
    from osculate import Actuated, Limits, Sampled, simulate

    run = simulate(
        CURVES["slalom"], controller=CurvatureTracker(), plant=Actuated(), initial=STARTS["offset"],
        clock=Sampled(period=0.01, delay=0.01, duration=60.0), limits=Limits(speed=1.0),
    )  # fmt: skip
    (cell,) = (c for c in comparison.of("ours") if (c["curve"], c["start"]) == ("slalom", "offset"))
    assert cell["cross_track_rms"] == run.metrics.cross_track_rms
    assert cell["duration"] == run.metrics.duration


def test_the_ranking_is_paired(comparison):
    first, second = comparison.ranking()
    assert first.controller == "ours"
    ours, other = (
        np.array([c["cross_track_rms"] for c in comparison.of(n)]) for n in ("ours", "pursuit")
    )
    assert second.ratio == pytest.approx(np.exp(np.log(other / ours).mean()))
    assert (second.wins, second.cells) == (0, 4)


def test_files(comparison, tmp_path):
    import pyarrow.parquet as pq

    written = comparison.write(tmp_path / "out")
    assert [p.name for p in written] == [
        "comparison.html", "comparison.json", "comparison.parquet", "comparison-slalom.png",
        "comparison-corner.png",
    ]  # fmt: skip
    cells = json.loads((tmp_path / "out" / "comparison.json").read_text())
    assert cells == comparison.cells
    table = pq.read_table(tmp_path / "out" / "comparison.parquet")
    assert table.num_rows == 8
    assert table.schema.metadata[b"cross_track_rms"] == b"m"
    page = (tmp_path / "out" / "comparison.html").read_text()
    assert "http" not in page.replace("data:image", "")
    assert len(ranking_table(comparison)) == 3
    assert len(cell_table(comparison)) == 9


def test_a_straight_line_is_compared_though_its_errors_are_rounding(tmp_path):
    """Curvature 0: errors are 0 or of the last bit, so that no ratio of them means anything."""
    start = {"on-path": InitialState(), "offset": InitialState(cross_track=0.1, settled=0.5)}
    result = compare(on={"line": Line(distance=2.0)}, speeds=[1.0], start=start)
    numbers = [v for cell in result.cells for v in cell.values() if isinstance(v, float)]
    assert np.isfinite(numbers).all()
    assert all(cell["arrived"] for cell in result.cells)
    exact = [c["cross_track_rms"] for c in result.cells if c["start"] == "on-path"]
    assert max(exact) < 1e-9
    assert np.isfinite([(s.ratio, s.cross_track_rms) for s in result.ranking()]).all()
    on_path = Comparison([c for c in result.cells if c["start"] == "on-path"], {}, {})
    assert [(s.ratio, s.wins) for s in on_path.ranking()] == [(1.0, 0)] * len(result.controllers)
    page, record, *_ = result.write(tmp_path)
    assert "nan" not in page.read_text().lower().split("<img")[0]
    assert len(json.loads(record.read_text())) == 2 * len(result.controllers)


def test_training_curves_are_not_the_reported_ones():
    assert not set(training_curves()) & set(CURVES)


def test_tuning_improves_and_is_reproducible(tmp_path):
    bad = PurePursuit(lookahead=1.5, lookahead_time=1.0)
    one = {"chicane": training_curves()["chicane"]}
    first = tune(bad, one, generations=3, population=6)
    again = tune(bad, one, generations=3, population=6)
    assert first.cost < first.initial_cost - 0.5
    assert first.controller == again.controller
    assert first.history == sorted(first.history, reverse=True)
    content = json.loads(first.write(tmp_path / "a" / "tuned.json").read_text())
    assert PurePursuit(**content["controller"]) == first.controller


def test_a_search_is_judged_on_the_speeds_and_starts_that_it_is_given():
    law, speed, start = PurePursuit(lookahead=0.5), 1.0, InitialState(cross_track=0.1, settled=1.0)
    path = training_curves()["chicane"]
    found = tune(law, {"one": path}, speeds=[speed], starts=[start], generations=1, population=4)
    same = {
        "controller": law, "limits": Limits(speed=speed), "initial": start,
        "clock": Sampled(period=0.01, delay=0.01, duration=60.0),
    }  # fmt: skip
    runs = [simulate(path, plant=plant, **same) for plant in PLANTS]
    errors = [1e3 * run.metrics.cross_track_rms for run in runs]
    assert 10**found.initial_cost == pytest.approx(math.prod(errors) ** (1.0 / len(errors)), 1e-6)
    slower = tune(law, {"one": path}, speeds=[0.5], starts=[start], generations=1, population=4)
    assert slower.initial_cost != found.initial_cost


def test_a_generation_of_a_quick_search_is_one_block_of_lanes():
    search = quick_search()
    assert set(search["on"].items()) <= set(training_curves().items())
    runs = len(search["on"]) * len(search["speeds"]) * len(search["starts"]) * len(PLANTS)
    assert runs * search["population"] == LANES


def test_mistakes_are_explained():
    class Fixed(PurePursuit):
        tunable = {}  # noqa: RUF012

    with pytest.raises(InvalidInput, match="has no tunable fields"):
        tune(Fixed())
    with pytest.raises(InvalidInput, match="must be a file or one of cycloid"):
        curves(["circle"])
    with pytest.raises(InvalidInput, match="must be one of on-path"):
        starts(["upside-down"])
    with pytest.raises(InvalidInput, match="must be one of ideal"):
        conditions(["broken"])
    from osculate import Arc

    with pytest.raises(NoSolution, match="cannot follow"):
        compare({"a": CurvatureTracker()}, {"tiny": Arc(radius=0.05, angle=3.0)})
    assert issubclass(PurePursuit, PathTracker)
    assert Line(distance=1.0).length == 1.0
