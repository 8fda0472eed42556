"""Scenario files with any value anywhere: a scenario, or an error of the package that names the field."""

import contextlib
import copy
import math

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import (
    Block,
    Cycloid,
    Disc,
    InvalidInput,
    NoSolution,
    OsculateError,
    Scenario,
    Spline,
    Wall,
)
from osculate.control.lqr import yaw_regulator
from osculate.curve import CurveFile

pytestmark = pytest.mark.core

FILES = (
    {
        "name": "a",
        "scene": {
            "obstacles": [
                {"kind": "wall", "distance": 10.0, "height": 5.0},
                {"kind": "disc", "x": 1.0, "y": 2.0, "radius": 0.3},
                {"kind": "block", "corners": [[1, 1], [2, 1], [2, 2]]},
            ],
            "corridor": 0.5,
        },
        "robot": {"body_mass": 3.0, "wheelbase": 0.4, "wheel_radius": 0.1, "track_width": 0.2},
        "curve": {"kind": "cycloid", "margin": 1.0},
        "target": {"kind": "modified", "profile": {"kind": "exponential", "decay": 0.5}},
        "controller": {"kind": "curvature", "yaw": {"effort_weight": 1.0}, "speed": {"gain": 6.0}},
        "plant": {"kind": "reduced"},
        "disturbance": {"frequency": 4.0},
        "clock": {"kind": "continuous", "step": 0.001},
        "initial": {"cross_track": 0.0},
    },
    {
        "robot": "tugger",
        "curve": {"kind": "spline", "points": [[0, 0], [1.5, 0.5], [3, 0]], "tolerance": 0.1},
        "controller": {"kind": "curvature-tracker", "speed": {"switching": "boundary-layer"}},
        "limits": {"speed": 1.0},
        "plant": {"kind": "actuated", "payload": 0.0},
        "sensors": {"seed": 1},
        "safety": {"half_width": 0.3},
        "faults": [{"kind": "payload", "mass": 4.5}, {"kind": "gusts", "seed": 3}],
    },
    {"curve": {"kind": "file", "path": "track.csv", "scale": 0.1, "tolerance": 0.02}},
)
NUMBERS = (
    *(sign * size for sign in (1, -1) for size in (0, 1, 1e-300, 1e-9, 1e9, 1e300, math.inf)),
    *(math.nan, 10**400),
)
ODD = (
    *NUMBERS, None, True, "", "[bold]", "$\\", "😀", "\0", "a" * 5000, [], [[]], [None], ["a"],
    {}, {1: 2}, {"kind": []}, {"kind": "gusts", 1: 2}, [{"kind": "disc", None: 2}],
)  # fmt: skip


def places(tree, way=()):
    yield way
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for name, inner in items if isinstance(tree, (dict, list)) else ():
        yield from (
            places(inner, (*way, name)) if isinstance(inner, (dict, list)) else [(*way, name)]
        )


def replaced(tree, way, value):
    if not way:
        return value
    tree = copy.deepcopy(tree)
    inner = tree
    for name in way[:-1]:
        inner = inner[name]
    inner[way[-1]] = value
    return tree


CASES = [(file, way) for file in FILES for way in places(file)]


@settings(max_examples=400, deadline=None)
@given(st.sampled_from(CASES), st.sampled_from(ODD))
def test_any_value_makes_a_scenario_or_an_error_with_a_message(tmp_path_factory, case, value):
    folder = tmp_path_factory.mktemp("odd")
    (folder / "track.csv").write_text("0,0\n10,0\n20,5\n30,5\n")
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(replaced(*case, value)), encoding="utf-8")
    with contextlib.suppress(OsculateError):
        Scenario.load(path)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"\x00\x01", b"", b"\x80\x81: 1", b"- 1"])
def test_a_file_that_is_no_text_is_refused(tmp_path, content):
    path = tmp_path / "mine.yaml"
    path.write_bytes(content)
    with pytest.raises(OsculateError):
        Scenario.load(path)


@pytest.mark.parametrize("name", ["a" * 5000, "a\0b", "", "/"])
def test_what_can_be_no_path_is_refused(name):
    with pytest.raises(InvalidInput, match="scenario"):
        Scenario.load(name)


@pytest.mark.filterwarnings("ignore::UserWarning")
@settings(max_examples=200, deadline=None)
@given(st.sampled_from(NUMBERS), st.sampled_from(NUMBERS), st.sampled_from(NUMBERS))
def test_curves_and_obstacles_beyond_all_measure_are_refused(tmp_path_factory, a, b, c):
    track = tmp_path_factory.getbasetemp() / "track.csv"
    track.write_text("0,0\n10,0\n20,5\n30,5\n")
    made = (
        lambda: Cycloid(distance=a, height=b, margin=c).length,
        lambda: Spline(points=((0, 0), (a, b), (b, c))).length,
        lambda: CurveFile(path=str(track), scale=a).length,
        lambda: Disc(x=a, y=b, radius=c).outline((0.0, 0.0)).max(),
        lambda: Wall(distance=a, height=b, width=c).outline((0.0, 0.0)).max(),
        lambda: Block(corners=((0, 0), (a, b), (b, c))).outline((0.0, 0.0)).max(),
    )
    for make in made:
        with contextlib.suppress(OsculateError):
            assert math.isfinite(make())


SIZES = st.floats(1e-300, 1e300)


@pytest.mark.filterwarnings("ignore::scipy.linalg.LinAlgWarning")
@settings(max_examples=100, deadline=None)
@given(SIZES, SIZES, SIZES, SIZES)
def test_weights_of_any_size_make_a_regulator_or_no_solution(gain, heading, rate, effort):
    with contextlib.suppress(NoSolution):
        assert np.isfinite(yaw_regulator(gain, heading, rate, effort).gain).all()
