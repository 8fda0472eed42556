"""A robot in plain Python, what its sensors say, and everything that can be wrong with that.

Nothing here uses the package's kernels or plants: it is the other side of the door that `Stepper` is.
"""

import math
from dataclasses import dataclass, field
from random import Random

from osculate.vehicle.measurement import NO_FIX, Fix, Measurement
from osculate.vehicle.motion import Command, Motion

SUBSTEPS = 4
KINDS = (
    "nan", "none", "+inf", "-inf", "+1e300", "-1e300", "spike", "frozen", "jump", "age < 0",
    "age > history", "age nan", "twice", "out of order", "no fix",
)  # fmt: skip
OF_AGE = {"age < 0": -1e-3, "age > history": 0.5, "age nan": math.nan}
VALUES = {
    "nan": math.nan, "none": None, "+inf": math.inf, "-inf": -math.inf, "+1e300": 1e300,
    "-1e300": -1e300,
}  # fmt: skip
OF_FIX = ("twice", "out of order", "no fix", *OF_AGE)  # kinds that concern a pose as a whole
READINGS = ("left", "right", "steering_angle", "yaw_rate")
SIZES = {  # of jumps and spikes that no robot makes
    "x": 2.0, "y": 2.0, "heading": 1.0, "speed": 2.0, "left": 2.0, "right": 2.0,
    "yaw_rate": 5.0, "steering_angle": 0.8,
}  # fmt: skip


def clip(value, limit):
    return max(-limit, min(limit, value))


@dataclass
class Robot:
    """A tricycle that rolls without slip: servo with limits, motors that lag, mass, brake."""

    vehicle: object
    x: float
    y: float
    heading: float
    angle: float = 0.0  # rad, steering
    speed: float = 0.0  # m/s
    rate: float = 0.0  # rad/s, of the steering
    torque: float = 0.0  # N m, both wheels
    blocked: bool = False  # whether something holds the wheels
    stuck: bool = False  # whether the servo ignores its commands

    @property
    def motion(self):
        turn = self.speed * math.tan(self.angle) / self.vehicle.wheelbase
        return Motion(self.x, self.y, self.heading, self.speed, turn, self.angle)

    def move(self, command, period):
        """A period under a command."""
        for _ in range(SUBSTEPS):
            self._steer(command.steering_angle, period / SUBSTEPS)
            self._drive(command, period / SUBSTEPS)
            self._roll(period / SUBSTEPS)

    def _steer(self, wanted, h):
        act = self.vehicle.actuators
        w = act.steering_frequency
        away = clip(wanted, act.steering_angle_limit) - self.angle
        if self.stuck:
            self.rate = 0.0
            return
        self.rate += h * (w * w * away - 2.0 * act.steering_damping * w * self.rate)
        self.rate = clip(self.rate, act.steering_rate_limit)
        self.angle = clip(self.angle + h * self.rate, act.steering_angle_limit)

    def _drive(self, command, h):
        v, act = self.vehicle, self.vehicle.actuators
        wanted = clip(command.torque_left, act.torque_limit)
        wanted += clip(command.torque_right, act.torque_limit)
        self.torque += (1.0 - math.exp(-h / act.motor_lag)) * (wanted - self.torque)
        mass = v.total_mass + 2.0 * v.wheel_inertia / v.wheel_radius**2
        mass += v.turn_inertia * (math.tan(self.angle) / v.wheelbase) ** 2
        speed = self.speed + h * self.torque / v.wheel_radius / mass
        drag = act.rolling_resistance * v.weight / mass
        if v.brake:
            held = v.brake.holding_torque / v.wheel_radius / mass
            moving = abs(self.speed) > 1e-3
            drag += command.brake * (v.brake.deceleration if moving else held)
        self.speed = math.copysign(max(abs(speed) - h * drag, 0.0), speed)
        if self.blocked:
            self.speed = 0.0

    def _roll(self, h):
        turn = h * self.speed * math.tan(self.angle) / self.vehicle.wheelbase
        middle = self.heading + 0.5 * turn
        self.x += h * self.speed * math.cos(middle)
        self.y += h * self.speed * math.sin(middle)
        self.heading += turn


@dataclass
class Senses:
    """Sensors of a robot: noise, and poses that take their time."""

    robot: Robot
    random: Random
    noise: float = 1.0  # of Gaussian noise, per that of `Sensors`
    every: int = 2  # instants between two poses
    latency: int = 0  # instants from a pose to its arrival
    period: float = 0.01  # s
    instant: int = 0
    taken: list = field(default_factory=list)

    def measure(self):
        """The measurement of this instant."""
        m, g = self.robot.motion, self._gauss
        half = 0.5 * self.robot.vehicle.track_width * m.yaw_rate
        if self.instant % self.every == 0:
            pose = (m.x + g(0.01), m.y + g(0.01), m.heading + g(0.0087))
            self.taken.append((self.instant, pose))
        fix = NO_FIX
        if self.taken and self.taken[0][0] + self.latency <= self.instant:
            then, pose = self.taken.pop(0)
            fix = Fix(*pose, (self.instant - then) * self.period)
        self.instant += 1
        return Measurement(
            m.speed - half + g(0.007), m.speed + half + g(0.007),
            m.steering_angle + g(0.00175), m.yaw_rate + 0.005 * self.noise + g(0.002), fix,
        )  # fmt: skip

    def _gauss(self, deviation):
        return self.random.gauss(0.0, deviation * self.noise) if self.noise else 0.0


@dataclass(frozen=True)
class Span:
    """One thing that is wrong with one field for some time."""

    name: str  # of the field
    kind: str
    begin: int  # instant
    end: int
    size: float  # of a spike or jump


@dataclass
class Corrupter:
    """Puts spans of wrong values into motions or measurements."""

    spans: tuple
    random: Random
    held: dict = field(default_factory=dict)  # what frozen fields showed at first
    fixes: list = field(default_factory=list)  # delivered so far

    @staticmethod
    def drawn(random, names, steps, many=3, longest=150, kinds=KINDS):
        """At most ``many`` spans in random fields, of random kinds and lengths."""
        spans = []
        for _ in range(random.randint(1, many)):
            name, kind = random.choice(names), random.choice(kinds)
            begin = random.randrange(steps)
            end = begin + random.choice((1, 2, 5, 20, random.randint(1, longest), steps))
            size = random.choice((-1.0, 1.0)) * random.uniform(0.6, 2.0) * SIZES.get(name, 1.0)
            spans.append(Span(name, kind, begin, end, size))
        return Corrupter(tuple(spans), random)

    def spoil(self, measured, n):
        """What arrives at instant ``n`` in place of ``measured``."""
        for span in self.spans:
            if span.begin <= n < span.end:
                measured = self._spoil(measured, n, span)
        if isinstance(measured, Measurement) and measured.fix is not None:
            self.fixes.append(measured.fix)
        return measured

    def _spoil(self, measured, n, span):
        if isinstance(measured, Motion):
            name = span.name if span.name in Motion._fields else "speed"
            return self._field(measured, name, n, span)
        if span.kind in OF_FIX:
            return measured._replace(fix=self._fix(measured.fix, span.kind))
        if span.name in READINGS:
            return self._field(measured, span.name, n, span)
        fix = NO_FIX if measured.fix is None else measured.fix
        name = span.name if span.name in Fix._fields else "x"
        return measured._replace(fix=self._field(fix, name, n, span))

    def _field(self, whole, name, n, span):
        value = getattr(whole, name)
        if span.kind in VALUES:
            value = VALUES[span.kind]
        elif span.kind == "frozen":
            value = self._frozen(value, span)
        elif value is not None and (span.kind == "jump" or span.kind == "spike"):
            rare = span.kind == "spike" and (n - span.begin) % 7
            value = value if rare else value + span.size
        return whole._replace(**{name: value})

    def _frozen(self, value, span):
        first = self.held.get(span)
        if first is None or first != first:
            self.held[span] = first = value
        return first

    def _fix(self, fix, kind):
        if kind == "no fix":
            return None
        if kind in OF_AGE:
            return None if fix is None else fix._replace(age=OF_AGE[kind])
        if not self.fixes:
            return fix
        return self.fixes[-1] if kind == "twice" else self.random.choice(self.fixes[-8:])


#: No command acts yet.
IDLE = Command(0.0, 0.0, 0.0, 0.0)
