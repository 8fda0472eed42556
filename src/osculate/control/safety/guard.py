"""The guard between a steering law and the actuators: it limits, slows down, and stops in time."""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.reasons import (
    CALM,
    CLOSE,
    DISOBEYED,
    LATERAL,
    LEAVING,
    OUTSIDE,
    POSITION,
    RATE,
    STEERING,
    Alarm,
)
from osculate.control.safety.corridor import (
    CorridorParameters,
    Outlook,
    aside_when_stuck,
    farthest,
)
from osculate.control.safety.obedience import (
    ObedienceMemory,
    ObedienceParameters,
    watch_servo,
)
from osculate.control.safety.watch import WatchMemory, WatchParameters
from osculate.control.safety.watch import watch_motion as watch_whole_motion
from osculate.control.tracking.contract import FREE, View, twin_angle
from osculate.curve.table import CurveTable, curvature_at
from osculate.kernel import kernel, select
from osculate.kernel.maths import atan, tan
from osculate.vehicle.actuators import servo_move
from osculate.vehicle.motion import Motion

CLOSENESS = 0.6  # of the half width, from which on the robot slows down
SLOW = 0.1  # m/s, to which it slows down at most: it shall go on, or stop


class SafetyParameters(NamedTuple):
    """Parameters of `watch_motion` and `guard_command`."""

    watch: WatchParameters
    obedience: ObedienceParameters
    corridor: CorridorParameters
    delayed: float  # 1 if a decision acts after the next one is made, else 0


class GuardMemory(NamedTuple):
    """Memory of the safety layer."""

    watch: WatchMemory
    obedience: ObedienceMemory
    inside: float  # 1 once the robot has been inside the corridor


@kernel
def watch_motion(motion: Motion, expected: Motion, now: GuardMemory, p: SafetyParameters) -> Any:
    """The motion as far as it is to be believed; memory and alarm."""
    believed, watched, alarm = watch_whole_motion(motion, expected, now.watch, p.watch)
    return believed, GuardMemory(watched, now.obedience, now.inside), alarm


@kernel
def steerable(
    s: float, p: CorridorParameters, curve: CurveTable, tables: NDArray[np.float64]
) -> float:
    """The speed (m/s) up to which the servo can follow the curve at arc length ``s`` (m)."""
    k, dk = curvature_at(s, curve, tables)
    slope = p.wheelbase * k
    need = abs(dk) * p.wheelbase
    return 0.95 * p.rate_limit * (1.0 + slope * slope) / (need if need > 1e-6 else 1e-6)


@kernel
def limit_lateral(view: View, angle: float, p: SafetyParameters) -> Any:
    """Steering angle (rad) and speed (m/s) that neither tip the robot nor make it slide."""
    c = p.corridor
    square = view.motion.speed * view.motion.speed
    largest = atan(c.wheelbase * c.lateral / (square if square > 1e-6 else 1e-6))
    soon = servo_move(view.steering, angle, p.obedience.servo)
    leaning = abs(soon.angle) > largest and abs(angle) > largest
    limited = largest if angle > 0.0 else -largest
    angle = limited if leaning else angle
    bend = abs(tan(angle)) / c.wheelbase
    slow = sqrt(c.lateral / bend) if leaning else FREE
    return angle, slow


@kernel
def judge_corridor(
    view: View, outlook: Outlook, stuck: bool, inside: float, p: SafetyParameters,
    curve: CurveTable, tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """Speed bound (m/s) and alarm of the corridor and the steering."""
    width = p.corridor.half_width
    speed = abs(view.motion.speed)
    close = outlook.aside > CLOSENESS * width
    gentle = speed * CLOSENESS * width / (outlook.aside if outlook.aside > 1e-9 else 1e-9)
    gentle = gentle if gentle > SLOW else SLOW
    alarm = select(close, Alarm(CLOSE, 0.0, outlook.cause), CALM)
    excess = outlook.aside - width
    alarm = select(excess > 0.0, Alarm(LEAVING, excess, outlook.cause), alarm)
    off = abs(aside_when_stuck(view, p.corridor, curve, tables)) - width
    alarm = select(stuck, Alarm(DISOBEYED, off if off > 0.0 else 0.0, STEERING), alarm)
    far = abs(view.foot.aside) - width
    alarm = select(inside == 0.0 and far > 0.0, Alarm(OUTSIDE, far, POSITION), alarm)
    return gentle if close else FREE, alarm


@kernel
def guard_command(
    view: View, angle: float, bound: float, deceleration: float, now: GuardMemory,
    p: SafetyParameters, curve: CurveTable, tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """Steering angle, speed bound, deceleration (m/s²), memory and alarm after looking at all dangers."""
    c = p.corridor
    speed = abs(view.motion.speed)
    angle, slow = limit_lateral(view, angle, p)
    alarm = select(slow < FREE, Alarm(LATERAL, 0.0, 0.0), CALM)
    bound = slow if slow < bound else bound

    s = view.foot.arc_length
    way = speed * c.reaction + 0.5 * speed * speed / c.deceleration
    here, ahead = steerable(s, c, curve, tables), steerable(s + way, c, curve, tables)
    able = here if here < ahead else ahead
    unable = able < speed and able < bound
    alarm = select(unable and alarm.reason == 0.0, Alarm(RATE, 0.0, 0.0), alarm)
    bound = able if able < bound else bound

    pending = view.pending[len(view.pending) - 1].steering_angle
    acting = twin_angle(pending, view.bias, view.stretch) if p.delayed > 0.0 else angle
    servo = watch_servo(view.steering, acting, now.obedience, p.obedience)
    stuck = servo.stuck > p.obedience.patience
    outlook = farthest(view, c)
    gentle, danger = judge_corridor(view, outlook, stuck, now.inside, p, curve, tables)
    bound = gentle if gentle < bound else bound
    alarm = select(danger.reason > 0.0, danger, alarm)
    brake = c.deceleration if danger.reason > 0.0 else deceleration
    inside = 1.0 if abs(view.foot.aside) <= c.half_width else now.inside
    return angle, bound, brake, GuardMemory(now.watch, servo, inside), alarm
