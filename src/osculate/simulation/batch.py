"""Many robots at once: the same closed-loop step in lanes, blocks of lanes in threads."""

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.errors import InvalidInput, require_kind
from osculate.kernel import leaves
from osculate.scene import Scene
from osculate.simulation.alike import close_alike
from osculate.simulation.blocks import (
    Finished,
    Report,
    final_run,
    last_row,
    run_block,
)
from osculate.simulation.columns import LANES, Columns, places_of
from osculate.simulation.hits import HitWatch, scene_of
from osculate.simulation.loop import Loop, Setup, close_loop, size
from osculate.simulation.metrics import Metrics, summarise
from osculate.simulation.outcomes import in_corridor, outcomes, path_of, verdicts
from osculate.simulation.run import make_setup
from osculate.simulation.size import longest, require_callable, require_size, require_whole
from osculate.simulation.variables import RATES, Variable, variables_of
from osculate.simulation.verdict import Hit, Outcome, Verdict

RESOLUTION = 1e-9  # s, within which two times are the same


@dataclass(frozen=True)
class Batch:
    """Many runs of one kind of closed loop.

    Attributes:
        setup: What was run (the first of the setups where they differ).
        varied: What differed: name to values, shape (runs,).
        metrics: Metrics whose entries have shape (runs,).
        time: Times of the recorded steps (s), shape (rows,); empty without a record.
        record: Shape (runs, rows, variables). Once a run has ended its record stands still: where it
            ended, with speeds, targets, torques and errors of speed 0. Empty without a record.
        variables: What the record holds, in order.
        outcomes: How the runs went and ended; leaves of shape (runs,).
        hits: The first contact of every run with an obstacle.
    """

    setup: Setup
    varied: dict[str, NDArray[np.float64]]
    metrics: Metrics
    time: NDArray[np.float64]
    record: NDArray[np.float64]
    variables: tuple[Variable, ...]
    outcomes: Outcome
    hits: tuple[Hit | None, ...]

    @cached_property
    def verdicts(self) -> tuple[Verdict, ...]:
        """What became of every run."""
        return tuple(verdicts(self.outcomes, self.hits))

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
    scene: Scene | None = None,
    record_every: int = 0,
    threads: int | None = None,
    report: Report | None = None,
    **parts: Any,
) -> Batch:
    """Run many closed loops that are made of the same kinds of parts.

    Any argument but the clock may be a list of objects, one for every run. They must be of one kind, since
    all runs share their machine code; numbers of pushes and patches, delays, latencies may differ. Single
    numbers are varied faster by name, without an object for each: `variable_names` lists what there is.

    Args:
        curve: A curve, or a list of curves.
        robot: A robot, or a list of robots.
        runs: How many runs; needed only if no list and no array says so.
        vary: Name of a kernel parameter or initial value to values, shape (runs,).
        scene: Obstacles, for hits, and a corridor, for all runs; with obstacles every step is looked at.
        record_every: Keep every this many steps of all runs, the first one included; 0 keeps metrics only.
        threads: Threads that work on blocks of lanes; by default all processors.
        report: Called with the fraction of the runs that are done.
        **parts: As for `simulate`; each may be a list.

    Raises:
        InvalidInput: Lengths that differ, names that do not exist, parts of different kinds (names the part
            and the run), MuJoCo or a law from Python, which run one robot at a time.
    """
    require_callable(report)
    for name, value in (("runs", runs), ("threads", threads)):
        if value is not None:
            require_whole(name, value, 1)
    require_kind("vary", {} if vary is None else vary, Mapping)
    given = {"curve": curve, **({} if robot is None else {"robot": robot}), **parts}
    varied = {name: _numbers(name, values) for name, values in (vary or {}).items()}
    count = _count(runs, given, varied)
    around = Scene() if scene is None else scene
    require_kind("scene", around, Scene)
    setups = _setups(given, count)
    loops = [in_corridor(loop, around) for loop in close_alike(setups)]
    scenes = [scene_of(s, k.setup, around) for s, k in zip(setups, loops, strict=True)]
    columns = Columns(loops, varied, count)
    first = loops[0]
    clock = first.setup.clock
    require_whole("record_every", record_every, 0, clock.steps)
    rows = longest(clock, first.plan) / clock.step / record_every if record_every else 0.0
    kept = size(first.initial) + (rows + 1.0) * size(first.row)
    require_size("runs", count, count * kept, f"{count:.3g} runs with {rows:.3g} rows each")

    starts = range(0, count, LANES)
    done = 0
    pieces: list[tuple[Any, Any, NDArray[np.float64]]] = []
    hits: list[Hit | None] = []

    def run(start: int) -> tuple[Finished, list[Hit | None]]:
        return _run(first, columns, start, record_every, scenes)

    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool, _none_left(pool):
        for start, (block, touched) in zip(starts, pool.map(run, starts), strict=True):
            used = min(LANES, count - start)
            record = np.moveaxis(block.record[..., :used], 2, 0)
            pieces.append((block.runs[:, :used], block.last[:, :used], record))
            hits += touched
            done += used
            if report:
                report(done / count)
    return _collect(columns, pieces, record_every, around, hits)


def _numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(f"vary[{name!r}]", values, "must be one number for every run") from None


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
    return sorted(places_of(loop))


def _run(
    loop: Loop, columns: Columns, start: int, every: int, scenes: list[Scene]
) -> tuple[Finished, list[Hit | None]]:
    """The block of the lanes from run ``start``, and what its runs touch."""
    runs = range(start, min(start + LANES, columns.count))
    if scenes[0].is_empty:
        return run_block(loop, columns.block(start), every), [None] * len(runs)
    here = [scenes[n if len(scenes) > 1 else 0] for n in runs]
    watch = HitWatch([columns.loop(n).setup for n in runs], here, loop.row)
    block = run_block(loop, columns.block(start), every, watch=watch.see)
    return block, watch.hits()


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
    require_whole(name, count, 1)
    return count


def _is_list(name: str, value: Any) -> bool:
    """Whether a part is given for every run; the faults of one run are a tuple."""
    if name == "faults":
        return isinstance(value, list)
    return isinstance(value, Sequence) and not isinstance(value, str)


def _setups(given: Mapping[str, Any], count: int) -> list[Setup]:
    """One setup if no argument is a list, else one for every run."""
    several = count if any(_is_list(name, v) for name, v in given.items()) else 1
    setups = []
    for n in range(several):
        here = {name: v[n] if _is_list(name, v) else v for name, v in given.items()}
        setups.append(make_setup(here.pop("curve"), here.pop("robot", None), here))
    return setups


def _collect(
    columns: Columns,
    pieces: list[tuple[Any, Any, NDArray[np.float64]]],
    every: int,
    scene: Scene,
    hits: list[Hit | None],
) -> Batch:
    loop = columns.loops[0]
    final = final_run(loop, np.concatenate([p[0] for p in pieces], axis=1))
    last = last_row(loop, np.concatenate([p[1] for p in pieces], axis=1))
    curves = [c.setup.curve for c in columns.loops]
    lengths = np.array([curve.length for curve in curves])
    goals = np.array([[float(v) for v in curve.at(curve.length)[:2]] for curve in curves])
    metrics = summarise(final, last, lengths, (goals[:, 0], goals[:, 1]))
    rows = max(p[2].shape[1] for p in pieces)
    record = np.concatenate([_padded(p[2], rows) for p in pieces])
    clock = loop.setup.clock
    time = np.arange(rows) * (clock.step * every)
    variables = variables_of(loop.row)
    record = record[..., : len(variables)]
    latest = np.stack([*leaves(last)], axis=-1)[:, : len(variables)]
    _stand_still(record, time, final.status.time, latest, variables)
    went = outcomes(final, last, **_paths(columns, scene))
    varied = dict(columns.varied)
    return Batch(loop.setup, varied, metrics, time, record, variables, went, tuple(hits))


def _paths(columns: Columns, scene: Scene) -> dict[str, Any]:
    """What `outcomes` has to know of all paths, laws and corridors, each of shape (runs,)."""
    each = [path_of(loop, scene) for loop in columns.loops]
    known = {name: np.array([path[name] for path in each]) for name in each[0]}
    if "events.half_width" in columns.varied:
        known["half_width"] = columns.varied["events.half_width"]
    return known


def _padded(record: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """As many rows as the longest block; those that are missing repeat the last one."""
    missing = rows - record.shape[1]
    if missing == 0:
        return record
    return np.concatenate([record, np.repeat(record[:, -1:], missing, axis=1)], axis=1)


def _stand_still(
    record: NDArray[np.float64],
    time: NDArray[np.float64],
    ends: Any,
    last: NDArray[np.float64],
    variables: tuple[Variable, ...],
) -> None:
    """Hold every run where it ended: its last row, and after that one the same at rest.

    Args:
        record: Shape (runs, rows, variables), overwritten.
        time: Times of the rows (s), shape (rows,).
        ends: When the runs ended (s), shape (runs,).
        last: Their rows at that time, shape (runs, variables).
        variables: What the columns are.
    """
    resting = np.where([v.name in RATES for v in variables], 0.0, last)
    late = time - np.asarray(ends)[:, None]  # s, since the end
    for rows, here in ((resting, late > RESOLUTION), (last, np.abs(late) <= RESOLUTION)):
        run, row = np.nonzero(here)
        record[run, row] = rows[run]
        record[run, row, 0] = time[row]


__all__ = ["LANES", "Batch", "simulate_batch", "variable_names"]
