"""A safety layer around any path tracker: it watches what is measured and guards what is decided.

Between the steering law and the actuators it limits lateral acceleration, slows down before the steering
cannot follow, and stops the robot while it still can: before it leaves its corridor, when measurements
fail, when the steering does not obey. A stop is final. Every intervention has its reason.

It is not a certified protective function (ISO 3691-4, ISO 13849): scanner, bumper and safety PLC stay.
"""

import math
from typing import Literal

from osculate.control.reasons import CAUSES, REASONS, explain
from osculate.control.safety.corridor import CorridorParameters
from osculate.control.safety.guard import (
    GuardMemory,
    SafetyParameters,
    guard_command,
    watch_motion,
)
from osculate.control.safety.obedience import ObedienceMemory, ObedienceParameters
from osculate.control.safety.reserve import StuckSteering, foresee_stuck_steering
from osculate.control.safety.watch import SETTLING, UNSEEN, WatchParameters
from osculate.control.tracking.contract import GuardPart, Road, stop_deceleration
from osculate.curve.contract import Curve
from osculate.spec import Spec, quantity
from osculate.target.speed import Ceiling, Limits
from osculate.vehicle.actuators import Steering
from osculate.vehicle.motion import Motion
from osculate.vehicle.tricycle import Tricycle

__all__ = ["CAUSES", "REASONS", "Safety", "explain", "foresee"]

SERVO_NOISE = 5e-3  # rad, that a standing servo's encoder seems to move
STUCK = 0.1  # s, for which a servo may not move: longer than a delay that nobody knows


class Safety(Spec):
    """What the safety layer allows."""

    kind: Literal["safety"] = "safety"
    half_width: float = quantity(
        "m", "distance from the curve that O may never exceed", default=0.3, gt=0
    )
    reserve: Literal["stuck-steering"] | None = None
    deceleration: float = quantity(
        "m/s²", "of a stop; no more than brake, motors and floor can do", default=4.0, gt=0
    )
    friction: float = quantity("1", "of tyres on the floor, at least", default=0.8, gt=0)
    lateral_acceleration: float | None = quantity(
        "m/s²", "largest; by default what neither tips nor slides", default=None, gt=0
    )
    patience: float = quantity("s", "for which measurements may fail", default=0.3, gt=0)
    jump: float = quantity(
        "m", "that no robot makes from one instant to the next", default=0.1, gt=0
    )
    heading_jump: float = quantity("rad", "likewise of the heading", default=0.1, gt=0)
    disobedience: float = quantity(
        "rad", "that a steering has to be told to move before it counts as stuck", default=0.03,
        gt=0.01,
    )  # fmt: skip

    def stop_deceleration(self, robot: Tricycle) -> float:
        """Deceleration (m/s²) of a stop."""
        grip = 0.8 * 0.9 * self.friction * robot.gravity
        return min(self.deceleration, stop_deceleration(robot), grip)

    def foresee(
        self, curve: Curve, robot: Tricycle, limits: Limits, period: float, delay: int
    ) -> StuckSteering:
        """What becomes of a robot whose steering gets stuck, anywhere on a curve.

        Args:
            curve: Where it drives.
            robot: What drives.
            limits: Its task; the speed matters.
            period: Time between two decisions (s).
            delay: Periods from a decision to its effect.
        """
        return foresee_stuck_steering(
            curve,
            wheelbase=robot.wheelbase,
            half_width=self.half_width,
            reaction=STUCK + 2.0 * period + self._reaction(robot, period, delay),
            deceleration=self.stop_deceleration(robot),
            disobedience=self.disobedience + SERVO_NOISE,
            fastest=limits.speed,
        )

    def part(self, road: Road, motion: Motion) -> GuardPart:
        """Kernels, parameters, and the memory of a robot that moves as said."""
        robot, act, period = road.robot, road.robot.actuators, road.period
        grip = 0.9 * self.friction * robot.gravity
        lateral = min(grip, 0.9 * robot.tipping_acceleration, self.lateral_acceleration or math.inf)
        servo = act.servo(period)
        stop = self.stop_deceleration(robot)
        watch = WatchParameters(
            wheelbase=robot.wheelbase,
            period=period,
            patience=self.patience,
            position=self.jump,
            heading=self.heading_jump,
            speed=0.5,
            yaw_rate=1.0,
            steering=0.15 + 2.0 * act.steering_rate_limit * period,
            blend=period / (SETTLING + period),
        )
        corridor = CorridorParameters(
            half_width=self.half_width,
            wheelbase=robot.wheelbase,
            angle_limit=act.steering_angle_limit,
            rate_limit=act.steering_rate_limit,
            lag=(road.delay + 1.0) * period + 2.0 * act.steering_damping / act.steering_frequency,
            lateral=lateral,
            reaction=self._reaction(robot, period, road.delay),
            deceleration=stop,
        )
        obedience = ObedienceParameters(servo, period, SERVO_NOISE, self.disobedience, STUCK)
        parameters = SafetyParameters(watch, obedience, corridor, float(road.delay > 0))
        standing = Steering(motion.steering_angle, 0.0)
        memory = GuardMemory(UNSEEN, ObedienceMemory(motion.steering_angle, standing, 0.0), 0.0)
        return GuardPart(watch_motion, guard_command, parameters, memory, self.patience, stop)

    def _reaction(self, robot: Tricycle, period: float, delay: int) -> float:
        """Time (s) from a decision to the beginning of its braking."""
        lag = 0.0 if robot.brake else robot.actuators.motor_lag
        return (delay + 1.0) * period + lag


def foresee(
    safety: Safety | None, curve: Curve, robot: Tricycle, limits: Limits, period: float, delay: int
) -> tuple[StuckSteering | None, Ceiling | None]:
    """What a safety layer foresees (`Safety.foresee`), and the limit that adds to the speed plan."""
    if safety is None:
        return None, None
    foreseen = safety.foresee(curve, robot, limits, period, delay)
    return foreseen, foreseen.ceiling if safety.reserve else None
