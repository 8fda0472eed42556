"""Controllers × curves × speeds × starts × conditions, in lanes: one cell for every combination."""

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking import PathTracker
from osculate.control.tracking.external import ExternalTracker
from osculate.curve import Curve
from osculate.errors import require_kind
from osculate.files import write_text
from osculate.folder import OutputFolder
from osculate.plant import Mujoco, world_of
from osculate.scene import Scene
from osculate.simulation import (
    InitialState,
    Sampled,
    Verdict,
    VerdictKind,
    simulate,
    simulate_batch,
)
from osculate.simulation.size import require_callable
from osculate.strict_json import strict_json
from osculate.study.comparison.arguments import require_effect, require_named
from osculate.study.comparison.kept import Arrays, Kept, key_of
from osculate.study.comparison.suite import Condition, conditions, curves, starts
from osculate.study.comparison.tuned import trackers_for
from osculate.target import Limits, plan_speed
from osculate.vehicle import Tricycle

OFF_ROAD = 0.5  # m, distance from the curve at which a run has left it, once errors count
LANE = Scene(corridor=OFF_ROAD)
PATIENCE = 2.0  # times the planned duration, after which a run counts as failed
FINEST = 1e-9  # m, below which errors are rounding
RECORD = 0.05  # s between two samples of the traces
FIELDS = {  # of a cell, from the metrics of a run
    "cross_track_rms": "cross_track_rms",
    "cross_track_max": "cross_track_max",
    "heading_error_rms": "heading_error_rms",
    "duration": "duration",
    "steering_travel": "steering_travel",
    "torque_travel": "torque_travel",
    "energy": "energy",
    "speed_max": "speed_max",
}
TRACED = ("foot", "cross_track_error", "x", "y")
UNITS = {
    "speed": "m/s", "cross_track_rms": "m", "cross_track_max": "m", "heading_error_rms": "rad",
    "duration": "s", "steering_travel": "rad", "torque_travel": "N m", "energy": "J",
    "speed_max": "m/s", "verdict_place": "m", "verdict_time": "s",
}  # fmt: skip


class Trace(NamedTuple):
    """What one run looked like."""

    arc_length: NDArray[np.float64]  # m
    cross_track: NDArray[np.float64]  # m
    x: NDArray[np.float64]  # m
    y: NDArray[np.float64]  # m


class Standing(NamedTuple):
    """How one controller did over all cells."""

    controller: str
    cross_track_rms: float  # m, mean over cells
    cross_track_max: float  # m, worst cell
    failures: int
    ratio: float  # geometric mean of its RMS over that of the first, cell by cell
    wins: int  # cells in which it is more exact than the first
    cells: int  # in which both arrived


def log_rms(cell: Mapping[str, Any]) -> float:
    """Logarithm of a cell's RMS error; errors below a nanometre, as on a straight line, are equal."""
    return math.log(max(cell["cross_track_rms"], FINEST))


@dataclass(frozen=True)
class Comparison:
    """The result: one dictionary per cell, traces for figures, and the curves."""

    cells: list[dict[str, Any]]
    traces: dict[tuple[str, ...], Trace]  # (controller, curve, speed, start, condition)
    curves: Mapping[str, Curve]

    def of(self, controller: str) -> list[dict[str, Any]]:
        """The cells of one controller, in the order in which all controllers have theirs."""
        return [cell for cell in self.cells if cell["controller"] == controller]

    @property
    def controllers(self) -> list[str]:
        """Names of the controllers."""
        return list(dict.fromkeys(cell["controller"] for cell in self.cells))

    @property
    def verdict(self) -> str:
        """What became of all runs, in a sentence."""
        kinds = Counter(cell["verdict"] for cell in self.cells)
        reached = kinds.pop(str(VerdictKind.REACHED), 0)
        if not kinds:
            return f"all {reached} runs reached the end"
        others = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())
        return (
            f"{len(self.cells) - reached} of {len(self.cells)} runs did not reach the end: {others}"
        )

    @property
    def reached(self) -> bool:
        """Whether all runs reached the end."""
        return all(cell["verdict"] == VerdictKind.REACHED for cell in self.cells)

    def ranking(self) -> list[Standing]:
        """All controllers, the most exact first, each compared cell by cell with the first."""
        order = sorted(self.controllers, key=self._merit)
        first = self.of(order[0])
        return [self._standing(name, first) for name in order]

    def _merit(self, controller: str) -> tuple[int, float]:
        cells = self.of(controller)
        alive = [log_rms(c) for c in cells if c["arrived"]]
        return sum(c["failed"] for c in cells), float(np.mean(alive)) if alive else math.inf

    def _standing(self, name: str, first: list[dict[str, Any]]) -> Standing:
        cells = self.of(name)
        alive = [c for c in cells if c["arrived"]]
        pairs = [
            log_rms(c) - log_rms(f)
            for c, f in zip(cells, first, strict=True)
            if c["arrived"] and f["arrived"]
        ]
        return Standing(
            name,
            float(np.mean([c["cross_track_rms"] for c in alive])) if alive else math.nan,
            max((c["cross_track_max"] for c in alive), default=math.nan),
            sum(c["failed"] for c in cells),
            float(np.exp(np.mean(pairs))) if pairs else math.nan,
            sum(pair < 0.0 for pair in pairs),
            len(pairs),
        )

    def write(self, output: str | Path) -> list[Path]:
        """Write ``comparison.html``, ``comparison.json``, ``comparison.parquet`` and one PNG per curve.

        Raises:
            InvalidInput: The folder cannot be made or written.
            NotWritten: Some of the files could not be written; the others are there.
        """
        from osculate.study.comparison.report import write_figures, write_page

        text = strict_json(self.cells, indent=1)
        with OutputFolder(output, "comparison") as folder:
            folder.write("comparison.json", lambda path: write_text(path, text + "\n"))
            folder.write("comparison.parquet", self._write_parquet)
            figures = write_figures(self, folder)
            folder.write("comparison.html", lambda path: write_page(self, path, figures))
        return sorted(folder.written, key=lambda path: path.suffix != ".html")

    def _write_parquet(self, path: Path) -> Path:
        import pyarrow as pa
        import pyarrow.parquet as pq

        table = pa.Table.from_pylist(self.cells)
        units = {name.encode(): unit.encode() for name, unit in UNITS.items()}
        pq.write_table(table.replace_schema_metadata(units), path)
        return path


def compare(
    controllers: Mapping[str, PathTracker] | None = None,
    on: Mapping[str, Curve] | None = None,
    *,
    speeds: Sequence[float] = (0.5, 1.0, 2.0),
    start: Mapping[str, InitialState] | None = None,
    condition: Mapping[str, Condition] | None = None,
    robot: Tricycle | None = None,
    limits: Limits | None = None,
    clock: Sampled | None = None,
    draws: int = 1,
    keep: Kept | str | Path | None = None,
    report: Callable[[float], None] | None = None,
) -> Comparison:
    """Run every combination and collect one cell for each.

    Args:
        controllers: Path trackers by name; by default all of the package, as tuned for the robot.
        on: Curves by name; by default the built-in set.
        speeds: Largest speeds (m/s).
        start: Initial states by name.
        condition: Ways in which the robot differs from what its law believes, by name.
        robot: The robot; by default the paper's.
        limits: Limits of the speed plans; ``speed`` comes from ``speeds``.
        clock: Period, known delay and step; the duration follows from the plans unless it is given.
        draws: How often every combination with random numbers is run, each time with another seed;
            all controllers meet the same ones.
        keep: Folder in which every finished cell is kept; cells that are there already, made by the
            same code from the same parts, are taken over and not run again.
        report: Called with the fraction that is done.

    Raises:
        InvalidInput: An argument that is empty, of another kind, or has no effect beside the others.
        NoSolution: The robot cannot follow one of the curves.
        MissingExtra: A controller or condition needs a package that is not installed.
    """
    body, task = Tricycle() if robot is None else robot, Limits() if limits is None else limits
    require_kind("robot", body, Tricycle)
    require_kind("limits", task, Limits)
    laws = require_named("controllers", controllers, PathTracker, lambda: trackers_for(body))
    paths = require_named("on", on, Curve, curves)
    begins = require_named("start", start, InitialState, starts)
    states = require_named("condition", condition, Condition, lambda: conditions(robot=body))
    require_effect(task, speeds, draws, states)
    timing = clock if clock is not None else Sampled(period=0.01, delay=0.01)
    require_kind("clock", timing, Sampled)
    require_callable(report)
    kept = Kept.at(keep)
    _load(laws, states)
    grid = list(itertools.product(paths, speeds, begins))
    allowed = {v: task.but(speed=v, creep=min(task.creep, v)) for v in speeds}
    longest = max(
        plan_speed(path, body, bound).duration
        for path in paths.values()
        for bound in allowed.values()
    )
    comparison = Comparison([], {}, paths)
    given = "duration" in timing.model_fields_set
    duration = timing.duration if given else PATIENCE * longest + 5.0
    tasks = [(name, kind) for name in laws for kind in states]
    for done, (name, kind) in enumerate(tasks, 1):
        state = states[kind]
        count = draws if state.seeded else 1
        cells = [(*cell, seed) for cell in grid for seed in range(1, count + 1)]
        work = [
            {
                "curve": paths[c], "robot": body, "limits": allowed[v], "initial": begins[s],
                **_surroundings(state.drawn(seed)),
            }
            for c, v, s, seed in cells
        ]  # fmt: skip
        own = _clock(timing, state, body, duration)
        outcomes = _run_or_take(work, laws[name], own, kept)
        for (c, v, s, seed), (values, verdict, trace) in zip(cells, outcomes, strict=True):
            comparison.cells.append(_cell((name, c, v, s, kind, seed), values, verdict, state))
            comparison.traces.setdefault((name, c, f"{v:g}", s, kind), trace)
        if report:
            report(done / len(tasks))
    return comparison


def _load(laws: Mapping[str, PathTracker], states: Mapping[str, Condition]) -> None:
    """Ask for optional packages now, not after hours."""
    for part in (*laws.values(), *(state.plant for state in states.values())):
        if isinstance(part, (ExternalTracker, Mujoco)):
            part.load()


def _surroundings(state: Condition) -> dict[str, Any]:
    return {
        "plant": state.plant, "sensors": state.sensors, "faults": state.faults,
        "safety": state.safety,
    }  # fmt: skip


def _clock(timing: Sampled, state: Condition, robot: Tricycle, duration: float) -> Sampled:
    """The clock of a condition: its plant may need a shorter step."""
    plant = world_of(state.plant, state.faults).plant
    steps = math.ceil(timing.period / min(timing.step, plant.longest_step(robot)) - 1e-9)
    return timing.but(
        step=timing.period / steps,
        unknown_delay=timing.unknown_delay + state.unknown_delay,
        duration=duration,
    )


Outcome = tuple[dict[str, Any], Verdict, Trace]


def _run_or_take(
    work: list[dict[str, Any]], law: PathTracker, clock: Sampled, kept: Kept | None
) -> list[Outcome]:
    """The outcome of each run: of those that are kept, or run now and kept as soon as they are made."""
    if kept is None:
        return [*_run(work, law, clock)]
    keys = [key_of(controller=law, clock=clock, **parts) for parts in work]
    found = [_unpacked(kept.find(key)) for key in keys]
    left = [n for n, outcome in enumerate(found) if outcome is None]
    if left:
        for n, outcome in zip(left, _run([work[n] for n in left], law, clock), strict=True):
            kept.keep(keys[n], _packed(outcome))
            found[n] = outcome
    return [outcome for outcome in found if outcome is not None]


def _packed(outcome: Outcome) -> Arrays:
    values, verdict, trace = outcome
    return {
        "metrics": _row(values), "verdict": _row(verdict.as_dict()), "trace": np.stack(trace)
    }  # fmt: skip


def _unpacked(arrays: Arrays | None) -> Outcome | None:
    if arrays is None:
        return None
    values, found = _fields(arrays["metrics"]), _fields(arrays["verdict"])
    verdict = Verdict(**{**found, "kind": VerdictKind(found["kind"])})
    return values, verdict, Trace(*arrays["trace"])


def _row(values: Mapping[str, Any]) -> NDArray[Any]:
    """Named values of any kinds, bit for bit, as one row of a table; None is left out."""
    known = {name: value for name, value in values.items() if value is not None}
    return np.array(
        [tuple(known.values())],
        dtype=[(name, np.asarray(value).dtype) for name, value in known.items()],
    )


def _fields(row: NDArray[Any]) -> dict[str, Any]:
    return dict(zip(row.dtype.names or (), row[0].item(), strict=True))


def _run(work: list[dict[str, Any]], law: PathTracker, clock: Sampled) -> Iterator[Outcome]:
    alone = isinstance(law, ExternalTracker) or isinstance(work[0]["plant"], Mujoco)
    return (_run_alone if alone else _run_together)(work, law, clock)


def _run_alone(work: list[dict[str, Any]], law: PathTracker, clock: Sampled) -> Iterator[Outcome]:
    """One run after the other: values of the metrics, verdict and trace of each."""
    every = max(1, round(RECORD / clock.step))
    for parts in work:
        run = simulate(**parts, controller=law, clock=clock, scene=LANE)
        columns = (run.columns[name][::every] for name in TRACED)
        yield run.metrics.as_dict(), run.verdict, Trace(*columns)


def _run_together(
    work: list[dict[str, Any]], law: PathTracker, clock: Sampled
) -> Iterator[Outcome]:
    """The same in lanes."""
    same = {"robot": work[0]["robot"], "controller": law, "clock": clock}
    each: dict[str, Any] = {
        name: [parts[name] for parts in work] for name in work[0] if name not in same
    }
    every = max(1, round(RECORD / clock.step))
    batch = simulate_batch(**each, **same, scene=LANE, record_every=every)
    names = [variable.name for variable in batch.variables]
    columns = [names.index(name) for name in TRACED]
    for n in range(len(work)):
        record = batch.record[n]
        alive = record[:, names.index("time")] <= batch.metrics.duration[n] + 1e-9
        values = {k: None if v is None else v[n] for k, v in batch.metrics.as_dict().items()}
        yield (
            values,
            batch.verdicts[n],
            Trace(*(np.array(record[alive, column]) for column in columns)),
        )


def _cell(
    key: tuple[Any, ...], metrics: dict[str, Any], verdict: Verdict, state: Condition
) -> dict[str, Any]:
    """The cell of one run; a guarded robot that stops inside its corridor has not failed."""
    values = {name: float(metrics[field]) for name, field in FIELDS.items()}
    stopped = verdict.kind is VerdictKind.STOPPED and state.safety is not None
    names = ("controller", "curve", "speed", "start", "plant", "seed")
    found = {
        "failed": not (verdict.reached or stopped), "arrived": verdict.reached,
        "ended": str(metrics["ended"]), "verdict": str(verdict.kind), "sentence": verdict.sentence,
        "verdict_place": verdict.place, "verdict_time": verdict.time,
    }  # fmt: skip
    return {**dict(zip(names, key, strict=True)), **values, **found}
