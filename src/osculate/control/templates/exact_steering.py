"""Template: steering along the ideal motion, through the servo's inverse, with one law's demand."""

from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking.contract import FREE, View, foot_of
from osculate.control.tracking.curvature_tracker import (
    LEAST,
    ExactParameters,
    Frame,
    Motive,
    Wish,
    clamp_error,
)
from osculate.control.tracking.pipe import Pose, look_ahead
from osculate.curve.table import CurveTable, curvature_at
from osculate.kernel import kernel
from osculate.kernel.maths import atan, sincos, tan

if TYPE_CHECKING:  # part, bound by `compose`
    from osculate.control.tracking.adaptation import adapt
    from osculate.control.tracking.curvature_tracker import demand_exactly as demand


@kernel
def wish(
    at: Frame, speed: float, p: ExactParameters, curve: CurveTable, tables: NDArray[np.float64]
) -> Wish:
    """What the law wants at a place of the path frame."""
    k, dk = curvature_at(at.arc_length, curve, tables)
    q = 1.0 - k * at.aside
    q = q if q > LEAST else LEAST
    sine, cosine = clamp_error(at.heading_error)
    length = p.time * speed
    length = length if length > p.shortest else p.shortest
    turn = demand(at.aside, sine, cosine, q, k, dk, length, p)
    pace = cosine / q
    angle = atan(p.wheelbase * pace * (k + turn))
    real_sine, real_cosine = sincos(at.heading_error)
    return Wish(angle, q * real_sine / (cosine if cosine > 0.1 else 0.1), turn, real_cosine / q)


@kernel
def path_angle(
    s: float, p: ExactParameters, curve: CurveTable, tables: NDArray[np.float64]
) -> float:
    """Steering angle (rad) of a robot on the path at arc length ``s`` (m)."""
    k, _ = curvature_at(s, curve, tables)
    return atan(p.wheelbase * k)


@kernel
def feed_path_forward(
    at: Frame, pace: float, pose: Pose, acceleration: float, p: ExactParameters, curve: CurveTable,
    tables: NDArray[np.float64],
) -> Motive:  # fmt: skip
    """The path's angle, its rate and its acceleration, by central differences over ± one window.

    Where the curvature has a corner, the rate passes from one side to the other within the window, half of
    it before the corner: as fast as a servo whose command has a limited rate can follow.
    """
    t = p.window
    way, bow = pose.speed * t, 0.5 * acceleration * t * t
    early = path_angle(at.arc_length + pace * (bow - way), p, curve, tables)
    middle = path_angle(at.arc_length, p, curve, tables)
    late = path_angle(at.arc_length + pace * (bow + way), p, curve, tables)
    return Motive(middle, (late - early) / (2.0 * t), (late - 2.0 * middle + early) / (t * t))


@kernel
def feed_return_forward(
    at: Frame, first: Wish, speed: float, p: ExactParameters, curve: CurveTable, tables: Any
) -> Motive:
    """Likewise what the wanted angle is beyond the path's, along the ideal motion back to it.

    The ideal motion is followed over one window by the midpoint rule.
    """
    step = 0.5 * p.return_window * speed * first.pace
    middle = Frame(
        at.arc_length + step,
        at.aside + step * first.aside_rate,
        at.heading_error + step * first.turn,
    )
    inner = wish(middle, speed, p, curve, tables)
    step = p.return_window * speed * inner.pace
    end = Frame(
        at.arc_length + step,
        at.aside + step * inner.aside_rate,
        at.heading_error + step * inner.turn,
    )
    last = wish(end, speed, p, curve, tables)
    now = first.steering_angle - path_angle(at.arc_length, p, curve, tables)
    half = inner.steering_angle - path_angle(middle.arc_length, p, curve, tables)
    late = last.steering_angle - path_angle(end.arc_length, p, curve, tables)
    t = p.return_window
    return Motive(
        now, (4.0 * half - 3.0 * now - late) / t, 4.0 * (now - 2.0 * half + late) / (t * t)
    )


@kernel
def caution(
    now: Wish, rate: float, angle: float, speed: float, length: float, p: ExactParameters
) -> float:
    """The largest speed (m/s) at which the robot can do what the law wants.

    Lateral acceleration of the wanted curvature, rate of the wanted angle, and time for the servo to
    come near the wanted angle before the robot has gone a quarter of its recovery length.
    """
    bend = abs(tan(now.steering_angle)) / p.wheelbase
    bound = sqrt(p.lateral / (bend if bend > 1e-6 else 1e-6))
    turning = abs(rate)
    slower = speed * p.steering_rate / (turning if turning > p.steering_rate else p.steering_rate)
    slower = slower if turning > p.steering_rate else FREE
    late = abs(now.steering_angle - angle) - 0.1
    reach = 0.25 * length * p.steering_rate / (late if late > 1e-3 else 1e-3)
    bound = bound if bound < slower else slower
    bound = bound if bound < reach else reach
    return bound if bound > 0.05 else 0.05


@kernel
def lean(pose: Pose, view: View, slip: float, p: ExactParameters) -> Pose:
    """The pose of a robot whose direction of motion gives way to the lateral acceleration."""
    before = view.motion.speed * view.motion.yaw_rate
    after = pose.speed * pose.speed * tan(pose.steering.angle) / p.wheelbase
    heading = pose.heading - slip * (after - before)
    return Pose(pose.x, pose.y, heading, pose.speed, pose.steering)


@kernel
def steer_exactly(
    real: View, memory: Any, p: ExactParameters, curve: CurveTable, tables: NDArray[np.float64]
) -> Any:
    """Steering command, speed bound and memory: see `osculate.control.tracking.curvature_tracker`."""
    twin, known = adapt(real, memory, p.adaptation)
    view = twin.seen
    pose = lean(look_ahead(view, twin.shift, p.pipe), view, twin.slip, p)
    moved = view.foot.arc_length + p.pipe.delay * p.pipe.period * view.motion.speed
    foot = foot_of(pose.x, pose.y, pose.heading, moved, curve, tables)
    speed = pose.speed if pose.speed > 0.02 else 0.02

    at = Frame(foot.arc_length, foot.aside, foot.heading_error)
    now = wish(at, speed, p, curve, tables)
    path = feed_path_forward(at, now.pace, pose, view.acceleration, p, curve, tables)
    back = feed_return_forward(at, now, speed, p, curve, tables)
    angle, rate = path.angle + back.angle, path.rate + back.rate
    bend = path.acceleration + back.acceleration

    t = p.half_period + twin.lead
    command = (
        angle + t * rate + 0.5 * t * t * bend
        + p.damping_time * (rate + t * bend)
        + p.inertia_time * bend
        + p.angle_feedback * (pose.steering.angle - angle)
        + p.rate_feedback * (pose.steering.rate - rate)
    )  # fmt: skip
    length = p.time * speed
    length = length if length > p.shortest else p.shortest
    bound = caution(now, rate, pose.steering.angle, speed, length, p)
    return command - twin.shift, bound, known
