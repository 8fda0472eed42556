"""Template: a path tracker with one steering law and one switching term of its speed loop."""

from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import Errors
from osculate.control.estimation.contract import Evidence
from osculate.control.tracking.contract import (
    Foot,
    Issued,
    TrackingMemory,
    TrackingParameters,
    View,
    foot_of,
)
from osculate.control.tracking.speed_loop import SpeedMemory, SpeedParameters
from osculate.kernel import kernel, read
from osculate.kernel.maths import clip, tan
from osculate.target.contract import Reference
from osculate.vehicle.actuators import Steering, servo_move
from osculate.vehicle.model import steered_torque
from osculate.vehicle.motion import Command, Motion

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.templates.exact_steering import steer_exactly as steer
    from osculate.control.tracking.contract import guard_nothing as guard
    from osculate.control.tracking.contract import watch_nothing as watch
    from osculate.control.tracking.speed_loop import switch_layer as switch

    DELAYED = True

SLOWEST = 0.02  # m/s, below which a plan does not fall


@kernel
def observe_steering(motion: Motion, expected: Steering, gain: float) -> Steering:
    """Angle as measured, rate as expected and corrected by the angle's surprise."""
    surprise = motion.steering_angle - expected.angle
    return Steering(motion.steering_angle, expected.rate + gain * surprise)


@kernel
def planned_speed(s: float, p: TrackingParameters, tables: NDArray[np.float64]) -> float:
    """Speed (m/s) of the plan at arc length ``s`` (m)."""
    energy, _ = read(s, p.profile, tables)
    speed = sqrt(2.0 * (energy if energy > 0.0 else 0.0))
    return speed if speed > SLOWEST else SLOWEST


@kernel
def drive(
    speed: float, wanted: float, brake: float, arriving: float, steering: Steering,
    now: SpeedMemory, p: TrackingParameters,
) -> Any:  # fmt: skip
    """Total torque (N m) and the memory after this decision; ``arriving`` acts from now on."""
    q: SpeedParameters = p.speed
    step = clip(wanted - now.reference, -brake * p.period, q.acceleration * p.period)
    error = speed - now.model
    surface = error + q.sliding * now.integral
    push, twist_rate = switch(surface, now.twist, q)
    acceleration = step / p.period - q.proportional * error + push
    tangent = tan(steering.angle)
    torque = steered_torque(p.model, tangent, steering.rate, speed, acceleration) + q.rolling
    limited = clip(torque, -q.torque_limit, q.torque_limit)
    free = 1.0 if limited == torque else 0.0  # no wind-up at the limit
    memory = SpeedMemory(
        reference=now.reference + step,
        model=now.model + q.lag * (arriving - now.model),
        integral=now.integral + free * p.period * error,
        twist=now.twist + free * p.period * twist_rate,
    )
    return limited, memory, error


@kernel
def track(
    seen: Motion, evidence: Evidence, memory: TrackingMemory, p: TrackingParameters,
    tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """One decision: the command, the next memory, and what was wanted and missed."""
    motion, watched = watch(seen, evidence, memory.guard, p.guard)
    steering = observe_steering(motion, memory.steering, p.observer)
    guess = memory.progress + p.period * motion.speed
    foot: Foot = foot_of(motion.x, motion.y, motion.heading, guess, p.curve, tables)

    pending = memory.pending
    oldest = pending[len(pending) - 1]
    acceleration = (oldest.speed - memory.speed.model) * p.speed.lag / p.period
    view = View(motion, foot, steering, acceleration, pending)
    angle, bound, steer_memory = steer(view, memory.steer, p.steer, p.curve, tables)
    angle = clip(angle, -p.angle_limit, p.angle_limit)
    angle, bound, brake, guarded = guard(
        view, angle, bound, p.speed.deceleration, watched, p.guard, p.curve, tables
    )

    plan = planned_speed(foot.arc_length + p.speed.ahead * motion.speed, p, tables)
    wanted = plan if plan < bound else bound
    torque, speed_memory, speed_error = drive(
        motion.speed, wanted, brake, oldest.speed, steering, memory.speed, p
    )

    decided = Issued(angle, speed_memory.reference)
    acting = oldest.steering_angle if DELAYED else angle
    following = TrackingMemory(
        progress=foot.arc_length,
        steering=servo_move(steering, acting, p.servo),
        speed=speed_memory,
        pending=(decided,) + pending[:-1],
        steer=steer_memory,
        guard=guarded,
    )
    bend = foot.curvature
    reference = Reference(
        memory.speed.model, 0.0, 0.0, bend * motion.speed, 0.0, 0.0, bend,
        motion.heading - foot.heading_error,
    )  # fmt: skip
    errors = Errors(foot.heading_error, motion.yaw_rate - bend * motion.speed, speed_error)
    return Command(angle, 0.5 * torque, 0.5 * torque), following, reference, errors
