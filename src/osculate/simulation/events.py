"""What goes wrong on the way: the first time that a robot leaves its corridor or goes backwards.

Watched sample by sample, so that a million runs need no record. A robot has left its corridor once O is
as far from the curve as the corridor is wide, having been nearer before: a start outside is no leaving,
unless it is to be made good by an arc length that is behind it.
It has reversed once it is `BACKWARD` behind where it was along the path, by the sum of speed times the
cosine of the heading error: driving backwards counts, and so does driving forward after a turn.

It slides while a wheel moves over the ground faster than `SLIDING` and `SLIP` allow: more than tyres creep.
That alone is no event; it is the reason of one. A robot that goes backwards after it slid has spun.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

from osculate.kernel import kernel, select
from osculate.kernel.maths import sincos
from osculate.simulation.tally import Tally
from osculate.vehicle.motion import Motion

if TYPE_CHECKING:
    from osculate.control.safety import Safety
    from osculate.vehicle import Tricycle

NOTHING, LEFT, REVERSED, SPUN = 0.0, 1.0, 2.0, 3.0
OFF_PATH = 1.0  # m, distance from the curve at which a robot has left it, if no corridor is given
BACKWARD = 0.1  # m, along the path
SLIDING = 0.15  # m/s, speed of a wheel over the ground that is no creep
SLIP = 0.2  # likewise per rolling speed: beyond it a tyre has passed its best grip
RECENT = 2.0  # s, for which having slid may be why something happened
LONG_AGO = -1e9  # s


class Event(NamedTuple):
    """One thing that went wrong."""

    kind: float  # NOTHING, LEFT, REVERSED or SPUN
    time: float  # s
    place: float  # m, arc length of the nearest point of the curve
    x: float  # m, of O
    y: float  # m
    slid: float  # 1 if it had slid shortly before


class EventParameters(NamedTuple):
    """Parameters of `watch_events`."""

    half_width: float  # m, of the corridor
    strict: float  # 1 if leaving it counts from the start, 0 if only from `settled` on
    settled: float  # m, arc length from which on the rest counts
    wheelbase: float  # m
    sliding: float  # m/s, speed of a wheel over the ground that is no creep; infinite if wheels only roll


class EventMemory(NamedTuple):
    """What is remembered from one sample to the next."""

    first: Event
    inside: float  # 1 once O was nearer to the curve than the corridor is wide
    backward: float  # m, by which the robot is behind where it was along the path
    slid: float  # s, when it last slid
    x: float  # m, of O at the last sample
    y: float  # m


def no_events(x: float, y: float) -> EventMemory:
    """The memory of a robot that stands at x and y (m)."""
    nothing = Event(NOTHING, 0.0, 0.0, 0.0, 0.0, 0.0)
    return EventMemory(nothing, 0.0, 0.0, LONG_AGO, x, y)


def event_parameters(
    robot: "Tricycle", settled: float, safety: "Safety | None", slippery: bool
) -> EventParameters:
    """What counts as leaving the path and going backwards.

    The corridor is that of the safety layer, which counts from the start, or `OFF_PATH` to each side.

    Args:
        robot: What drives.
        settled: Arc length (m) from which on errors count.
        safety: Its safety layer.
        slippery: Whether its wheels can slide at all.
    """
    half_width = OFF_PATH if safety is None else safety.half_width
    sliding = SLIDING if slippery else math.inf
    return EventParameters(half_width, float(safety is not None), settled, robot.wheelbase, sliding)


@kernel
def slides(elapsed: float, motion: Motion, x: float, y: float, p: EventParameters) -> bool:
    """Whether a wheel slides over the ground since O was at x and y (m), ``elapsed`` seconds ago."""
    sine, cosine = sincos(motion.heading)
    across, ahead = sincos(motion.steering_angle)
    per_second = 1.0 / elapsed if elapsed > 0.0 else 0.0
    dx, dy = (motion.x - x) * per_second, (motion.y - y) * per_second
    along, aside = dx * cosine + dy * sine, dy * cosine - dx * sine
    swing = aside + p.wheelbase * motion.yaw_rate
    front = swing * ahead - along * across
    rear = aside * aside + (along - motion.speed) * (along - motion.speed)
    worst = rear if rear > front * front else front * front
    allowed = p.sliding * p.sliding + SLIP * SLIP * motion.speed * motion.speed
    return elapsed > 0.0 and worst > allowed


@kernel
def watch_events(
    t: float, elapsed: float, motion: Motion, tally: Tally, memory: EventMemory, p: EventParameters
) -> EventMemory:
    """The memory with one more sample.

    Args:
        t: Time of the sample (s).
        elapsed: Since the last one (s), 0 for the first.
        motion: What the robot does.
        tally: With this sample.
        memory: Without it.
        p: The parameters.
    """
    slid = t if slides(elapsed, motion, memory.x, memory.y, p) else memory.slid
    _, facing = sincos(tally.heading_error)
    backward = memory.backward - elapsed * motion.speed * facing
    counts = p.settled <= 0.0 or tally.foot >= p.settled
    backward = backward if backward > 0.0 and counts else 0.0
    outside = abs(tally.cross_track) >= p.half_width
    due = p.settled > 0.0 and counts
    left = outside and (due or (memory.inside > 0.0 and (counts or p.strict > 0.0)))
    lately = 1.0 if t - slid <= RECENT else 0.0
    back = SPUN if lately > 0.0 else REVERSED
    kind = LEFT if left else (back if backward >= BACKWARD else NOTHING)
    now = Event(kind, t, tally.foot, motion.x, motion.y, lately)
    first = select(memory.first.kind == NOTHING and kind != NOTHING, now, memory.first)
    inside = memory.inside if outside else 1.0
    return EventMemory(first, inside, backward, slid, motion.x, motion.y)
