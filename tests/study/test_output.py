"""What a run leaves behind: report, metrics, record, pictures."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from osculate import InvalidInput, NoSolution, NotWritten, Scenario
from osculate.folder import MARK
from osculate.simulation.verdict import infeasible
from osculate.study.output import write_output, write_refusal


@pytest.fixture(scope="module")
def scenario():
    return Scenario.load("paper")


@pytest.fixture(scope="module")
def run(scenario):
    """A run, one of whose metrics is not known."""
    done = scenario.run()
    return replace(done, metrics=replace(done.metrics, energy=math.nan))


@pytest.fixture(scope="module")
def folder(scenario, run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("output") / "deep" / "down"
    seen = []
    write_output(run, folder, scenario, animate=True, report=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)
    return folder


def test_all_files_are_there(folder):
    names = {path.name for path in folder.iterdir()}
    assert names == {
        "report.html", "metrics.json", "run.nc", "scenario.json", "animation.gif", "overview.png",
        "path.png", "speeds.png", "errors.png", "steering.png", "torques.png", ".osculate.json",
    }  # fmt: skip


def test_metrics_carry_units(folder, run):
    metrics = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    assert metrics["cross_track_rms"] == run.metrics.cross_track_rms
    assert metrics["units"]["torque_left_max"] == "N m"
    for name in (
        "path_length", "duration", "cross_track_max", "heading_error_rms", "clearance_min",
        "steering_angle_max", "steering_rate_max", "torque_right_max", "end_position_error",
    ):  # fmt: skip
        assert isinstance(metrics[name], float), name


def test_what_is_not_known_is_null_in_json_and_a_word_on_the_page(folder, run):
    def refuse(name):
        raise AssertionError(f"{name} is no JSON")

    for path in folder.glob("*.json"):
        json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)
    assert json.loads((folder / "metrics.json").read_text(encoding="utf-8"))["energy"] is None
    assert "<td>not known</td>" in (folder / "report.html").read_text(encoding="utf-8")


def test_the_written_scenario_can_be_run_again(folder, scenario):
    assert Scenario.load(folder / "scenario.json") == scenario


def test_the_report_is_one_page_that_works_offline(folder):
    page = (folder / "report.html").read_text(encoding="utf-8")
    outside = re.sub(r"<script>.*?</script>", "<script></script>", page, flags=re.DOTALL)
    assert "http" not in outside
    assert "<link" not in outside
    assert "src=" not in outside
    for heading in ("Path", "Speeds", "Cross-track error", "Steering", "Torques"):
        assert f"<h2>{heading}</h2>" in page
    assert "clearance to the obstacle, min" in page
    for trace in ("obstacle", "footprint", "target curve", "path driven"):
        assert f'"{trace}"' in page


def test_pictures_are_pictures(folder):
    for name in ("overview.png", "path.png", "torques.png"):
        with Image.open(folder / name) as image:
            assert min(image.size) > 300
            assert len(image.convert("L").getcolors()) > 20
    with Image.open(folder / "animation.gif") as animation:
        assert animation.n_frames > 50


def test_an_unwritable_folder_is_explained(run, scenario, tmp_path):
    blocker = tmp_path / "file"
    blocker.write_text("")
    with pytest.raises(InvalidInput, match=r"output = .*must be a writable folder"):
        write_output(run, blocker / "below", scenario)


def test_what_lies_elsewhere_is_written_although_the_folder_cannot(run, scenario, tmp_path):
    blocker = tmp_path / "file"
    blocker.write_text("")
    with pytest.raises(InvalidInput, match="must be a writable folder"):
        write_output(run, blocker, scenario, also=[tmp_path / "run.nc", blocker / "other.nc"])
    assert {path.name for path in tmp_path.iterdir()} == {"file", "run.nc"}


def test_a_file_that_fails_elsewhere_leaves_a_complete_folder(run, scenario, tmp_path):
    (tmp_path / "file").write_text("")
    also = [tmp_path / "file" / "run.nc", tmp_path / "out" / "own.nc"]
    with pytest.raises(NotWritten, match=r"file/run.nc is missing"):
        write_output(run, tmp_path / "out", scenario, also=also)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"report.html", "own.nc", "torques.png"} <= names
    assert MARK not in names
    write_output(run, tmp_path / "out", scenario)
    assert not (tmp_path / "out" / "own.nc").exists()


def test_a_scenario_that_lies_in_its_own_output_is_never_missing(
    run, scenario, tmp_path, monkeypatch
):
    write_output(run, tmp_path, scenario)
    rename = Path.replace

    def look(path, target):
        assert Scenario.load(tmp_path / "scenario.json") == scenario
        return rename(path, target)

    monkeypatch.setattr(Path, "replace", look)
    write_output(run, tmp_path, scenario, also=[tmp_path / "own.nc"])


def test_a_refusal_takes_the_place_of_an_earlier_run(run, scenario, tmp_path, monkeypatch):
    verdict = infeasible(NoSolution("<the turn> is too tight"))
    write_output(run, tmp_path, scenario)
    (tmp_path / "own.txt").write_text("mine", encoding="utf-8")
    assert write_refusal(verdict, tmp_path, scenario) == tmp_path / "report.html"
    assert {path.name for path in tmp_path.iterdir()} == {
        "report.html", "metrics.json", "scenario.json", ".osculate.json", "own.txt",
    }  # fmt: skip
    found = json.loads((tmp_path / "metrics.json").read_text(encoding="utf-8"))
    assert found == {"verdict": verdict.as_dict()}
    assert "&lt;the turn&gt; is too tight" in (tmp_path / "report.html").read_text("utf-8")

    def fail(*_):
        raise OSError("no space")

    monkeypatch.setattr("osculate.study.report.write_text", fail)
    with pytest.raises(NotWritten, match=r"report.html is missing \(no space\)"):
        write_refusal(verdict, tmp_path, scenario)
    assert (tmp_path / MARK).exists()
