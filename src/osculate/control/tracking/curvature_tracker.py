"""Curvature tracking with the pose loop closed, by exact linearisation in arc length.

In the path frame (lateral error y, heading error e, q = 1 − κ y, ' = d/ds):

    y' = q tan e
    f(y) = (y/L) / √(1 + (y / (L tan α))²)                approach no steeper than α
    σ = y' + f(y),   demand σ' = −σ/L
    u = −f'(y) y' − σ/L                                    the y'' that does it
    e' = (cos² e / q) [u + κ' y tan e + κ q tan² e]
    φ_d = atan(a (cos e / q) (κ + e'))

This is geometric: the paths that the robot takes back to the curve do not depend on its speed, and nothing
is divided by κ. φ_d, its rate and its acceleration are taken along the ideal motion from the pose at which
the decision will act (`look_ahead`), in the middle of the period for which it is held. Its inverse is

    φ_c = φ_d + (2ζ/ω) φ̇_d + φ̈_d/ω² + g (φ − φ_d) + g' (φ̇ − φ̇_d)

with the gains (`Actuators.deadbeat`) that bring the servo from any deviation to φ_d within two horizons h.
What is wanted is inverted exactly whatever h is; h only says how hard deviations, and with them noise, are
answered (`inversion_horizon`).
"""

import math
from math import sqrt
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np

from osculate.control.tracking.adaptation import (
    STRANGER,
    AdaptationParameters,
    adapt,
    adapt_nothing,
)
from osculate.control.tracking.contract import PathTracker, Road, SteerPart
from osculate.control.tracking.pipe import PipeParameters
from osculate.kernel import Nothing, compose, kernel
from osculate.kernel.maths import clip, sincos
from osculate.spec import quantity

STEEPEST = 1.2  # rad, heading errors beyond are treated as this one
LEAST = 0.2  # q is kept above this
WINDOW = 0.8  # of the servo's time 1/ω, over which the path's angle is differentiated
RETURN = 0.2  # likewise the angle that leads back to the path
STIFFNESS = 0.6  # of the servo's time 1/ω, the shortest horizon
LONGEST = 4  # quarters of the shortest horizon, by which it may be stretched
CALM = math.radians(0.7)  # rad, change of a command from one decision to the next because of noise


class Frame(NamedTuple):
    """A pose in the path frame, on its way along the ideal motion."""

    arc_length: float  # m
    aside: float  # m, y
    heading_error: float  # rad, e


class Wish(NamedTuple):
    """What the law wants at one place."""

    steering_angle: float  # rad, φ_d
    aside_rate: float  # dy/ds
    turn: float  # 1/m, de/ds
    pace: float  # ds per distance driven, cos e / q


class Motive(NamedTuple):
    """A steering angle that changes."""

    angle: float  # rad
    rate: float  # rad/s
    acceleration: float  # rad/s²


class ExactParameters(NamedTuple):
    """Parameters of `steer_exactly`."""

    pipe: PipeParameters
    wheelbase: float  # m
    half_period: float  # s
    window: float  # s, over which the path's angle is differentiated
    return_window: float  # s, over which the rest of φ_d is
    damping_time: float  # s, 2ζ/ω
    inertia_time: float  # s², 1/ω²
    angle_feedback: float  # of φ − φ_d
    rate_feedback: float  # s, of their rates
    shortest: float  # m, smallest L
    time: float  # s, L per speed
    slope: float  # tan α
    lateral: float  # m/s², largest lateral acceleration that the law may cause
    steering_rate: float  # rad/s, largest that it may ask for
    heading_gain: float  # of the linear law: 1/m
    aside_gain: float  # of the linear law: 1/m²
    adaptation: Any  # parameters of what is learned


@kernel
def demand_exactly(
    y: float, sine: float, cosine: float, q: float, k: float, dk: float, length: float,
    p: ExactParameters,
) -> float:  # fmt: skip
    """Turn of the heading error, e' (1/m), by exact linearisation."""
    tangent = sine / cosine
    rate = q * tangent
    steep = y / (length * p.slope)
    root = sqrt(1.0 + steep * steep)
    approach = y / (length * root)
    approach_rate = 1.0 / (length * root * root * root)
    u = -approach_rate * rate - (rate + approach) / length
    return cosine * cosine / q * (u + dk * y * tangent + k * q * tangent * tangent)


@kernel
def demand_linearly(
    y: float, sine: float, cosine: float, q: float, k: float, dk: float, length: float,
    p: ExactParameters,
) -> float:  # fmt: skip
    """Turn of the heading error, e' (1/m), by linear state feedback of (y, e).

    Far off, y counts as the one at which the path is approached at the angle α: a larger one would turn
    the robot beyond the path's normal, into circles.
    """
    widest = p.heading_gain * p.slope / (p.aside_gain * sqrt(1.0 + p.slope * p.slope))
    return -p.aside_gain * clip(y, -widest, widest) - p.heading_gain * sine


@kernel
def clamp_error(e: float) -> Any:
    """Sine and cosine of the heading error, kept away from the path's normal."""
    return sincos(clip(e, -STEEPEST, STEEPEST))


class CurvatureTracker(PathTracker):
    """The tracker of this package: exact linearisation in arc length through the servo's inverse.

    Its one user-facing number is ``tightness``: 1 recovers from an error over a distance that suits
    actuators and delay, larger values recover faster and react more to noise.
    """

    kind: Literal["curvature-tracker"] = "curvature-tracker"
    tunable: ClassVar[dict[str, tuple[float, float]]] = {"tightness": (0.15, 1.5)}
    tightness: float = quantity("1", "how tightly the curve is held", default=1.0, gt=0.05, le=2)
    approach_angle: float = quantity(
        "rad", "steepest angle at which the path is approached", default=0.7853981633974483,
        gt=0.1, lt=1.4,
    )  # fmt: skip
    lateral_acceleration: float = quantity(
        "m/s²", "largest lateral acceleration, corrections included", default=3.0, gt=0
    )
    horizon: float | None = quantity(
        "s", "h, half of the time in which the servo makes good a deviation; by default from servo, "
        "delay and noise", default=None, gt=0,
    )  # fmt: skip
    learning: float = quantity(
        "s", "time in which slip and steering offset are learned from exact poses; 0: never",
        default=0.2, ge=0,
    )  # fmt: skip

    def steering_part(self, road: Road) -> SteerPart:
        """See `PathTracker.steering_part`."""
        return exact_part(
            road, demand_exactly, horizon=self.horizon, tightness=self.tightness,
            approach_angle=self.approach_angle, lateral=self.lateral_acceleration,
            learning=0.0 if road.jitter else self.learning,
        )  # fmt: skip


def inversion_horizon(road: Road, length: float) -> float:
    """H (s): the shortest whose commands do not tremble; it is a matter of servo, delay and noise.

    A pose that is believed to jump by (δy, δe) changes the wanted angle by about δφ = a (δy/L² + 2 δe/L)
    and the command by (1 + |g|) δφ, where g, the gain of the servo's inverse, falls with ω h. A longer
    horizon makes good deviations later: the first whose command changes by no more than `CALM` is taken.

    Args:
        road: Robot, timing and jitter of the believed pose; without jitter the stiffest is taken.
        length: L (m), over which the law recovers.
    """
    act = road.robot.actuators
    shortest = max(STIFFNESS / act.steering_frequency, road.period)
    if road.jitter is None:
        return shortest
    across, turned = road.jitter.position / length**2, 2.0 * road.jitter.heading / length
    wanted = road.robot.wheelbase * math.hypot(across, turned)
    for stretch in range(LONGEST):
        horizon = shortest * (1.0 + 0.25 * stretch)
        if (1.0 + abs(act.deadbeat(horizon)[2])) * wanted <= CALM:
            break
    return horizon


def exact_part(
    road: Road,
    demand: Any,
    *,
    horizon: float | None,
    lateral: float,
    tightness: float = 1.0,
    approach_angle: float = math.pi / 4.0,
    linear: tuple[float, float] = (0.0, 0.0),
    learning: float = 0.0,
) -> SteerPart:
    """The steering law with one of the two demands.

    Args:
        road: What it is made for.
        demand: Kernel of the demand.
        horizon: h, half of the servo's inversion (s); None chooses it.
        lateral: Largest lateral acceleration that the law may cause (m/s²).
        tightness: See `CurvatureTracker`; a linear demand uses it for its caution only.
        approach_angle: Steepest approach (rad), of the exact demand.
        linear: Gains of y (1/m²) and e (1/m), of the linear demand.
        learning: Time in which slip and offset are learned (s); 0 learns nothing.
    """
    robot, act = road.robot, road.robot.actuators
    shortest = 0.4 * robot.wheelbase / tightness
    horizon = horizon or inversion_horizon(road, shortest)
    _, _, angle_feedback, rate_feedback = act.deadbeat(max(horizon, road.period))
    lag = 2.0 * act.steering_damping / act.steering_frequency + (road.delay + 0.5) * road.period
    tipping = 0.9 * robot.tipping_acceleration
    parameters = ExactParameters(
        PipeParameters(
            act.servo(0.5 * road.period), robot.wheelbase, road.period, float(road.delay)
        ),
        robot.wheelbase,
        0.5 * road.period,
        max(WINDOW / act.steering_frequency, 2.0 * road.period),
        max(RETURN / act.steering_frequency, road.period),
        2.0 * act.steering_damping / act.steering_frequency,
        act.steering_frequency**-2,
        angle_feedback,
        rate_feedback,
        shortest=shortest,
        time=0.8 * lag / tightness,
        slope=float(np.tan(approach_angle)),
        lateral=min(lateral, tipping),
        steering_rate=0.85 * act.steering_rate_limit,
        aside_gain=linear[0],
        heading_gain=linear[1],
        adaptation=Nothing(),
    )
    template = "osculate.control.templates.exact_steering"
    if learning == 0.0:
        steer = compose(template, {"demand": demand, "adapt": adapt_nothing}).steer_exactly
        return SteerPart(steer, parameters, Nothing())
    rate = road.period / (learning + road.period)
    adaptation = AdaptationParameters(road.period, robot.wheelbase, rate)
    steer = compose(template, {"demand": demand, "adapt": adapt}).steer_exactly
    return SteerPart(steer, parameters._replace(adaptation=adaptation), STRANGER)
