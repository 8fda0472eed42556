"""What pushes a robot, and what goes wrong with its actuators: kernels evaluated once a period."""

from math import sqrt
from typing import Any, NamedTuple

from osculate.kernel import Nothing, kernel, normals
from osculate.kernel.maths import sincos
from osculate.plant.contract import Push
from osculate.vehicle.motion import Command, Motion


class Blow(NamedTuple):
    """One acceleration from outside: steady, or wandering with a correlation time."""

    begin: float  # s
    end: float  # s
    along: float  # m/s², in the robot's frame
    aside: float  # m/s²
    x: float  # m/s², in the map frame
    y: float  # m/s²
    yaw: float  # rad/s²
    time: float  # s, correlation time; 0 if it is steady
    seed: float
    stream: float  # of random numbers


#: A blow that does nothing.
STILL = Blow(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Impairment(NamedTuple):
    """What the actuators do not do."""

    stuck: float  # s, from which on the steering stays where it was told to be
    left_begin: float  # s
    left_strength: float  # part of the left torque that is there from then on
    right_begin: float  # s
    right_strength: float


@kernel
def strength(t: float, blow: Blow) -> Any:
    """Factors of its three components at time ``t``: normal numbers that move smoothly, or ones."""
    steady = not blow.time > 0.0
    u = t / (1.0 if steady else blow.time)
    cell = float(int(u))
    f = u - cell
    w = f * f * (3.0 - 2.0 * f)
    a0, b0, c0, _ = normals(blow.seed, cell, blow.stream)
    a1, b1, c1, _ = normals(blow.seed, cell + 1.0, blow.stream)
    size = 1.0 / sqrt((1.0 - w) * (1.0 - w) + w * w)  # the blend of two is as large as each of them
    along = size * (a0 + w * (a1 - a0))
    aside = size * (b0 + w * (b1 - b0))
    yaw = size * (c0 + w * (c1 - c0))
    return 1.0 if steady else along, 1.0 if steady else aside, 1.0 if steady else yaw


@kernel
def blow_all(t: float, motion: Motion, blows: Any) -> Push:
    """The sum of all blows at time ``t``."""
    sine, cosine = sincos(motion.heading)
    along, aside, yaw = 0.0, 0.0, 0.0
    for n in range(len(blows)):
        blow: Blow = blows[n]
        here = 1.0 if blow.begin <= t < blow.end else 0.0
        first, second, third = strength(t, blow)
        along = along + here * first * (blow.along + blow.x * cosine + blow.y * sine)
        aside = aside + here * second * (blow.aside + blow.y * cosine - blow.x * sine)
        yaw = yaw + here * third * blow.yaw
    return Push(along, yaw, 0.0, aside)


@kernel
def blow_nothing(t: float, motion: Motion, blows: Nothing) -> Push:
    """No wind, level ground."""
    return Push(0.0, 0.0, 0.0, 0.0)


@kernel
def impair(t: float, before: Command, command: Command, p: Impairment) -> Command:
    """What the actuators are told, when ``command`` was decided and ``before`` told last."""
    stuck = t >= p.stuck
    left = p.left_strength if t >= p.left_begin else 1.0
    right = p.right_strength if t >= p.right_begin else 1.0
    angle = before.steering_angle if stuck else command.steering_angle
    return Command(angle, left * command.torque_left, right * command.torque_right, command.brake)


@kernel
def impair_nothing(t: float, before: Command, command: Command, p: Nothing) -> Command:
    """Actuators that do what they are told."""
    return command
