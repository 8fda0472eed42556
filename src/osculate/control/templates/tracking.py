"""Template: a path tracker with one steering law and one switching term of its speed loop."""

from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import Errors
from osculate.control.estimation.contract import Evidence, Sight
from osculate.control.gate import gate_command
from osculate.control.reasons import (
    ARRIVED,
    CALM,
    GYRO,
    NO_GYRO,
    NO_STEERING,
    SPEED,
    STEERING,
    Alarm,
    is_stop,
)
from osculate.control.standstill import (
    ROLLING,
    StopMemory,
    come_to_rest,
    oppose,
    watch_readings,
)
from osculate.control.tracking.arrival import arrival_speed
from osculate.control.tracking.contract import (
    Foot,
    Issued,
    TrackingMemory,
    TrackingParameters,
    View,
    foot_of,
    servo_angle,
    twin_angle,
)
from osculate.control.tracking.pipe import PipeParameters, Pose, roll
from osculate.control.tracking.speed_loop import SpeedMemory, SpeedParameters
from osculate.kernel import finite_sum, kernel, read, select
from osculate.kernel.maths import clip, tan
from osculate.target.contract import Reference
from osculate.vehicle.actuators import Steering
from osculate.vehicle.model import steered_torque
from osculate.vehicle.motion import Command, Motion

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.templates.exact_steering import steer_exactly as steer
    from osculate.control.tracking.contract import guard_nothing as guard
    from osculate.control.tracking.contract import watch_nothing as watch
    from osculate.control.tracking.speed_loop import switch_layer as switch

    DELAYED = True

SLOWEST = 0.02  # m/s, below which a plan does not fall, but to come to rest
WIDEST = 1.5  # rad, of a twin's steering angle: the tangent goes no further


@kernel
def observe_steering(motion: Motion, expected: Steering, p: TrackingParameters) -> Steering:
    """Angle as measured, rate as expected and corrected by the angle's surprise."""
    surprise = motion.steering_angle - expected.angle
    limit = p.half.rate_limit
    return Steering(
        motion.steering_angle, clip(expected.rate + p.observer * surprise, -limit, limit)
    )


@kernel
def planned_speed(s: float, p: TrackingParameters, tables: NDArray[np.float64]) -> float:
    """Speed (m/s) of the plan at arc length ``s`` (m), from which the robot can come to rest at the end."""
    energy, _ = read(s, p.profile, tables)
    speed = sqrt(2.0 * (energy if energy > 0.0 else 0.0))
    speed = speed if speed > SLOWEST else SLOWEST
    arriving = arrival_speed(s, p.arrival)
    return speed if speed < arriving else arriving


@kernel
def drive(
    speed: float, wanted: float, brake: float, arriving: float, known: bool, heard: bool,
    steering: Steering, now: SpeedMemory, p: TrackingParameters,
) -> Any:  # fmt: skip
    """Total torque (N m) and the memory after this decision; ``arriving`` acts from now on.

    A speed that is not ``heard`` but ``known`` from poses is answered in proportion, one that is not known
    not at all: then the torque is what the reference asks for.
    """
    q: SpeedParameters = p.speed
    before = now.acceleration if now.acceleration > 0.0 else 0.0
    rise = before + q.jerk * p.period
    rise = rise if rise < q.acceleration else q.acceleration
    step = clip(wanted - now.reference, -brake * p.period, rise * p.period)
    error = speed - now.model
    surface = error + q.sliding * now.integral
    push, twist_rate = switch(surface, now.twist, q)
    answer = (push if heard else 0.0) - (q.proportional * error if known else 0.0)
    acceleration = step / p.period + answer
    tangent = tan(steering.angle)
    torque = steered_torque(p.model, tangent, steering.rate, speed, acceleration) + q.rolling
    limited = clip(torque, -q.torque_limit, q.torque_limit)
    free = 1.0 if limited == torque and heard else 0.0  # no wind-up at the limit
    memory = SpeedMemory(
        reference=now.reference + step,
        model=now.model + q.lag * (arriving - now.model),
        integral=now.integral + free * p.period * error,
        twist=now.twist + free * p.period * twist_rate,
        acceleration=step / p.period,
    )
    return limited, memory, error


@kernel
def settle(
    torque: float, speed: float, moved: SpeedMemory, stop: StopMemory, waits: bool,
    p: TrackingParameters,
) -> Any:  # fmt: skip
    """Torque (N m), brake and memory of the speed loop of a robot that drives, stops or stands."""
    rests = waits or stop.resting > 0.0
    brakes = stop.alarm.reason > 0.0
    opposed = 0.0 if p.stop.brake > 0.0 else oppose(torque, speed)
    torque = opposed if brakes else torque
    brake = p.stop.brake if brakes else 0.0
    standing = SpeedMemory(0.0, 0.0, 0.0, 0.0, 0.0)
    return (
        0.0 if rests else torque, p.stop.parking if rests else brake,
        select(rests, standing, moved),
    )  # fmt: skip


@kernel
def worst(
    readings: Alarm, watched: Alarm, guarded: Alarm, evidence: Evidence, p: TrackingParameters
) -> Alarm:
    """The alarm that counts: stops before cautions, causes before consequences."""
    alarm = CALM
    alarm = select(evidence.gyro_age > p.stop.wheels, Alarm(NO_GYRO, 0.0, GYRO), alarm)
    alarm = select(evidence.steering_age > p.stop.wheels, Alarm(NO_STEERING, 0.0, STEERING), alarm)
    alarm = select(guarded.reason > 0.0, guarded, alarm)
    alarm = select(is_stop(watched.reason), watched, alarm)
    return select(readings.reason > 0.0, readings, alarm)


@kernel
def show(stop: Alarm, now: Alarm) -> Alarm:
    """What is told: a stop for as long as it lasts; the end of the path is no intervention."""
    alarm = select(stop.reason > 0.0, stop, now)
    return select(alarm.reason == ARRIVED, CALM, alarm)


@kernel
def expect(
    motion: Motion, steering: Steering, command: float, acceleration: float, rests: bool,
    p: TrackingParameters,
) -> Any:  # fmt: skip
    """The motion one period later under a command (rad) of the twin's servo, and its steering."""
    speed = 0.0 if rests and abs(motion.speed) < ROLLING else motion.speed
    pose = Pose(motion.x, motion.y, motion.heading, speed, steering)
    pipe = PipeParameters(p.half, p.wheelbase, p.period, 0.0)
    end: Pose = roll(pose, command, 0.0 if rests else acceleration, pipe)
    yaw_rate = end.speed * tan(end.steering.angle) / p.wheelbase
    angle = end.steering.angle
    return Motion(end.x, end.y, end.heading, end.speed, yaw_rate, angle), end.steering


@kernel
def propose(
    view: View, memory: TrackingMemory, p: TrackingParameters, tables: NDArray[np.float64]
) -> Any:
    """Steering angle (rad, of the twin), speed bound (m/s) and memory of the law, and their soundness.

    A law whose answer is not finite is not followed: the angle stays, the robot slows down, and the law
    forgets what it has learned at this instant.
    """
    angle, bound, learned = steer(view, memory.steer, p.steer, p.curve, tables)
    sound = finite_sum((angle, bound, learned)) == 0.0
    held = twin_angle(memory.gate.last.steering_angle, view.bias, view.stretch)
    angle = clip(angle if sound else held, -WIDEST, WIDEST)
    return angle, bound if sound else 0.0, select(sound, learned, memory.steer), sound


@kernel
def track(
    sight: Sight, memory: TrackingMemory, p: TrackingParameters, tables: NDArray[np.float64]
) -> Any:
    """One decision: the command, the next memory, and what was wanted and missed."""
    evidence = sight.evidence
    motion, watched, strange = watch(sight.motion, memory.expected, memory.guard, p.guard)
    steering = observe_steering(motion, memory.steering, p)
    guess = memory.progress + p.period * motion.speed
    foot: Foot = foot_of(motion.x, motion.y, motion.heading, guess, p.curve, tables)

    pending = memory.pending
    oldest = pending[len(pending) - 1]
    acceleration = (oldest.speed - memory.speed.model) * p.speed.lag / p.period
    view = View(motion, foot, steering, acceleration, pending, sight.bias, sight.stretch)
    angle, bound, learned, sound = propose(view, memory, p, tables)
    waits = evidence.located <= 0.0
    angle, bound, brake, guarded, danger = guard(
        view, angle, bound, p.speed.deceleration, watched, p.guard, p.curve, tables
    )
    soon = foot.arc_length + p.speed.ahead * motion.speed
    arrived = foot.arc_length >= p.stop.end or soon >= p.arrival.end
    missing = watch_readings(evidence, memory.gate.undecided, arrived, memory.stop, p.stop)
    alarm = worst(missing, strange, danger, evidence, p)
    told = memory.gate.last
    known = evidence.wheels_age == 0.0
    stop = come_to_rest(
        alarm, motion.speed, known, told.torque_left + told.torque_right, foot.arc_length,
        memory.stop, p.stop,
    )  # fmt: skip
    brakes = stop.alarm.reason > 0.0
    rests = waits or stop.resting > 0.0

    wanted = planned_speed(soon, p, tables)
    wanted = wanted if wanted < bound else bound
    torque, moved, speed_error = drive(
        motion.speed, 0.0 if brakes or waits else wanted, p.stop.deceleration if brakes else brake,
        oldest.speed, known, known and strange.cause != SPEED, steering, memory.speed, p,
    )  # fmt: skip
    torque, braking, speed_memory = settle(torque, motion.speed, moved, stop, waits, p)
    servo = servo_angle(angle, sight.bias, sight.stretch)
    stands = rests and (waits or abs(motion.speed) < ROLLING)
    held = memory.gate.last.steering_angle
    decided = Command(held if stands else servo, 0.5 * torque, 0.5 * torque, braking)
    command, gate = gate_command(decided, sound, memory.gate, p.gate)

    acting = oldest.steering_angle if DELAYED else command.steering_angle
    following, servo_next = expect(
        motion, steering, twin_angle(acting, sight.bias, sight.stretch),
        (speed_memory.model - memory.speed.model) / p.period, rests, p,
    )  # fmt: skip
    after = TrackingMemory(
        progress=foot.arc_length,
        evidence=evidence,
        expected=following,
        steering=servo_next,
        speed=speed_memory,
        pending=(Issued(command.steering_angle, speed_memory.reference),) + pending[:-1],
        steer=learned,
        guard=guarded,
        gate=gate,
        stop=stop,
        alarm=show(stop.alarm, alarm),
    )
    bend = foot.curvature
    reference = Reference(
        memory.speed.model, 0.0, 0.0, bend * motion.speed, 0.0, 0.0, bend,
        motion.heading - foot.heading_error,
    )  # fmt: skip
    errors = Errors(foot.heading_error, motion.yaw_rate - bend * motion.speed, speed_error)
    return command, after, reference, errors
