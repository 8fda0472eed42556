"""Steering decisions that come from Python: the optimiser as a baseline."""

import pytest

from osculate import (
    Actuated,
    InvalidInput,
    Limits,
    Nmpc,
    Sampled,
    compare,
    simulate,
    simulate_batch,
)
from osculate.study.comparison.suite import CURVES, starts

casadi = pytest.importorskip("casadi")
CLOCK = Sampled(period=0.04, delay=0.04, duration=20.0)


@pytest.mark.core
def test_it_follows_a_corner_and_reports_progress():
    seen = []
    run = simulate(
        CURVES["corner"], plant=Actuated(), controller=Nmpc(horizon=10), clock=CLOCK,
        limits=Limits(speed=1.0), report=seen.append,
    )  # fmt: skip
    assert run.metrics.ended == "path end"
    assert run.metrics.cross_track_rms < 3e-3
    assert seen == sorted(seen)


def test_it_takes_part_in_comparisons():
    result = compare(
        {"nmpc": Nmpc(horizon=8)}, {"corner": CURVES["corner"]}, speeds=[1.0],
        start=starts(["on-path"]), clock=CLOCK,
    )  # fmt: skip
    (cell,) = result.cells
    assert not cell["failed"]
    assert cell["cross_track_rms"] < 5e-3


def test_it_runs_one_robot_at_a_time():
    with pytest.raises(InvalidInput, match="one run at a time"):
        simulate_batch(
            CURVES["corner"], runs=2, plant=Actuated(), controller=Nmpc(), clock=CLOCK,
            limits=Limits(speed=1.0),
        )  # fmt: skip
