"""The tally: exactness of a run, summed up step by step so that a million runs fit in memory.

The robot is compared with the foot point of its position on the curve, the nearest point with the
heading taken into account. The foot moves with the robot (one Newton correction a step); nothing is
searched, so that a curve that crosses itself causes no jump.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.table import CurveTable, point_at
from osculate.kernel import kernel
from osculate.kernel.maths import sincos, wrap_angle
from osculate.vehicle.model import ReducedModel
from osculate.vehicle.motion import Command, Motion


class Tally(NamedTuple):
    """Sums and extremes over the samples of one run so far."""

    samples: float  # number of samples
    foot: float  # m, arc length of the foot point
    cross_track: float  # m, now; signed, left of the curve is positive
    heading_error: float  # rad, now; robot minus curve, wrapped to (−π, π]
    steering_angle: float  # rad, now
    cross_track_squares: float  # m², sum
    cross_track_max: float  # m, of the absolute value
    heading_error_squares: float  # rad², sum
    heading_error_max: float  # rad
    steering_angle_max: float  # rad
    steering_rate_max: float  # rad/s
    torque_left_max: float  # N m
    torque_right_max: float  # N m
    speed_max: float  # m/s
    steering_travel: float  # rad, sum of all changes of the steering angle
    torque_travel: float  # N m, sum of all changes of the total torque commanded
    torque: float  # N m, now: total torque commanded
    counted: float  # number of samples whose errors count
    energy: float  # J, work of the commanded torques, both signs counted


def empty_tally(foot: float) -> Tally:
    """The tally of a run that starts with its foot point at arc length ``foot`` (m)."""
    return Tally(0.0, foot, *[0.0] * 17)


@kernel
def larger(a: float, b: float) -> float:
    """The larger of two numbers; ``b`` if either is not a number."""
    return a if a > b else b


@kernel
def count(
    elapsed: float,
    motion: Motion,
    command: Command,
    tally: Tally,
    settled: float,
    model: ReducedModel,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Tally:
    """Add one sample, ``elapsed`` seconds after the last (0 for the first)."""
    guess = tally.foot + elapsed * motion.speed
    guess = guess if guess > 0.0 else 0.0
    guess = guess if guess < curve.length else curve.length
    point = point_at(guess, curve, tables)
    sine, cosine = sincos(point.heading)
    dx, dy = motion.x - point.x, motion.y - point.y
    along, aside = dx * cosine + dy * sine, dy * cosine - dx * sine
    slack = 1.0 - point.curvature * aside
    shift = along / (slack if slack > 0.1 else 0.1)
    # second order: moving the foot by `shift` leaves the chord by κ shift²/2
    cross_track = aside - 0.5 * point.curvature * shift * along
    heading_error = wrap_angle(motion.heading - point.heading - point.curvature * shift)
    per_second = 1.0 / elapsed if elapsed > 0.0 else 0.0
    moved = abs(motion.steering_angle - tally.steering_angle)
    rate = moved * per_second
    total = command.torque_left + command.torque_right
    counts = guess >= settled
    off = cross_track if counts else 0.0
    turned = heading_error if counts else 0.0
    one = 1.0 if counts else 0.0
    steered = moved if elapsed > 0.0 else 0.0
    return Tally(
        samples=tally.samples + 1.0,
        foot=guess + shift,
        cross_track=cross_track,
        heading_error=heading_error,
        steering_angle=motion.steering_angle,
        cross_track_squares=tally.cross_track_squares + off * off,
        cross_track_max=larger(abs(off), tally.cross_track_max),
        heading_error_squares=tally.heading_error_squares + turned * turned,
        heading_error_max=larger(abs(turned), tally.heading_error_max),
        steering_angle_max=larger(abs(motion.steering_angle), tally.steering_angle_max),
        steering_rate_max=larger(rate, tally.steering_rate_max),
        torque_left_max=larger(abs(command.torque_left), tally.torque_left_max),
        torque_right_max=larger(abs(command.torque_right), tally.torque_right_max),
        speed_max=larger(abs(motion.speed), tally.speed_max),
        steering_travel=tally.steering_travel + steered,
        torque_travel=tally.torque_travel + abs(total - tally.torque),
        torque=total,
        counted=tally.counted + one,
        energy=tally.energy + elapsed * abs(total * motion.speed) * model.traction,
    )
