"""Significance from paired results."""

import math

import numpy as np
import pytest

from osculate.study.comparison.compare import Comparison
from osculate.study.comparison.significance import condition_table, paired_comparisons, summary


def cell(controller, curve, seed, rms, failed=False, ended="path end"):
    return {
        "controller": controller, "curve": curve, "speed": 1.0, "start": "on-path", "plant": "noisy",
        "seed": seed, "cross_track_rms": rms, "cross_track_max": 3.0 * rms, "failed": failed,
        "arrived": ended == "path end" and not failed, "ended": ended,
    }  # fmt: skip


def comparison(factor, spread, seed=1):
    rng = np.random.default_rng(seed)
    cells = []
    for curve in "abcdefgh":
        level = 1e-3 * math.exp(rng.normal(0.0, 2.0))  # curves differ far more than controllers
        for draw in (1, 2):
            cells.append(cell("ours", curve, draw, level))
            theirs = level * factor * math.exp(rng.normal(0.0, spread))
            cells.append(cell("theirs", curve, draw, theirs))
    return Comparison(cells, {}, {})


@pytest.mark.parametrize(
    ("factor", "word"), [(1.5, "better"), (1.0 / 1.5, "worse"), (1.0, "equal")]
)
def test_pairs_tell_better_from_worse_though_curves_differ(factor, word):
    (pair,) = paired_comparisons(comparison(factor, 0.1), "ours")
    assert pair.word == word
    assert pair.low < factor < pair.high
    assert pair.low < pair.ratio < pair.high
    assert pair.cells == 8
    assert "95 % CI" in pair.sentence


def test_a_stop_before_errors_count_has_no_largest_error():
    early = cell("ours", "a", 1, math.nan, ended="safety stop")
    for others, bound in (([], "1 of 1 stopped"), ([2e-3], "2 of 2 stopped, ≤ 6 mm")):
        late = [cell("ours", "a", 2, rms, ended="safety stop") for rms in others]
        for cells in ([early, *late], [*late, early]):
            assert condition_table(Comparison(cells, {}, {}), "ours")[1] == ["noisy", bound]


def test_the_interval_covers_the_truth_as_often_as_it_says():
    hits = 0
    for seed in range(200):
        (pair,) = paired_comparisons(comparison(1.3, 0.3, seed), "ours")
        hits += pair.low < 1.3 < pair.high
    assert 180 <= hits <= 199


def test_failures_are_counted_and_not_compared():
    cells = comparison(2.0, 0.1).cells
    cells[1]["failed"], cells[1]["arrived"] = True, False
    (pair,) = paired_comparisons(Comparison(cells, {}, {}), "ours")
    assert (pair.failed, pair.other_failed, pair.runs) == (0, 1, 16)
    assert "it failed in 0 and theirs in 1 of 16 runs" in pair.sentence
    header, row = condition_table(Comparison(cells, {}, {}), "ours")
    assert header == ["condition", "ours", "theirs"]
    assert row[2].endswith("+ (1 of 16 failed)")
    assert summary([pair]).startswith("Over 1 comparisons the controller is better in 1")


def test_stops_are_told_apart_from_arrivals():
    cells = [cell(name, "a", 1, 0.0, ended="safety stop") for name in ("ours", "theirs")]
    (pair,) = paired_comparisons(Comparison(cells, {}, {}), "ours")
    assert "nothing can be said" in pair.sentence
    assert condition_table(Comparison(cells, {}, {}), "ours")[1][1] == "1 of 1 stopped, ≤ 0 mm"
