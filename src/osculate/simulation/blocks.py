"""Driving the compiled engine: blocks of lanes in, final runs and records out."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import rebuild
from osculate.simulation.loop import Loop, blank_row, size
from osculate.simulation.records import Progress, Row

CHUNK = 2048  # steps between two reports of progress
FIRST_BYTES = 64_000_000  # of a record, before it grows

Report = Callable[[float], None]


@dataclass(frozen=True)
class Finished:
    """A block after its last instant."""

    runs: NDArray[np.float64]  # shape (leaves of Progress, lanes)
    record: NDArray[np.float64]  # shape (rows, leaves of Row, lanes)
    last: NDArray[np.float64]  # shape (leaves of Row, lanes), the row at the last instant


def run_block(
    loop: Loop,
    runs: NDArray[np.float64],
    parameters: NDArray[np.float64],
    every: int = 0,
    report: Report | None = None,
) -> Finished:
    """Run one block from start to end.

    Args:
        loop: The closed loop.
        runs: Initial runs, shape (leaves of Progress, lanes); not changed.
        parameters: Shape (leaves of Parameters, lanes).
        every: Record every this many steps; 0 records nothing.
        report: Called with the fraction of the steps made.
    """
    lanes = runs.shape[1]
    engine, clock, row = loop.engine(lanes), loop.setup.clock, blank_row()
    likes = (loop.initial, loop.parameters, row)
    runs = np.array(runs)
    rows = 0 if every == 0 else (clock.steps + every - 1) // every
    record = np.empty((min(rows, FIRST_BYTES // (8 * size(row) * lanes)), size(row), lanes))
    made = filled = 0
    while made < clock.steps:
        steps = min(CHUNK, clock.steps - made)
        record = _roomy(record, filled, min(rows, filled + steps))
        done = engine.run_block(
            *likes, runs, parameters, loop.tables, made, steps,
            clock.step, clock.substeps, max(every, 1), record[filled:],
        )  # fmt: skip
        made += done
        filled = 0 if every == 0 else (made + every - 1) // every
        if report:
            report(made / clock.steps)
        if done < steps:
            break
    last = np.empty((size(row), lanes))
    engine.land_block(*likes, runs, parameters, loop.tables, clock.step, clock.substeps, last)
    return Finished(runs, record[:filled], last)


def _roomy(record: NDArray[np.float64], filled: int, needed: int) -> NDArray[np.float64]:
    """The record with room for ``needed`` rows: long durations cost memory only when they are driven."""
    if needed <= len(record):
        return record
    larger = np.empty((max(needed, 2 * len(record)), *record.shape[1:]))
    larger[:filled] = record[:filled]
    return larger


def final_run(loop: Loop, runs: NDArray[np.float64]) -> Progress:
    """All final runs as one `Progress` whose leaves are arrays of shape (lanes,)."""
    return rebuild(loop.initial, iter(runs))


def last_row(last: NDArray[np.float64]) -> Row:
    """All last rows as one `Row` whose leaves are arrays of shape (lanes,)."""
    return rebuild(blank_row(), iter(last))
