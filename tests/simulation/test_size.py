"""Runs that would not fit into memory are refused before they start, small curves are not."""

import pytest

from osculate import (
    Continuous,
    CurvatureTracker,
    Cycloid,
    InvalidInput,
    Laps,
    Late,
    Line,
    Sampled,
    Spline,
    Tricycle,
    plan_speed,
    simulate,
    simulate_batch,
)
from osculate.curve import tabulate
from osculate.curve.table import curvature_at, point_at
from osculate.kernel import Tables

LOOP = Spline(points=((0, 0), (4, -1), (6, 2), (2, 4)), loop=True)
TRACKER = CurvatureTracker()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: tabulate(LOOP, Tables(), cells=23_000_000), r"would need 23 M cells, at most 10 M"),
        (lambda: plan_speed(Line(distance=1e9), Tricycle()), r"would need 6\.67e\+03 M nodes"),
        (
            lambda: simulate(Laps(track=LOOP, count=10**6), controller=TRACKER),
            r"curve\.length = .* fewer laps",
        ),
        (
            lambda: simulate(LOOP, controller=TRACKER, clock=Sampled(period=0.01, delay=1e5)),
            r"clock\.delay = .*would keep 1e\+07 commands .*must be at most 1\.28 s",
        ),
        (
            lambda: simulate(LOOP, controller=TRACKER, faults=(Late(delay=100.0),)),
            r"clock\.delay = .*would keep 1e\+04 commands",
        ),
        (
            lambda: simulate(Cycloid.over(), clock=Continuous(step=1e-9, duration=100)),
            r"clock\.duration = 100\.0: would need .* M numbers \(1e\+11 steps of ",
        ),
        (
            lambda: simulate_batch(LOOP, controller=TRACKER, runs=10**9),
            r"runs = 1000000000: would need .* M numbers",
        ),
        (
            lambda: simulate_batch(LOOP, controller=TRACKER, runs=10**5, record_every=1),
            r"runs = 100000: would need .* M numbers",
        ),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_with_its_size(call, message):
    with pytest.raises(InvalidInput, match=message):
        call()


@pytest.mark.parametrize("length", [1e-3, 0.05, 0.5])
def test_short_curves_have_tables_of_bounded_size(length):
    tables = Tables()
    table = tabulate(Line(distance=length), tables, margin=3.0)
    assert tables.array.nbytes < 2e7
    assert point_at(0.5 * length, table, tables.array).x == pytest.approx(0.5 * length, abs=1e-12)
    assert point_at(length + 2.0, table, tables.array).x == pytest.approx(length + 2.0)
    assert curvature_at(0.5 * length, table, tables.array).curvature == 0.0


def test_a_line_of_a_millimetre_is_driven():
    run = simulate(Spline(points=((0, 0), (1e-3, 0))), controller=TRACKER)
    assert "reached the end" in run.verdict.sentence


def test_a_curve_too_fine_for_its_table_is_refused_by_place():
    from osculate import Parametric

    with pytest.raises(InvalidInput, match=r"turns by .* rad within .* m near s = "):
        tabulate(Parametric(x="p", y="sin(3000 * p)"), Tables())
