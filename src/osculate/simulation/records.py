"""The named tuples that the engine moves: parameters, state and one row of the record."""

from typing import Any, NamedTuple

from osculate.control.contract import Errors
from osculate.curve.table import CurveTable
from osculate.plant.contract import Push
from osculate.simulation.events import EventMemory, EventParameters
from osculate.simulation.tally import Tally
from osculate.target.contract import Reference, TargetMemory
from osculate.vehicle.motion import Command, Motion


class Parameters(NamedTuple):
    """Everything about a robot's world that may differ between two runs of one closed loop.

    A law that is integrated together with the plant has its parameters here, a sampled one in `Thought`.
    """

    plant: Any
    disturbance: Any
    pace: Any
    target: Any
    control: Any
    curve: CurveTable
    delay: float  # steps between a command's decision and its effect (sampled clock)
    finish: float  # m, arc length at which the run is complete
    path_end: float  # m, arc length of the nearest point at which a tracked run is over, moving
    deadline: float  # s, when the timetable of a static target is complete
    settled: float  # m, errors count from this arc length on
    speed_limit: float  # m/s, beyond which a run counts as diverged
    events: EventParameters


class Thought(NamedTuple):
    """Likewise everything that matters when a sampled law decides."""

    plant: Any
    sensors: Any
    blows: Any  # what pushes the robot
    impairment: Any
    pace: Any
    target: Any
    control: Any
    curve: CurveTable


class Mind(NamedTuple):
    """What a sampled law and its sensors remember from one instant to the next."""

    memory: Any
    sensors: Any


class State(NamedTuple):
    """State of the closed loop: what is integrated."""

    plant: Any
    disturbance: Any
    target: TargetMemory
    control: Any  # nothing when the law is sampled: then its memory is in `Mind`


class Held(NamedTuple):
    """What was decided at the last instant and acts until the next one."""

    push: Push  # of all blows
    insight: Any  # `Insight` of a pilot, or nothing
    reference: Reference
    errors: Errors
    stop: float  # reason for which the law stops the robot for good; 0 is none
    commands: Any  # tuple of the last commands decided, the newest first


class Action(NamedTuple):
    """What a sampled law's last decisions amount to now: constant during a step."""

    command: Command
    push: Push
    insight: Any
    reference: Reference
    errors: Errors


class Status(NamedTuple):
    """Whether a run still goes on, and where its clock stands."""

    code: float  # RUNNING, FINISHED, DIVERGED or STOPPED
    time: float  # s, of the state held


RUNNING, FINISHED, DIVERGED, STOPPED = 0.0, 1.0, 2.0, 3.0


class Moved(NamedTuple):
    """What changes in every step: the beginning of a `Progress`, which is stored alone."""

    state: State
    tally: Tally
    events: EventMemory
    status: Status


class Progress(NamedTuple):
    """A run at one instant."""

    state: State
    tally: Tally
    events: EventMemory
    status: Status
    held: Any  # `Held` when the law is sampled


class Row(NamedTuple):
    """One row of the record: what was seen, wanted and commanded at one time."""

    time: float  # s
    motion: Motion
    reference: Reference
    command: Command
    errors: Errors
    arc_length: float  # m, the target's own progress
    foot: float  # m, arc length of the nearest point
    cross_track: float  # m
    heading_error: float  # rad, robot minus curve
    insight: Any  # what a pilot believed and did, or nothing
