"""The named tuples that the engine moves: parameters, state and one row of the record."""

from typing import Any, NamedTuple

from osculate.control.contract import Errors
from osculate.curve.table import CurveTable
from osculate.simulation.tally import Tally
from osculate.target.contract import Reference, TargetMemory
from osculate.vehicle.motion import Command, Motion


class Parameters(NamedTuple):
    """Everything that may differ between two runs of one closed loop."""

    plant: Any
    disturbance: Any
    pace: Any
    target: Any
    control: Any
    curve: CurveTable
    delay: float  # steps between a command's decision and its effect (sampled clock)
    finish: float  # m, arc length at which the run is complete
    path_end: float  # m, arc length of the nearest point at which a tracked run is complete
    deadline: float  # s, when the timetable of a static target is complete
    settled: float  # m, errors count from this arc length on
    speed_limit: float  # m/s, beyond which a run counts as diverged


class State(NamedTuple):
    """State of the closed loop: what is integrated."""

    plant: Any
    disturbance: Any
    target: TargetMemory
    control: Any  # nothing when the law is sampled: then its memory is in `Held`


class Held(NamedTuple):
    """What a sampled law keeps between two instants."""

    memory: Any
    reference: Reference
    errors: Errors
    commands: Any  # tuple of the last commands decided, the newest first


class Action(NamedTuple):
    """What a sampled law's last decisions amount to now: constant during a step."""

    command: Command
    reference: Reference
    errors: Errors


class Status(NamedTuple):
    """Whether a run still goes on, and where its clock stands."""

    code: float  # RUNNING, FINISHED or DIVERGED
    time: float  # s, of the state held


RUNNING, FINISHED, DIVERGED = 0.0, 1.0, 2.0


class Progress(NamedTuple):
    """A run at one instant."""

    state: State
    held: Any  # `Held` when the law is sampled
    tally: Tally
    status: Status


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
