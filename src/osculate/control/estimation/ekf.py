"""An extended Kalman filter for pose, motion, and what the robot's description does not say.

The state is (x, y, θ, v, φ, φ̇, b, g, β, c, k, δ): pose of O, speed, the servo's angle and rate, steering
bias, scale of the wheel encoders, gyro bias, rear slip, understeer and swerve. Between two instants the
servo moves exactly, the pose by Simpson's rule. With linear tyres, whose slip angles are proportional to
the lateral acceleration v ω, O moves in the direction θ − c v ω, and with the understeer gradient k

    ω = v tan(φ + b) / (a + k v²) + δ,

where δ is what steering does not explain: it forgets itself within a fraction of a second.

A pose that arrives late is compared with where the robot was when it was taken: the estimate, moved back
by what was driven since. A pose that does not fit is left out, unless several in a row agree with each
other. Every reading passes a gate of its own before it is used (`osculate.control.estimation.gates`), and a
belief that is not finite is never taken: whatever is measured, what is believed stays finite.
"""

import math
from typing import Literal

from osculate.control.contract import Start
from osculate.control.estimation.belief import Belief, EkfParameters, Heard, Place
from osculate.control.estimation.contract import TRUSTED, EstimatorPart
from osculate.control.estimation.filter import estimate_kinematics
from osculate.control.estimation.gates import UNHEARD, GateParameters
from osculate.control.estimation.kinematics import UNITS, ZERO, Covariance, Kinematics
from osculate.control.tracking.contract import Jitter
from osculate.spec import Spec, quantity
from osculate.vehicle.tricycle import Tricycle

SURPRISING = 5.0  # standard deviations, beyond which wheels and gyro lose weight


class Ekf(Spec):
    """The estimator of this package; its noises are standard deviations.

    A standard deviation of 0 for bias, scale, slip or understeer takes that state out: it stays 0.
    """

    kind: Literal["ekf"] = "ekf"
    position_noise: float = quantity("m", "of a measured position, each axis", default=0.01, gt=0)
    heading_noise: float = quantity("rad", "of a measured heading", default=0.0087, gt=0)
    wheel_noise: float = quantity("m/s", "of each wheel's encoder", default=0.007, gt=0)
    wheel_slip: float = quantity(
        "1", "of the drive wheels' slip under traction, part of the speed", default=0.005, ge=0
    )
    tyre_noise: float = quantity(
        "m/s", "of the drive wheels' difference, for tyres that slip", default=0.03, ge=0
    )
    steering_noise: float = quantity("rad", "of the steering encoder", default=0.00175, gt=0)
    gyro_noise: float = quantity("rad/s", "of the gyro", default=0.002, gt=0)
    steering_bias: float = quantity("rad", "of the unknown steering offset", default=0.02, ge=0)
    speed_scale: float = quantity("1", "of the unknown wear of the wheels", default=0.02, ge=0)
    gyro_bias: float = quantity("rad/s", "of the gyro's unknown bias", default=0.01, ge=0)
    slip: float = quantity("rad s²/m", "of the unknown rear slip c", default=0.002, ge=0)
    understeer: float = quantity("rad s²/m", "of the unknown understeer k", default=0.001, ge=0)
    bias_drift: float = quantity(
        "1/s^0.5", "of bias, scale and slip per root second, part of their own deviation",
        default=0.002, ge=0,
    )  # fmt: skip
    pose_drift: float = quantity("m/s^0.5", "of the pose that nothing explains", default=3e-4, ge=0)
    heading_drift: float = quantity("rad/s^0.5", "of the heading", default=5e-5, ge=0)
    acceleration_noise: float = quantity("m/s^1.5", "of the speed", default=0.1, ge=0)
    servo_noise: float = quantity("rad/s^1.5", "of the steering rate", default=0.05, ge=0)
    swerve: float = quantity(
        "rad/s", "of the yaw rate that steering does not explain", default=0.01, ge=0
    )
    swerve_time: float = quantity("s", "in which that forgets itself", default=0.1, gt=0)
    doubt: float = quantity(
        "m/s^0.5",
        "of the pose, when poses surprise twice as much as they should",
        default=1e-3,
        ge=0,
    )
    gate: float = quantity(
        "1", "largest innovation that is believed, in standard deviations", default=5.0, gt=1
    )
    patience: int = quantity(
        "1", "poses in a row that are not believed, before one is", default=3, ge=0
    )
    history: float = quantity("s", "how late a pose may arrive", default=0.06, ge=0, le=1)

    def part(self, robot: Tricycle, start: Start, period: float) -> EstimatorPart:
        """Kernel, parameters and initial belief of a robot that stands about where it is said to."""
        q = self.bias_drift**2 * period
        left = math.exp(-period / self.swerve_time)
        slow = {
            name: getattr(self, name)
            for name in ("steering_bias", "speed_scale", "gyro_bias", "slip", "understeer")
        }
        wander = Kinematics(
            x=self.pose_drift**2 * period,
            y=self.pose_drift**2 * period,
            heading=self.heading_drift**2 * period,
            speed=self.acceleration_noise**2 * period,
            steering_angle=0.0,
            steering_rate=self.servo_noise**2 * period,
            **{name: q * deviation**2 for name, deviation in slow.items()},
            swerve=self.swerve**2 * (1.0 - left**2),
        )
        vague = period * self.doubt**2
        doubt = ZERO._replace(
            x=vague, y=vague, heading=vague / robot.wheelbase**2, speed=vague, swerve=vague
        )
        parameters = EkfParameters(
            half=robot.actuators.servo(0.5 * period),
            wheelbase=robot.wheelbase,
            track=robot.track_width,
            period=period,
            wander=wander,
            doubt=doubt,
            swerve=left,
            speed=0.5 * self.wheel_noise**2,
            wheel_slip=self.wheel_slip,
            per_load=1.0 / max(0.1, 1.0 - robot.centre_ahead / robot.wheelbase),
            difference=2.0 * self.wheel_noise**2 + self.tyre_noise**2,
            steering=self.steering_noise**2,
            gyro=self.gyro_noise**2,
            position=self.position_noise**2,
            heading=self.heading_noise**2,
            gate=self.gate**2,
            surprising=SURPRISING**2,
            patience=float(self.patience),
            gates=self._gates(robot, period),
        )
        return EstimatorPart(estimate_kinematics, parameters, self._belief(robot, start, period))

    def jitter(self, robot: Tricycle, period: float) -> Jitter:
        """By how much the pose changes at a decision because of noise alone: one pose's correction.

        In the steady state of a scalar filter with process variance q and measurement variance r, the
        correction has the standard deviation p / √(p + r), with p = (q + √(q² + 4 q r)) / 2.
        """

        def step(process: float, noise: float) -> float:
            q, r = process**2 * period, noise**2
            p = 0.5 * (q + math.sqrt(q * q + 4.0 * q * r))
            return p / math.sqrt(p + r)

        turning = math.hypot(self.heading_drift, self.swerve * math.sqrt(2.0 * self.swerve_time))
        return Jitter(step(self.pose_drift, self.position_noise), step(turning, self.heading_noise))

    def _gates(self, robot: Tricycle, period: float) -> GateParameters:
        act = robot.actuators
        return GateParameters(
            period=period,
            history=self.history,
            track=robot.track_width,
            wheelbase=robot.wheelbase,
            wheels=0.5,
            part=0.3,
            gyro=0.75,
            steering=0.12 + 5.0 * self.steering_noise,
            turning=0.15 + 5.0 * self.steering_noise,
            lock=act.steering_angle_limit + 0.1 + 5.0 * self.steering_noise,
            swing=1.5 * act.steering_rate_limit * period + 0.03,
        )

    def _belief(self, robot: Tricycle, start: Start, period: float) -> Belief:
        angle = math.atan(robot.wheelbase * start.curvature)
        mean = ZERO._replace(
            x=float(start.x), y=float(start.y), heading=float(start.heading),
            speed=float(start.speed), steering_angle=angle,
        )  # fmt: skip
        deviations = Kinematics(
            self.position_noise, self.position_noise, self.heading_noise, 0.01,
            self.steering_noise, 0.01, self.steering_bias, self.speed_scale, self.gyro_bias,
            self.slip, self.understeer, self.swerve,
        )  # fmt: skip
        rows = (
            Kinematics(*(d * d * entry for entry in unit))
            for d, unit in zip(deviations, UNITS, strict=True)
        )
        instants = math.ceil(self.history / period - 1e-9) + 1
        trail = (Place(0.0, 0.0, 0.0),) * (1 << (instants - 1).bit_length())
        evidence = TRUSTED._replace(located=0.0)
        nowhere = Place(0.0, 0.0, 0.0)
        return Belief(
            mean, Covariance(*rows), trail, evidence, UNHEARD, Heard(0.0, 0.0), 0.0, nowhere, 3.0
        )
