"""The command line: what it prints, what it writes, how it fails."""

import json
import math
import subprocess
import sys

import pytest

from osculate.apps.cli import main


def osculate(*arguments, code=0, **environment):
    import os

    done = subprocess.run(
        [sys.executable, "-m", "osculate", *map(str, arguments)],
        capture_output=True,
        text=True,
        env={**os.environ, "COLUMNS": "120", **environment},
        check=False,
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done


@pytest.mark.core
def test_run_prints_the_metrics_and_where_the_report_lies(tmp_path):
    done = osculate("run", "--output", tmp_path)
    for label in (
        "path length", "duration", "cross-track error, RMS", "cross-track error, max",
        "heading error, RMS", "clearance to the obstacle, min", "steering angle, peak",
        "steering rate, peak", "torque left, peak", "distance to the end of the path",
    ):  # fmt: skip
        assert label in done.stdout
    assert f"Report: {tmp_path / 'report.html'}" in done.stdout.replace("\n", "")
    assert json.loads((tmp_path / "metrics.json").read_text())["cross_track_rms"] < 1e-8


def test_run_takes_a_file(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("name: mine\ntarget: {kind: dynamical}\n", encoding="utf-8")
    done = osculate("run", path)
    assert "mine" in done.stdout
    assert "ended after its duration" in done.stdout


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("robot: {body_mass: -1}", "Scenario.robot.body_mass = -1: must be greater than 0 (kg)"),
        (
            "clock: {kind: continuous, step: 0.1}",
            "clock.step = 0.1: too large for the closed loop's fastest rate",
        ),
        (
            "curve: {kind: parametric, x: p, y: sin(p), end: 6}",
            "use the projected target for curves with straights or inflections",
        ),
    ],
)
def test_bad_input_is_one_message_and_exit_code_2(tmp_path, text, message):
    path = tmp_path / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    done = osculate("run", path, code=2)
    assert message in done.stderr.replace("\n", " ")
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


def test_a_diverging_run_is_reported_and_written(tmp_path):
    path = tmp_path / "wild.yaml"
    path.write_text(
        "target: {kind: static, profile: {kind: natural}}\n"
        "disturbance: {heading_feedback: 20, yaw_rate_feedback: 20}\n",
        encoding="utf-8",
    )
    done = osculate("run", path, "--output", tmp_path / "out", code=13)
    assert done.stdout.startswith("diverged: diverged after t =")
    assert json.loads((tmp_path / "out" / "metrics.json").read_text())["ended"] == "diverged"
    assert (tmp_path / "out" / "report.html").is_file()


def test_scenarios_and_model_are_listed():
    assert "paper-disturbed" in osculate("scenarios").stdout
    assert r"\dot{v} = " in osculate("model").stdout


def test_paper_prints_every_judgement(tmp_path):
    done = osculate(
        "paper", "--output", tmp_path, "--yaw-origin", "printed", "--after-end", "continue"
    )
    assert "does not hold" in done.stdout
    assert "holds only if" in done.stdout
    record = json.loads((tmp_path / "claims.json").read_text())
    assert len(record["claims"]) >= 40
    assert record["provenance"]["after_end"] == "continue"
    ends = {row["name"]: row["ending"] for row in record["experiments"]}
    assert ends["modified_d12"].startswith("ended after its duration of 20.000 s")
    bad = osculate("paper", "--yaw-origin", "zero", code=2)
    assert "yaw_origin = 'zero': must be one of start, printed" in bad.stderr.replace("\n", " ")


def test_help_and_no_arguments():
    assert "run" in osculate("--help").stdout
    assert "Usage" in osculate("run", "--help").stdout


def test_init_run_and_curve_lead_from_nothing_to_a_report(tmp_path):
    scenario = tmp_path / "scenario.yaml"
    osculate("init", scenario)
    done = osculate("run", scenario, "--output", tmp_path / "out")
    assert "reached the end of the path" in done.stdout
    counted = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert counted["cross_track_max"] < 1e-5  # not the start, 0.1 m off
    assert "<h2>Speed plan</h2>" in (tmp_path / "out" / "report.html").read_text()
    shown = osculate("curve", scenario, "--output", tmp_path)
    assert "tightest place" in shown.stdout
    assert (tmp_path / "curve.png").is_file()
    assert json.loads(osculate("schema").stdout)["title"] == "Scenario"


def test_a_scenario_finds_files_beside_it(tmp_path):
    (tmp_path / "way.csv").write_text("x,y\n0,0\n2,0.3\n4,0\n6,-0.2\n", encoding="utf-8")
    path = tmp_path / "mine.yaml"
    path.write_text(
        "robot: tugger\ncurve: {kind: file, path: way.csv}\n"
        "controller: {kind: pure-pursuit, lookahead: 0.8}\nscene: {obstacles: []}\n",
        encoding="utf-8",
    )
    assert "reached the end of the path" in osculate("run", path).stdout


def test_compare_and_tune(tmp_path):
    done = osculate(
        "compare", "--controllers", "curvature-tracker,lqr", "--curves", "corner", "--speeds", "1",
        "--starts", "on-path", "--output", tmp_path,
    )  # fmt: skip
    assert "curvature-tracker" in done.stdout
    assert len(json.loads((tmp_path / "comparison.json").read_text())) == 2
    done = osculate(
        "tune", "pure-pursuit", "--curves", "corner", "--generations", "1", "--quick",
        "--output", tmp_path / "tuned.json",
    )  # fmt: skip
    assert "lookahead" in done.stdout
    assert json.loads((tmp_path / "tuned.json").read_text())["controller"]["kind"] == "pure-pursuit"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("compare", "--controllers", "magic"), "controller = 'magic': must be one of"),
        (("compare", "--speeds", "fast"), "speeds = 'fast': must be positive numbers"),
        (("tune", "curvature"), "controller = 'curvature': must be one of"),
        (("curve", "corner", "--robot", "bus"), "robot = 'bus': must be one of paper, tugger"),
        (("curve", "corner", "--loop"), "loop = True: is for curves from files; corner is none"),
        (("curve", "corner", "--columns", "2"), "columns = '2': must be two numbers from 1"),
        (("curve", "corner", "--speed", "-1"), "speed = -1.0: must be positive (m/s)"),
        (("run", "nowhere.yaml"), "must be a YAML file or one of"),
    ],
)
def test_mistakes_on_the_command_line_are_explained(arguments, message):
    done = osculate(*arguments, code=2)
    assert message in done.stderr.replace("\n", " ")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("run --animate", "animate = True: goes into the output folder: give --output as well"),
        ("compare --scale 2", "scale = 2.0: is for curves from files; none of these is one"),
        ("tune lqr --scale 2", "scale = 2.0: is for curves from files"),
        ("compare --suite reality --plants slip", "suite = 'reality': names conditions"),
        ("compare --plants late --draws 2", "draws = 2: nothing is random under these conditions"),
    ],
)
def test_options_that_would_change_nothing_are_refused(arguments, message):
    from typer.testing import CliRunner

    from osculate import InvalidInput
    from osculate.apps.cli import app

    error = CliRunner().invoke(app, arguments.split()).exception
    assert isinstance(error, InvalidInput)
    assert message in str(error)


def test_every_option_is_read():
    """By the name of its argument, in the body of its command."""
    import inspect

    from osculate.apps.cli import app

    for command in app.registered_commands:
        body = inspect.getsource(command.callback).partition(") -> None:")[2]
        for name in inspect.signature(command.callback).parameters:
            assert name in body, (command.callback.__name__, name)


def test_a_curve_that_the_robot_cannot_follow_is_said_so(tmp_path):
    path = tmp_path / "tight.csv"
    path.write_text("0,0\n0.05,0.05\n0,0.1\n", encoding="utf-8")
    assert "cannot follow the curve" in osculate("curve", path, code=1).stdout.replace("\n", " ")


def wave(column=""):
    rows = (f"{n / 4},{0.8 * math.sin(math.pi * n / 12)}{column}" for n in range(49))
    return "\n".join(rows) + "\n"


def test_curve_says_what_it_understood(tmp_path):
    path = tmp_path / "wave.csv"
    path.write_text("y_mm;x_mm;vx_mps\n" + "\n".join(
        f"{800 * math.sin(math.pi * n / 12)};{250 * n};0.4" for n in range(49)
    ), encoding="utf-8")  # fmt: skip
    shown = osculate("curve", path).stdout
    assert "format: table with semicolons\n" in shown
    assert "columns: x_mm, y_mm (columns 2 and 1)\n" in shown
    assert "points: 49\n" in shown
    assert "units: mm\n" in shown
    assert "ends: open: its ends are 12 m apart" in shown
    assert "speeds: vx_mps is in the file and not used; --speeds keeps to it" in shown
    assert "13.8" in shown
    capped = osculate("curve", path, "--speeds", "--speed", "5").stdout
    assert "not used" not in capped
    assert "speeds of the file" in capped
    assert "or the file's speed, whichever is less, everywhere." in capped.replace("\n", " ")
    assert "but not at 5 m/s" in osculate("curve", path, "--speed", "5").stdout


def test_curve_takes_columns_and_ends_as_told(tmp_path):
    path = tmp_path / "log.csv"
    rows = [f"{n},{line}" for n, line in enumerate(wave().split())]
    path.write_text("\n".join(rows), encoding="utf-8")
    refused = osculate("curve", path, code=2).stderr.replace("\n", " ")
    assert "column 1 counts 0, 1, 2, …" in refused
    assert "--columns 2,3" in refused
    assert "13.8" in osculate("curve", path, "--columns", "2,3").stdout
    ring = tmp_path / "ring.csv"
    turns = [2 * math.pi * n / 40 for n in range(40)]
    ring.write_text(
        "\n".join(f"{3 * math.cos(a)},{3 * math.sin(a)}" for a in turns), encoding="utf-8"
    )
    assert "ends: closed: its ends are" in osculate("curve", ring).stdout
    assert "ends: open: as told (--no-loop)" in osculate("curve", ring, "--no-loop").stdout
    shown = osculate("curve", path, "--columns", "2,3", "--loop", code=1).stdout
    assert "ends: closed: as told" in shown
    assert "This robot cannot follow the curve" in shown


def test_curve_inspects_a_scenario_with_its_own_robot(tmp_path):
    (tmp_path / "way.csv").write_text("x,y\n" + wave(), encoding="utf-8")
    path = tmp_path / "mine.yaml"
    path.write_text(
        "robot: forklift\ncurve: {kind: file, path: way.csv, speeds: false}\nscene: {obstacles: []}\n"
        "controller: {kind: pure-pursuit}\n",
        encoding="utf-8",
    )
    own = osculate("curve", path).stdout
    assert "columns: x, y" in own
    assert "of 80.21°" in own  # the forklift's limit
    assert "of 70°" in osculate("curve", path, "--robot", "paper").stdout


@pytest.mark.parametrize(
    ("arguments", "blocked", "message"),
    [
        (("run", "--save", "a.mcap"), ["mcap_ros2"], "pip install 'osculate[mcap]'"),
        (("run", "--save", "a.mcap"), ["rosbags"], "pip install 'osculate[mcap]'"),
        (("run", "--save", "a.rrd"), ["rerun"], "pip install 'osculate[rerun]'"),
        (("run", "--video", "a.mp4"), ["av"], "pip install 'osculate[video]'"),
        (("run", "--save", "a.mp4"), ["av"], "pip install 'osculate[video]'"),
        (("run", "--video", "a.gif"), ["mujoco"], "pip install 'osculate[video]'"),
        (("run", "--save", "a.txt"), [], "must end in .nc, .mcap or .rrd"),
        (("run", "--video", "a.avi"), [], "must end in"),
        (("run", "--save", "file/a.nc"), [], "must be writable"),
        (("run", "--save", "a.nc", "--save", "./a.nc"), [], "is written already"),
        (("run", "-o", "a", "--animate", "--video", "a/animation.gif"), [], "is written already"),
        (("run", "--output", "file/out"), [], "output = 'file/out': must be a writable folder"),
        (("run", "--output", "file"), [], "output = 'file': must be a writable folder"),
        (("paper", "--output", "file"), [], "output = 'file': must be a writable folder"),
        (("compare", "--output", "file"), [], "output = 'file': must be a writable folder"),
        (("curve", "corner", "-o", "file/a"), [], "output = 'file/a': must be a writable folder"),
        (("tune", "lqr", "--output", "file/t.json"), [], "must be writable"),
        (("tune", "lqr", "--output", "."), [], "must be writable"),
        (("tune", "lqr"), ["cma"], "pip install 'osculate[tune]'"),
        (("compare", "--controllers", "lqr,nmpc"), ["casadi"], "pip install 'osculate[mpc]'"),
        (("compare", "--plants", "ideal,mujoco"), ["mujoco"], "pip install 'osculate[mujoco]'"),
    ],
)  # fmt: skip
def test_what_cannot_be_written_is_said_before_anything_runs(
    tmp_path, monkeypatch, capsys, arguments, blocked, message
):
    (tmp_path / "file").write_text("")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["osculate", *arguments])
    for name in blocked:
        here = [known for known in sys.modules if known.startswith(f"{name}.")]
        for known in (name, *here):
            monkeypatch.setitem(sys.modules, known, None)
    for name in ("run.run_loop", "physics.run_physics", "batch._run"):
        monkeypatch.setattr(f"osculate.simulation.{name}", pytest.fail)
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr()
    assert ended.value.code == 2
    assert message in " ".join(said.err.split())
    assert said.out == ""
    assert {path.name for path in tmp_path.iterdir()} == {"file"}


def test_a_film_that_fails_loses_nothing_that_was_written(tmp_path, monkeypatch, capsys):
    def fail(*_, **__):
        raise RuntimeError("the encoder gave up")

    scenario = tmp_path / "mine.yaml"
    scenario.write_text("clock: {kind: continuous, duration: 0.2}\n", encoding="utf-8")
    out = tmp_path / "out"
    monkeypatch.setattr("osculate.study.figures.write_animation", fail)
    monkeypatch.setattr(
        sys, "argv", ["osculate", "run", str(scenario), "--output", str(out), "--animate"]
    )
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 1
    said = " ".join(capsys.readouterr().err.split())
    assert "out is not complete: animation.gif is missing (RuntimeError('the encoder gave" in said
    assert {"run.nc", "metrics.json", "report.html", "overview.png", "INCOMPLETE.txt"} <= {
        path.name for path in out.iterdir()
    }
    assert "Missing: animation.gif (the encoder gave up)" in (out / "INCOMPLETE.txt").read_text()
