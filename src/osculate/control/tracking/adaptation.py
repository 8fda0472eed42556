"""Learning from exact poses how a robot differs from one that rolls without slip.

O moves in the direction θ − c a_y with the lateral acceleration a_y = v ω, and the steered wheel acts
like one at the angle φ + b − k a_y. The three numbers follow normalised least mean squares (Widrow & Hoff
1960) from two consecutive poses. Behind an estimator, which knows slip and offset, nothing is learned.
"""

from typing import Any, NamedTuple

from osculate.control.tracking.contract import Foot, View
from osculate.kernel import Nothing, kernel
from osculate.kernel.maths import atan, clip, sincos, wrap_angle
from osculate.vehicle.actuators import Steering
from osculate.vehicle.motion import Motion

SLOWEST = 0.1  # m/s, below which nothing is learned
LARGEST_SLIP = 0.05  # rad s²/m
LARGEST_OFFSET = 0.2  # rad


class AdaptationParameters(NamedTuple):
    """Parameters of `adapt`."""

    period: float  # s
    wheelbase: float  # m
    rate: float  # part of an error that one instant makes good


class Habits(NamedTuple):
    """Memory of `adapt`: what was learned, and the last pose."""

    slip: float  # rad s²/m, c
    offset: float  # rad, b
    understeer: float  # rad s²/m, k
    x: float  # m
    y: float  # m
    heading: float  # rad
    yaw_rate: float  # rad/s
    steering: Steering  # then
    known: float  # 1 once there is a last pose


#: Nothing is known yet.
STRANGER = Habits(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, Steering(0.0, 0.0), 0.0)


class Twin(NamedTuple):
    """A view of the twin that rolls without slip."""

    seen: View
    shift: float  # rad, the twin's steering angle minus the robot's
    lead: float  # s, by which the direction of motion lags behind the yaw rate
    slip: float  # rad s²/m


@kernel
def adapt_nothing(view: View, now: Nothing, p: Nothing) -> Any:
    """The view as it is."""
    return Twin(view, 0.0, 0.0, 0.0), now


@kernel
def learn_habits(view: View, now: Habits, p: AdaptationParameters) -> Habits:
    """One step of least mean squares."""
    m = view.motion
    t = (
        p.period / 12.0
    )  # means over a period by the trapezoidal rule, corrected by the slopes at its ends
    turned = wrap_angle(m.heading - now.heading)
    sine, cosine = sincos(now.heading + 0.5 * turned - t * (m.yaw_rate - now.yaw_rate))
    last, newest = now.steering, view.steering
    angle = 0.5 * (last.angle + newest.angle) - t * (newest.rate - last.rate)
    dx, dy = m.x - now.x, m.y - now.y
    along, aside = dx * cosine + dy * sine, dy * cosine - dx * sine
    speed = along / p.period
    moving = now.known > 0.0 and speed > SLOWEST
    way = along if moving else 1.0
    bend = turned / way if moving else 0.0
    pull = speed * speed * bend  # lateral acceleration
    rate = p.rate / (1.0 + pull * pull) if moving else 0.0
    drift = aside / way + now.slip * pull
    miss = atan(p.wheelbase * bend) - angle - now.offset + now.understeer * pull
    return Habits(
        clip(now.slip - rate * drift * pull, -LARGEST_SLIP, LARGEST_SLIP),
        clip(now.offset + rate * miss, -LARGEST_OFFSET, LARGEST_OFFSET),
        clip(now.understeer - rate * miss * pull, -LARGEST_SLIP, LARGEST_SLIP),
        m.x,
        m.y,
        m.heading,
        m.yaw_rate,
        newest,
        1.0,
    )


@kernel
def adapt(view: View, now: Habits, p: AdaptationParameters) -> Any:
    """The twin's view, and what is known after this instant."""
    habits = learn_habits(view, now, p)
    m, foot = view.motion, view.foot
    pull = m.speed * m.yaw_rate
    tilt = habits.slip * pull
    shift = habits.offset - habits.understeer * pull
    motion = Motion(m.x, m.y, m.heading - tilt, m.speed, m.yaw_rate, m.steering_angle + shift)
    seen = Foot(
        foot.arc_length, foot.aside, foot.heading_error - tilt, foot.curvature, foot.curvature_rate
    )
    steering = Steering(view.steering.angle + shift, view.steering.rate)
    twin = View(motion, seen, steering, view.acceleration, view.pending, view.bias, view.stretch)
    return Twin(twin, shift, habits.slip * m.speed, habits.slip), habits
