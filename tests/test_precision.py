"""What README says about precision holds within a factor of three, in both directions."""

import re
from pathlib import Path

import numpy as np

from osculate import CurvatureTracker, Cycloid, Disturbance, Limits, Modified, Spline, simulate
from osculate.study.comparison.compare import compare
from osculate.study.comparison.suite import conditions, curves, starts
from osculate.study.comparison.tuned import trackers_for
from osculate.vehicle import vehicle_named

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
FACTOR = 3.0
UNITS = {"mm": 1e-3, "micrometres": 1e-6}


def within(measured, stated):
    return stated / FACTOR < measured < FACTOR * stated


def test_the_first_example_is_as_exact_as_it_says():
    stated = re.search(r"the run holds the path to ([\d.]+) (mm)", README)
    run = simulate(Cycloid.over(), target=Modified(), disturbance=Disturbance.external())
    assert within(run.metrics.cross_track_rms, float(stated[1]) * UNITS[stated[2]])


def test_the_second_example_is_as_exact_as_it_says():
    stated = re.search(r"# m: ([\d.]+) (micrometres)", README)
    curve = Spline(points=((0, 0), (1.5, 0.5), (3, 0), (4.5, -0.5), (6, 0)))
    run = simulate(curve, controller=CurvatureTracker(), limits=Limits(speed=1.0))
    assert within(run.metrics.cross_track_rms, float(stated[1]) * UNITS[stated[2]])


def stated_table():
    """Condition to tracker to mean RMS (mm), of the table of the paper's robot."""
    table = README.partition("<!-- table paper -->")[2].partition("<!-- end -->")[0]
    header, _, *rows = [line.strip("| ").split("|") for line in table.splitlines() if "|" in line]
    names = [name.strip() for name in header]
    return {
        row[0].strip(): {
            name: float(cell.split()[0])
            for name, cell in zip(names[1:], row[1:], strict=True)
            if "failed" not in cell and "stopped" not in cell
        }
        for row in rows
    }


def test_the_table_is_as_exact_as_it_says():
    """The other conditions are run by ``make tables``, which writes the table."""
    stated = stated_table()["ideal"]
    assert len(stated) == 6
    trackers = trackers_for(vehicle_named("paper"))
    result = compare(
        {name: trackers[name] for name in stated}, curves(), start=starts(["running"]),
        condition=conditions(["ideal"]),
    )  # fmt: skip
    for name, millimetres in stated.items():
        measured = 1e3 * np.mean([cell["cross_track_rms"] for cell in result.of(name)])
        assert within(measured, millimetres), (name, measured, millimetres)
