"""Sensors: what a robot reports of its motion, with noise, latency, gaps and outliers.

Every random number is a function of the seed, the number of the instant and the sensor, so that a run is
reproduced in any order and in any company. A pose waits as long as its way to the robot takes; poses may
overtake each other, and at most one arrives at an instant.
"""

import math
from typing import Any, Literal, NamedTuple

from osculate.errors import InvalidInput
from osculate.kernel import Nothing, kernel, normals, select, uniforms
from osculate.kernel.maths import TWO_PI, sincos
from osculate.spec import Spec, quantity
from osculate.vehicle.measurement import Fix, Measurement
from osculate.vehicle.motion import Motion, Wheels

NEVER = -1.0  # instant at which a lost pose arrives


class Outage(NamedTuple):
    """When a sensor reports nothing."""

    begin: float  # s
    end: float  # s


class Outages(NamedTuple):
    """The outage of every sensor."""

    pose: Outage
    wheels: Outage
    steering: Outage
    gyro: Outage


class SensorParameters(NamedTuple):
    """Parameters of `sense_noisily`."""

    seed: float
    every: float  # instants between two poses
    period: float  # s
    position: float  # m, standard deviations
    heading: float  # rad
    wheel: float  # m/s
    steering: float  # rad
    gyro: float  # rad/s
    gyro_bias: float  # rad/s
    latency: float  # s
    jitter: float  # s
    dropout: float  # probability
    outliers: float  # probability
    outlier_size: float  # m
    outages: Outages


class Waiting(NamedTuple):
    """A pose on its way."""

    taken: float  # number of the instant
    due: float  # number of the instant at which it arrives
    x: float  # m
    y: float  # m
    heading: float  # rad


class SensorMemory(NamedTuple):
    """Memory of `sense_noisily`."""

    instant: float  # number of the next instant
    waiting: Any  # tuple of `Waiting`, the newest first


@kernel
def sense_exactly(motion: Motion, wheels: Wheels, memory: Nothing, p: Nothing) -> Any:
    """The motion itself, for a law that knows it."""
    return motion, memory


@kernel
def reported(value: float, t: float, outage: Outage) -> float:
    """A reading; not a number during the outage."""
    return math.nan if outage.begin <= t < outage.end else value


@kernel
def take_pose(n: float, motion: Motion, waiting: Any, p: SensorParameters) -> Waiting:
    """A pose measured at instant ``n``, and when it will arrive: at an instant of its own."""
    x, y, heading, _ = normals(p.seed, n, 1.0)
    lost, wild, late, way = uniforms(p.seed, n, 2.0)
    sine, cosine = sincos(TWO_PI * way)
    jump = p.outlier_size if wild < p.outliers else 0.0
    wait = (p.latency + p.jitter * late) / p.period
    due = n + float(int(wait + 0.999999))
    for _ in range(len(waiting)):
        for other in range(len(waiting)):
            due = due + (1.0 if waiting[other].due == due else 0.0)
    t = n * p.period
    gone = lost < p.dropout or (p.outages.pose.begin <= t < p.outages.pose.end)
    return Waiting(
        n,
        NEVER if gone else due,
        motion.x + p.position * x + jump * cosine,
        motion.y + p.position * y + jump * sine,
        motion.heading + p.heading * heading,
    )


@kernel
def sense_noisily(motion: Motion, wheels: Wheels, memory: SensorMemory, p: SensorParameters) -> Any:
    """The measurement of this instant, and the sensors' memory."""
    n = memory.instant
    t = n * p.period
    left, right, steering, gyro = normals(p.seed, n, 0.0)
    phase = n / p.every
    due = phase - float(int(phase)) < 1.0 / p.every - 1e-9
    taken = take_pose(n, motion, memory.waiting, p)
    waiting = select(due, (taken,) + memory.waiting[:-1], memory.waiting)
    fix = Fix(math.nan, math.nan, math.nan, 0.0)
    for m in range(len(waiting)):
        w = waiting[m]
        fix = select(w.due == n, Fix(w.x, w.y, w.heading, (n - w.taken) * p.period), fix)
    out = p.outages
    measurement = Measurement(
        reported(wheels.left + p.wheel * left, t, out.wheels),
        reported(wheels.right + p.wheel * right, t, out.wheels),
        reported(motion.steering_angle + p.steering * steering, t, out.steering),
        reported(motion.yaw_rate + p.gyro_bias + p.gyro * gyro, t, out.gyro),
        fix,
    )
    return measurement, SensorMemory(n + 1.0, waiting)


class Sensors(Spec):
    """Pose from outside, encoders of drive wheels and steering, gyro; noises are standard deviations."""

    kind: Literal["noisy"] = "noisy"
    seed: int = quantity("1", "of all random numbers", default=1, ge=0, lt=2**53)
    pose_rate: float = quantity("Hz", "how often a pose is measured", default=50.0, gt=0)
    position_noise: float = quantity("m", "of the position, each axis", default=0.01, ge=0)
    heading_noise: float = quantity("rad", "of the heading", default=0.0087, ge=0)
    pose_latency: float = quantity("s", "from a pose to its arrival", default=0.0, ge=0)
    pose_jitter: float = quantity("s", "largest random addition to it", default=0.0, ge=0)
    pose_dropout: float = quantity("1", "probability that a pose is lost", default=0.0, ge=0, le=1)
    pose_outliers: float = quantity(
        "1", "probability that a pose is wrong", default=0.0, ge=0, le=1
    )
    outlier_size: float = quantity("m", "by how much it then is", default=0.5, ge=0)
    wheel_noise: float = quantity("m/s", "of each drive wheel's encoder", default=0.007, ge=0)
    steering_noise: float = quantity("rad", "of the steering encoder", default=0.00175, ge=0)
    gyro_noise: float = quantity("rad/s", "of the gyro", default=0.002, ge=0)
    gyro_bias: float = quantity("rad/s", "of the gyro: what it reports at rest", default=0.005)
    gyro: bool = quantity("1", "whether there is one", default=True)

    @property
    def latest(self) -> float:
        """How late (s) a pose may be, unless too many arrive at once."""
        return self.pose_latency + self.pose_jitter

    def part(self, period: float, outages: Outages) -> "tuple[SensorParameters, SensorMemory]":
        """Parameters and initial memory.

        Raises:
            InvalidInput: Poses more often than instants.
        """
        every = 1.0 / (self.pose_rate * period)
        if every < 1.0 - 1e-9:
            message = f"must not exceed the clock's rate of {1.0 / period:.6g} Hz"
            raise InvalidInput("sensors.pose_rate", self.pose_rate, message)
        silent = outages if self.gyro else outages._replace(gyro=Outage(0.0, math.inf))
        parameters = SensorParameters(
            seed=float(self.seed),
            every=every,
            period=period,
            position=self.position_noise,
            heading=self.heading_noise,
            wheel=self.wheel_noise,
            steering=self.steering_noise,
            gyro=self.gyro_noise,
            gyro_bias=self.gyro_bias,
            latency=self.pose_latency,
            jitter=self.pose_jitter,
            dropout=self.pose_dropout,
            outliers=self.pose_outliers,
            outlier_size=self.outlier_size,
            outages=silent,
        )
        under_way = math.ceil(self.latest / (every * period)) + 1
        slots = 1 << under_way.bit_length()
        return parameters, SensorMemory(0.0, (Waiting(-1.0, NEVER, 0.0, 0.0, 0.0),) * slots)
