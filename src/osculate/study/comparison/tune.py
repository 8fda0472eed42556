"""Tuning a controller on training curves by CMA-ES (Hansen's ``cma``), a population at a time in lanes."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from osculate.control.tracking import PathTracker
from osculate.curve import Curve
from osculate.errors import InvalidInput, import_extra, require_kind
from osculate.files import write_text
from osculate.plant import Actuated
from osculate.simulation import InitialState, Sampled, simulate_batch
from osculate.simulation.size import require_callable, require_whole
from osculate.strict_json import strict_json
from osculate.study.comparison.arguments import require_named, require_speeds
from osculate.study.comparison.compare import OFF_ROAD, PATIENCE
from osculate.study.comparison.kept import Kept, key_of
from osculate.study.comparison.suite import training_curves
from osculate.target import Limits, plan_speed
from osculate.vehicle import Tricycle

SPEEDS = (0.5, 1.0, 2.0)
STARTS = (
    InitialState(),
    InitialState(cross_track=0.1, heading_error=math.radians(5.0), settled=1.5),
    InitialState(cross_track=-0.6, settled=2.5),
)
PLANTS = (Actuated(), Actuated(servo=0.75))  # a law that only just holds one robot is no good
FAILED = 10.0  # cost of a run that failed, in units of log10 of the RMS in mm
QUICK_POPULATION = 8  # times the eight runs of `quick_search` that is one block of lanes


@dataclass(frozen=True)
class Tuning:
    """The best controller found, and how the search went."""

    controller: PathTracker
    cost: float  # mean of log10 of the RMS in mm
    initial_cost: float
    history: list[float]  # best cost of every generation

    def write(self, path: str | Path) -> Path:
        """Write the controller and the history as JSON; its ``controller`` fits a scenario file.

        Raises:
            InvalidInput: The file cannot be written.
        """
        content = {
            "controller": self.controller.model_dump(mode="json"),
            "cost": self.cost,
            "initial_cost": self.initial_cost,
            "history": self.history,
        }
        try:
            return write_text(path, strict_json(content, indent=2) + "\n")
        except OSError as error:
            raise InvalidInput("path", str(path), f"must be writable ({error})") from None


def tune(
    controller: PathTracker,
    on: Mapping[str, Curve] | None = None,
    *,
    robot: Tricycle | None = None,
    clock: Sampled | None = None,
    speeds: Sequence[float] = SPEEDS,
    starts: Sequence[InitialState] = STARTS,
    generations: int = 12,
    population: int = 10,
    seed: int = 1,
    keep: Kept | str | Path | None = None,
    report: Callable[[float], None] | None = None,
) -> Tuning:
    """Search the controller's tunable fields for the most exact tracking.

    Args:
        controller: Where the search starts.
        on: Training curves by name; by default the package's, which are never reported.
        robot: The robot; by default the paper's.
        clock: Period, delay and step; the duration follows from the plans unless it is given.
        speeds: Largest speeds (m/s), each for every curve.
        starts: Initial states, each for every curve and speed.
        generations: Generations of the search.
        population: Controllers per generation; their runs share a batch.
        seed: Of the search: the same seed finds the same controller.
        keep: Folder in which the costs of every generation are kept; those that are there already, made
            by the same code from the same parts, are taken over, so that a search goes on where it ended.
        report: Called with the fraction that is done.

    Raises:
        InvalidInput: The controller has nothing to tune, or an argument that is empty or of another kind.
        MissingExtra: The optimiser is not installed.
    """
    cma = import_extra("cma", "tune", "cma")
    body = Tricycle() if robot is None else robot
    timing = Sampled(period=0.01, delay=0.01) if clock is None else clock
    require_kind("controller", controller, PathTracker)
    require_kind("robot", body, Tricycle)
    require_kind("clock", timing, Sampled)
    ranges = controller.tunable
    if not ranges:
        raise InvalidInput("controller", type(controller).__name__, "has no tunable fields")
    require_speeds(speeds)
    _require_search(generations, population, seed, report)
    paths = list(require_named("on", on, Curve, training_curves).values())
    task = _Task(controller, body, timing, _cells(paths, speeds, starts), Kept.at(keep))
    low, high = (np.log([ranges[name][side] for name in ranges]) for side in (0, 1))
    begin = np.clip(np.log([getattr(controller, name) for name in ranges]), low, high)
    options = {"popsize": population, "seed": seed, "verbose": -9, "bounds": [0.0, 1.0]}
    unit = (begin - low) / (high - low)
    search: Any = cma.CMAEvolutionStrategy(_padded(unit), 0.25, options)
    initial = task.costs([task.make(ranges, begin)])[0]
    best, found, history = initial, controller, []
    for generation in range(generations):
        points = search.ask()
        laws = [task.make(ranges, low + p[: len(low)] * (high - low)) for p in points]
        costs = task.costs(laws)
        search.tell(points, costs)
        if min(costs) < best:
            best, found = min(costs), laws[int(np.argmin(costs))]
        history.append(best)
        if report:
            report((generation + 1) / generations)
    return Tuning(found, best, initial, history)


def _require_search(generations: int, population: int, seed: int, report: object) -> None:
    """Refuse a search that cannot begin."""
    least = (("generations", generations, 1), ("population", population, 4), ("seed", seed, 1))
    for field, value, bound in least:
        require_whole(field, value, bound)
    require_callable(report)


def quick_search() -> dict[str, Any]:
    """Arguments of `tune` with few runs: two curves, one speed, two starts; seconds a generation."""
    chosen = {name: path for name, path in training_curves().items() if name != "hairpin"}
    return {
        "on": chosen, "speeds": (1.0,), "starts": (STARTS[0], STARTS[2]),
        "population": QUICK_POPULATION,
    }  # fmt: skip


def _padded(unit: Any) -> Any:
    """The search needs two dimensions; a second one that does nothing is added to a single one."""
    return unit if len(unit) > 1 else np.append(unit, 0.5)


Cell = tuple[Curve, Limits, InitialState, Actuated]


def _cells(
    paths: Sequence[Curve], speeds: Sequence[float], starts: Sequence[InitialState]
) -> list[Cell]:
    """All training runs of one controller."""
    if not isinstance(starts, Sequence) or not starts:
        raise InvalidInput("starts", starts, "must have at least one InitialState")
    for start in starts:
        require_kind("starts", start, InitialState)
    bounds = [Limits(speed=v, creep=min(Limits().creep, v)) for v in speeds]
    return list(itertools.product(paths, bounds, starts, PLANTS))


class _Task:
    """All training runs of any number of controllers."""

    def __init__(
        self,
        law: PathTracker,
        robot: Tricycle,
        timing: Sampled,
        cells: list[Cell],
        kept: Kept | None,
    ) -> None:
        self.law, self.robot, self.cells, self.kept = law, robot, cells, kept
        longest = max(plan_speed(path, robot, bound).duration for path, bound, *_ in cells)
        given = "duration" in timing.model_fields_set
        self.clock = timing if given else timing.but(duration=PATIENCE * longest + 5.0)

    def make(self, ranges: Mapping[str, Any], logs: Any) -> PathTracker:
        """The controller with other values of its tunable fields."""
        values = {name: float(value) for name, value in zip(ranges, np.exp(logs), strict=True)}
        return self.law.but(**values)

    def costs(self, laws: list[PathTracker]) -> list[float]:
        """Mean of log10 of the RMS (mm) over all training runs, for every controller; or what is kept."""
        if self.kept is None:
            return self._run(laws)
        key = key_of(laws=laws, robot=self.robot, clock=self.clock, cells=self.cells)
        found = self.kept.find(key)
        if found:
            return [float(cost) for cost in found["costs"]]
        costs = self._run(laws)
        self.kept.keep(key, {"costs": np.array(costs)})
        return costs

    def _run(self, laws: list[PathTracker]) -> list[float]:
        cells = [(law, *cell) for law in laws for cell in self.cells]
        batch = simulate_batch(
            [c[1] for c in cells],
            self.robot,
            controller=[c[0] for c in cells],
            limits=[c[2] for c in cells],
            initial=[c[3] for c in cells],
            plant=[c[4] for c in cells],
            clock=self.clock,
        )
        arrived = (batch.metrics.ended == "path end") & (batch.metrics.cross_track_max <= OFF_ROAD)
        cost = np.where(arrived, np.log10(1e3 * batch.metrics.cross_track_rms + 1e-9), FAILED)
        return [float(c) for c in cost.reshape(len(laws), -1).mean(axis=1)]
