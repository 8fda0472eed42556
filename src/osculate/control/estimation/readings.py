"""The measurement model: what every sensor says about the state, linearised.

A pose that arrives late is compared with where the robot was when it was taken: the estimate, moved back
by what was driven since.
"""

import math
from typing import Any

from osculate.control.estimation.belief import EkfParameters, Place
from osculate.control.estimation.kinematics import UNITS, ZERO, Clue, Covariance, Kinematics
from osculate.control.estimation.process import yaw
from osculate.kernel import axpy, kernel
from osculate.kernel.maths import sincos, wrap_angle
from osculate.vehicle.measurement import Fix, Measurement


@kernel
def speed_clue(m: Kinematics, z: Measurement, acceleration: float, p: EkfParameters) -> Clue:
    """The mean of both drive wheels' encoders: (1 + g) (1 + c v̇ / ρ) v, ρ being their share of the load.

    The same tyres slip along as across; what they do besides makes the reading less certain.
    """
    traction = acceleration * p.per_load
    tread = 1.0 + m.slip * traction
    scale = (1.0 + m.speed_scale) * tread
    slip = p.wheel_slip * m.speed
    slope = axpy(scale, UNITS.speed, axpy(m.speed * tread, UNITS.speed_scale, ZERO))
    slope = axpy((1.0 + m.speed_scale) * m.speed * traction, UNITS.slip, slope)
    miss = 0.5 * (z.left + z.right) - scale * m.speed
    return Clue(slope, miss, p.speed + slip * slip, p.surprising)


@kernel
def difference_clue(m: Kinematics, z: Measurement, p: EkfParameters) -> Clue:
    """Their difference: (1 + g) d ω, less certain because tyres under different loads slip differently."""
    steered, per_angle, per_speed, per_understeer = yaw(m, p)
    rate = steered + m.swerve
    scale = 1.0 + m.speed_scale
    arm = scale * p.track
    slope = Kinematics(
        0.0, 0.0, 0.0, arm * per_speed, arm * per_angle, 0.0, arm * per_angle, p.track * rate, 0.0,
        0.0, arm * per_understeer, arm,
    )  # fmt: skip
    return Clue(slope, z.right - z.left - arm * rate, p.difference, p.surprising)


@kernel
def gyro_clue(m: Kinematics, reading: float, p: EkfParameters) -> Clue:
    """The gyro: ω + β."""
    rate, per_angle, per_speed, per_understeer = yaw(m, p)
    slope = Kinematics(
        0.0, 0.0, 0.0, per_speed, per_angle, 0.0, per_angle, 0.0, 1.0, 0.0, per_understeer, 1.0
    )
    return Clue(slope, reading - rate - m.swerve - m.gyro_bias, p.gyro, p.surprising)


@kernel
def place_then(trail: Any, instants: float) -> Place:
    """Where dead reckoning was so many instants ago; the trail goes back far enough."""
    x, y, heading = 0.0, 0.0, 0.0
    for n in range(len(trail)):
        near = 1.0 - abs(instants - n)
        near = near if near > 0.0 else 0.0
        x = x + near * trail[n].x
        y = y + near * trail[n].y
        heading = heading + near * trail[n].heading
    return Place(x, y, heading)


@kernel
def fix_innovation(m: Kinematics, trail: Any, fix: Fix, p: EkfParameters) -> Any:
    """What a pose is off from where the robot was then, and the way driven since (m, ahead and aside)."""
    now = trail[0]
    then = place_then(trail, fix.age / p.period)
    sine, cosine = sincos(then.heading)
    dx, dy = now.x - then.x, now.y - then.y
    along, aside = dx * cosine + dy * sine, dy * cosine - dx * sine
    heading = m.heading - (now.heading - then.heading)
    sine, cosine = sincos(heading)
    ahead_x, ahead_y = along * cosine - aside * sine, along * sine + aside * cosine
    off = Place(fix.x - (m.x - ahead_x), fix.y - (m.y - ahead_y), wrap_angle(fix.heading - heading))
    return off, Place(ahead_x, ahead_y, 0.0)


@kernel
def fits(off: Place, c: Covariance, p: EkfParameters) -> bool:
    """Whether a pose is within its gate; false without one."""
    x = off.x * off.x <= p.gate * (c.x.x + p.position)
    y = off.y * off.y <= p.gate * (c.y.y + p.position)
    return x and y and off.heading * off.heading <= p.gate * (c.heading.heading + p.heading)


@kernel
def agrees(off: Place, before: Place, p: EkfParameters) -> bool:
    """Whether two poses are off by the same."""
    dx, dy = off.x - before.x, off.y - before.y
    turned = wrap_angle(off.heading - before.heading)
    near = dx * dx + dy * dy <= 2.0 * p.gate * p.position
    return near and turned * turned <= 2.0 * p.gate * p.heading


@kernel
def fix_clues(off: Place, ahead: Place, taken: bool, p: EkfParameters) -> Any:
    """The three readings of a pose, taken in or left out together."""
    lost = 0.0 if taken else math.nan
    far = math.inf
    return (
        Clue(axpy(ahead.y, UNITS.heading, UNITS.x), off.x + lost, p.position, far),
        Clue(axpy(-ahead.x, UNITS.heading, UNITS.y), off.y + lost, p.position, far),
        Clue(UNITS.heading, off.heading + lost, p.heading, far),
    )
