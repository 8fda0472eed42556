"""One simulated run: record, metrics and the objects it was made from."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control import Controller, Ekf, PathTracker, Safety
from osculate.control.reasons import CAUSES, REASONS
from osculate.curve import Curve
from osculate.errors import InvalidInput, require_kind
from osculate.files import write_by
from osculate.plant import Actuated, Disturbance, Fault, Late, Mujoco, Plant, Sensors
from osculate.scene import Scene
from osculate.simulation.blocks import Report, final_run, last_row, run_block, single_block
from osculate.simulation.clock import Clock, Sampled
from osculate.simulation.effects import require_effect, require_read
from osculate.simulation.hits import clearance_of, find_hit, scene_of
from osculate.simulation.loop import InitialState, Loop, Setup, close_loop, size
from osculate.simulation.metrics import Metrics, summarise
from osculate.simulation.outcomes import in_corridor, outcomes, path_of, verdicts
from osculate.simulation.records import DIVERGED
from osculate.simulation.size import longest, require_callable, require_size, require_slots
from osculate.simulation.variables import variables_of
from osculate.simulation.verdict import Verdict
from osculate.target import Limits, SpeedPlan, Target
from osculate.vehicle import Tricycle


class Intervention(NamedTuple):
    """One time during which something else than the law decided what the robot does."""

    begin: float  # s
    end: float  # s
    reason: str
    place: float  # m, arc length of the nearest point of the curve when it began
    excess: float  # m, predicted distance beyond the corridor's edge; 0 if that is not why
    cause: str  # what was measured or asked for; empty if nothing in particular

    def __str__(self) -> str:
        """Times, place, reason and cause."""
        text = f"{self.begin:.2f} to {self.end:.2f} s, from {self.place:.2f} m on: {self.reason}"
        text += f" by {self.excess:.3g} m" if self.excess > 0.0 else ""
        return f"{text} ({self.cause})" if self.cause else text


def list_interventions(columns: dict[str, NDArray[np.float64]]) -> list[Intervention]:
    """The interventions of a record: its columns by the names of their variables."""
    numbers = columns.get("intervention")
    if numbers is None:
        return []
    time, causes = columns["time"], columns["intervention_cause"]
    edges = np.flatnonzero(np.diff(numbers)) + 1
    begins, ends = [0, *edges], [*edges, len(numbers)]
    return [
        Intervention(
            float(time[b]), float(time[e - 1]), REASONS[int(numbers[b])],
            float(columns["foot"][b]), float(columns["corridor_excess"][b]),
            CAUSES.get(int(causes[b]), ""),
        )
        for b, e in zip(begins, ends, strict=True)
        if numbers[b] > 0.0
    ]  # fmt: skip


@dataclass(frozen=True)
class Run:
    """A run of one robot.

    Attributes:
        setup: What was run.
        scene: What stood around.
        columns: The record: variable name to samples, shape (n,); ``time`` is one of them.
        metrics: Exactness and effort.
        verdict: What became of it: what happened first, where and when.
        plan: The speed plan of a path tracker.
        caution: What was foreseen before it began: where a stuck steering would take it out of its
            corridor, why it may slide.
    """

    setup: Setup
    scene: Scene
    columns: dict[str, NDArray[np.float64]]
    metrics: Metrics
    verdict: Verdict
    plan: SpeedPlan | None = None
    caution: str | None = None

    @property
    def diverged(self) -> bool:
        """Whether the run had to be stopped; the record then ends with the last finite state."""
        return bool(self.metrics.ended == "diverged")

    @property
    def interventions(self) -> "list[Intervention]":
        """What was done instead of what the law decided, in order."""
        return list_interventions(self.columns)

    @cached_property
    def clearance(self) -> NDArray[np.float64]:
        """Distance from the footprint to the nearest obstacle (m), shape (n,)."""
        return clearance_of(self.setup, self.scene, self.columns)

    @cached_property
    def data(self) -> Any:
        """The record as an `xarray.Dataset` over ``time``, every variable with unit and meaning."""
        from osculate.simulation.dataset import run_dataset

        return run_dataset(self)

    def save(self, path: str | Path) -> Path:
        """Write the record; the file's ending chooses the format.

        ``.nc``: netCDF, for xarray and any other netCDF reader. ``.mcap``: ROS 2 messages (extra
        ``mcap``). ``.rrd``: a Rerun recording (extra ``rerun``). ``.mp4``, ``.gif``: a film (extra
        ``video``).

        Raises:
            InvalidInput: Another ending, or a file that cannot be written.
            MissingExtra: What writes this format is not installed.
        """
        from osculate.simulation.recording.formats import writer_for

        target = Path(path)
        write = writer_for(target)
        try:
            return write_by(lambda temporary: write(self, temporary), target)
        except OSError as error:
            raise InvalidInput("path", str(path), f"must be writable ({error})") from None

    def plot(self) -> Any:
        """Path, speeds, errors and commands as one Matplotlib figure."""
        from osculate.simulation.plot import overview

        return overview(self)


def simulate(
    curve: Any,
    robot: Any = None,
    *,
    scene: Scene | None = None,
    report: Report | None = None,
    **parts: Any,
) -> Run:
    """Let one robot follow a curve.

    Args:
        curve: The curve to follow.
        robot: The robot; by default the paper's.
        scene: Obstacles, for the clearance and for hits, and a corridor.
        report: Called with the fraction of the run that is done.
        **parts: ``target``, ``controller``, ``plant``, ``disturbance``, ``clock``, ``initial``, ``limits``,
            ``sensors``, ``estimator``, ``safety``, ``faults`` (a tuple). Whatever is left out is the
            paper's; a path tracker drives the actuated robot at 100 Hz, 10 ms late, if neither plant
            nor clock is given.

    Returns:
        The run. A run that diverges is not an error: it stops, keeps its record and says so.

    Raises:
        InvalidInput: Parts that do not exist or do not fit each other.
    """
    require_callable(report)
    around = Scene() if scene is None else scene
    require_kind("scene", around, Scene)
    setup = make_setup(curve, robot, parts)
    if isinstance(setup.plant, Mujoco):
        from osculate.simulation.physics import run_physics

        return run_physics(setup, around, report)
    loop = close_loop(setup)
    return run_loop(loop, scene_of(setup, loop.setup, around), report)


#: What a path tracker drives unless told otherwise: the actuated robot at 100 Hz, 10 ms late.
TRACKER_WORLD = {
    "plant": Actuated(),
    "clock": Sampled(period=0.01, delay=0.01, duration=600.0),
}

OPTIONAL = ("sensors", "estimator", "safety")
PARTS = {
    "curve": Curve,
    "robot": Tricycle,
    "target": Target,
    "controller": Controller,
    "plant": Plant,
    "disturbance": Disturbance,
    "clock": Clock,
    "initial": InitialState,
    "limits": Limits,
    "sensors": Sensors,
    "estimator": Ekf,
    "safety": Safety,
    "faults": tuple,
}


def make_setup(curve: Any, robot: Any, parts: dict[str, Any]) -> Setup:
    """A `Setup` from the arguments of `simulate`, with clear errors for unknown or wrong parts."""
    named = {"curve": curve, **({} if robot is None else {"robot": robot}), **parts}
    if isinstance(named.get("controller"), PathTracker):
        named = {**TRACKER_WORLD, **named}
    defaults = Setup._field_defaults
    for name, value in named.items():
        if name not in Setup._fields:
            raise InvalidInput(name, value, f"unknown part; valid: {', '.join(defaults)}")
        if name in OPTIONAL and value is None:
            continue
        require_kind(name, value, PARTS[name])
    for fault in named.get("faults", ()):
        require_kind("faults", fault, Fault)
    require_read(parts)
    setup = Setup(**named)
    require_effect(setup)
    require_slots(setup.clock, sum(f.delay for f in setup.faults if isinstance(f, Late)))
    return setup


def run_loop(loop: Loop, scene: Scene, report: Report | None = None) -> Run:
    """Run a closed loop once, recording every step."""
    loop = in_corridor(loop, scene)
    clock = loop.setup.clock
    steps, width = longest(clock, loop.plan) / clock.step, size(loop.row)
    require_size("clock.duration", clock.duration, steps * width, f"{steps:.3g} steps of {width}")
    done = run_block(loop, single_block(loop), every=1, report=report)
    final: Any = final_run(loop, done.runs)
    code = float(final.status.code[0])
    # the landing adds a sample of its own, except to a run that diverged
    alive = int(final.tally.samples[0]) - (code != DIVERGED)
    rows = np.concatenate([done.record[:alive, :, 0], done.last.T])
    fresh = np.concatenate([[True], np.diff(rows[:, 0]) > 0.0])
    columns = {
        v.name: np.ascontiguousarray(rows[fresh, n]) for n, v in enumerate(variables_of(loop.row))
    }
    curve = loop.setup.curve
    end = curve.at(curve.length)
    many = summarise(final, last_row(loop, done.last), curve.length, (float(end.x), float(end.y)))
    single = {
        name: None if value is None else np.asarray(value).item()
        for name, value in many.as_dict().items()
    }
    hit = None
    if not scene.is_empty:
        clearance = clearance_of(loop.setup, scene, columns)
        single["clearance_min"] = float(clearance.min())
        hit = find_hit(loop.setup, scene, columns, clearance)
    (verdict,) = verdicts(outcomes(final, last_row(loop, done.last), **path_of(loop, scene)), [hit])
    return Run(loop.setup, scene, columns, Metrics(**single), verdict, loop.plan, loop.caution)
