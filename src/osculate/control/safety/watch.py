"""What is measured against what was expected: every field of a motion, and fields against each other.

The expectation is the last motion moved on by what acted on the robot. A pose that jumps is replaced by
it, a speed, yaw rate or steering angle that jumps likewise. What creeps away slowly is found by comparing
means: way and turn by the poses with speed and yaw rate, and the yaw rate with the steering angle.
"""

from typing import Any, NamedTuple

from osculate.control.reasons import (
    HEADING,
    IMPOSSIBLE,
    POSITION,
    SPEED,
    STEERING_ANGLE,
    YAW_RATE,
    Alarm,
)
from osculate.kernel import kernel, select
from osculate.kernel.maths import sincos, tan, wrap_angle
from osculate.vehicle.motion import Motion

SETTLING = 0.1  # s, over which means are taken
DISTRUST = 1.0  # s, for which a speed that was wrong is not believed
MOVING = 0.05  # m/s, at which a pose that stays the same is frozen


class WatchParameters(NamedTuple):
    """Parameters of `watch_motion`."""

    wheelbase: float  # m
    period: float  # s
    patience: float  # s, for which measurements may be impossible
    position: float  # m, that no pose jumps in a period
    heading: float  # rad, likewise
    speed: float  # m/s, likewise of the speed
    yaw_rate: float  # rad/s
    steering: float  # rad
    blend: float  # part of a mean that is new in every period


class WatchMemory(NamedTuple):
    """Memory of `watch_motion`."""

    last: Motion  # as measured
    seen: Motion  # as it was believed then
    known: float  # 1 once there is one
    way: float  # m/s, mean of the speed by poses minus the speed
    turn: float  # rad/s, mean of the yaw rate by headings minus the yaw rate
    bend: float  # rad/s, mean of the yaw rate minus that of the steering angle
    doubt: float  # s, for which measurements have been impossible
    distrust: float  # s, for which the speed is not believed any more


#: Nothing was measured yet.
UNSEEN = WatchMemory(
    Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
)


@kernel
def compare_means(motion: Motion, believed: Motion, now: WatchMemory, p: WatchParameters) -> Any:
    """Means of what poses and readings say differently (speed, yaw rate, yaw rate of the steering).

    Poses are those that were believed; the fourth value is the speed (m/s) by the last two of them.
    """
    last, before = now.last, now.seen
    sine, cosine = sincos(believed.heading)
    along = (believed.x - before.x) * cosine + (believed.y - before.y) * sine
    turned = wrap_angle(believed.heading - before.heading)
    steered = motion.speed * tan(motion.steering_angle) / p.wheelbase
    known = now.known * p.blend
    way = now.way + known * (along / p.period - 0.5 * (motion.speed + last.speed) - now.way)
    turn = now.turn + known * (
        turned / p.period - 0.5 * (motion.yaw_rate + last.yaw_rate) - now.turn
    )
    bend = now.bend + known * (motion.yaw_rate - steered - now.bend)
    return way, turn, bend, along / p.period


@kernel
def blame(motion: Motion, expected: Motion, now: WatchMemory, p: WatchParameters) -> Any:
    """What is impossible about a motion, 0 if nothing is, and the part of it that may be believed."""
    dx, dy = motion.x - expected.x, motion.y - expected.y
    away = dx * dx + dy * dy > p.position * p.position
    frozen = (
        motion.x == now.last.x and motion.y == now.last.y and motion.heading == now.last.heading
    )
    away = away or (frozen and now.known > 0.0 and abs(expected.speed) > MOVING)
    turned = abs(wrap_angle(motion.heading - expected.heading)) > p.heading
    hasty = abs(motion.speed - expected.speed) > p.speed
    spun = abs(motion.yaw_rate - expected.yaw_rate) > p.yaw_rate + 0.5 * abs(expected.yaw_rate)
    bent = abs(motion.steering_angle - expected.steering_angle) > p.steering
    lost = away or turned
    believed = Motion(
        expected.x if lost else motion.x,
        expected.y if lost else motion.y,
        expected.heading if lost else motion.heading,
        expected.speed if hasty else motion.speed,
        expected.yaw_rate if spun else motion.yaw_rate,
        expected.steering_angle if bent else motion.steering_angle,
    )
    cause = YAW_RATE if spun else 0.0
    cause = STEERING_ANGLE if bent else cause
    cause = SPEED if hasty else cause
    cause = HEADING if turned else cause
    return believed, POSITION if away else cause


@kernel
def watch_motion(motion: Motion, expected: Motion, now: WatchMemory, p: WatchParameters) -> Any:
    """The motion as far as it is to be believed, the memory, and the alarm with what is doubted.

    A speed that the poses contradict, or did lately, is replaced by the expected one, corrected by theirs.
    """
    fresh = now.known > 0.0
    believed, sudden = blame(motion, select(fresh, expected, motion), now, p)
    way, turn, bend, pace = compare_means(motion, believed, now, p)
    rate = abs(motion.yaw_rate)
    slides = abs(way) > 0.25 + 0.15 * abs(motion.speed)
    creeping = YAW_RATE if abs(turn) > 0.25 + 0.25 * rate else 0.0
    creeping = STEERING_ANGLE if abs(bend) > 0.35 + 0.35 * rate else creeping
    creeping = SPEED if slides else creeping
    cause = sudden if sudden > 0.0 else creeping
    doubt = now.doubt + p.period if cause > 0.0 else 0.0
    distrust = DISTRUST if cause == SPEED else now.distrust - p.period
    doubted = distrust > 0.0
    lost = sudden in (POSITION, HEADING)
    observed = expected.speed + (0.0 if lost else p.blend * (pace - expected.speed))
    seen = Motion(
        believed.x, believed.y, believed.heading, observed if doubted else believed.speed,
        believed.yaw_rate, believed.steering_angle,
    )  # fmt: skip
    what = SPEED if doubted and cause == 0.0 else cause
    alarm = Alarm(IMPOSSIBLE if doubt > p.patience else 0.0, 0.0, what)
    return seen, WatchMemory(motion, seen, 1.0, way, turn, bend, doubt, distrust), alarm
