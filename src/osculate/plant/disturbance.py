"""What disturbs a run: the paper's d₁ on the yaw errors and d₂ on the speed error (Section 5)."""

from typing import Any, Literal, NamedTuple

from osculate.control.contract import Errors
from osculate.kernel import kernel
from osculate.kernel.maths import sincos
from osculate.plant.contract import Push
from osculate.spec import Spec, quantity
from osculate.vehicle.motion import Motion


class DisturbanceParameters(NamedTuple):
    """Parameters of `disturb`; every number may differ from lane to lane."""

    heading_feedback: float  # 1/s, d₁ on ẏ₁ per y₁
    yaw_rate_feedback: float  # 1/s, d₁ on ẏ₂ per y₂
    heading_amplitude: float  # rad/s, d₁ on ẏ₁: amplitude of sin(frequency t)
    yaw_rate_amplitude: float  # rad/s², d₁ on ẏ₂: amplitude of cos(frequency t)
    frequency: float  # rad/s
    speed_amplitude: float  # m/s², d₂: amplitude of sin t
    speed_feedback: float  # 1/s, d₂ per z
    turns_robot: float  # 1: d₁ on ẏ₁ turns the robot; 0: only the law's heading coordinate


class DisturbanceMemory(NamedTuple):
    """How far the law's heading coordinate has drifted from the robot's heading."""

    heading_drift: float  # rad


@kernel
def perceive(motion: Motion, memory: DisturbanceMemory) -> Motion:
    """The motion as the law sees it."""
    return Motion(
        motion.x,
        motion.y,
        motion.heading + memory.heading_drift,
        motion.speed,
        motion.yaw_rate,
        motion.steering_angle,
    )


@kernel
def disturb(t: float, errors: Errors, p: DisturbanceParameters) -> Any:
    """The push on the robot and the rate of the memory."""
    wave, quarter = sincos(p.frequency * t)
    slow, _ = sincos(t)
    heading = p.heading_feedback * errors.heading + p.heading_amplitude * wave
    push = Push(
        acceleration=p.speed_amplitude * slow + p.speed_feedback * errors.speed,
        yaw_acceleration=p.yaw_rate_feedback * errors.yaw_rate + p.yaw_rate_amplitude * quarter,
        yaw_rate=p.turns_robot * heading,
        aside=0.0,
    )
    return push, DisturbanceMemory((1.0 - p.turns_robot) * heading)


class Disturbance(Spec):
    """d₁ = (f₁ y₁ + a₁ sin ωt, f₂ y₂ + a₂ cos ωt) on Ẏ and d₂ = a sin t + f z on ż, Section 5.

    The paper's d₁ enters the error system; its first component disturbs the law's heading
    coordinate (``acts_on="law"``). ``acts_on="robot"`` turns the robot itself, which no law without
    feedback of the pose can notice. All zero by default.
    """

    kind: Literal["paper"] = "paper"
    heading_feedback: float = quantity("1/s", "d₁ on ẏ₁ per y₁", default=0.0)
    yaw_rate_feedback: float = quantity("1/s", "d₁ on ẏ₂ per y₂", default=0.0)
    heading_amplitude: float = quantity(
        "rad/s", "d₁ on ẏ₁, factor of sin(frequency t)", default=0.0
    )
    yaw_rate_amplitude: float = quantity(
        "rad/s²", "d₁ on ẏ₂, factor of cos(frequency t)", default=0.0
    )
    frequency: float = quantity("rad/s", "frequency of both waves in d₁", default=4.0, ge=0)
    speed_amplitude: float = quantity("m/s²", "d₂ on ż, factor of sin t", default=0.0)
    speed_feedback: float = quantity("1/s", "d₂ on ż per z", default=0.0)
    acts_on: Literal["law", "robot"] = "law"

    @classmethod
    def internal(cls, heading: float, yaw_rate: float, **fields: Any) -> "Disturbance":
        """d₁ = (heading · y₁, yaw_rate · y₂) with the paper's d₂ = 0.1 sin t + 2 z."""
        return cls(
            heading_feedback=heading,
            yaw_rate_feedback=yaw_rate,
            speed_amplitude=0.1,
            speed_feedback=2.0,
            **fields,
        )

    @classmethod
    def external(cls, **fields: Any) -> "Disturbance":
        """d₁₂ = (sin 4t, cos 4t) with the paper's d₂ = 0.1 sin t + 2 z."""
        return cls(
            heading_amplitude=1.0,
            yaw_rate_amplitude=1.0,
            speed_amplitude=0.1,
            speed_feedback=2.0,
            **fields,
        )

    def parameters(self) -> DisturbanceParameters:
        """The numbers for the kernels."""
        return DisturbanceParameters(
            self.heading_feedback,
            self.yaw_rate_feedback,
            self.heading_amplitude,
            self.yaw_rate_amplitude,
            self.frequency,
            self.speed_amplitude,
            self.speed_feedback,
            1.0 if self.acts_on == "robot" else 0.0,
        )
