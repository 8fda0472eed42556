"""A closed loop: one choice of every part, made once, before anything runs."""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control import Controller, ControlPart, CurvatureLaw, Ekf, Errors, Safety, Start
from osculate.control.pilot import Insight, PilotPart, no_insight, no_stop, pilot_part
from osculate.control.safety import foresee
from osculate.control.tracking import PathTracker
from osculate.control.tracking.contract import Road, survey
from osculate.control.tracking.external import Decide, ExternalTracker
from osculate.curve import Curve, CurveTable, Pose, tabulate
from osculate.curve.approach import plan_approach
from osculate.curve.table import CELLS
from osculate.errors import InvalidInput
from osculate.kernel import Nothing, Tables, compose, leaves, zeros
from osculate.plant import (
    Disturbance,
    Fault,
    Mujoco,
    Plant,
    Push,
    Reduced,
    Sensors,
    Slip,
    World,
    world_of,
)
from osculate.plant.disturbance import DisturbanceMemory, disturb, perceive
from osculate.plant.faults import HEARD
from osculate.plant.grip import foresee_sliding
from osculate.plant.sensors import sense_exactly, sense_noisily
from osculate.plant.weather import blow_all, blow_nothing, impair, impair_nothing
from osculate.simulation.clock import Clock, Continuous, Sampled
from osculate.simulation.events import EventParameters, event_parameters, no_events
from osculate.simulation.records import (
    RUNNING,
    Held,
    Mind,
    Parameters,
    Progress,
    Row,
    State,
    Status,
    Thought,
)
from osculate.simulation.tally import empty_tally
from osculate.simulation.verdict import NEAR
from osculate.spec import Spec, quantity
from osculate.target import Limits, Modified, Reference, SpeedPlan, Target, TargetMemory
from osculate.target.speed import Begin, rests_at_end
from osculate.vehicle import Command, Motion, Tricycle

RECOVERABLE_HEADING = math.radians(100.0)
RECOVERABLE_DISTANCE = 2.5  # m
TEMPLATES = "osculate.simulation.templates"
SLOW = 0.03  # m/s, that a robot can drive everywhere on a way onto its curve
ROLLED = NEAR + 1e-3  # m beyond the end, at which a robot that should rest there rolls away
SPEED_LIMIT = 1e5  # m/s, beyond which a run counts as diverged


def _blank(kind: Any) -> Any:
    return kind(*[0.0] * len(kind._fields))


#: A row of zeros: the shape of a record without insight.
BLANK = Row(
    0.0,
    _blank(Motion),
    _blank(Reference),
    _blank(Command),
    _blank(Errors),
    0.0,
    0.0,
    0.0,
    0.0,
    Nothing(),
)
NOISES = ("position_noise", "heading_noise", "wheel_noise", "steering_noise", "gyro_noise")


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
    target_heading: float | None = quantity(
        "rad",
        "heading at which a target begins to integrate, θ̂(0); by default the curve's",
        default=None,
    )
    settled: float = quantity(
        "m", "errors count from this arc length on: not while the start is made good", default=0.0
    )

    def on(self, curve: Curve) -> Start:
        """The initial state in the map frame.

        Raises:
            InvalidInput: A start, or the place from which errors count, beyond the end of the curve.
        """
        if self.arc_length >= curve.length:
            raise InvalidInput(
                "initial.arc_length",
                self.arc_length,
                f"must be below the curve's length of {curve.length:.6g} m",
            )
        if self.settled >= curve.length:
            raise InvalidInput(
                "initial.settled",
                self.settled,
                f"must be below the curve's length of {curve.length:.6g} m: no error would count",
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
    sensors: Sensors | None = None
    estimator: Ekf | None = None
    safety: Safety | None = None
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True)
class Loop:
    """A closed loop ready to run in any number of lanes."""

    setup: Setup
    bindings: dict[str, Any]  # what the templates are composed with
    parameters: Parameters
    initial: Progress
    mind: Any  # initial `Mind` of a sampled law, or nothing
    thought: Any  # its `Thought`, or nothing
    tables: NDArray[np.float64]
    plan: SpeedPlan | None = None  # of a path tracker
    decide: Decide | None = None  # where steering decisions come from Python
    row: Row = BLANK  # shape of its record
    caution: str | None = None  # what is foreseen of it

    @cached_property
    def _composed(self) -> dict[tuple[str, int], Any]:
        return {}

    def engine(self, lanes: int) -> Any:
        """The compiled engine for blocks of ``lanes`` runs."""
        return self._once("engine", lanes, self._compose_engine)

    def decider(self, lanes: int) -> Any:
        """The compiled decision of a sampled law for blocks of ``lanes`` runs."""
        return self._once("decider", lanes, self._compose_decider)

    def _once(self, what: str, lanes: int, make: Callable[[int], Any]) -> Any:
        if (what, lanes) not in self._composed:
            self._composed[what, lanes] = make(lanes)
        return self._composed[what, lanes]

    @property
    def sampled(self) -> bool:
        """Whether the law decides at instants."""
        return isinstance(self.setup.clock, Sampled)

    def _compose_engine(self, lanes: int) -> Any:
        world = "sampled" if self.sampled else "continuous"
        laws = () if self.sampled else ("control", "refer", "pace")
        dynamics = compose(
            f"{TEMPLATES}.{world}",
            self._bound("measure", "plant_rates", "disturb", "perceive", *laws),
        )
        stepper = compose(f"{TEMPLATES}.rk4", {"rates": dynamics.rates})
        return compose(
            f"{TEMPLATES}.engine",
            {
                "halted": dynamics.halted,
                "hold": dynamics.hold,
                "look": dynamics.look,
                "respond": dynamics.respond,
                "rk4": stepper.rk4,
                "measure": self.bindings["measure"],
                "LANES": lanes,
                "LIKE": zeros(self.initial),
                "LIKE_PARAMETERS": zeros(self.parameters),
                "LIKE_ROW": zeros(self.row),
            },
        )

    def _compose_decider(self, lanes: int) -> Any:
        law, parts = (
            ("tracked", ("pilot",)) if self.plan else ("held", ("control", "refer", "pace"))
        )
        step = compose(f"{TEMPLATES}.{law}", self._bound(*parts)).step
        names = ("measure", "wheels", "perceive", "sense", "blow", "impair", "insight", "stop")
        return compose(
            f"{TEMPLATES}.deciding",
            {
                **self._bound(*names),
                "step": step,
                "LANES": lanes,
                "LIKE": zeros(self.initial),
                "LIKE_MIND": zeros(self.mind),
                "LIKE_THOUGHT": zeros(self.thought),
            },
        )

    def _bound(self, *names: str) -> dict[str, Any]:
        return {name: self.bindings[name] for name in names}


def close_loop(setup: Setup, tables: Tables | None = None) -> Loop:
    """Tabulate, solve and choose everything that a run of ``setup`` needs.

    Several loops may share their ``tables``; each then keeps the array as it was after its own.

    Raises:
        InvalidInput: Parts that do not fit each other, or a step too large for the loop.
        NoSolution: The robot cannot follow the curve.
    """
    tables = tables or Tables()
    if isinstance(setup.plant, Mujoco):
        raise InvalidInput("plant", setup.plant, "runs one robot at a time; use simulate")
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
    bindings = {
        "control": control.control, "refer": target.refer, "pace": target.pace.pace,
        "insight": no_insight, "stop": no_stop,
    }  # fmt: skip
    return _assemble(setup, table, start, control, parts, bindings, tables, None)


def _close_tracking(setup: Setup, law: PathTracker, tables: Tables) -> Loop:
    """A law that follows the curve itself at the speeds of a plan."""
    if isinstance(setup.plant, Reduced):
        raise InvalidInput(
            "plant", setup.plant, "a path tracker steers a servo; must be Actuated(...)"
        )
    clock = sampled_clock(setup)
    setup = with_approach(setup)
    curve = setup.curve
    delay = round(clock.delay / clock.period)
    task = (curve, setup.robot, setup.limits, clock.period, delay)
    foreseen, ceiling = foresee(setup.safety, *task)
    start = setup.initial.on(curve)
    begin = Begin(setup.initial.arc_length, start.speed)
    road, plan = survey(*task, tables, ceiling, begin)
    pilot = make_pilot(setup, road, start)
    parts = {
        "pace": Nothing(),
        "target": Nothing(),
        "finish": math.inf,
        "path_end": path_end(curve, setup.limits),
        "deadline": math.inf,
    }
    bindings = {"pilot": pilot.decide, "insight": pilot.insight, "stop": pilot.stop}
    loop = _assemble(setup, road.curve, start, pilot, parts, bindings, tables, plan)
    stuck = foreseen.caution(plan) if foreseen is not None else None
    world = checked_world(setup)
    caution = tables.once(
        ("caution", world.plant, begin, *task, ceiling, stuck),
        lambda: cautions(setup, world, plan, stuck),
    )
    loop = replace(loop, caution=caution)
    if isinstance(law, ExternalTracker):
        return replace(loop, decide=law.decider(curve, road, loop.tables))
    return loop


def cautions(setup: Setup, world: World, plan: SpeedPlan, stuck: str | None) -> str | None:
    """What is foreseen of a run, in sentences; None if nothing. Sliding is warned of.

    Args:
        setup: What is going to run.
        world: Its plant, with all faults.
        plan: Its speeds.
        stuck: What becomes of it if its steering gets stuck.
    """
    sliding = foresee_sliding(world.plant, setup.robot, setup.limits, setup.curve, plan)
    if sliding is not None:
        warnings.warn(sliding, stacklevel=2)
    return "; ".join(text for text in (stuck, sliding) if text) or None


def path_end(curve: Curve, limits: Limits) -> float:
    """Arc length (m) at which a run is over at any speed: beyond the end if the robot rests there."""
    return curve.length + (ROLLED if rests_at_end(curve, limits) else 0.0)


def sampled_clock(setup: Setup) -> Sampled:
    """The clock of a path tracker.

    Raises:
        InvalidInput: A continuous one.
    """
    if not isinstance(setup.clock, Sampled):
        message = "a path tracker decides at instants; must be Sampled(...)"
        raise InvalidInput("clock", setup.clock, message)
    return setup.clock


def make_pilot(setup: Setup, road: Road, start: Start) -> PilotPart:
    """Tracker, estimator and safety layer of a setup.

    Raises:
        InvalidInput: A law from Python behind an estimator.
    """
    law = setup.controller
    assert isinstance(law, PathTracker)
    if setup.sensors is not None and isinstance(law, ExternalTracker):
        raise InvalidInput("sensors", setup.sensors, "a law from Python needs exact motions")
    return pilot_part(
        law, road, start, setup.initial.arc_length, motion_at(setup, start), estimator_of(setup),
        setup.safety,
    )  # fmt: skip


def motion_at(setup: Setup, start: Start) -> Motion:
    """The motion of a robot at its start."""
    angle = math.atan(setup.robot.wheelbase * start.curvature)
    return Motion(start.x, start.y, start.heading, start.speed, start.yaw_rate, angle)


def estimator_of(setup: Setup) -> Ekf | None:
    """The estimator of noisy sensors: the setup's own, or one that knows their noise."""
    sensors = setup.sensors
    if sensors is None:
        return None
    if setup.estimator is not None:
        return setup.estimator
    noises = {name: max(getattr(sensors, name), 1e-6) for name in NOISES}
    period = setup.clock.period if isinstance(setup.clock, Sampled) else 0.0
    return Ekf(**noises, history=sensors.latest + 2.0 * period)


def with_approach(setup: Setup) -> Setup:
    """The setup with a way onto the curve before it, if the start is beyond what a tracker recovers.

    A start outside the corridor of the safety layer is one; the way onto the curve has the same corridor.

    Raises:
        InvalidInput: It is, and no approach may be planned.
        NoSolution: There is no such way.
    """
    initial, curve, robot = setup.initial, setup.curve, setup.robot
    foot = curve.at(initial.arc_length)
    corridor = math.inf if setup.safety is None else setup.safety.half_width
    turned = abs(initial.heading_error) > RECOVERABLE_HEADING
    far = abs(initial.cross_track) > min(RECOVERABLE_DISTANCE, corridor)
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
    turning = setup.limits.steering * robot.actuators.steering_rate_limit / SLOW
    way, length = plan_approach(curve, pose, tightest, initial.arc_length, robot.wheelbase, turning)
    begin = InitialState(speed=initial.speed, settled=max(initial.settled, length))
    return setup._replace(curve=way, initial=begin)


def _assemble(
    setup: Setup,
    table: CurveTable,
    start: Start,
    control: ControlPart | PilotPart,
    parts: dict[str, Any],
    bindings: dict[str, Any],
    tables: Tables,
    plan: SpeedPlan | None,
) -> Loop:
    clock = setup.clock
    world = checked_world(setup)
    plant = world.plant.part(setup.robot, start)
    sampled = isinstance(clock, Sampled)
    around = surroundings(setup, world)
    law = {"pace": parts.pop("pace"), "target": parts.pop("target"), "control": control.parameters}
    parameters = Parameters(
        plant=plant.parameters,
        disturbance=setup.disturbance.parameters(),
        curve=table,
        delay=float(clock.delay_steps + round(world.delay / clock.step)),
        speed_limit=SPEED_LIMIT,
        settled=setup.initial.settled,
        events=corridor_of(setup),
        **parts,
        **(dict.fromkeys(law, Nothing()) if sampled else law),
    )
    thought = Thought(
        plant=plant.parameters,
        sensors=around.sensors,
        blows=around.blows,
        impairment=around.impairment,
        curve=table,
        **law,
    )
    rest = Command(float(np.arctan(setup.robot.wheelbase * start.curvature)), 0.0, 0.0, 0.0)
    place, heading = setup.initial.arc_length, setup.initial.target_heading
    state = State(
        plant.state,
        DisturbanceMemory(0.0),
        TargetMemory(place, float(setup.curve.at(place).heading) if heading is None else heading),
        Nothing() if sampled else control.memory,
    )
    insight: Any = Nothing()
    if bindings["insight"] is not no_insight:
        motion = motion_at(setup, start)
        insight = Insight(motion.x, motion.y, motion.heading, motion.speed, 0.0, 0.0, 0.0)
    held: Any = Nothing()
    if isinstance(clock, Sampled):
        slots = _slots(clock, world.delay)
        held = Held(
            Push(0.0, 0.0, 0.0, 0.0), insight, _blank(Reference), Errors(0.0, 0.0, 0.0), 0.0,
            (rest,) * slots,
        )  # fmt: skip
    shared = {
        "disturb": disturb,
        "perceive": perceive,
        "measure": plant.measure,
        "plant_rates": plant.rates,
        "wheels": plant.wheels,
        **around.bindings,
    }
    events = no_events(start.x, start.y)
    initial = Progress(state, empty_tally(place), events, Status(RUNNING, 0.0), held)
    row = BLANK._replace(insight=insight)
    mind = Mind(control.memory, around.memory) if sampled else Nothing()
    return Loop(
        setup, {**bindings, **shared}, parameters, initial, mind, thought if sampled else Nothing(),
        tables.array, plan, row=row,
    )  # fmt: skip


def corridor_of(setup: Setup) -> EventParameters:
    """What counts as leaving the path and going backwards, if the scene has no corridor."""
    slippery = isinstance(setup.plant, Slip | Mujoco)
    return event_parameters(setup.robot, setup.initial.settled, setup.safety, slippery)


class Surroundings(NamedTuple):
    """What a sampled law sees and suffers: kernels by their names in templates, and their numbers."""

    bindings: dict[str, Any]
    sensors: Any
    memory: Any  # of the sensors
    blows: Any
    impairment: Any


def surroundings(setup: Setup, world: World) -> Surroundings:
    """Sensors, pushes and actuator faults of a setup."""
    clock = setup.clock
    sensors: Any = Nothing()
    memory: Any = Nothing()
    bindings = {"sense": sense_exactly, "blow": blow_nothing, "impair": impair_nothing}
    if setup.sensors is not None and isinstance(clock, Sampled):
        sensors, memory = setup.sensors.part(clock.period, world.outages)
        bindings["sense"] = sense_noisily
    if world.calm and setup.sensors is None:  # noisy worlds share one kind of machine code
        return Surroundings(bindings, sensors, memory, Nothing(), Nothing())
    bindings |= {"blow": blow_all, "impair": impair}
    return Surroundings(bindings, sensors, memory, world.padded_blows, world.impairment)


def checked_world(setup: Setup) -> World:
    """The plant with all faults.

    Raises:
        InvalidInput: Faults, sensors or a safety layer where they have no effect.
    """
    world = world_of(setup.plant, setup.faults)
    sampled = isinstance(setup.clock, Sampled)
    if not sampled and (world.delay > 0.0 or not world.calm):
        raise InvalidInput("faults", setup.faults, "act at instants; clock must be Sampled(...)")
    if setup.sensors is None and world.outages != HEARD:
        raise InvalidInput("faults", setup.faults, "a sensor fails: sensors must be Sensors(...)")
    for name in ("sensors", "estimator", "safety"):
        value = getattr(setup, name)
        if value is not None and not isinstance(setup.controller, PathTracker):
            raise InvalidInput(name, value, "needs a path tracker as controller")
    if setup.estimator is not None and setup.sensors is None:
        raise InvalidInput("estimator", setup.estimator, "needs sensors: Sensors(...)")
    if isinstance(setup.clock, Sampled):
        ratio = world.delay / setup.clock.step
        if abs(ratio - round(ratio)) > 1e-6:
            message = f"must add up to a multiple of step = {setup.clock.step:g} s"
            raise InvalidInput("faults.delay", world.delay, message)
    longest = world.plant.longest_step(setup.robot)
    if setup.clock.step > longest:
        message = f"too large for this plant; must be at most {longest:.3g} s"
        raise InvalidInput("clock.step", setup.clock.step, message)
    return world


def size(value: Any) -> int:
    """Number of leaves of a nested tuple."""
    return sum(1 for _ in leaves(value))


def _slots(clock: Sampled, added: float) -> int:
    """Commands to remember: a power of two, so that few delays need machine code of their own."""
    needed = -(-(clock.delay_steps + round(added / clock.step)) // clock.substeps) + 1
    return max(2, 1 << (needed - 1).bit_length())
