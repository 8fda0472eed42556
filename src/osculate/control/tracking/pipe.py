"""Looking through the pipe: where the robot will be when the next decision acts.

Commands already issued move servo and robot during the delay. The servo is exact (constant commands);
the pose follows by Simpson's rule in the map frame, which no path singularity can disturb.
"""

from typing import Any, NamedTuple

from osculate.control.tracking.contract import View, twin_angle
from osculate.kernel import kernel
from osculate.kernel.maths import sincos, tan
from osculate.vehicle.actuators import ServoStep, Steering, servo_move


class Pose(NamedTuple):
    """A robot's pose, speed and steering."""

    x: float  # m
    y: float  # m
    heading: float  # rad
    speed: float  # m/s
    steering: Steering


class PipeParameters(NamedTuple):
    """Parameters of `look_ahead`."""

    half: ServoStep  # half a period
    wheelbase: float  # m
    period: float  # s
    delay: float  # periods until a decision acts


@kernel
def roll(pose: Pose, command: float, acceleration: float, p: PipeParameters) -> Pose:
    """The robot one period later under a constant steering command."""
    middle = servo_move(pose.steering, command, p.half)
    end = servo_move(middle, command, p.half)
    t = p.period
    v0 = pose.speed
    v1 = v0 + 0.5 * t * acceleration
    v2 = v0 + t * acceleration
    w0 = v0 * tan(pose.steering.angle) / p.wheelbase
    w1 = v1 * tan(middle.angle) / p.wheelbase
    w2 = v2 * tan(end.angle) / p.wheelbase
    half_way = pose.heading + t / 24.0 * (5.0 * w0 + 8.0 * w1 - w2)
    heading = pose.heading + t / 6.0 * (w0 + 4.0 * w1 + w2)
    s0, c0 = sincos(pose.heading)
    s1, c1 = sincos(half_way)
    s2, c2 = sincos(heading)
    x = pose.x + t / 6.0 * (v0 * c0 + 4.0 * v1 * c1 + v2 * c2)
    y = pose.y + t / 6.0 * (v0 * s0 + 4.0 * v1 * s1 + v2 * s2)
    return Pose(x, y, heading, v2, end)


@kernel
def look_ahead(view: View, shift: float, p: PipeParameters) -> Any:
    """The pose when the next decision acts; ``shift`` (rad) is added to the commands issued."""
    motion = view.motion
    pose = Pose(motion.x, motion.y, motion.heading, motion.speed, view.steering)
    if p.delay > 0.0:
        for n in range(len(view.pending) - 1, -1, -1):
            command = twin_angle(view.pending[n].steering_angle, view.bias, view.stretch)
            pose = roll(pose, command + shift, view.acceleration, p)
    return pose
