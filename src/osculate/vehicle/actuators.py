"""What moves the robot, and how well: steering servo, drive motors, rolling resistance."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import kernel
from osculate.kernel.maths import clip
from osculate.spec import Spec, quantity
from osculate.vehicle.motion import Command


class Actuators(Spec):
    """Steering servo (second order with limits), two drive motors, and what resists rolling."""

    steering_frequency: float = quantity(
        "rad/s", "natural frequency of the steering servo", default=20.0, gt=0
    )
    steering_damping: float = quantity("1", "its damping ratio", default=0.8, gt=0)
    steering_rate_limit: float = quantity("rad/s", "largest steering rate", default=3.0, gt=0)
    steering_angle_limit: float = quantity(
        "rad", "largest steering angle", default=1.2217304763960306, gt=0, lt=1.57
    )
    motor_lag: float = quantity("s", "time constant of the drive torques", default=0.02, gt=0)
    torque_limit: float = quantity("N m", "largest torque of each drive wheel", default=5.0, gt=0)
    power_limit: float | None = quantity(
        "W", "largest power of both drives together; by default no limit", default=None, gt=0
    )
    rolling_resistance: float = quantity(
        "1", "force that resists rolling, per weight", default=0.01, ge=0
    )

    def servo(self, step: float) -> "ServoStep":
        """How the servo moves in ``step`` seconds towards a constant command."""
        e11, e12, e21, e22 = (float(entry) for entry in self.transition(step).ravel())
        return ServoStep(e11, e12, e21, e22, self.steering_rate_limit, step)

    def parameters(self, servo: float = 1.0) -> "ActuatorParameters":
        """The numbers for `actuator_rates`; ``servo`` scales the servo's natural frequency."""
        frequency = self.steering_frequency * servo
        return ActuatorParameters(
            frequency=frequency,
            damping=2.0 * self.steering_damping * frequency,
            rate_limit=self.steering_rate_limit,
            angle_limit=self.steering_angle_limit,
            motor_rate=1.0 / self.motor_lag,
            torque_limit=self.torque_limit,
        )

    def transition(self, step: float) -> NDArray[np.float64]:
        """e^{A step}, shape (2, 2), of (angle − command, rate)."""
        from scipy.linalg import expm

        w, damping = self.steering_frequency, self.steering_damping
        matrix: NDArray[np.float64] = expm(
            np.array([[0.0, 1.0], [-(w**2), -2.0 * damping * w]]) * step
        )
        return matrix

    def deadbeat(self, horizon: float) -> tuple[float, float, float, float]:
        """Gains of the servo's inverse: which command leads to a wanted angle and rate.

        Two commands, each held for ``horizon`` seconds, bring the servo from any angle and rate to any
        other. The first of them is g₀ φ* + g₁ φ̇* + g₂ φ + g₃ φ̇ with φ*, φ̇* wanted after two horizons.

        Returns:
            (g₀, g₁, g₂, g₃).
        """
        move = self.transition(horizon)
        drive = (np.eye(2) - move) @ np.array([1.0, 0.0])
        first = np.linalg.inv(np.stack([move @ drive, drive], axis=1))[0]
        now = -first @ move @ move
        return float(first[0]), float(first[1]), float(now[0]), float(now[1])


class Steering(NamedTuple):
    """State of a steering servo."""

    angle: float  # rad
    rate: float  # rad/s


class ServoStep(NamedTuple):
    """Parameters of `servo_move`: e^{A step} by rows, and the rate limit."""

    e11: float
    e12: float  # s
    e21: float  # 1/s
    e22: float
    rate_limit: float  # rad/s
    step: float  # s


@kernel
def servo_move(now: Steering, command: float, p: ServoStep) -> Steering:
    """The servo one step later, exact for a constant command unless its rate is limited."""
    away = now.angle - command
    moved = command + p.e11 * away + p.e12 * now.rate - now.angle
    reach = p.rate_limit * p.step
    rate = p.e21 * away + p.e22 * now.rate
    return Steering(now.angle + clip(moved, -reach, reach), clip(rate, -p.rate_limit, p.rate_limit))


class ActuatorState(NamedTuple):
    """State of the servo and of the two motors."""

    steering_angle: float  # rad, as the servo sees it
    steering_rate: float  # rad/s
    torque_left: float  # N m
    torque_right: float  # N m


class ActuatorParameters(NamedTuple):
    """Parameters of `actuator_rates`."""

    frequency: float  # rad/s, natural frequency of the servo
    damping: float  # 2 ζ ω, 1/s
    rate_limit: float  # rad/s
    angle_limit: float  # rad
    motor_rate: float  # 1/s
    torque_limit: float  # N m, each wheel


@kernel
def actuator_rates(state: ActuatorState, command: Command, p: ActuatorParameters) -> ActuatorState:
    """A servo of second order whose rate is limited, and motors that lag."""
    wanted = clip(command.steering_angle, -p.angle_limit, p.angle_limit)
    pull = (
        p.frequency * p.frequency * (wanted - state.steering_angle)
        - p.damping * state.steering_rate
    )
    outward = pull * state.steering_rate > 0.0 and abs(state.steering_rate) >= p.rate_limit
    left = clip(command.torque_left, -p.torque_limit, p.torque_limit)
    right = clip(command.torque_right, -p.torque_limit, p.torque_limit)
    return ActuatorState(
        steering_angle=clip(state.steering_rate, -p.rate_limit, p.rate_limit),
        steering_rate=0.0 if outward else pull,
        torque_left=(left - state.torque_left) * p.motor_rate,
        torque_right=(right - state.torque_right) * p.motor_rate,
    )
