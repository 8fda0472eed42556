"""The contract of path trackers: what they see, what they decide, what they remember.

A tracker decides once a period. Its steering law is a kernel

    steer(view, memory, parameters, curve, tables) -> (steering angle, speed bound, memory)

and everything else (progress, servo observer, speed loop) is the same for all of them, so that a
comparison compares steering laws. Progress along the curve is memory, moved by the speed and corrected
by a projection that starts where the robot was: nothing searches, a curve that crosses itself is fine.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import Controller, ControlPart, Start
from osculate.control.estimation.contract import TRUSTED, Evidence
from osculate.control.gate import GateMemory, GateParameters, gate_of
from osculate.control.reasons import CALM, Alarm
from osculate.control.standstill import DRIVING, StopMemory, StopParameters
from osculate.control.tracking.arrival import ArrivalParameters, arrival_parameters
from osculate.control.tracking.speed_loop import (
    SpeedLoop,
    SpeedMemory,
    SpeedParameters,
    effect_time,
)
from osculate.curve.contract import Curve
from osculate.curve.table import CELLS, CurveTable, point_at, tabulate
from osculate.kernel import Grid, Nothing, Tables, compose, kernel
from osculate.kernel.maths import atan, sincos, tan, wrap_angle
from osculate.target.contract import TargetPart
from osculate.target.speed import RESTING, Begin, Ceiling, Limits, SpeedPlan, plan_from
from osculate.vehicle.actuators import ServoStep, Steering
from osculate.vehicle.model import ReducedModel
from osculate.vehicle.motion import Motion
from osculate.vehicle.tricycle import Tricycle

FINEST = 0.02  # m, longest cell of a tracked curve
BEYOND = 2.0  # m, how far a tracked curve is known beyond its ends
FREE = 1e3  # m/s, no bound on the speed
NEAREST = 0.2  # 1 − κ y is kept above this: nearer to the centre of curvature nothing is unique


class Foot(NamedTuple):
    """A pose in the path frame."""

    arc_length: float  # m, of the nearest point
    aside: float  # m, y: left of the path is positive
    heading_error: float  # rad, e: robot minus path
    curvature: float  # 1/m, κ of the path there
    curvature_rate: float  # 1/m², dκ/ds


class Issued(NamedTuple):
    """A decision that does not act yet."""

    steering_angle: float  # rad, of the servo
    speed: float  # m/s, the speed it is meant to lead to


class View(NamedTuple):
    """What a steering law sees."""

    motion: Motion  # measured
    foot: Foot  # of the measured pose
    steering: Steering  # angle as measured, rate as observed
    acceleration: float  # m/s², expected until the next decision acts
    pending: Any  # tuple of `Issued`, the newest first
    bias: float  # rad, see `Sight`
    stretch: float


class TrackingParameters(NamedTuple):
    """Parameters of the tracking template."""

    model: ReducedModel
    period: float  # s
    observer: float  # 1/s, gain of the servo observer's rate
    half: ServoStep  # half a period
    wheelbase: float  # m
    speed: SpeedParameters
    profile: Grid  # E and E' over arc length
    curve: CurveTable
    steer: Any  # parameters of the steering law
    guard: Any  # of the safety layer
    gate: GateParameters
    stop: StopParameters
    arrival: ArrivalParameters


class TrackingMemory(NamedTuple):
    """Memory of the tracking template."""

    progress: float  # m
    evidence: Evidence  # of the last motion
    expected: Motion  # at the next instant
    steering: Steering  # likewise
    speed: SpeedMemory
    pending: Any  # tuple of `Issued`, the newest first
    steer: Any  # memory of the steering law
    guard: Any  # of the safety layer
    gate: GateMemory
    stop: StopMemory
    alarm: Alarm  # of the last decision


@kernel
def twin_angle(servo: float, bias: float, stretch: float) -> float:
    """Steering angle (rad) of the twin (see `Sight`) when the servo stands at ``servo``."""
    plain = bias == 0.0 and stretch == 1.0
    return servo if plain else atan(tan(servo + bias) / stretch)


@kernel
def servo_angle(twin: float, bias: float, stretch: float) -> float:
    """Angle (rad) of the servo at which the robot turns as its twin with the angle ``twin`` does."""
    plain = bias == 0.0 and stretch == 1.0
    return twin if plain else atan(stretch * tan(twin)) - bias


@kernel
def foot_of(
    x: float, y: float, heading: float, guess: float, curve: CurveTable, tables: NDArray[np.float64]
) -> Foot:
    """The pose in the path frame, by two Newton steps from a guess of the arc length."""
    s = guess
    for _ in range(2):
        near = point_at(s, curve, tables)
        sine, cosine = sincos(near.heading)
        along = (x - near.x) * cosine + (y - near.y) * sine
        off = (y - near.y) * cosine - (x - near.x) * sine
        slack = 1.0 - near.curvature * off
        s = s + along / (slack if slack > NEAREST else NEAREST)
    point = point_at(s, curve, tables)
    sine, cosine = sincos(point.heading)
    aside = (y - point.y) * cosine - (x - point.x) * sine
    return Foot(
        s, aside, wrap_angle(heading - point.heading), point.curvature, point.curvature_rate
    )


class Jitter(NamedTuple):
    """By how much a believed pose changes from one decision to the next for no reason: RMS."""

    position: float  # m, across the path
    heading: float  # rad


@dataclass(frozen=True)
class Road:
    """What a tracker is made for: the robot, the curve and its speeds, and its own timing."""

    robot: Tricycle
    curve: CurveTable
    profile: Grid
    limits: Limits
    arrival: ArrivalParameters  # at the end
    period: float  # s
    delay: int  # periods between a decision and its effect
    jitter: Jitter | None = None  # of the pose that is believed; None if it is known


def survey(
    curve: Curve,
    robot: Tricycle,
    limits: Limits,
    period: float,
    delay: int,
    tables: Tables,
    ceiling: Ceiling | None = None,
    begin: Begin = RESTING,
) -> tuple[Road, SpeedPlan]:
    """Plan the speed and tabulate curve and plan; what is in ``tables`` already is shared.

    A ``ceiling`` is one more limit of the speed over arc length, with its name; ``begin`` says where the
    robot begins, and how fast.

    Raises:
        InvalidInput: Limits that contradict each other.
        NoSolution: The robot cannot follow the curve, or begins too fast.
    """
    task = (begin, curve, robot, limits, ceiling)
    plan = tables.once(task, lambda: plan_from(*task))
    profile = tables.once((*task, "profile"), lambda: plan.table(tables))
    cells = max(CELLS, math.ceil(curve.length / FINEST))
    beyond = BEYOND + 2.0 * robot.wheelbase
    table = tables.once((curve, cells, beyond), lambda: tabulate(curve, tables, cells, beyond))
    ahead = effect_time(robot, period, delay)
    arrival = arrival_parameters(curve, robot, limits, ahead)
    return Road(robot, table, profile, limits, arrival, period, delay), plan


@dataclass(frozen=True)
class SteerPart:
    """A steering law ready to run."""

    steer: Any  # kernel, see the module's docstring
    parameters: Any
    memory: Any


@kernel
def watch_nothing(motion: Motion, expected: Motion, memory: Nothing, p: Nothing) -> Any:
    """Believe every motion."""
    return motion, memory, CALM


@kernel
def guard_nothing(
    view: View, angle: float, bound: float, deceleration: float, memory: Nothing, p: Nothing,
    curve: CurveTable, tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """Leave every decision as it is."""
    return angle, bound, deceleration, memory, CALM


class GuardPart(NamedTuple):
    """A safety layer ready to run: it sees what is measured and what is decided."""

    watch: Any = watch_nothing
    guard: Any = guard_nothing
    parameters: Any = Nothing()
    memory: Any = Nothing()
    patience: float | None = None  # s, for which pose and encoders may be missing
    deceleration: float = math.inf  # m/s², of a stop, if the robot can


#: No safety layer.
UNGUARDED = GuardPart()
BRAKING = 0.8  # part of motors, brake and grip that a stop counts on
GRIP = 0.72  # part of the load: nine tenths of a friction of 0.8
POSE_PATIENCE = 5.0  # s, for which a pose may be missing where nothing guards the robot
PATIENCE = 0.3  # s, likewise the wheel encoders, or motions


def stop_deceleration(robot: Tricycle) -> float:
    """Deceleration (m/s²) of a stop by the brake or, without one, by the motors."""
    means = robot.brake.deceleration if robot.brake else BRAKING * robot.motor_deceleration
    return min(means, BRAKING * GRIP * robot.gravity)


def stop_parameters(road: Road, end: float, guard: GuardPart) -> StopParameters:
    """How a robot stops, and when it must.

    Args:
        road: What it drives.
        end: Arc length (m) at which the path ends.
        guard: Its safety layer.
    """
    robot = road.robot
    wanted = min(stop_deceleration(robot), guard.deceleration)
    share = min(1.0, wanted / robot.brake.deceleration) if robot.brake else 0.0
    pose = POSE_PATIENCE if road.jitter else PATIENCE
    return StopParameters(
        period=road.period,
        pose=guard.patience or pose,
        wheels=guard.patience or PATIENCE,
        deceleration=wanted,
        brake=share,
        parking=float(robot.brake is not None),
        end=end,
        inertia=robot.wheel_radius * robot.total_mass,
        rolling=robot.actuators.rolling_resistance * robot.gravity,
    )


class PathTracker(Controller):
    """A sampled law that follows a curve at the speeds of a plan, with feedback of the pose."""

    speed: SpeedLoop = SpeedLoop()

    #: Fields that a tuner may change, with the range in which it looks.
    tunable: ClassVar[dict[str, tuple[float, float]]] = {}

    def part(
        self, model: ReducedModel, target: TargetPart, start: Start, tables: Tables
    ) -> ControlPart:
        """Trackers are made by `tracking_part`: they follow no target of speeds over time."""
        raise NotImplementedError

    @abstractmethod
    def steering_part(self, road: Road) -> SteerPart:
        """The steering law for a road."""

    def tracking_part(
        self, road: Road, start: Start, progress: float, guard: GuardPart = UNGUARDED
    ) -> ControlPart:
        """Kernel, parameters and initial memory; ``progress`` (m) is where on the curve it starts."""
        law = self.steering_part(road)
        robot, period = road.robot, road.period
        act = robot.actuators
        angle = float(np.arctan(robot.wheelbase * start.curvature))
        speed = max(start.speed, 0.0)
        gate, gate_memory = gate_of(act, period, angle)
        parameters = TrackingParameters(
            model=robot.reduced_model(),
            period=period,
            observer=0.3 / period,
            half=act.servo(0.5 * period),
            wheelbase=robot.wheelbase,
            speed=self.speed.parameters(robot, road.limits, period, road.delay),
            profile=road.profile,
            curve=road.curve,
            steer=law.parameters,
            guard=guard.parameters,
            gate=gate,
            stop=stop_parameters(road, road.curve.length, guard),
            arrival=road.arrival,
        )
        memory = TrackingMemory(
            progress=progress,
            evidence=TRUSTED._replace(located=0.0),
            expected=Motion(*start[:5], angle),
            steering=Steering(angle, 0.0),
            speed=SpeedMemory(speed, speed, 0.0, 0.0, 0.0),
            pending=(Issued(angle, speed),) * max(1, road.delay),
            steer=law.memory,
            guard=guard.memory,
            gate=gate_memory,
            stop=DRIVING,
            alarm=CALM,
        )
        switch = self.speed.switch()
        template = "osculate.control.templates.tracking"
        parts = {
            "steer": law.steer, "switch": switch, "watch": guard.watch, "guard": guard.guard,
            "DELAYED": road.delay > 0,
        }  # fmt: skip
        track = compose(template, parts).track
        return ControlPart(track, parameters, memory, 0.0)
