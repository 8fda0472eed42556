"""The speed loop of every path tracker: feedback linearisation with a robust term.

The reference v_r follows the plan and any caution within the accelerations that the loop may ask for.
What the motors make of it, v_m, is known: delayed and lagged. Only the difference ε = v − v_m is an
error; S = ε + λ ∫ε is driven to zero by one of four switching terms:

    boundary layer    −k sat(S/b)                       integral sliding mode, no chatter
    twisting layer    −k √|S| sat(S/b) + w, ẇ = −q sat(S/b)
    super-twisting    −k √|S| sgn S + w,    ẇ = −q sgn S
    discontinuous     −k sgn S                          the paper's
"""

from math import sqrt
from typing import Any, Literal, NamedTuple

from osculate.kernel import kernel
from osculate.kernel.maths import clip, sign
from osculate.spec import Spec, quantity
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
    torque_limit: float  # N m, both wheels
    rolling: float  # N m, torque against rolling resistance


class SpeedMemory(NamedTuple):
    """Memory of the speed loop."""

    reference: float  # m/s, v_r
    model: float  # m/s, v_m
    integral: float  # m, ∫ε
    twist: float  # m/s², w


@kernel
def switch_layer(s: float, twist: float, p: SpeedParameters) -> Any:
    """Integral sliding mode in a boundary layer."""
    return -p.gain * clip(s / p.layer, -1.0, 1.0), 0.0


@kernel
def switch_twisting_layer(s: float, twist: float, p: SpeedParameters) -> Any:
    """Super-twisting in a boundary layer."""
    side = clip(s / p.layer, -1.0, 1.0)
    return -p.gain * sqrt(abs(s)) * side + twist, -p.integral * side


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


class SpeedLoop(Spec):
    """Robust speed control by torque."""

    switching: Literal["boundary-layer", "twisting-layer", "super-twisting", "discontinuous"] = (
        "twisting-layer"
    )
    proportional: float = quantity("1/s", "feedback of the speed error", default=4.0, ge=0)
    sliding: float = quantity("1/s", "λ of S = ε + λ ∫ε", default=4.0, ge=0)
    gain: float = quantity("m/s²", "size of the switching term, k", default=1.5, ge=0)
    integral: float = quantity("m/s³", "rate of the twisting term, q", default=2.0, ge=0)
    layer: float = quantity("m/s", "half width of the boundary layer, b", default=0.05, gt=0)
    acceleration: float = quantity("m/s²", "largest rise of the reference", default=1.5, gt=0)
    deceleration: float = quantity("m/s²", "largest fall of the reference", default=2.0, gt=0)

    def switch(self) -> Any:
        """The kernel of the switching term."""
        return SWITCHES[self.switching]

    def parameters(self, robot: Tricycle, period: float, delay: int) -> SpeedParameters:
        """The numbers for the kernels."""
        act = robot.actuators
        return SpeedParameters(
            proportional=self.proportional,
            sliding=self.sliding,
            gain=self.gain,
            integral=self.integral,
            layer=self.layer,
            lag=period / (act.motor_lag + period),
            ahead=delay * period + act.motor_lag + 0.5 * period,
            acceleration=self.acceleration,
            deceleration=self.deceleration,
            torque_limit=2.0 * act.torque_limit,
            rolling=act.rolling_resistance * robot.weight * robot.wheel_radius,
        )
