"""Template: run a block of closed loops side by side, ``LANES`` of them (one, or many)."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.reasons import ARRIVED
from osculate.kernel import compiled, finite_sum, kernel, load, scratch, select, store
from osculate.simulation.events import watch_events
from osculate.simulation.records import (
    DIVERGED,
    FINISHED,
    RUNNING,
    STOPPED,
    Moved,
    Parameters,
    Progress,
    Row,
    Status,
)
from osculate.simulation.tally import count

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.plant.reduced import measure_reduced as measure
    from osculate.simulation.templates.continuous import halted, hold, look, respond
    from osculate.simulation.templates.rk4 import rk4

    LANES = 1
    LIKE: Any = None
    LIKE_PARAMETERS: Any = None
    LIKE_ROW: Any = None

STANDSTILL = 1e-3  # m/s, below which a robot that stops has stopped
LANDINGS = 4  # Newton steps to the instant at which the path ends


@kernel
def observe(
    t: float,
    elapsed: float,
    run: Progress,
    action: Any,
    p: Parameters,
    tables: NDArray[np.float64],
) -> Any:
    """The record's row at time ``t``, the tally and the events with this sample."""
    _, reference, command, errors, _ = respond(t, run.state, action, p, tables)
    motion = measure(run.state.plant, p.plant)
    tally = count(elapsed, motion, command, run.tally, p.settled, p.plant.model, p.curve, tables)
    events = watch_events(t, elapsed, motion, tally, run.events, p.events)
    row = Row(
        t,
        motion,
        reference,
        command,
        errors,
        run.state.target.arc_length,
        tally.foot,
        tally.cross_track,
        tally.heading_error,
        look(action),
    )
    return row, tally, events


@kernel
def advance(
    t: float, h: float, elapsed: float, run: Progress, action: Any, p: Parameters, tables: Any
) -> Any:
    """Observe a run at ``t`` and move it on by ``h``, unless it has ended: then it stays.

    A single run is not touched any more once it has ended, so that it needs no such care.
    """
    row, tally, events = observe(t, elapsed, run, action, p, tables)
    state = rk4(t, h, run.state, action, p, tables)
    speed = measure(state.plant, p.plant).speed
    wild = finite_sum(state) != 0.0 or not abs(speed) <= p.speed_limit
    travelled = state.target.arc_length - run.state.target.arc_length
    beyond = (
        state.target.arc_length >= p.finish
        or tally.foot + travelled >= p.path_end
        or t + h >= p.deadline
    )
    still = abs(measure(run.state.plant, p.plant).speed) < STANDSTILL
    stopped = halted(run.held) if still else 0.0
    beyond = beyond or stopped == ARRIVED
    stands = STOPPED if stopped > 0.0 else RUNNING
    code = DIVERGED if wild else (FINISHED if beyond else stands)
    running = LANES == 1 or run.status.code == RUNNING
    going = running and code == RUNNING
    moved = Moved(
        select(going, state, run.state),
        select(running, tally, run.tally),
        select(running, events, run.events),
        select(running, Status(code, t + h if going else t), run.status),
    )
    return row, moved


@kernel
def land(h: float, age: int, substeps: int, run: Progress, p: Parameters, tables: Any) -> Any:
    """The last instant of a run: where path or timetable ends if it does, else where it stands."""
    t = run.status.time
    action = hold(age, substeps, run.held, p)
    finished = run.status.code == FINISHED
    part = 0.0
    state = run.state
    goal = run.state.target.arc_length + p.path_end - run.tally.foot
    goal = p.finish if p.finish < goal else goal
    speed = measure(run.state.plant, p.plant).speed
    rests = halted(run.held) == ARRIVED and abs(speed) < STANDSTILL
    for _ in range(LANDINGS):
        speed = measure(state.plant, p.plant).speed
        part = part + (goal - state.target.arc_length) / (speed if speed > 1e-9 else 1e-9)
        part = part if part < h else h
        part = part if part < p.deadline - t else p.deadline - t
        part = part if part > 0.0 and finished and not rests else 0.0
        state = rk4(t, part, run.state, action, p, tables)
    ended = Progress(
        select(finished, state, run.state), run.tally, run.events, run.status, run.held
    )
    row, tally, events = observe(t + part, part, ended, action, p, tables)
    fresh = run.status.code != DIVERGED
    status = Status(run.status.code, t + part)
    counted, seen = select(fresh, tally, run.tally), select(fresh, events, run.events)
    return row, Moved(ended.state, counted, seen, status)


@kernel
def any_running(block: NDArray[np.float64]) -> bool:
    """Whether a run of the block has not ended yet."""
    running = 0
    for lane in range(LANES):
        running += load(LIKE, block, lane).status.code == RUNNING
    return running > 0


@kernel
def copy(source: NDArray[np.float64], target: NDArray[np.float64]) -> None:
    """Copy a block."""
    for leaf in range(source.shape[0]):
        for lane in range(LANES):
            target[leaf, lane] = source[leaf, lane]


@compiled
def run_block(
    runs: NDArray[np.float64],
    parameters: NDArray[np.float64],
    tables: NDArray[np.float64],
    start: int,
    steps: int,
    h: float,
    substeps: int,
    every: int,
    record: NDArray[np.float64],
) -> int:
    """Advance a block by up to ``steps`` steps from step ``start``; returns the steps made.

    Args:
        runs: Shape (leaves, LANES), read and overwritten.
        parameters: Shape (leaves, LANES).
        tables: Shape (n,).
        start: Number of the first step; time is step times ``h``.
        steps: Steps to make at most; fewer when all runs have ended.
        h: Step (s).
        substeps: Steps between two instants of a sampled law.
        every: A step is recorded when its number is a multiple of this.
        record: Shape (rows, leaves, LANES), one row per recorded step; nothing if it has no rows.
    """
    block = scratch(LIKE, LANES)
    rows = scratch(LIKE_ROW, LANES)
    copy(runs, block)
    alone = load(LIKE_PARAMETERS, parameters, 0)
    filled = 0
    made = 0
    while made < steps:
        # a single run is looked at before every step, many of them now and then: see `advance`
        if made % LANES == 0 and not any_running(block):
            break
        step = start + made
        age = step % substeps
        elapsed = h if step > 0 else 0.0
        recording = step % every == 0 and filled < record.shape[0]
        if recording and LANES > 1:  # many runs are seldom recorded: look at them only then
            for lane in range(LANES):
                run = load(LIKE, block, lane)
                p = load(LIKE_PARAMETERS, parameters, lane)
                action = hold(age, substeps, run.held, p)
                row, _, _ = observe(step * h, elapsed, run, action, p, tables)
                store(row, rows, lane)
        for lane in range(LANES):
            run = load(LIKE, block, lane)
            p = alone if LANES == 1 else load(LIKE_PARAMETERS, parameters, lane)
            action = hold(age, substeps, run.held, p)
            row, moved = advance(step * h, h, elapsed, run, action, p, tables)
            store(moved, block, lane)
            if LANES == 1:
                store(row, rows, lane)
        if recording:
            copy(rows, record[filled])
            filled += 1
        made += 1
    copy(block, runs)
    return made


@compiled
def land_block(
    runs: NDArray[np.float64],
    parameters: NDArray[np.float64],
    tables: NDArray[np.float64],
    h: float,
    substeps: int,
    record: NDArray[np.float64],
) -> None:
    """Bring every run of a block to its last instant; see `run_block`.

    Args:
        runs: See `run_block`; likewise all arguments up to ``tables``.
        parameters: See `run_block`.
        tables: See `run_block`.
        h: Step (s).
        substeps: Steps between two instants of a sampled law.
        record: Shape (leaves, LANES), the row at the last instant.
    """
    for lane in range(LANES):
        run = load(LIKE, runs, lane)
        p = load(LIKE_PARAMETERS, parameters, lane)
        age = int(run.status.time / h + 0.5) % substeps
        row, landed = land(h, age, substeps, run, p, tables)
        store(landed, runs, lane)
        store(row, record, lane)
