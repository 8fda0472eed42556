"""Controllers × curves × speeds × starts × conditions, in lanes: one cell for every combination."""

import itertools
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking import PathTracker
from osculate.control.tracking.external import ExternalTracker
from osculate.curve import Curve
from osculate.files import write_text
from osculate.folder import OutputFolder
from osculate.plant import Mujoco, world_of
from osculate.simulation import InitialState, Sampled, simulate, simulate_batch
from osculate.study.comparison.kept import Arrays, Kept, key_of
from osculate.study.comparison.suite import Condition, conditions, curves, starts
from osculate.study.comparison.tuned import trackers_for
from osculate.target import Limits, plan_speed
from osculate.vehicle import Tricycle

OFF_ROAD = 0.5  # m, a cell whose counted error exceeds this has failed
PATIENCE = 2.0  # times the planned duration, after which a run counts as failed
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
    "speed_max": "m/s",
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

    def ranking(self) -> list[Standing]:
        """All controllers, the most exact first, each compared cell by cell with the first."""
        order = sorted(self.controllers, key=self._merit)
        first = self.of(order[0])
        return [self._standing(name, first) for name in order]

    def _merit(self, controller: str) -> tuple[int, float]:
        cells = self.of(controller)
        alive = [math.log(c["cross_track_rms"]) for c in cells if c["arrived"]]
        return sum(c["failed"] for c in cells), float(np.mean(alive)) if alive else math.inf

    def _standing(self, name: str, first: list[dict[str, Any]]) -> Standing:
        cells = self.of(name)
        alive = [c for c in cells if c["arrived"]]
        pairs = [
            math.log(c["cross_track_rms"] / f["cross_track_rms"])
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

        text = json.dumps(self.cells, indent=1, ensure_ascii=False)
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
        limits: Limits of the speed plans; ``speed`` is replaced.
        clock: Period, known delay and step; the duration follows from the plans.
        draws: How often every combination with random numbers is run, each time with another seed;
            all controllers meet the same ones.
        keep: Folder in which every finished cell is kept; cells that are there already, made by the
            same code from the same parts, are taken over and not run again.
        report: Called with the fraction that is done.

    Raises:
        NoSolution: The robot cannot follow one of the curves.
        MissingExtra: A controller or condition needs a package that is not installed.
    """
    body, task = robot or Tricycle(), limits or Limits()
    laws = dict(controllers or trackers_for(body))
    paths = dict(on or curves())
    begins, states = dict(start or starts()), dict(condition or conditions(robot=body))
    _load(laws, states)
    timing = clock or Sampled(period=0.01, delay=0.01)
    grid = list(itertools.product(paths, speeds, begins))
    allowed = {v: task.but(speed=v, creep=min(task.creep, v)) for v in speeds}
    longest = max(
        plan_speed(path, body, bound).duration
        for path in paths.values()
        for bound in allowed.values()
    )
    comparison = Comparison([], {}, paths)
    duration = PATIENCE * longest + 5.0
    tasks = [(name, kind) for name in laws for kind in states]
    kept = Kept.at(keep)
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
        for (c, v, s, seed), (values, trace) in zip(cells, outcomes, strict=True):
            comparison.cells.append(_cell((name, c, v, s, kind, seed), values, state))
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


Outcome = tuple[dict[str, Any], Trace]


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
    values, trace = outcome
    plain = {k: v.item() if isinstance(v, np.generic) else v for k, v in values.items()}
    return {"values": np.array(json.dumps(plain)), "trace": np.stack(trace)}


def _unpacked(arrays: Arrays | None) -> Outcome | None:
    if arrays is None:
        return None
    return json.loads(str(arrays["values"])), Trace(*arrays["trace"])


def _run(work: list[dict[str, Any]], law: PathTracker, clock: Sampled) -> Iterator[Outcome]:
    alone = isinstance(law, ExternalTracker) or isinstance(work[0]["plant"], Mujoco)
    return (_run_alone if alone else _run_together)(work, law, clock)


def _run_alone(work: list[dict[str, Any]], law: PathTracker, clock: Sampled) -> Iterator[Outcome]:
    """One run after the other: values of the metrics and trace of each."""
    every = max(1, round(RECORD / clock.step))
    for parts in work:
        run = simulate(**parts, controller=law, clock=clock)
        columns = (run.columns[name][::every] for name in TRACED)
        yield run.metrics.as_dict(), Trace(*columns)


def _run_together(
    work: list[dict[str, Any]], law: PathTracker, clock: Sampled
) -> Iterator[Outcome]:
    """The same in lanes."""
    same = {"robot": work[0]["robot"], "controller": law, "clock": clock}
    each: dict[str, Any] = {
        name: [parts[name] for parts in work] for name in work[0] if name not in same
    }
    batch = simulate_batch(**each, **same, record_every=max(1, round(RECORD / clock.step)))
    names = [variable.name for variable in batch.variables]
    columns = [names.index(name) for name in TRACED]
    for n in range(len(work)):
        record = batch.record[n]
        alive = record[:, names.index("time")] <= batch.metrics.duration[n] + 1e-9
        values = {k: None if v is None else v[n] for k, v in batch.metrics.as_dict().items()}
        yield values, Trace(*(np.array(record[alive, column]) for column in columns))


def _cell(key: tuple[Any, ...], metrics: dict[str, Any], state: Condition) -> dict[str, Any]:
    """The cell of one run; a guarded robot that stops inside its corridor has not failed."""
    values = {name: float(metrics[field]) for name, field in FIELDS.items()}
    ended = str(metrics["ended"])
    allowed = state.safety.half_width if state.safety else OFF_ROAD
    arrived = ended == "path end" or (ended == "safety stop" and state.safety is not None)
    failed = not arrived or not values["cross_track_max"] <= allowed
    names = ("controller", "curve", "speed", "start", "plant", "seed")
    found = {"failed": failed, "arrived": ended == "path end" and not failed, "ended": ended}
    return {**dict(zip(names, key, strict=True)), **values, **found}
