"""The speed loop of every path tracker: feedback linearisation with a robust term.

The reference v_r follows the plan and any caution within the accelerations that the loop may ask for.
What the motors make of it, v_m, is known: delayed and lagged. Only the difference ε = v − v_m is an
error; S = ε + λ ∫ε is driven to zero by one of four switching terms:

    boundary layer    −k sat(S/b)                       integral sliding mode, no chatter
    twisting layer    −k S/√(|S| + b) + w, ẇ = −q S/(|S| + b)
    super-twisting    −k √|S| sgn S + w,    ẇ = −q sgn S
    discontinuous     −k sgn S                          the paper's

The twisting layer is super-twisting for |S| ≫ b and linear for |S| ≪ b, with the slopes k/√b and q/b. (With
√|S| sat(S/b), which has no slope at 0, the integral alone would act there and swing for ever.)

From a standstill the reference takes off no faster than the task's jerk limit and acceleration allow, and
never asks for more than the motors have.
"""

from math import sqrt
from typing import Any, Literal, NamedTuple

from osculate.kernel import kernel
from osculate.kernel.maths import clip, sign
from osculate.spec import Spec, quantity
from osculate.target.speed import Limits
from osculate.vehicle.tricycle import Tricycle


class SpeedParameters(NamedTuple):
    """Parameters of the speed loop."""

    proportional: float  # 1/s
    sliding: float  # 1/s, λ
    gain: float  # k
    integral: float  # q
    layer: float  # m/s, b
    lag: float  # part of the way to the delayed reference in one period
    ahead: float  # s, from a decision to its effect, motors included
    acceleration: float  # m/s²
    deceleration: float  # m/s²
    jerk: float  # m/s³, of the reference when it rises
    torque_limit: float  # N m, both wheels
    rolling: float  # N m, torque against rolling resistance


class SpeedMemory(NamedTuple):
    """Memory of the speed loop."""

    reference: float  # m/s, v_r
    model: float  # m/s, v_m
    integral: float  # m, ∫ε
    twist: float  # m/s², w
    acceleration: float  # m/s², of the reference


@kernel
def switch_layer(s: float, twist: float, p: SpeedParameters) -> Any:
    """Integral sliding mode in a boundary layer."""
    return -p.gain * clip(s / p.layer, -1.0, 1.0), 0.0


@kernel
def switch_twisting_layer(s: float, twist: float, p: SpeedParameters) -> Any:
    """Super-twisting far from S = 0, linear near it."""
    size = abs(s) + p.layer
    return -p.gain * s / sqrt(size) + twist, -p.integral * s / size


@kernel
def switch_twisting(s: float, twist: float, p: SpeedParameters) -> Any:
    """Super-twisting."""
    return -p.gain * sqrt(abs(s)) * sign(s) + twist, -p.integral * sign(s)


@kernel
def switch_discontinuous(s: float, twist: float, p: SpeedParameters) -> Any:
    """The paper's switching term."""
    return -p.gain * sign(s), 0.0


SWITCHES = {
    "boundary-layer": switch_layer,
    "twisting-layer": switch_twisting_layer,
    "super-twisting": switch_twisting,
    "discontinuous": switch_discontinuous,
}


def effect_time(robot: Tricycle, period: float, delay: int) -> float:
    """Time (s) from a decision to its effect: the delay, the motors' lag and half of the hold."""
    return delay * period + robot.actuators.motor_lag + 0.5 * period


class SpeedLoop(Spec):
    """Robust speed control by torque."""

    switching: Literal["boundary-layer", "twisting-layer", "super-twisting", "discontinuous"] = (
        "twisting-layer"
    )
    proportional: float = quantity("1/s", "feedback of the speed error", default=4.0, ge=0)
    sliding: float = quantity("1/s", "λ of S = ε + λ ∫ε", default=4.0, ge=0)
    gain: float = quantity("m/s²", "size of the switching term, k", default=1.5, ge=0)
    integral: float = quantity("m/s³", "rate of the twisting term, q", default=0.3, ge=0)
    layer: float = quantity("m/s", "half width of the boundary layer, b", default=0.2, gt=0)
    acceleration: float = quantity(
        "m/s²", "largest rise of the reference, if task and motors allow it", default=1.5, gt=0
    )
    deceleration: float = quantity("m/s²", "largest fall of the reference", default=2.0, gt=0)

    def switch(self) -> Any:
        """The kernel of the switching term."""
        return SWITCHES[self.switching]

    def parameters(
        self, robot: Tricycle, limits: Limits, period: float, delay: int
    ) -> SpeedParameters:
        """The numbers for the kernels."""
        act = robot.actuators
        rolling = act.rolling_resistance * robot.weight * robot.wheel_radius
        spare = (2.0 * act.torque_limit - rolling) / (robot.wheel_radius * robot.total_mass)
        rise = min(self.acceleration, limits.acceleration, limits.torque * spare)
        return SpeedParameters(
            proportional=self.proportional,
            sliding=self.sliding,
            gain=self.gain,
            integral=self.integral,
            layer=self.layer,
            lag=period / (act.motor_lag + period),
            ahead=effect_time(robot, period, delay),
            acceleration=max(rise, 1e-3),
            deceleration=self.deceleration,
            jerk=limits.jerk,
            torque_limit=2.0 * act.torque_limit,
            rolling=rolling,
        )
