"""A safety layer around any path tracker: it watches what is measured and guards what is decided.

Between the steering law and the actuators it limits lateral acceleration, slows down before the steering
cannot follow, and stops the robot while it still can: before it leaves its corridor, when measurements
fail, when the steering does not obey. A stop is final. Every intervention has its reason.
"""

import math
from math import sqrt
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.estimation.contract import Evidence
from osculate.control.tracking.contract import FREE, GuardPart, Road, View, foot_of
from osculate.curve.table import CurveTable, curvature_at
from osculate.kernel import kernel, select
from osculate.kernel.maths import atan, sincos, tan
from osculate.spec import Spec, quantity
from osculate.vehicle.actuators import ServoStep, Steering, servo_move
from osculate.vehicle.motion import Motion

#: Reasons of interventions; the number is what a record holds, 0 is none.
REASONS = {
    1: "lateral acceleration limited",
    2: "slowed down for the steering rate",
    3: "slowed down to be able to stop inside the corridor",
    4: "stopped: would leave the corridor",
    5: "stopped: no pose",
    6: "stopped: impossible measurements",
    7: "stopped: the steering does not obey",
}
LATERAL, RATE, CLOSE, LEAVING, BLIND, IMPOSSIBLE, DISOBEYED = (float(n) for n in REASONS)
CLOSENESS = 0.6  # of the half width, from which on the robot slows down
MEMORY = 5.0  # 1/s, rate at which the model of the servo is reconciled with what it does


class SafetyParameters(NamedTuple):
    """Parameters of `watch_motion` and `guard_command`."""

    wheelbase: float  # m
    period: float  # s
    delayed: float  # 1 if a decision acts after the next one is made, else 0
    reaction: float  # s, from a decision to its effect
    servo: ServoStep  # one period
    deceleration: float  # m/s², of a stop
    lateral: float  # m/s²
    half_width: float  # m
    patience: float  # s, for which measurements may fail
    jump: float  # m, that no robot makes in a period
    disobedience: float  # rad


class GuardMemory(NamedTuple):
    """Memory of the safety layer."""

    alarm: float  # reason of this instant's intervention
    stop: float  # reason of the stop
    inside: float  # 1 once the robot has been inside the corridor
    shadow: Steering  # what the servo should be doing
    obstinate: float  # s, for which it has been doing something else
    doubt: float  # s, for which measurements have been impossible
    last: Motion  # believed
    x: float  # m, as measured last
    y: float  # m


@kernel
def watch_motion(motion: Motion, evidence: Evidence, now: GuardMemory, p: SafetyParameters) -> Any:
    """The motion, or where it is not to be believed, the last one moved on; and the memory."""
    last = now.last
    sine, cosine = sincos(last.heading)
    way = p.period * last.speed
    expected = Motion(
        last.x + way * cosine,
        last.y + way * sine,
        last.heading + p.period * last.yaw_rate,
        last.speed,
        last.yaw_rate,
        last.steering_angle,
    )
    dx, dy = motion.x - expected.x, motion.y - expected.y
    whole = motion.x + motion.y + motion.heading + motion.speed + motion.steering_angle
    near = dx * dx + dy * dy < p.jump * p.jump and whole - whole == 0.0
    still = motion.x == now.x and motion.y == now.y and abs(last.speed) > 0.05
    fine = near and not still
    doubt = 0.0 if fine else now.doubt + p.period
    stop = now.stop
    stop = IMPOSSIBLE if stop == 0.0 and doubt > p.patience else stop
    stop = BLIND if stop == 0.0 and evidence.fix_age > p.patience else stop
    believed = select(fine, motion, expected)
    return believed, GuardMemory(
        stop, stop, now.inside, now.shadow, now.obstinate, doubt, believed, motion.x, motion.y
    )


@kernel
def obey(view: View, angle: float, now: GuardMemory, p: SafetyParameters) -> GuardMemory:
    """Compare the servo with what it was told, over the memory of a fifth of a second."""
    off = view.steering.angle - now.shadow.angle
    obstinate = now.obstinate + p.period if abs(off) > p.disobedience else 0.0
    blend = MEMORY * p.period
    reconciled = Steering(now.shadow.angle + blend * off, now.shadow.rate)
    acting = view.pending[len(view.pending) - 1].steering_angle
    shadow = servo_move(reconciled, acting if p.delayed > 0.0 else angle, p.servo)
    fails = now.stop == 0.0 and obstinate > 5.0 * p.period
    stop = DISOBEYED if fails else now.stop
    return GuardMemory(stop, stop, now.inside, shadow, obstinate, now.doubt, now.last, now.x, now.y)


@kernel
def aside_at_stop(
    view: View, way: float, p: SafetyParameters, curve: CurveTable, tables: NDArray[np.float64]
) -> float:
    """Lateral error (m) after ``way`` metres with the steering as it is."""
    motion = view.motion
    turn = tan(view.steering.angle) / p.wheelbase * way
    sine, cosine = sincos(motion.heading + 0.5 * turn)
    chord = way * (1.0 - turn * turn / 24.0)
    x, y = motion.x + chord * cosine, motion.y + chord * sine
    foot = foot_of(x, y, motion.heading + turn, view.foot.arc_length + way, curve, tables)
    return foot.aside


@kernel
def steerable(
    s: float, p: SafetyParameters, curve: CurveTable, tables: NDArray[np.float64]
) -> float:
    """The speed (m/s) up to which the servo can follow the curve at arc length ``s`` (m)."""
    k, dk = curvature_at(s, curve, tables)
    slope = p.wheelbase * k
    need = abs(dk) * p.wheelbase
    return 0.95 * p.servo.rate_limit * (1.0 + slope * slope) / (need if need > 1e-6 else 1e-6)


@kernel
def guard_command(
    view: View, angle: float, bound: float, deceleration: float, now: GuardMemory,
    p: SafetyParameters, curve: CurveTable, tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """Steering angle, speed bound, deceleration (m/s²) and memory after looking at all dangers."""
    speed = abs(view.motion.speed)
    angle = angle if angle == angle else view.pending[0].steering_angle
    bound = bound if bound == bound else 0.0
    watched = obey(view, angle, now, p)
    alarm, stop = watched.alarm, watched.stop

    square = speed * speed
    largest = atan(p.wheelbase * p.lateral / (square if square > 1e-6 else 1e-6))
    soon = servo_move(view.steering, angle, p.servo)
    leaning = abs(soon.angle) > largest and abs(angle) > largest
    limited = largest if angle > 0.0 else -largest
    angle = limited if leaning else angle
    slow = sqrt(p.lateral * p.wheelbase / abs(tan(angle))) if leaning else FREE
    alarm = LATERAL if leaning and alarm == 0.0 else alarm
    bound = slow if slow < bound else bound

    way = speed * p.reaction + 0.5 * square / p.deceleration
    s = view.foot.arc_length
    here, ahead = steerable(s, p, curve, tables), steerable(s + way, p, curve, tables)
    able = here if here < ahead else ahead
    unable = able < speed and able < bound
    alarm = RATE if unable and alarm == 0.0 else alarm
    bound = able if able < bound else bound

    aside = abs(aside_at_stop(view, way, p, curve, tables))
    inside = 1.0 if abs(view.foot.aside) < p.half_width else watched.inside
    outward = aside > abs(view.foot.aside) and inside > 0.0
    leaving = outward and aside > p.half_width
    close = outward and aside > CLOSENESS * p.half_width
    gentle = speed * CLOSENESS * p.half_width / (aside if aside > 1e-9 else 1e-9)
    gentle = gentle if close else FREE
    alarm = CLOSE if close and alarm == 0.0 else alarm
    bound = gentle if gentle < bound else bound
    stop = LEAVING if leaving and stop == 0.0 else stop

    stopping = stop > 0.0
    memory = GuardMemory(
        stop if stopping else alarm, stop, inside, watched.shadow, watched.obstinate,
        watched.doubt, watched.last, watched.x, watched.y,
    )  # fmt: skip
    brake = p.deceleration if stopping or close else deceleration
    return angle, 0.0 if stopping else bound, brake, memory


class Safety(Spec):
    """What the safety layer allows."""

    kind: Literal["safety"] = "safety"
    half_width: float = quantity(
        "m", "distance from the curve that O may never exceed", default=0.3, gt=0
    )
    deceleration: float = quantity(
        "m/s²", "of a stop; no more than motors and floor can do", default=4.0, gt=0
    )
    friction: float = quantity("1", "of tyres on the floor, at least", default=0.8, gt=0)
    lateral_acceleration: float | None = quantity(
        "m/s²", "largest; by default what neither tips nor slides", default=None, gt=0
    )
    patience: float = quantity("s", "for which measurements may fail", default=0.3, gt=0)
    jump: float = quantity(
        "m", "that no robot makes from one instant to the next", default=0.1, gt=0
    )
    disobedience: float = quantity(
        "rad", "between what the servo does and should do", default=0.12, gt=0
    )

    def part(self, road: Road, motion: Motion) -> GuardPart:
        """Kernels, parameters, and the memory of a robot that moves as said."""
        robot, act, period = road.robot, road.robot.actuators, road.period
        grip = 0.9 * self.friction * robot.gravity
        motors = 0.8 * 2.0 * act.torque_limit / (robot.wheel_radius * robot.total_mass)
        lateral = min(grip, 0.9 * robot.tipping_acceleration, self.lateral_acceleration or math.inf)
        parameters = SafetyParameters(
            wheelbase=robot.wheelbase,
            period=period,
            delayed=float(road.delay > 0),
            reaction=(road.delay + 1.0) * period + act.motor_lag,
            servo=act.servo(period),
            deceleration=min(self.deceleration, 0.8 * grip, motors),
            lateral=lateral,
            half_width=self.half_width,
            patience=self.patience,
            jump=self.jump,
            disobedience=self.disobedience,
        )
        shadow = Steering(motion.steering_angle, 0.0)
        memory = GuardMemory(0.0, 0.0, 0.0, shadow, 0.0, 0.0, motion, math.nan, math.nan)
        return GuardPart(watch_motion, guard_command, parameters, memory)
