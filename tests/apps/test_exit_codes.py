"""The verdict through the door: exit code, first line, report and every file that is saved."""

import json

import pytest
from typer.testing import CliRunner

from osculate.apps.cli import app
from osculate.simulation.verdict import EXIT_CODES, INTERNAL_ERROR, WRONG_INPUT
from osculate.study import Scenario

LINE = (
    "robot: {robot}\ncurve: {{kind: line, distance: 6.0}}\ncontroller: {{kind: curvature-tracker}}\n"
    "clock: {{kind: sampled, period: 0.01, delay: 0.01, duration: 2.0}}\n"
)
EMPTY = "scene: {obstacles: []}\n"
CASES = {
    "reached": "scene: {obstacles: []}\nclock: {kind: continuous, duration: 20.0}\n",
    "left": LINE.format(robot="tugger")
    + "scene: {corridor: 0.05}\ninitial: {heading_error: 0.6}\n",
    "hit": LINE.format(robot="tugger")
    + "scene: {obstacles: [{kind: disc, x: 9, y: 9, radius: 1}, {kind: disc, x: 2, y: 0, radius: 0.1}]}\n",
    "late": LINE.format(robot="forklift") + EMPTY,
    "diverged": LINE.format(robot="paper")
    + EMPTY
    + "faults: [{kind: shove, time: 0.1, along: 1.0e9}]\n",
    "reversed": LINE.format(robot="paper")
    + EMPTY
    + "faults: [{kind: shove, time: 0.1, along: -30.0, duration: 0.2}]\n",
    "stopped": LINE.format(robot="paper").replace("2.0}", "20.0}")
    + EMPTY
    + "safety: {}\nfaults: [{kind: stuck-steering, time: 1.0}]\ninitial: {cross_track: 0.1}\n",
    "infeasible": EMPTY + "robot: forklift\ncontroller: {kind: curvature-tracker}\n"
    "curve: {kind: spline, points: [[0, 0], [0.5, 0.5], [1, 0], [1.5, -0.5], [2, 0]]}\n",
}


def run(tmp_path, text, *options):
    path = tmp_path / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return CliRunner().invoke(app, ["run", str(path), *map(str, options)])


@pytest.mark.parametrize("kind", CASES)
def test_the_first_line_and_the_exit_code_are_the_verdict(tmp_path, kind):
    done = run(tmp_path, CASES[kind])
    assert done.exit_code == EXIT_CODES[kind]
    shown = done.stderr if kind == "infeasible" else done.stdout
    assert shown.startswith(f"{kind}: ")


def test_help_lists_every_exit_code():
    shown = " ".join(CliRunner().invoke(app, ["run", "--help"]).stdout.split())
    for kind, code in EXIT_CODES.items():
        expected = "2 wrong input or infeasible" if code == WRONG_INPUT else f"{code} {kind}"
        assert expected in shown
    assert f"{INTERNAL_ERROR} internal error" in shown


def test_an_internal_error_is_exit_code_1(tmp_path, monkeypatch):
    def fail(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(Scenario, "run", fail)
    assert run(tmp_path, CASES["reached"]).exit_code == INTERNAL_ERROR


def test_a_hit_is_red_and_in_every_file(tmp_path):
    pytest.importorskip("mcap_ros2")
    out = tmp_path / "out"
    done = run(tmp_path, CASES["hit"], "--output", out, "--save", tmp_path / "run.mcap")
    verdict = json.loads((out / "metrics.json").read_text(encoding="utf-8"))["verdict"]
    assert (verdict["kind"], verdict["obstacle"]) == ("hit", 2)
    assert 0.0 < verdict["penetration"] < 1.0
    assert done.stdout.startswith(f"hit: {verdict['sentence']}\n")
    page = (out / "report.html").read_text(encoding="utf-8")
    banner = f'<p class="verdict bad"><strong>✗ hit</strong>: {verdict["sentence"]}.</p>'
    assert page.index(banner) < page.index("<section>")
    assert page.index(banner) < page.index("path length")
    assert f'"x": [{verdict["x"]}]' in page

    import xarray

    with xarray.open_dataset(out / "run.nc") as data:
        assert data.verdict == "hit"
        assert data.ended == verdict["sentence"]
        assert json.loads(data.verdict_details) == verdict
    status = diagnostics(tmp_path / "run.mcap")
    assert (status.level, status.message) == (2, f"hit: {verdict['sentence']}")
    values = {value.key: value.value for value in status.values}
    assert values["verdict kind"] == "hit"
    assert float(values["verdict penetration"]) == verdict["penetration"]


def diagnostics(path):
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        (found,) = reader.iter_decoded_messages(topics=["/diagnostics"])
        return found[3].status[0]


def test_what_is_infeasible_leaves_a_report_that_says_so(tmp_path):
    out = tmp_path / "out"
    done = run(tmp_path, CASES["infeasible"], "--output", out)
    assert done.exit_code == WRONG_INPUT
    verdict = json.loads((out / "metrics.json").read_text(encoding="utf-8"))["verdict"]
    assert verdict["kind"] == "infeasible"
    assert "needs a steering angle" in verdict["sentence"]
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "✗ infeasible" in page
    assert "There is no run" in page
    assert not (out / "run.nc").exists()


def test_a_good_run_is_green(tmp_path):
    run(tmp_path, CASES["reached"], "--output", tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert '<p class="verdict good"><strong>✓ reached</strong>' in page
    assert '"symbol": "x"' not in page
