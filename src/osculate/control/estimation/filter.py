"""One period of the extended Kalman filter: predict, screen, correct, and only then believe."""

import math
from typing import Any

from osculate.control.estimation.belief import Belief, EkfParameters, Heard, Place
from osculate.control.estimation.contract import Evidence, Sight, Told
from osculate.control.estimation.gates import screen
from osculate.control.estimation.kinematics import (
    UNITS,
    ZERO,
    Clue,
    Covariance,
    Kinematics,
    Learned,
    learn,
    spread,
)
from osculate.control.estimation.process import effective_base, step_forward, yaw
from osculate.control.estimation.readings import (
    agrees,
    difference_clue,
    fits,
    fix_clues,
    fix_innovation,
    gyro_clue,
    speed_clue,
)
from osculate.kernel import axpy, finite_sum, kernel, select
from osculate.kernel.maths import atan, sincos, tan
from osculate.vehicle.measurement import Measurement
from osculate.vehicle.motion import Motion

STARTLING = 1e3  # normalised innovation squared, per reading, of the most surprising pose
CALM = 1.5  # mean square of normalised innovations up to which nothing is doubted


@kernel
def see(m: Kinematics, evidence: Evidence, p: EkfParameters) -> Sight:
    """The twin without slip and offset that moves as the robot does."""
    rate, _, _, _ = yaw(m, p)
    stretch = effective_base(m, p) / p.wheelbase
    angle = atan(tan(m.steering_angle + m.steering_bias) / stretch)
    course = m.heading - m.slip * m.speed * (rate + m.swerve)
    motion = Motion(m.x, m.y, course, m.speed, rate + m.swerve, angle)
    return Sight(motion, m.steering_bias, stretch, evidence)


@kernel
def growth(z: Measurement, m: Kinematics, belief: Belief, p: EkfParameters) -> Kinematics:
    """The variance of this period.

    Poses that surprise more than they should mean that the robot moves in ways that the filter does not
    know; and what the servo's model cannot explain, its encoder knows better.
    """
    excess = belief.evidence.surprise - CALM
    wander = axpy(excess if excess > 0.0 else 0.0, p.doubt, p.wander)
    miss = z.steering_angle - m.steering_angle
    square = miss * miss
    variance = belief.covariance.steering_angle.steering_angle + p.steering
    return axpy(square if square > p.gate * variance else 0.0, UNITS.steering_angle, wander)


@kernel
def begin(m: Kinematics, z: Measurement, off: Place, p: EkfParameters) -> Kinematics:
    """The first belief: what the first pose and its companions say where they differ from what was said."""
    pose = off.x == off.x
    speed = 0.5 * (z.left + z.right) / (1.0 + m.speed_scale)
    moves = abs(speed - m.speed) > p.gates.wheels
    turned = abs(z.steering_angle - m.steering_angle) > p.gates.steering
    return Kinematics(
        m.x + off.x if pose else m.x, m.y + off.y if pose else m.y,
        m.heading + off.heading if pose else m.heading, speed if moves else m.speed,
        z.steering_angle if turned else m.steering_angle, 0.0 if turned else m.steering_rate,
        m.steering_bias, m.speed_scale, m.gyro_bias, m.slip, m.understeer, m.swerve,
    )  # fmt: skip


@kernel
def age_readings(
    z: Measurement, located: bool, fitted: bool, nis: float, before: Belief, p: EkfParameters
) -> Any:
    """For how long every sensor has been missing, how surprising poses are, and who was ever heard."""
    e, t = before.evidence, p.period
    wheels = z.left == z.left
    steering, gyro = z.steering_angle == z.steering_angle, z.yaw_rate == z.yaw_rate
    heard = Heard(1.0 if steering else before.heard.steering, 1.0 if gyro else before.heard.gyro)
    share = nis / 3.0
    share = share if share < STARTLING else STARTLING
    surprise = e.surprise + 0.1 * (share - e.surprise) if nis == nis else e.surprise
    evidence = Evidence(
        fix_age=0.0 if fitted else e.fix_age + t,
        surprise=surprise,
        wheels_age=0.0 if wheels else e.wheels_age + t,
        steering_age=0.0 if steering else e.steering_age + t * heard.steering,
        gyro_age=0.0 if gyro else e.gyro_age + t * heard.gyro,
        located=1.0 if located else 0.0,
    )
    return evidence, heard


@kernel
def correct(
    mean: Kinematics, covariance: Covariance, z: Measurement, acceleration: float, poses: Any,
    p: EkfParameters,
) -> Any:  # fmt: skip
    """Everything that arrived, one scalar after the other; and how much the pose surprised."""
    angle = Clue(UNITS.steering_angle, z.steering_angle - mean.steering_angle, p.steering, math.inf)
    clues = (
        speed_clue(mean, z, acceleration, p), difference_clue(mean, z, p), angle,
        gyro_clue(mean, z.yaw_rate, p),
    ) + poses  # fmt: skip
    learned = Learned(ZERO, covariance)
    nis = 0.0
    for n in range(len(clues)):
        learned, one = learn(learned, clues[n])
        nis = nis + (one if n > 3 else 0.0)
    return axpy(1.0, learned.shift, mean), learned.covariance, nis


@kernel
def estimate_kinematics(z: Measurement, told: Told, belief: Belief, p: EkfParameters) -> Any:
    """Predict, then correct by everything that arrived and passes its gate."""
    mean, slopes = step_forward(belief.mean, told, p)
    steered, _, _, _ = yaw(mean, p)
    fresh = belief.evidence.located == 0.0
    z, gates = screen(z, mean, steered + mean.swerve, fresh, belief.gates, p.gates)
    covariance = spread(belief.covariance, slopes, growth(z, mean, belief, p))
    trail = (follow_trail(belief.trail[0], belief.mean, mean),) + belief.trail[:-1]

    off, ahead = fix_innovation(mean, trail, z.fix, p)
    there = off.x == off.x
    fitted = fits(off, covariance, p)
    starts = fresh and not fitted
    mean = select(starts, begin(mean, z, off, p), mean)
    agreed = there and not fitted and agrees(off, belief.off, p)
    forced = agreed and belief.rejected >= p.patience
    poses = fix_clues(off, ahead, (fitted or forced) and not starts, p)
    mean, covariance, fix_nis = correct(mean, covariance, z, told.acceleration, poses, p)

    located = not fresh or there
    evidence, heard = age_readings(z, located, fitted or (starts and there), fix_nis, belief, p)
    rejected = belief.rejected + 1.0 if agreed else (1.0 if there else belief.rejected)
    rejected = 0.0 if fitted or forced or starts else rejected
    last = fix_nis if fix_nis == fix_nis else belief.fix_nis
    following = Belief(
        mean, covariance, trail, evidence, gates, heard, rejected,
        select(there and not fitted, off, belief.off), last,
    )  # fmt: skip
    sound = finite_sum(following) == 0.0
    following = select(sound, following, belief)
    return see(following.mean, evidence, p), following


@kernel
def follow_trail(last: Place, before: Kinematics, after: Kinematics) -> Place:
    """Dead reckoning moved on by what the estimate was predicted to move, in the body's frame."""
    turn = last.heading - before.heading
    sine, cosine = sincos(turn)
    dx, dy = after.x - before.x, after.y - before.y
    return Place(
        last.x + dx * cosine - dy * sine,
        last.y + dx * sine + dy * cosine,
        last.heading + (after.heading - before.heading),
    )
