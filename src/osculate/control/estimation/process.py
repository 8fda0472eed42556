"""The process model: how the state moves in one period, and the slopes of that map.

The servo moves exactly, the pose by Simpson's rule, with ω = v tan(φ + b) / (a + k v²) + δ.
"""

from typing import Any

from osculate.control.estimation.belief import EkfParameters
from osculate.control.estimation.contract import Told
from osculate.control.estimation.kinematics import Kinematics, Slopes
from osculate.control.tracking.pipe import PipeParameters, Pose, roll
from osculate.kernel import kernel
from osculate.kernel.maths import sincos, tan
from osculate.vehicle.actuators import Steering


@kernel
def yaw(m: Kinematics, p: EkfParameters) -> Any:
    """Yaw rate ω without δ, and its slopes along φ (and b), v and k."""
    tangent = tan(m.steering_angle + m.steering_bias)
    base = effective_base(m, p)
    rate = m.speed * tangent / base
    per_angle = m.speed * (1.0 + tangent * tangent) / base
    per_speed = tangent * (2.0 * p.wheelbase - base) / (base * base)
    return rate, per_angle, per_speed, -rate * m.speed * m.speed / base


@kernel
def effective_base(m: Kinematics, p: EkfParameters) -> float:
    """Wheelbase (m) of the twin that steers as the robot does: a + k v²."""
    base = p.wheelbase + m.understeer * m.speed * m.speed
    least = 0.5 * p.wheelbase
    return base if base > least else least


@kernel
def step_forward(m: Kinematics, told: Told, p: EkfParameters) -> Any:
    """The state one period later, and the slopes of that map."""
    rate, _, _, _ = yaw(m, p)
    course = m.heading - m.slip * m.speed * (rate + m.swerve)
    base = effective_base(m, p)
    pipe = PipeParameters(p.half, base, p.period, 0.0)
    begin = Pose(
        m.x, m.y, course, m.speed, Steering(m.steering_angle + m.steering_bias, m.steering_rate)
    )
    end = roll(begin, told.steering_angle + m.steering_bias, told.acceleration, pipe)
    angle = end.steering.angle - m.steering_bias
    after = Kinematics(
        end.x, end.y, m.heading + (end.heading - course) + p.period * m.swerve, end.speed, angle,
        end.steering.rate, m.steering_bias, m.speed_scale, m.gyro_bias, m.slip, m.understeer,
        p.swerve * m.swerve,
    )  # fmt: skip
    middle = Kinematics(
        0.0, 0.0, 0.0, 0.5 * (m.speed + end.speed), 0.5 * (m.steering_angle + angle), 0.0,
        m.steering_bias, 0.0, 0.0, 0.0, m.understeer, 0.0,
    )  # fmt: skip
    omega, per_angle, per_speed, per_understeer = yaw(middle, p)
    sine, cosine = sincos(0.5 * (course + end.heading))
    t = p.period
    way = t * middle.speed
    h = p.half
    slopes = Slopes(
        x_heading=-way * sine,
        x_speed=t * cosine,
        x_slip=way * middle.speed * omega * sine,
        y_heading=way * cosine,
        y_speed=t * sine,
        y_slip=-way * middle.speed * omega * cosine,
        turn=t * per_angle,
        turn_rate=0.5 * t * t * per_angle,
        turn_speed=t * per_speed,
        turn_understeer=t * per_understeer,
        turn_swerve=t,
        swerve=p.swerve,
        e11=h.e11 * h.e11 + h.e12 * h.e21,
        e12=h.e11 * h.e12 + h.e12 * h.e22,
        e21=h.e21 * h.e11 + h.e22 * h.e21,
        e22=h.e21 * h.e12 + h.e22 * h.e22,
    )
    return after, slopes
