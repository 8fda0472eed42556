"""What `osculate curve FILE` says about points and trajectories that need a word."""

import json
import math
import re
import sys
import warnings

import numpy as np
import pytest

from osculate.apps.cli import main

W = math.sqrt(0.5)


@pytest.fixture
def inspect(tmp_path, monkeypatch, capsys):
    """Write a file and inspect it: exit code and all that is printed, on one line."""

    def call(text, name="path.csv", *options):
        path = tmp_path / name
        path.write_text(text if isinstance(text, str) else json.dumps(text), encoding="utf-8")
        monkeypatch.setattr(sys, "argv", ["osculate", "curve", str(path), *options])
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            with pytest.raises(SystemExit) as left:
                main()
        printed = capsys.readouterr()
        return left.value.code, " ".join((printed.out + printed.err).split())

    return call


def rows(points):
    return "x,y\n" + "\n".join(f"{x},{y}" for x, y in points)


def number(pattern, words):
    return float(re.search(pattern, words).group(1))


def trajectory(degree, knots, points):
    control = [dict(zip(("x", "y", "weight"), (*p, 1.0)[:3], strict=True)) for p in points]
    return {"degree": degree, "knotVector": knots, "controlPoints": control}


def test_uneven_points_stay_near_their_polyline(inspect):
    code, words = inspect(rows([(0, 0), (4, 0), (4.3, 0), (4.6, 0), (4.6, 4)]))
    assert code == 0
    assert number(r"polyline max (\S+) m", words) <= 0.2
    assert number(r"length (\S+) m", words) == pytest.approx(8.6, abs=0.1)
    assert "can follow" in words


def test_two_points_are_a_straight_line(inspect):
    code, words = inspect(rows([(0, 0), (3, 4)]))
    assert code == 0
    assert "length 5 m" in words
    assert "can follow the curve at 1 m/s everywhere" in words


def test_pairs_are_named_with_a_tolerance(inspect):
    points = [(n, 0.0) for n in range(11)]
    points.insert(4, (3.001, 0.0005))
    _, words = inspect(rows(points))
    assert "points 4 lie within 0.0011 m of their neighbours" in words
    assert "tolerance: 0.002" in words
    assert "curvature 0 … 0 1/m" in words


def test_rounded_coordinates_are_told(inspect):
    x = np.linspace(0, 12, 49)
    wave = np.stack([388096 + x, 5572090 + 0.8 * np.sin(x)], axis=1)
    _, words = inspect(rows([(f"{a:g}", f"{b:g}") for a, b in wave]))
    assert "y takes only multiples of 10 m, all equal: rounded to 6 digits" in words
    _, words = inspect(rows(wave.astype(np.float32).tolist()))
    assert "y takes only multiples of 0.5 m: rounded to single precision" in words


def test_a_path_that_turns_round_is_refused_at_its_point(inspect):
    points = [(0.25 * n, 0) for n in range(13)] + [
        (3 - 0.25 * n, -0.02 * n * n) for n in range(1, 9)
    ]
    code, words = inspect(rows(points))
    assert code == 2
    assert "turns round at point 12 (line 14) = (3, 0), s = 3 m" in words


def test_the_textbook_half_circle_passes(inspect):
    points = [(0, 0, 1), (3, 0, W), (3, 3, 1), (3, 6, W), (0, 6, 1)]
    code, words = inspect(trajectory(2, [0, 0, 0, 0.5, 0.5, 1, 1, 1], points), "arc.json")
    assert code == 0
    assert "length 9.42478 m" in words
    assert "curvature 0.3333 … 0.3333 1/m" in words


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (
            trajectory(1, [0, 0, 0.5, 1, 1], [(0, 0), (3, 0), (3, 3)]),
            "s = 3 m, (3, 0)': the heading jumps",
        ),
        (
            trajectory(2, [0] * 4 + [1] * 4, [(n, -4) for n in range(5)]),
            "occurs 4 times, at most degree + 1 = 3 (the knots fit degree 3 with 4 points)",
        ),
        (
            trajectory(3, [0] * 4 + [0.5] + [1] * 4, [(0, 0), (0, 0), (2, 0), (4, 1), (4, 1)]),
            "points 0 and 1 = (0.0, 0.0)': must not coincide",
        ),
    ],
)
def test_trajectories_that_no_robot_drives_are_refused(inspect, made, message):
    code, words = inspect(made, "trajectory.json")
    assert code == 2
    assert message in words


@pytest.mark.parametrize(
    ("y", "message"),
    [
        ("9**9**9", "its position is not finite at p = 0"),
        ("1 / (p - 0.37123)", "grows without bound (a pole) near p = 0.37123"),
        ("sin(p", "must be a formula in p with + - * / **"),
    ],
)
def test_formulas_fail_in_one_sentence(inspect, y, message):
    code, words = inspect(f"curve: {{kind: parametric, x: p, y: '{y}'}}\n", "scenario.yaml")
    assert code == 2
    assert message in words
    assert "Traceback" not in words


def test_formulas_are_resolved(inspect):
    text = "curve: {kind: parametric, x: p, y: 'atan(1e6 * (p - 0.37))'}\n"
    code, words = inspect(text, "scenario.yaml")
    assert code == 1
    assert "length 4.1382 m" in words
    assert "cannot follow the curve: at s = " in words
