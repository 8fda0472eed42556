"""How far aside a robot can come that steers and brakes as well as it can.

In the path frame with lateral error y, heading error e and a curvature of the robot's own path that
differs from that of the curve by δ. It takes the time t (delay, lag, and the servo's way at its largest
rate) until the wheel stands as it should. Until then, at the speed v,

    e₁ = e + δ v t,        y₁ = y + e v t + δ (v t)² / 2

and after that the robot turns back with the curvature k that angle limit, grip and tipping leave it,

    y₂ = y₁ + (1 − cos e₁) / k.

With the steering stuck it goes on along its circle instead, for as long as it takes to brake.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.reasons import HEADING, POSITION, STEERING_ANGLE
from osculate.control.tracking.contract import View, foot_of
from osculate.curve.table import CurveTable
from osculate.kernel import kernel
from osculate.kernel.maths import atan, cos, sincos, tan

LEAST = 0.05  # 1/m, curvature that is always left to turn back


class CorridorParameters(NamedTuple):
    """Parameters of `farthest` and `aside_when_stuck`."""

    half_width: float  # m
    wheelbase: float  # m
    angle_limit: float  # rad
    rate_limit: float  # rad/s
    lag: float  # s, from a decision to its effect, without the servo's way
    lateral: float  # m/s², that neither tips nor slides
    reaction: float  # s, from a decision to the beginning of its braking
    deceleration: float  # m/s², of a stop


class Outlook(NamedTuple):
    """Where a robot is going to be at worst."""

    aside: float  # m, largest distance from the path
    cause: float  # what contributes most to it


@kernel
def farthest(view: View, p: CorridorParameters) -> Outlook:
    """The largest distance from the path (m) of a robot that does its best from now on."""
    foot, speed = view.foot, abs(view.motion.speed)
    side = 1.0 if foot.aside >= 0.0 else -1.0  # the side on which it is: outward is positive
    y, e = abs(foot.aside), side * foot.heading_error
    q = 1.0 - foot.curvature * foot.aside
    bend = tan(view.steering.angle) / p.wheelbase
    surplus = side * (bend - foot.curvature / (q if q > 0.2 else 0.2))

    square = speed * speed
    grip = p.lateral / (square if square > 1e-6 else 1e-6)
    lock = tan(p.angle_limit) / p.wheelbase
    most = (lock if lock < grip else grip) - abs(foot.curvature)
    most = most if most > LEAST else LEAST
    # the wheel has to go from where it is to that of the path, and half as far again to turn back
    swing = atan(p.wheelbase * bend) - atan(p.wheelbase * foot.curvature)
    time = p.lag + abs(swing) / p.rate_limit
    way = speed * time
    turned = e + surplus * way
    turned = turned if turned > 0.0 else 0.0
    turned = turned if turned < 3.0 else 3.0
    drift = e * way + 0.5 * surplus * way * way
    drift = drift if drift > 0.0 else 0.0
    late = drift if drift < way else way
    swerve = (1.0 - cos(turned)) / most
    cause = HEADING if e > 0.5 * turned else STEERING_ANGLE
    cause = POSITION if y > late + swerve else cause
    return Outlook(y + late + swerve, cause)


@kernel
def aside_when_stuck(
    view: View, p: CorridorParameters, curve: CurveTable, tables: NDArray[np.float64]
) -> float:
    """Lateral error (m) at standstill with the steering as it is."""
    motion, speed = view.motion, abs(view.motion.speed)
    way = speed * p.reaction + 0.5 * speed * speed / p.deceleration
    turn = tan(view.steering.angle) / p.wheelbase * way
    sine, cosine = sincos(motion.heading + 0.5 * turn)
    chord = way * (1.0 - turn * turn / 24.0)
    x, y = motion.x + chord * cosine, motion.y + chord * sine
    foot = foot_of(x, y, motion.heading + turn, view.foot.arc_length + way, curve, tables)
    return foot.aside
