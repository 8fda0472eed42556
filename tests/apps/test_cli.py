"""The command line: what it prints, what it writes, how it fails."""

import json
import subprocess
import sys

import pytest


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
    done = osculate("run", path, "--output", tmp_path / "out", code=1)
    assert "diverged after t =" in done.stdout
    assert json.loads((tmp_path / "out" / "metrics.json").read_text())["ended"] == "diverged"
    assert (tmp_path / "out" / "report.html").is_file()


def test_scenarios_and_model_are_listed():
    assert "paper-disturbed" in osculate("scenarios").stdout
    assert r"\dot{v} = " in osculate("model").stdout


def test_paper_prints_every_verdict(tmp_path):
    done = osculate("paper", "--output", tmp_path)
    assert "does not hold" in done.stdout
    assert "holds only if" in done.stdout
    assert len(json.loads((tmp_path / "claims.json").read_text())) >= 20


def test_help_and_no_arguments():
    assert "run" in osculate("--help").stdout
    assert "Usage" in osculate("run", "--help").stdout
