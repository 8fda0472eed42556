"""Many robots at once: the same closed-loop step in lanes, blocks of lanes in threads."""

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.errors import InvalidInput
from osculate.kernel import Tables, names
from osculate.simulation.blocks import (
    Block,
    Finished,
    Report,
    final_run,
    last_row,
    run_block,
    single_block,
)
from osculate.simulation.loop import Loop, Setup, close_loop, size
from osculate.simulation.metrics import Metrics, summarise
from osculate.simulation.run import make_setup
from osculate.simulation.size import longest, require_size
from osculate.simulation.variables import Variable, variables_of

LANES = 64  # runs side by side in one block


@dataclass(frozen=True)
class Batch:
    """Many runs of one kind of closed loop.

    Attributes:
        setup: What was run (the first of the setups where they differ).
        varied: What differed: name to values, shape (runs,).
        metrics: Metrics whose entries have shape (runs,).
        time: Times of the recorded steps (s), shape (rows,); empty without a record.
        record: Shape (runs, rows, variables); after a run's end its last values are repeated. Empty
            without a record.
        variables: What the record holds, in order.
    """

    setup: Setup
    varied: dict[str, NDArray[np.float64]]
    metrics: Metrics
    time: NDArray[np.float64]
    record: NDArray[np.float64]
    variables: tuple[Variable, ...]

    @cached_property
    def data(self) -> Any:
        """Metrics (and record, if any) as an `xarray.Dataset` over ``run`` (and ``time``)."""
        from osculate.simulation.dataset import batch_dataset

        return batch_dataset(self)


def simulate_batch(
    curve: Any,
    robot: Any = None,
    *,
    runs: int | None = None,
    vary: Mapping[str, ArrayLike] | None = None,
    record_every: int = 0,
    threads: int | None = None,
    report: Report | None = None,
    **parts: Any,
) -> Batch:
    """Run many closed loops that are made of the same kinds of parts.

    Any argument may be a list of objects of one kind, one for every run. Single numbers are varied
    faster by name, without building an object for each: `variable_names` lists what there is.

    Args:
        curve: A curve, or a list of curves.
        robot: A robot, or a list of robots.
        runs: How many runs; needed only if no list and no array says so.
        vary: Name of a kernel parameter or initial value to values, shape (runs,).
        record_every: Keep every this many steps of all runs; 0 keeps metrics only.
        threads: Threads that work on blocks of lanes; by default all processors.
        report: Called with the fraction of the runs that are done.
        **parts: As for `simulate`; each may be a list.

    Raises:
        InvalidInput: Lengths that differ, names that do not exist, parts of different kinds.
    """
    given = {"curve": curve, **({} if robot is None else {"robot": robot}), **parts}
    varied = {name: np.asarray(values, dtype=float) for name, values in (vary or {}).items()}
    count = _count(runs, given, varied)
    loops = _close_loops(given, count)
    columns = _Columns(loops, varied, count)
    first = loops[0]
    clock = first.setup.clock
    rows = longest(clock, first.plan) / clock.step / record_every if record_every else 0.0
    kept = size(first.initial) + (rows + 1.0) * size(first.row)
    require_size("runs", count, count * kept, f"{count:.3g} runs with {rows:.3g} rows each")

    starts = range(0, count, LANES)
    done = 0
    pieces: list[tuple[Any, Any, NDArray[np.float64]]] = []
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool, _none_left(pool):
        for start, block in zip(
            starts, pool.map(lambda s: _run(first, columns, s, record_every), starts), strict=True
        ):
            used = min(LANES, count - start)
            record = np.moveaxis(block.record[..., :used], 2, 0)
            pieces.append((block.runs[:, :used], block.last[:, :used], record))
            done += used
            if report:
                report(done / count)
    return _collect(first, columns, pieces, record_every)


@contextmanager
def _none_left(pool: ThreadPoolExecutor) -> Iterator[None]:
    """After an error or Ctrl-C, blocks that have not begun are not run."""
    try:
        yield
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise


def variable_names(curve: Any, robot: Any = None, **parts: Any) -> list[str]:
    """Names that ``vary`` of `simulate_batch` accepts for these parts."""
    loop = close_loop(make_setup(curve, robot, parts))
    return sorted(_places(loop))


def _places(loop: Loop) -> dict[str, list[tuple[int, int]]]:
    """Name of a number to where a `Block` holds it: which of its arrays, and the row."""
    places: dict[str, list[tuple[int, int]]] = {}
    for array, value in ((1, loop.parameters), (3, loop.thought)):
        for row, name in enumerate(names(value)):
            if name.rpartition(".")[2] != "zero":
                places.setdefault(name, []).append((array, row))
    for row, name in enumerate(names(loop.initial.state)):
        places[f"initial.{name}"] = [(0, row)]
    return places


def _run(loop: Loop, columns: "_Columns", start: int, every: int) -> Finished:
    return run_block(loop, columns.block(start), every)


def _count(
    runs: int | None, given: Mapping[str, Any], varied: Mapping[str, NDArray[np.float64]]
) -> int:
    lengths = {name: len(v) for name, v in given.items() if _is_list(name, v)}
    for name, values in varied.items():
        if values.ndim > 1:
            raise InvalidInput(f"vary[{name!r}]", values.shape, "must be one number for every run")
        if values.ndim == 1:
            lengths[f"vary[{name!r}]"] = len(values)
    if runs is not None:
        lengths["runs"] = runs
    if not lengths:
        raise InvalidInput("runs", runs, "must be given when nothing varies")
    name, count = next(iter(lengths.items()))
    for other, length in lengths.items():
        if length != count:
            raise InvalidInput(other, length, f"must have the length of {name}, {count}")
    if count < 1:
        raise InvalidInput(name, count, "must be at least 1")
    return count


def _is_list(name: str, value: Any) -> bool:
    """Whether a part is given for every run; the faults of one run are a tuple."""
    if name == "faults":
        return isinstance(value, list)
    return isinstance(value, Sequence) and not isinstance(value, str)


def _close_loops(given: Mapping[str, Any], count: int) -> list[Loop]:
    """One loop if no argument is a list, else one for every run, all in the same tables."""
    several = count if any(_is_list(name, v) for name, v in given.items()) else 1
    tables = Tables()
    loops = []
    for n in range(several):
        here = {name: v[n] if _is_list(name, v) else v for name, v in given.items()}
        setup = make_setup(here.pop("curve"), here.pop("robot", None), here)
        loops.append(close_loop(setup, tables))
        if loops[n].decide is not None:
            raise InvalidInput(
                "controller", setup.controller, "decides in Python; use simulate, one run at a time"
            )
        if loops[n].bindings != loops[0].bindings or setup.clock != loops[0].setup.clock:
            raise InvalidInput(
                f"run {n}",
                type(setup.target).__name__,
                "must have the same kinds of parts and clock as run 0",
            )
    whole = tables.array
    return [replace(loop, tables=whole) for loop in loops]


class _Columns:
    """The initial runs and parameters of any block, without holding all of them."""

    def __init__(
        self, loops: list[Loop], varied: Mapping[str, NDArray[np.float64]], count: int
    ) -> None:
        self.count, self.loops = count, loops
        self.places = _places(loops[0])
        for name in varied:
            if name not in self.places:
                raise InvalidInput(
                    f"vary[{name!r}]", name, f"unknown; valid: {', '.join(sorted(self.places))}"
                )
        self.varied = {n: np.broadcast_to(v, (count,)) for n, v in varied.items()}

    def block(self, start: int) -> Block:
        """The runs of the lanes from run ``start``; the last one is repeated."""
        index = np.minimum(np.arange(start, start + LANES), self.count - 1)
        if len(self.loops) == 1:
            block = Block(*(np.repeat(a, LANES, axis=1) for a in single_block(self.loops[0])))
        else:
            columns = [single_block(self.loops[i]) for i in index]
            block = Block(*(np.hstack(parts) for parts in zip(*columns, strict=True)))
        for name, values in self.varied.items():
            for array, row in self.places[name]:
                block[array][row] = values[index]
        return block


def _collect(
    loop: Loop,
    columns: _Columns,
    pieces: list[tuple[Any, Any, NDArray[np.float64]]],
    every: int,
) -> Batch:
    final = final_run(loop, np.concatenate([p[0] for p in pieces], axis=1))
    last = last_row(loop, np.concatenate([p[1] for p in pieces], axis=1))
    curves = [c.setup.curve for c in columns.loops]
    lengths = np.array([curve.length for curve in curves])
    ends = np.array([[float(v) for v in curve.at(curve.length)[:2]] for curve in curves])
    metrics = summarise(final, last, lengths, (ends[:, 0], ends[:, 1]))
    rows = max(p[2].shape[1] for p in pieces)
    record = np.concatenate([_padded(p[2], rows) for p in pieces])
    clock = loop.setup.clock
    time = np.arange(rows) * (clock.step * every)
    variables = variables_of(loop.row)
    record = record[..., : len(variables)]
    return Batch(loop.setup, dict(columns.varied), metrics, time, record, variables)


def _padded(record: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """Repeat the last row of a block that ended early."""
    missing = rows - record.shape[1]
    if missing == 0:
        return record
    return np.concatenate([record, np.repeat(record[:, -1:], missing, axis=1)], axis=1)


__all__ = ["LANES", "Batch", "simulate_batch", "variable_names"]
