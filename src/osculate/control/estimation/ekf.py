"""An extended Kalman filter for pose, motion, and what the robot's description does not say.

The state is (x, y, θ, v, φ, φ̇, b, g, β, c, k, δ): pose of O, speed, the servo's angle and rate, steering
bias, scale of the wheel encoders, gyro bias, rear slip, understeer and swerve. Between two instants the
servo moves exactly, the pose by Simpson's rule. With linear tyres, whose slip angles are proportional to
the lateral acceleration v ω, O moves in the direction θ − c v ω, and with the understeer gradient k

    ω = v tan(φ + b) / (a + k v²) + δ,

where δ is what steering does not explain: it forgets itself within a fraction of a second.

A pose that arrives late is compared with where the robot was when it was taken: the estimate, moved back
by what was driven since. A pose that does not fit is left out, unless several in a row agree with each
other. Every reading passes a gate of its own before it is used (`osculate.control.estimation.gates`), and a
belief that is not finite is never taken: whatever is measured, what is believed stays finite.
"""

import math
from typing import Any, Literal, NamedTuple

from osculate.control.contract import Start
from osculate.control.estimation.contract import TRUSTED, EstimatorPart, Evidence, Sight, Told
from osculate.control.estimation.gates import UNHEARD, GateMemory, GateParameters, screen
from osculate.control.estimation.kinematics import (
    UNITS,
    ZERO,
    Clue,
    Covariance,
    Kinematics,
    Learned,
    Slopes,
    learn,
    spread,
)
from osculate.control.tracking.contract import Jitter
from osculate.control.tracking.pipe import PipeParameters, Pose, roll
from osculate.kernel import axpy, finite_sum, kernel, select
from osculate.kernel.maths import atan, sincos, tan, wrap_angle
from osculate.spec import Spec, quantity
from osculate.vehicle.actuators import ServoStep, Steering
from osculate.vehicle.measurement import Fix, Measurement
from osculate.vehicle.motion import Motion
from osculate.vehicle.tricycle import Tricycle


class Place(NamedTuple):
    """A pose of dead reckoning, which no correction moves."""

    x: float  # m
    y: float  # m
    heading: float  # rad


class Heard(NamedTuple):
    """Which sensors have ever reported something: 1 or 0."""

    steering: float
    gyro: float


class Belief(NamedTuple):
    """Memory of the filter."""

    mean: Kinematics
    covariance: Covariance
    trail: Any  # tuple of `Place` at the last instants, the newest first
    evidence: Evidence
    gates: GateMemory
    heard: Heard
    rejected: float  # number of poses in a row that did not fit, but fitted each other
    off: Place  # what the last of them was off
    fix_nis: float  # of the last pose: squared normalised innovation, 3 degrees of freedom


class EkfParameters(NamedTuple):
    """Parameters of `estimate_kinematics`."""

    half: ServoStep  # half a period
    wheelbase: float  # m
    track: float  # m
    period: float  # s
    wander: Kinematics  # variance that every period adds
    doubt: Kinematics  # likewise, for every unit by which the poses surprise too much
    swerve: float  # part of δ that is left after a period
    speed: float  # variances of the sensors: (m/s)², mean of the wheels
    difference: float  # (m/s)², of the wheels
    wheel_slip: float  # standard deviation, part of the speed
    per_load: float  # 1 / ρ
    steering: float  # rad²
    gyro: float  # (rad/s)²
    position: float  # m²
    heading: float  # rad²
    gate: float  # square of the largest normalised innovation of a pose
    surprising: float  # likewise of wheels and gyro, beyond which they lose weight
    patience: float  # number of poses in a row that are not believed before one is
    gates: GateParameters


SURPRISING = 5.0  # standard deviations, beyond which wheels and gyro lose weight
STARTLING = 1e3  # normalised innovation squared, per reading, of the most surprising pose
CALM = 1.5  # mean square of normalised innovations up to which nothing is doubted


@kernel
def yaw(m: Kinematics, p: EkfParameters) -> Any:
    """Yaw rate ω without δ, and its slopes along φ (and b), v and k."""
    tangent = tan(m.steering_angle + m.steering_bias)
    base = effective_base(m, p)
    rate = m.speed * tangent / base
    per_angle = m.speed * (1.0 + tangent * tangent) / base
    per_speed = tangent * (2.0 * p.wheelbase - base) / (base * base)
    return rate, per_angle, per_speed, -rate * m.speed * m.speed / base


@kernel
def effective_base(m: Kinematics, p: EkfParameters) -> float:
    """Wheelbase (m) of the twin that steers as the robot does: a + k v²."""
    base = p.wheelbase + m.understeer * m.speed * m.speed
    least = 0.5 * p.wheelbase
    return base if base > least else least


@kernel
def step_forward(m: Kinematics, told: Told, p: EkfParameters) -> Any:
    """The state one period later, and the slopes of that map."""
    rate, _, _, _ = yaw(m, p)
    course = m.heading - m.slip * m.speed * (rate + m.swerve)
    base = effective_base(m, p)
    pipe = PipeParameters(p.half, base, p.period, 0.0)
    begin = Pose(
        m.x, m.y, course, m.speed, Steering(m.steering_angle + m.steering_bias, m.steering_rate)
    )
    end = roll(begin, told.steering_angle + m.steering_bias, told.acceleration, pipe)
    angle = end.steering.angle - m.steering_bias
    after = Kinematics(
        end.x, end.y, m.heading + (end.heading - course) + p.period * m.swerve, end.speed, angle,
        end.steering.rate, m.steering_bias, m.speed_scale, m.gyro_bias, m.slip, m.understeer,
        p.swerve * m.swerve,
    )  # fmt: skip
    middle = Kinematics(
        0.0, 0.0, 0.0, 0.5 * (m.speed + end.speed), 0.5 * (m.steering_angle + angle), 0.0,
        m.steering_bias, 0.0, 0.0, 0.0, m.understeer, 0.0,
    )  # fmt: skip
    omega, per_angle, per_speed, per_understeer = yaw(middle, p)
    sine, cosine = sincos(0.5 * (course + end.heading))
    t = p.period
    way = t * middle.speed
    h = p.half
    slopes = Slopes(
        x_heading=-way * sine,
        x_speed=t * cosine,
        x_slip=way * middle.speed * omega * sine,
        y_heading=way * cosine,
        y_speed=t * sine,
        y_slip=-way * middle.speed * omega * cosine,
        turn=t * per_angle,
        turn_rate=0.5 * t * t * per_angle,
        turn_speed=t * per_speed,
        turn_understeer=t * per_understeer,
        turn_swerve=t,
        swerve=p.swerve,
        e11=h.e11 * h.e11 + h.e12 * h.e21,
        e12=h.e11 * h.e12 + h.e12 * h.e22,
        e21=h.e21 * h.e11 + h.e22 * h.e21,
        e22=h.e21 * h.e12 + h.e22 * h.e22,
    )
    return after, slopes


@kernel
def speed_clue(m: Kinematics, z: Measurement, acceleration: float, p: EkfParameters) -> Clue:
    """The mean of both drive wheels' encoders: (1 + g) (1 + c v̇ / ρ) v, ρ being their share of the load.

    The same tyres slip along as across; what they do besides makes the reading less certain.
    """
    traction = acceleration * p.per_load
    tread = 1.0 + m.slip * traction
    scale = (1.0 + m.speed_scale) * tread
    slip = p.wheel_slip * m.speed
    slope = axpy(scale, UNITS.speed, axpy(m.speed * tread, UNITS.speed_scale, ZERO))
    slope = axpy((1.0 + m.speed_scale) * m.speed * traction, UNITS.slip, slope)
    miss = 0.5 * (z.left + z.right) - scale * m.speed
    return Clue(slope, miss, p.speed + slip * slip, p.surprising)


@kernel
def difference_clue(m: Kinematics, z: Measurement, p: EkfParameters) -> Clue:
    """Their difference: (1 + g) d ω, less certain because tyres under different loads slip differently."""
    steered, per_angle, per_speed, per_understeer = yaw(m, p)
    rate = steered + m.swerve
    scale = 1.0 + m.speed_scale
    arm = scale * p.track
    slope = Kinematics(
        0.0, 0.0, 0.0, arm * per_speed, arm * per_angle, 0.0, arm * per_angle, p.track * rate, 0.0,
        0.0, arm * per_understeer, arm,
    )  # fmt: skip
    return Clue(slope, z.right - z.left - arm * rate, p.difference, p.surprising)


@kernel
def gyro_clue(m: Kinematics, reading: float, p: EkfParameters) -> Clue:
    """The gyro: ω + β."""
    rate, per_angle, per_speed, per_understeer = yaw(m, p)
    slope = Kinematics(
        0.0, 0.0, 0.0, per_speed, per_angle, 0.0, per_angle, 0.0, 1.0, 0.0, per_understeer, 1.0
    )
    return Clue(slope, reading - rate - m.swerve - m.gyro_bias, p.gyro, p.surprising)


@kernel
def place_then(trail: Any, instants: float) -> Place:
    """Where dead reckoning was so many instants ago; the trail goes back far enough."""
    x, y, heading = 0.0, 0.0, 0.0
    for n in range(len(trail)):
        near = 1.0 - abs(instants - n)
        near = near if near > 0.0 else 0.0
        x = x + near * trail[n].x
        y = y + near * trail[n].y
        heading = heading + near * trail[n].heading
    return Place(x, y, heading)


@kernel
def fix_innovation(m: Kinematics, trail: Any, fix: Fix, p: EkfParameters) -> Any:
    """What a pose is off from where the robot was then, and the way driven since (m, ahead and aside)."""
    now = trail[0]
    then = place_then(trail, fix.age / p.period)
    sine, cosine = sincos(then.heading)
    dx, dy = now.x - then.x, now.y - then.y
    along, aside = dx * cosine + dy * sine, dy * cosine - dx * sine
    heading = m.heading - (now.heading - then.heading)
    sine, cosine = sincos(heading)
    ahead_x, ahead_y = along * cosine - aside * sine, along * sine + aside * cosine
    off = Place(fix.x - (m.x - ahead_x), fix.y - (m.y - ahead_y), wrap_angle(fix.heading - heading))
    return off, Place(ahead_x, ahead_y, 0.0)


@kernel
def fits(off: Place, c: Covariance, p: EkfParameters) -> bool:
    """Whether a pose is within its gate; false without one."""
    x = off.x * off.x <= p.gate * (c.x.x + p.position)
    y = off.y * off.y <= p.gate * (c.y.y + p.position)
    return x and y and off.heading * off.heading <= p.gate * (c.heading.heading + p.heading)


@kernel
def agrees(off: Place, before: Place, p: EkfParameters) -> bool:
    """Whether two poses are off by the same."""
    dx, dy = off.x - before.x, off.y - before.y
    turned = wrap_angle(off.heading - before.heading)
    near = dx * dx + dy * dy <= 2.0 * p.gate * p.position
    return near and turned * turned <= 2.0 * p.gate * p.heading


@kernel
def fix_clues(off: Place, ahead: Place, taken: bool, p: EkfParameters) -> Any:
    """The three readings of a pose, taken in or left out together."""
    lost = 0.0 if taken else math.nan
    far = math.inf
    return (
        Clue(axpy(ahead.y, UNITS.heading, UNITS.x), off.x + lost, p.position, far),
        Clue(axpy(-ahead.x, UNITS.heading, UNITS.y), off.y + lost, p.position, far),
        Clue(UNITS.heading, off.heading + lost, p.heading, far),
    )


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


class Ekf(Spec):
    """The estimator of this package; its noises are standard deviations.

    A standard deviation of 0 for bias, scale, slip or understeer takes that state out: it stays 0.
    """

    kind: Literal["ekf"] = "ekf"
    position_noise: float = quantity("m", "of a measured position, each axis", default=0.01, gt=0)
    heading_noise: float = quantity("rad", "of a measured heading", default=0.0087, gt=0)
    wheel_noise: float = quantity("m/s", "of each wheel's encoder", default=0.007, gt=0)
    wheel_slip: float = quantity(
        "1", "of the drive wheels' slip under traction, part of the speed", default=0.005, ge=0
    )
    tyre_noise: float = quantity(
        "m/s", "of the drive wheels' difference, for tyres that slip", default=0.03, ge=0
    )
    steering_noise: float = quantity("rad", "of the steering encoder", default=0.00175, gt=0)
    gyro_noise: float = quantity("rad/s", "of the gyro", default=0.002, gt=0)
    steering_bias: float = quantity("rad", "of the unknown steering offset", default=0.02, ge=0)
    speed_scale: float = quantity("1", "of the unknown wear of the wheels", default=0.02, ge=0)
    gyro_bias: float = quantity("rad/s", "of the gyro's unknown bias", default=0.01, ge=0)
    slip: float = quantity("rad s²/m", "of the unknown rear slip c", default=0.002, ge=0)
    understeer: float = quantity("rad s²/m", "of the unknown understeer k", default=0.001, ge=0)
    bias_drift: float = quantity(
        "1/s^0.5", "of bias, scale and slip per root second, part of their own deviation",
        default=0.002, ge=0,
    )  # fmt: skip
    pose_drift: float = quantity("m/s^0.5", "of the pose that nothing explains", default=3e-4, ge=0)
    heading_drift: float = quantity("rad/s^0.5", "of the heading", default=5e-5, ge=0)
    acceleration_noise: float = quantity("m/s^1.5", "of the speed", default=0.1, ge=0)
    servo_noise: float = quantity("rad/s^1.5", "of the steering rate", default=0.05, ge=0)
    swerve: float = quantity(
        "rad/s", "of the yaw rate that steering does not explain", default=0.01, ge=0
    )
    swerve_time: float = quantity("s", "in which that forgets itself", default=0.1, gt=0)
    doubt: float = quantity(
        "m/s^0.5",
        "of the pose, when poses surprise twice as much as they should",
        default=1e-3,
        ge=0,
    )
    gate: float = quantity(
        "1", "largest innovation that is believed, in standard deviations", default=5.0, gt=1
    )
    patience: int = quantity(
        "1", "poses in a row that are not believed, before one is", default=3, ge=0
    )
    history: float = quantity("s", "how late a pose may arrive", default=0.06, ge=0, le=1)

    def part(self, robot: Tricycle, start: Start, period: float) -> EstimatorPart:
        """Kernel, parameters and initial belief of a robot that stands about where it is said to."""
        q = self.bias_drift**2 * period
        left = math.exp(-period / self.swerve_time)
        slow = {
            name: getattr(self, name)
            for name in ("steering_bias", "speed_scale", "gyro_bias", "slip", "understeer")
        }
        wander = Kinematics(
            x=self.pose_drift**2 * period,
            y=self.pose_drift**2 * period,
            heading=self.heading_drift**2 * period,
            speed=self.acceleration_noise**2 * period,
            steering_angle=0.0,
            steering_rate=self.servo_noise**2 * period,
            **{name: q * deviation**2 for name, deviation in slow.items()},
            swerve=self.swerve**2 * (1.0 - left**2),
        )
        vague = period * self.doubt**2
        doubt = ZERO._replace(
            x=vague, y=vague, heading=vague / robot.wheelbase**2, speed=vague, swerve=vague
        )
        parameters = EkfParameters(
            half=robot.actuators.servo(0.5 * period),
            wheelbase=robot.wheelbase,
            track=robot.track_width,
            period=period,
            wander=wander,
            doubt=doubt,
            swerve=left,
            speed=0.5 * self.wheel_noise**2,
            wheel_slip=self.wheel_slip,
            per_load=1.0 / max(0.1, 1.0 - robot.centre_ahead / robot.wheelbase),
            difference=2.0 * self.wheel_noise**2 + self.tyre_noise**2,
            steering=self.steering_noise**2,
            gyro=self.gyro_noise**2,
            position=self.position_noise**2,
            heading=self.heading_noise**2,
            gate=self.gate**2,
            surprising=SURPRISING**2,
            patience=float(self.patience),
            gates=self._gates(robot, period),
        )
        return EstimatorPart(estimate_kinematics, parameters, self._belief(robot, start, period))

    def jitter(self, robot: Tricycle, period: float) -> Jitter:
        """By how much the pose changes at a decision because of noise alone: one pose's correction.

        In the steady state of a scalar filter with process variance q and measurement variance r, the
        correction has the standard deviation p / √(p + r), with p = (q + √(q² + 4 q r)) / 2.
        """

        def step(process: float, noise: float) -> float:
            q, r = process**2 * period, noise**2
            p = 0.5 * (q + math.sqrt(q * q + 4.0 * q * r))
            return p / math.sqrt(p + r)

        turning = math.hypot(self.heading_drift, self.swerve * math.sqrt(2.0 * self.swerve_time))
        return Jitter(step(self.pose_drift, self.position_noise), step(turning, self.heading_noise))

    def _gates(self, robot: Tricycle, period: float) -> GateParameters:
        act = robot.actuators
        return GateParameters(
            period=period,
            history=self.history,
            track=robot.track_width,
            wheelbase=robot.wheelbase,
            wheels=0.5,
            part=0.3,
            gyro=0.75,
            steering=0.12 + 5.0 * self.steering_noise,
            turning=0.15 + 5.0 * self.steering_noise,
            lock=act.steering_angle_limit + 0.1 + 5.0 * self.steering_noise,
            swing=1.5 * act.steering_rate_limit * period + 0.03,
        )

    def _belief(self, robot: Tricycle, start: Start, period: float) -> Belief:
        angle = math.atan(robot.wheelbase * start.curvature)
        mean = ZERO._replace(
            x=float(start.x), y=float(start.y), heading=float(start.heading),
            speed=float(start.speed), steering_angle=angle,
        )  # fmt: skip
        deviations = Kinematics(
            self.position_noise, self.position_noise, self.heading_noise, 0.01,
            self.steering_noise, 0.01, self.steering_bias, self.speed_scale, self.gyro_bias,
            self.slip, self.understeer, self.swerve,
        )  # fmt: skip
        rows = (
            Kinematics(*(d * d * entry for entry in unit))
            for d, unit in zip(deviations, UNITS, strict=True)
        )
        instants = math.ceil(self.history / period - 1e-9) + 1
        trail = (Place(0.0, 0.0, 0.0),) * (1 << (instants - 1).bit_length())
        evidence = TRUSTED._replace(located=0.0)
        nowhere = Place(0.0, 0.0, 0.0)
        return Belief(
            mean, Covariance(*rows), trail, evidence, UNHEARD, Heard(0.0, 0.0), 0.0, nowhere, 3.0
        )
