"""A closed loop: one choice of every part, made once, before anything runs."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control import Controller, ControlPart, CurvatureLaw, Errors, Start
from osculate.control.tracking import PathTracker
from osculate.control.tracking.contract import survey
from osculate.control.tracking.external import Decide, ExternalTracker
from osculate.curve import Curve, CurveTable, Pose, tabulate
from osculate.curve.approach import plan_approach
from osculate.curve.table import CELLS
from osculate.errors import InvalidInput
from osculate.kernel import Nothing, Tables, compose, leaves
from osculate.plant import Disturbance, Mujoco, Plant, Reduced
from osculate.plant.disturbance import DisturbanceMemory, disturb, perceive
from osculate.simulation.clock import Clock, Continuous, Sampled
from osculate.simulation.records import (
    RUNNING,
    Held,
    Parameters,
    Progress,
    Row,
    State,
    Status,
)
from osculate.simulation.tally import empty_tally
from osculate.spec import Spec, quantity
from osculate.target import Limits, Modified, Reference, SpeedPlan, Target, TargetMemory
from osculate.vehicle import Command, Motion, Tricycle

RECOVERABLE_HEADING = math.radians(100.0)
RECOVERABLE_DISTANCE = 2.5  # m
TEMPLATES = "osculate.simulation.templates"
SPEED_LIMIT = 1e5  # m/s, beyond which a run counts as diverged


class InitialState(Spec):
    """Where a run starts, relative to the curve; by default at its start, on it and at rest."""

    cross_track: float = quantity("m", "lateral offset, left of the curve is positive", default=0.0)
    heading_error: float = quantity("rad", "heading minus the curve's", default=0.0)
    speed: float = quantity("m/s", "initial speed", default=0.0)
    yaw_rate: float = quantity("rad/s", "initial yaw rate", default=0.0)
    arc_length: float = quantity("m", "where on the curve, from its start", default=0.0, ge=0)
    approach: bool = quantity(
        "1", "whether a tracker may plan a way onto the curve from a start far off it", default=True
    )
    settled: float = quantity(
        "m", "errors count from this arc length on: not while the start is made good", default=0.0
    )

    def on(self, curve: Curve) -> Start:
        """The initial state in the map frame.

        Raises:
            InvalidInput: A start beyond the end of the curve.
        """
        if self.arc_length >= curve.length:
            raise InvalidInput(
                "initial.arc_length",
                self.arc_length,
                f"must be below the curve's length of {curve.length:.6g} m",
            )
        point = curve.at(self.arc_length)
        heading = float(point.heading)
        return Start(
            x=float(point.x) - self.cross_track * np.sin(heading),
            y=float(point.y) + self.cross_track * np.cos(heading),
            heading=heading + self.heading_error,
            speed=self.speed,
            yaw_rate=self.yaw_rate,
            curvature=float(point.curvature),
        )


class Setup(NamedTuple):
    """The objects a closed loop is made of."""

    curve: Curve
    robot: Tricycle = Tricycle()
    target: Target = Modified()
    controller: Controller = CurvatureLaw()
    plant: Plant = Reduced()
    disturbance: Disturbance = Disturbance()
    clock: Clock = Continuous()
    initial: InitialState = InitialState()
    limits: Limits = Limits()


@dataclass(frozen=True)
class Loop:
    """A closed loop ready to run in any number of lanes."""

    setup: Setup
    bindings: dict[str, Any]  # what the templates are composed with
    parameters: Parameters
    initial: Progress
    tables: NDArray[np.float64]
    plan: SpeedPlan | None = None  # of a path tracker
    decide: Decide | None = None  # where steering decisions come from Python

    @cached_property
    def _engines(self) -> dict[int, Any]:
        return {}

    def engine(self, lanes: int) -> Any:
        """The compiled engine for blocks of ``lanes`` runs."""
        if lanes not in self._engines:
            self._engines[lanes] = self._compose(lanes)
        return self._engines[lanes]

    def _compose(self, lanes: int) -> Any:
        world = "sampled" if isinstance(self.setup.clock, Sampled) else "continuous"
        bindings = self.bindings
        if world == "sampled":
            law = "held" if self.plan is None else "tracked"
            bindings = {**bindings, "step": compose(f"{TEMPLATES}.{law}", bindings).step}
        dynamics = compose(f"{TEMPLATES}.{world}", bindings)
        stepper = compose(f"{TEMPLATES}.rk4", {"rates": dynamics.rates})
        return compose(
            f"{TEMPLATES}.engine",
            {
                "decide": dynamics.decide,
                "hold": dynamics.hold,
                "respond": dynamics.respond,
                "rk4": stepper.rk4,
                "measure": self.bindings["measure"],
                "LANES": lanes,
                "SAMPLED": world == "sampled",
            },
        )


def close_loop(setup: Setup, tables: Tables | None = None) -> Loop:
    """Tabulate, solve and choose everything that a run of ``setup`` needs.

    Several loops may share their ``tables``; each then keeps the array as it was after its own.

    Raises:
        InvalidInput: Parts that do not fit each other, or a step too large for the loop.
        NoSolution: The robot cannot follow the curve.
    """
    tables = tables or Tables()
    if isinstance(setup.controller, PathTracker):
        return _close_tracking(setup, setup.controller, tables)
    return _close_target(setup, tables)


def _close_target(setup: Setup, tables: Tables) -> Loop:
    """A law that follows a target of speeds over time."""
    curve, robot, clock = setup.curve, setup.robot, setup.clock
    table = tables.once((curve, CELLS), lambda: tabulate(curve, tables))
    start = setup.initial.on(curve)
    target = setup.target.part(curve, table, robot, tables)
    control = setup.controller.part(setup.plant.model(robot), target, start, tables)
    clock.check(control.fastest_rate)
    parts = {
        "pace": target.pace.parameters,
        "target": target.parameters,
        "finish": curve.length if target.follows_path else math.inf,
        "path_end": math.inf,
        "deadline": math.inf if target.follows_path else target.pace.duration,
    }
    bindings = {"control": control.control, "refer": target.refer, "pace": target.pace.pace}
    return _assemble(setup, table, start, control, parts, bindings, tables, None)


def _close_tracking(setup: Setup, law: PathTracker, tables: Tables) -> Loop:
    """A law that follows the curve itself at the speeds of a plan."""
    curve, robot, clock = setup.curve, setup.robot, setup.clock
    if not isinstance(clock, Sampled):
        raise InvalidInput(
            "clock", clock, "a path tracker decides at instants; must be Sampled(...)"
        )
    if isinstance(setup.plant, Mujoco):
        raise InvalidInput("plant", setup.plant, "runs one robot at a time; use simulate")
    if isinstance(setup.plant, Reduced):
        raise InvalidInput(
            "plant", setup.plant, "a path tracker steers a servo; must be Actuated(...)"
        )
    setup = with_approach(setup)
    curve = setup.curve
    delay = round(clock.delay / clock.period)
    road, plan = survey(curve, robot, setup.limits, clock.period, delay, tables)
    start = setup.initial.on(curve)
    control = law.tracking_part(road, start, setup.initial.arc_length)
    parts = {
        "pace": Nothing(),
        "target": Nothing(),
        "finish": math.inf,
        "path_end": curve.length,
        "deadline": math.inf,
    }
    loop = _assemble(
        setup, road.curve, start, control, parts, {"track": control.control}, tables, plan
    )
    if isinstance(law, ExternalTracker):
        return replace(loop, decide=law.decider(curve, road, loop.tables))
    return loop


def with_approach(setup: Setup) -> Setup:
    """The setup with a way onto the curve before it, if the start is beyond what a tracker recovers.

    Raises:
        InvalidInput: It is, and no approach may be planned.
        NoSolution: There is no such way.
    """
    initial, curve, robot = setup.initial, setup.curve, setup.robot
    foot = curve.at(initial.arc_length)
    turned = abs(initial.heading_error) > RECOVERABLE_HEADING
    far = abs(initial.cross_track) > RECOVERABLE_DISTANCE
    inside = 1.0 - float(foot.curvature) * initial.cross_track < 0.2
    if not (turned or far or inside):
        return setup
    reason = "heading_error" if turned else "cross_track"
    if not initial.approach:
        raise InvalidInput(
            f"initial.{reason}",
            getattr(initial, reason),
            "cannot be recovered by tracking alone; allow an approach or start nearer",
        )
    start = initial.on(curve)
    tightest = float(np.tan(robot.actuators.steering_angle_limit)) / robot.wheelbase
    pose = Pose(x=start.x, y=start.y, heading=start.heading)
    way, length = plan_approach(curve, pose, tightest, initial.arc_length)
    begin = InitialState(speed=initial.speed, settled=max(initial.settled, length))
    return setup._replace(curve=way, initial=begin)


def _assemble(
    setup: Setup,
    table: CurveTable,
    start: Start,
    control: ControlPart,
    parts: dict[str, Any],
    bindings: dict[str, Any],
    tables: Tables,
    plan: SpeedPlan | None,
) -> Loop:
    clock = setup.clock
    plant = setup.plant.part(setup.robot, start)
    sampled = isinstance(clock, Sampled)
    parameters = Parameters(
        plant=plant.parameters,
        disturbance=setup.disturbance.parameters(),
        control=control.parameters,
        curve=table,
        delay=float(clock.delay_steps),
        speed_limit=SPEED_LIMIT,
        settled=setup.initial.settled,
        **parts,
    )
    rest = Command(float(np.arctan(setup.robot.wheelbase * start.curvature)), 0.0, 0.0)
    place = setup.initial.arc_length
    state = State(
        plant.state,
        DisturbanceMemory(0.0),
        TargetMemory(place, float(setup.curve.at(place).heading)),
        Nothing() if sampled else control.memory,
    )
    held = (
        Held(control.memory, _blank(Reference), Errors(0.0, 0.0, 0.0), (rest,) * _slots(clock))
        if isinstance(clock, Sampled)
        else Nothing()
    )
    shared = {
        "disturb": disturb,
        "perceive": perceive,
        "measure": plant.measure,
        "plant_rates": plant.rates,
    }
    initial = Progress(state, held, empty_tally(place), Status(RUNNING, 0.0))
    return Loop(setup, {**bindings, **shared}, parameters, initial, tables.array, plan)


def blank_row() -> Row:
    """A row of zeros: the shape of a record."""
    return Row(0.0, _blank(Motion), _blank(Reference), _blank(Command), _blank(Errors), *[0.0] * 4)


def size(value: Any) -> int:
    """Number of leaves of a nested tuple."""
    return sum(1 for _ in leaves(value))


def _blank(kind: Any) -> Any:
    return kind(*[0.0] * len(kind._fields))


def _slots(clock: Sampled) -> int:
    """Commands to remember: a power of two, so that few delays need machine code of their own."""
    needed = -(-clock.delay_steps // clock.substeps) + 1
    return max(2, 1 << (needed - 1).bit_length())
