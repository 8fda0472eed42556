"""Conditions suited to a robot, trackers tuned for one, and the command that writes the tables."""

import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import Gusts, Payload, Slope, Tricycle
from osculate.study.comparison import CONDITIONS, TUNED, trackers_for
from osculate.study.comparison.suite import conditions
from osculate.vehicle import VEHICLES

ROOT = Path(__file__).parents[3]


def make_tables(*arguments):
    subprocess.run([sys.executable, ROOT / "scripts" / "tables.py", *arguments], check=True)


def test_the_papers_robot_keeps_its_numbers():
    assert conditions(CONDITIONS) == CONDITIONS


@given(st.floats(0.5, 5000.0))
def test_a_payload_is_the_same_part_of_any_robot(mass):
    robot = Tricycle(body_mass=mass, body_inertia=mass)
    found = conditions(CONDITIONS, robot=robot)
    assert found["payload"].plant.payload / (mass + 6.0) == pytest.approx(5.0 / 9.0)
    (load, *_) = found["noisy-real"].faults
    assert isinstance(load, Payload)
    assert load.mass / (mass + 6.0) == pytest.approx(0.5)


@pytest.mark.parametrize("name", VEHICLES)
def test_the_motors_can_climb_the_slope_and_overcome_the_gusts(name):
    robot = VEHICLES[name]
    spare = robot.motor_deceleration - robot.actuators.rolling_resistance * robot.gravity
    for state in conditions(CONDITIONS, robot=robot).values():
        for fault in state.faults:
            if isinstance(fault, Slope):
                assert 0.0 < fault.gravity * fault.grade <= spare / 2.0 + 1e-9
            if isinstance(fault, Gusts):
                assert 0.0 < fault.along <= spare / 2.0 + 1e-9


def test_tuned_fields_are_tunable_and_a_strange_robot_is_told():
    for name, fields in TUNED.items():
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            laws = trackers_for(VEHICLES[name])
        for kind, values in fields.items():
            assert set(values) <= set(laws[kind].tunable)
            assert all(getattr(laws[kind], field) == value for field, value in values.items())
    with pytest.warns(UserWarning, match="not tuned for this robot"):
        trackers_for(Tricycle(body_mass=77.0))


def test_finished_cells_are_kept_and_pages_written_twice_are_the_same(tmp_path):
    page = "before\n<!-- table paper -->\nformerly\n<!-- end -->\nafter\n"
    (tmp_path / "docs").mkdir()
    for name in ("README.md", "docs/reality.md"):
        (tmp_path / name).write_text(page)
    given = [
        "--robots", "paper", "--conditions", "ideal", "--controllers",
        "curvature-tracker,pure-pursuit", "--curves", "corner", "--speeds", "1,2", "--workers", "1",
        "--pages", str(tmp_path), "--cells", str(tmp_path / "cells"),
    ]  # fmt: skip
    make_tables(*given)
    first = (tmp_path / "README.md").read_text()
    kept = {path: path.stat().st_mtime_ns for path in (tmp_path / "cells").rglob("*.json")}
    assert len(kept) == 2
    assert first.startswith("before\n<!-- table paper -->\n\n| condition | curvature-tracker |")
    assert "Over 1 comparisons `curvature-tracker` is better in" in first
    assert "formerly" not in first
    make_tables(*given)
    assert (tmp_path / "README.md").read_text() == first
    assert kept == {path: path.stat().st_mtime_ns for path in (tmp_path / "cells").rglob("*.json")}
