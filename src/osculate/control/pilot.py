"""Everything that decides, in one object: estimator, path tracker and safety layer.

A pilot is what runs on a robot: a measurement in, a command out, once a period. Without an estimator the
measurement is the motion itself.
"""

from dataclasses import replace
from typing import Any, NamedTuple

from osculate.control.contract import Start
from osculate.control.estimation.contract import Told
from osculate.control.estimation.ekf import Ekf
from osculate.control.safety import Safety
from osculate.control.tracking.contract import UNGUARDED, PathTracker, Road, TrackingMemory
from osculate.kernel import Nothing, compose, kernel
from osculate.vehicle.motion import Motion


class PilotMemory(NamedTuple):
    """Memory of the pilot template."""

    law: Any  # of the tracker
    belief: Any  # of the estimator
    told: Told  # what acts until the next instant


class PilotParameters(NamedTuple):
    """Parameters of the pilot template."""

    law: Any
    estimator: Any


class Insight(NamedTuple):
    """What a pilot believed and did at its last decision."""

    x: float  # m, estimated
    y: float  # m
    heading: float  # rad
    speed: float  # m/s
    intervention: float  # number of the reason, see `osculate.control.reasons`
    excess: float  # m, by which the robot would have left its corridor
    cause: float  # number of what caused it


@kernel
def insight_of_pilot(seen: Any, memory: PilotMemory) -> Insight:
    """The estimate, and what was intervened."""
    m, alarm = memory.belief.mean, memory.law.alarm
    return Insight(m.x, m.y, m.heading, m.speed, alarm.reason, alarm.excess, alarm.cause)


@kernel
def insight_of_tracker(seen: Motion, memory: TrackingMemory) -> Insight:
    """The motion, which is known, and what was intervened."""
    alarm = memory.alarm
    return Insight(
        seen.x, seen.y, seen.heading, seen.speed, alarm.reason, alarm.excess, alarm.cause
    )


@kernel
def no_insight(seen: Any, memory: Any) -> Nothing:
    """Nothing beyond the motion."""
    return Nothing(0.0)


@kernel
def stop_of_pilot(memory: PilotMemory) -> float:
    """Reason of a stop, 0 if there is none."""
    return memory.law.stop.alarm.reason


@kernel
def stop_of_tracker(memory: TrackingMemory) -> float:
    """Reason of a stop, 0 if there is none."""
    return memory.stop.alarm.reason


@kernel
def no_stop(memory: Any) -> float:
    """Nobody stops the robot."""
    return 0.0


class PilotPart(NamedTuple):
    """A pilot ready to run."""

    decide: Any  # kernel (measurement or motion, memory, parameters, tables), see the template
    parameters: Any
    memory: Any
    insight: Any  # kernel (measurement or motion, memory) -> `Insight` or nothing
    stop: Any  # kernel (memory) -> number of the stop's reason


def pilot_part(
    law: PathTracker,
    road: Road,
    start: Start,
    progress: float,
    motion: Motion,
    estimator: Ekf | None = None,
    safety: Safety | None = None,
) -> PilotPart:
    """Put a pilot together.

    Args:
        law: The tracker.
        road: What it is made for.
        start: Where the robot is believed to be.
        progress: Where on the curve (m).
        motion: What it is believed to do.
        estimator: Where motions come from; None if they are measured themselves.
        safety: What guards the law.
    """
    if estimator is not None:
        road = replace(road, jitter=estimator.jitter(road.robot, road.period))
    guard = safety.part(road, motion) if safety else UNGUARDED
    part = law.tracking_part(road, start, progress, guard)
    if estimator is None:
        track = compose("osculate.control.templates.trusting", {"track": part.control}).decide
        insight = insight_of_tracker if safety else no_insight
        return PilotPart(track, part.parameters, part.memory, insight, stop_of_tracker)
    guess = estimator.part(road.robot, start, road.period)
    angle = motion.steering_angle
    memory = PilotMemory(part.memory, guess.belief, Told(angle, 0.0))
    parts = {"track": part.control, "estimate": guess.estimate, "DELAYED": road.delay > 0}
    return PilotPart(
        compose("osculate.control.templates.pilot", parts).pilot,
        PilotParameters(part.parameters, guess.parameters),
        memory,
        insight_of_pilot,
        stop_of_pilot,
    )
