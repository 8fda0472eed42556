"""Which readings an estimator may use at all: each has a gate of its own.

A reading that is not finite, that no robot can produce, or that contradicts two others, is refused: from
then on it is missing (NaN). A reading that is merely surprising is used with less weight (see `learn`).

The steering encoder is believed when it agrees with the model of the servo or with the yaw rate; a servo
that is stuck, late or slow agrees with the latter. The gyro is believed when it agrees with the steering or
with the wheels.
"""

import math
from typing import Any, NamedTuple

from osculate.control.estimation.kinematics import Kinematics
from osculate.kernel import finite_sum, kernel
from osculate.kernel.maths import PI, atan
from osculate.vehicle.measurement import FARTHEST, FASTEST, TURNS, Fix, Measurement

ROLLING = 0.2  # m/s, from which on a yaw rate says something about the steering
STANDING = 0.05  # m, that a robot may move while the same pose is reported again


class GateParameters(NamedTuple):
    """Parameters of `screen`; a robot moves away from what was expected no further than this."""

    period: float  # s
    history: float  # s, largest age of a pose
    track: float  # m
    wheelbase: float  # m
    wheels: float  # m/s, plus `part` of the speed
    part: float
    gyro: float  # rad/s, plus half of the yaw rate
    steering: float  # rad, from the servo's model
    turning: float  # rad, from the angle that the yaw rate says
    lock: float  # rad, that the encoder can report
    swing: float  # rad, that the servo can move in a period, and some more


class GateMemory(NamedTuple):
    """What was reported last."""

    steering_angle: float  # rad
    x: float  # m, newest pose
    y: float  # m
    heading: float  # rad
    way: float  # m, driven since that pose came for the first time


#: Nothing was reported yet.
UNHEARD = GateMemory(0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def screen_wheels(z: Measurement, m: Kinematics, yaw_rate: float, p: GateParameters) -> bool:
    """Whether both wheel encoders may be believed."""
    scale = 1.0 + m.speed_scale
    allowed = p.wheels + p.part * abs(m.speed)
    mean = abs(0.5 * (z.left + z.right) - scale * m.speed) < allowed
    return mean and abs(z.right - z.left - scale * p.track * yaw_rate) < 2.0 * allowed


@kernel
def screen_gyro(
    z: Measurement, m: Kinematics, yaw_rate: float, rolled: float, p: GateParameters
) -> bool:
    """Whether the gyro may be believed; ``rolled`` (rad/s) is what the wheels say."""
    rate = z.yaw_rate - m.gyro_bias
    allowed = p.gyro + 0.5 * abs(yaw_rate)
    return abs(rate - yaw_rate) < allowed or abs(rate - rolled) < p.gyro


@kernel
def screen_steering(
    z: Measurement, m: Kinematics, turning: float, before: float, p: GateParameters
) -> bool:
    """Whether the steering encoder may be believed; ``turning`` (rad/s) is the yaw rate as read."""
    angle = z.steering_angle
    rolls = abs(m.speed) > ROLLING
    implied = atan(p.wheelbase * turning / (m.speed if rolls else 1.0)) - m.steering_bias
    calm = abs(angle - m.steering_angle) < p.steering
    turns = rolls and abs(angle - implied) < p.turning
    creeps = not rolls and abs(angle - before) < p.swing
    return abs(angle) < p.lock and (calm or turns or creeps)


@kernel
def screen_fix(fix: Fix, now: GateMemory, p: GateParameters) -> bool:
    """Whether a pose is whole, of an age that can be, and new."""
    near = abs(fix.x) < FARTHEST and abs(fix.y) < FARTHEST and abs(fix.heading) < TURNS
    timely = fix.age >= 0.0 and fix.age <= p.history + 1e-9
    same = fix.x == now.x and fix.y == now.y and fix.heading == now.heading
    return near and timely and not (same and now.way > STANDING)


@kernel
def screen(
    z: Measurement, m: Kinematics, yaw_rate: float, fresh: bool, now: GateMemory, p: GateParameters
) -> Any:
    """The measurement with NaN for what is refused, and the memory.

    Args:
        z: What was reported.
        m: The state as expected.
        yaw_rate: Its yaw rate (rad/s).
        fresh: Whether no pose was believed so far: then speed and steering are not known either.
        now: What was reported before.
        p: The gates.
    """
    possible = abs(z.left) < FASTEST and abs(z.right) < FASTEST
    wheels = possible and (fresh or screen_wheels(z, m, yaw_rate, p))
    left = z.left if wheels else math.nan
    right = z.right if wheels else math.nan
    rolled = (right - left) / (p.track * (1.0 + m.speed_scale))
    gyro = abs(z.yaw_rate) < FASTEST and (fresh or screen_gyro(z, m, yaw_rate, rolled, p))
    reading = z.yaw_rate if gyro else math.nan
    turning = reading - m.gyro_bias if gyro else rolled
    turning = turning if turning == turning else yaw_rate
    steering = abs(z.steering_angle) < p.lock and fresh
    steering = steering or screen_steering(z, m, turning, now.steering_angle, p)
    fixed = screen_fix(z.fix, now, p)
    lost = math.nan
    fix = Fix(
        z.fix.x if fixed else lost, z.fix.y if fixed else lost, z.fix.heading if fixed else lost,
        z.fix.age if fixed else 0.0,
    )  # fmt: skip
    known = abs(z.steering_angle) < PI
    same = z.fix.x == now.x and z.fix.y == now.y and z.fix.heading == now.heading
    way = now.way + p.period * abs(m.speed)
    keep = same or finite_sum(fix) != 0.0
    memory = GateMemory(
        z.steering_angle if known else now.steering_angle,
        now.x if keep else fix.x,
        now.y if keep else fix.y,
        now.heading if keep else fix.heading,
        way if keep else 0.0,
    )
    clean = Measurement(left, right, z.steering_angle if steering else lost, reading, fix)
    return clean, memory
