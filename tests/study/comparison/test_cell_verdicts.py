"""What became of the runs of a comparison: its cells, its table, its first line."""

import json

import pytest

from osculate import Comparison, CurvatureTracker, InitialState, compare
from osculate.study.comparison.report import cell_table, verdict_text
from osculate.study.comparison.suite import CURVES


@pytest.fixture(scope="module")
def comparison():
    """One run that is well, one that begins by leaving what comparisons allow, one that makes that good."""
    starts = {
        "on-path": InitialState(),
        "leaving": InitialState(cross_track=0.45, heading_error=1.2),
        "settled": InitialState(cross_track=0.45, heading_error=1.2, settled=3.0),
    }
    return compare(
        {"curvature-tracker": CurvatureTracker()}, {"slalom": CURVES["slalom"]}, speeds=(1.0,),
        start=starts,
    )  # fmt: skip


def test_cells_are_judged_by_their_verdicts(comparison):
    fine, left, settled = comparison.cells
    for cell in (fine, settled):
        assert (cell["verdict"], cell["failed"], cell["arrived"]) == ("reached", False, True)
    assert (left["verdict"], left["failed"], left["arrived"]) == ("left", True, False)
    assert left["sentence"].startswith("left the corridor of 0.5 m to each side at t = ")
    assert left["verdict_time"] < 2.0
    assert not comparison.reached
    assert comparison.verdict == "1 of 3 runs did not reach the end: 1 left"
    assert Comparison([fine, settled], {}, {}).verdict == "all 2 runs reached the end"
    assert Comparison([fine, settled], {}, {}).reached


def test_the_table_marks_what_did_not_reach_the_end(comparison):
    head, *rows = cell_table(comparison)
    column = head.index("verdict")
    marks = [row[column] for row in rows]
    cell = comparison.cells[1]
    where = f"{cell['verdict_time']:.2f} s, {cell['verdict_place']:.2f} m"
    assert marks == ["reached", f"✗ left at {where}", "reached"]
    assert verdict_text(cell) == marks[1]


def test_the_page_begins_with_what_became_of_all_runs(comparison, tmp_path):
    page, record, parquet, *_ = comparison.write(tmp_path)
    text = page.read_text(encoding="utf-8")
    line = '<p class="verdict bad">✗ 1 of 3 runs did not reach the end: 1 left.</p>'
    assert text.index(line) < text.index("Ranking")
    assert '<td class="bad">✗ left at ' in text
    assert json.loads(record.read_text(encoding="utf-8"))[1]["verdict"] == "left"

    import pyarrow.parquet as pq

    assert pq.read_table(parquet)["verdict"].to_pylist() == ["reached", "left", "reached"]
