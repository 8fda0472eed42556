"""Driving the compiled engine: blocks of lanes in, final runs and records out."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking.external import Decide
from osculate.kernel import leaves, names, rebuild
from osculate.simulation.clock import Sampled
from osculate.simulation.loop import Loop, size
from osculate.simulation.records import Progress, Row

CHUNK = 2048  # steps between two reports of progress
FIRST_BYTES = 64_000_000  # of a record, before it grows

Report = Callable[[float], None]
Watch = Callable[[NDArray[np.float64]], None]


class Block(NamedTuple):
    """Runs side by side, one column for each; a continuous law has no minds and no thoughts."""

    runs: NDArray[np.float64]  # shape (leaves of Progress, lanes)
    parameters: NDArray[np.float64]  # shape (leaves of Parameters, lanes)
    minds: NDArray[np.float64]  # shape (leaves of Mind, lanes)
    thoughts: NDArray[np.float64]  # shape (leaves of Thought, lanes)


def single_block(loop: Loop) -> Block:
    """The block of one run as the loop describes it."""
    columns = (loop.initial, loop.parameters, loop.mind, loop.thought)
    return Block(*(np.array([*leaves(value)], dtype=float)[:, None] for value in columns))


@dataclass(frozen=True)
class Finished:
    """A block after its last instant."""

    runs: NDArray[np.float64]  # shape (leaves of Progress, lanes)
    minds: NDArray[np.float64]  # shape (leaves of Mind, lanes)
    record: NDArray[np.float64]  # shape (rows, leaves of Row, lanes)
    last: NDArray[np.float64]  # shape (leaves of Row, lanes), the row at the last instant


def run_block(
    loop: Loop,
    block: Block,
    every: int = 0,
    report: Report | None = None,
    watch: Watch | None = None,
) -> Finished:
    """Run one block from start to end.

    Args:
        loop: The closed loop.
        block: Initial runs and their parameters; not changed.
        every: Record every this many steps; 0 records nothing.
        report: Called with the fraction of the steps made.
        watch: Called with the rows of every step, shape (rows, leaves of Row, lanes), as they are made.
    """
    runs, minds = block.runs.copy(), block.minds.copy()
    lanes = runs.shape[1]
    engine, clock, row = loop.engine(lanes), loop.setup.clock, loop.row
    decide = _decision(loop, runs, minds, block.thoughts)
    chunk = clock.substeps if loop.sampled else CHUNK
    rows = 0 if every == 0 else (clock.steps + every - 1) // every
    record = np.empty((min(rows, FIRST_BYTES // (8 * size(row) * lanes)), size(row), lanes))
    rows_of_chunk = np.empty((chunk if watch else 0, size(row), lanes))
    made = filled = reported = 0
    while made < clock.steps:
        steps = min(chunk, clock.steps - made)
        record = _roomy(record, filled, min(rows, filled + steps))
        decide(made * clock.step)
        target = rows_of_chunk if watch else record[filled:]
        done = engine.run_block(
            runs, block.parameters, loop.tables, made, steps, clock.step, clock.substeps,
            1 if watch else max(every, 1), target,
        )  # fmt: skip
        begun, before = made, filled
        made += done
        filled = 0 if every == 0 else (made + every - 1) // every
        if watch:
            watch(target[:done])
        if watch and every:
            record[before:filled] = target[before * every - begun : done : every]
        if report and (made - reported >= CHUNK or made == clock.steps):
            reported = made
            report(made / clock.steps)
        if done < steps:
            break
    last = np.empty((size(row), lanes))
    engine.land_block(runs, block.parameters, loop.tables, clock.step, clock.substeps, last)
    if watch:
        watch(last[None])
    return Finished(runs, minds, record[:filled], last)


def _decision(
    loop: Loop,
    runs: NDArray[np.float64],
    minds: NDArray[np.float64],
    thoughts: NDArray[np.float64],
) -> Callable[[float], None]:
    """What is to be called at every instant, with its time (s)."""
    clock = loop.setup.clock
    if not isinstance(clock, Sampled):
        return lambda t: None
    decider, tables, period = loop.decider(runs.shape[1]), loop.tables, clock.period
    ask = None if loop.decide is None else _question(loop, loop.decide, runs, minds)

    def decide(t: float) -> None:
        if ask:
            ask()
        decider.decide_block(runs, minds, thoughts, tables, t, period)

    return decide


def _question(
    loop: Loop, law: Decide, runs: NDArray[np.float64], minds: NDArray[np.float64]
) -> Callable[[], None]:
    """What puts the steering angle of a law in Python into its memory, for one run."""
    measure: Any = loop.bindings["measure"]
    place = list(names(loop.mind)).index("memory.steer.steering_angle")

    def ask() -> None:
        run = rebuild(loop.initial, iter(runs[:, 0].tolist()))
        mind = rebuild(loop.mind, iter(minds[:, 0].tolist()))
        minds[place, 0] = law(measure(run.state.plant, loop.thought.plant), mind.memory)

    return ask


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


def last_row(loop: Loop, last: NDArray[np.float64]) -> Row:
    """All last rows as one `Row` whose leaves are arrays of shape (lanes,)."""
    return rebuild(loop.row, iter(last))
