"""What moves the robot, and how well: steering servo, drive motors, rolling resistance."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import kernel
from osculate.kernel.maths import clip
from osculate.spec import Spec, quantity


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
