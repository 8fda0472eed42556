"""`Stepper` in closed loop with a robot of the tests' own, and what must hold at every step."""

from collections import Counter
from dataclasses import dataclass, field
from random import Random

import numpy as np

from control.kinematic import IDLE, Corrupter, Robot, Senses, Span
from osculate import (
    CurvatureTracker,
    Ekf,
    FeedforwardLqr,
    Kanayama,
    Limits,
    PreviewLqr,
    PurePursuit,
    Safety,
    Stanley,
    Stepper,
)
from osculate.kernel import leaves, rebuild
from osculate.study.comparison.suite import CURVES
from osculate.vehicle.catalogue import VEHICLES
from osculate.vehicle.measurement import Measurement
from osculate.vehicle.motion import Motion

PERIOD = 0.01  # s
WIDTH = 0.3  # m, half width of the corridor
SLACK = 1e-9
MOVES = 0.05  # m/s, faster than a robot at rest
LAWS = {
    "curvature-tracker": CurvatureTracker, "lqr-preview": PreviewLqr, "pure-pursuit": PurePursuit,
    "lqr": FeedforwardLqr, "kanayama": Kanayama, "stanley": Stanley,
}  # fmt: skip
SPEEDS = {"paper": 1.0, "tugger": 0.8, "forklift": 0.8}  # m/s, from which physics can stop in time
MOTION = Motion._fields
SENSED = ("left", "right", "steering_angle", "yaw_rate", "x", "y", "heading", "age")


@dataclass
class Case:
    """A stepper that can be put back to its beginning, and where its memory holds what."""

    law: str
    estimates: bool
    guarded: bool
    robot: str = "paper"
    curve: str = "slalom"
    speed: float | None = None
    delay: float = 0.01
    width: float = WIDTH

    def __post_init__(self):
        self.vehicle, self.path = VEHICLES[self.robot], CURVES[self.curve]
        self.stepper = Stepper(
            LAWS[self.law](), self.path, self.vehicle,
            Limits(speed=self.speed or SPEEDS[self.robot]), period=PERIOD, delay=self.delay,
            estimator=Ekf() if self.estimates else None,
            safety=Safety(half_width=self.width) if self.guarded else None,
        )  # fmt: skip
        self.beginning = self.stepper._memory.copy()
        whole = self.stepper._whole
        count = len(list(leaves(whole)))
        where = rebuild(whole, iter(range(count)))
        law = where.law if self.estimates else where
        self.reason, self.resting = law.stop.alarm.reason, law.stop.resting
        self.foreseen = law.expected.speed
        s = np.linspace(0.0, self.path.length, 4000)
        point = self.path.at(s)
        self.points = np.stack([point.x, point.y])
        self.ends = tuple((float(self.points[0, n]), float(self.points[1, n])) for n in (0, -1))

    def begin(self):
        """A robot at rest at the start of the curve, and a stepper that knows nothing."""
        self.stepper._memory = self.beginning.copy()
        start = self.path.at(0.0)
        angle = float(np.arctan(self.vehicle.wheelbase * start.curvature))
        place = float(start.x), float(start.y), float(start.heading)
        return Robot(self.vehicle, *place, angle=angle)

    def away(self, robots):
        """Distances (m) of places from the curve."""
        place = np.array(robots)
        gaps = [np.hypot(*(self.points - p[:, None])).min() for p in place]
        return np.array(gaps)


@dataclass
class Watch:
    """Counts what must not be, at every step."""

    case: Case
    counts: Counter = field(default_factory=Counter)
    last: object = None  # command
    widest: float = 0.0  # m, largest distance from the curve
    robot: object = None
    stopped: bool = False
    rested: bool = False

    def check(self, command, located):
        """Look at one command and at the memory behind it."""
        act, stepper = self.case.vehicle.actuators, self.case.stepper
        finite = np.isfinite(command).all()
        self.counts["command not finite"] += not finite
        self.counts["memory not finite"] += not np.isfinite(stepper._memory).all()
        angle, left, right, brake = command
        step = abs(angle - self.last.steering_angle) if self.last else 0.0
        self.counts["over the angle"] += abs(angle) > act.steering_angle_limit + SLACK
        self.counts["over the rate"] += step > act.steering_rate_limit * PERIOD + SLACK
        torque = max(abs(left), abs(right))
        self.counts["over the torque"] += torque > act.torque_limit + SLACK
        self.counts["over the brake"] += not -SLACK <= brake <= 1.0 + SLACK
        self.counts["drive before a pose"] += not located and torque > 0.0
        reason = stepper._memory[self.case.reason, 0]
        resting = stepper._memory[self.case.resting, 0] > 0.0
        self.counts["stop not final"] += self.stopped and reason == 0.0
        self.counts["rest not final"] += self.rested and not resting
        self.counts["drive at rest"] += resting and torque > 0.0
        self.stopped, self.rested = self.stopped or reason > 0.0, self.rested or resting
        self.last = command


def episode(case, seed, steps, **drawn):
    """One run with something wrong: what was counted, and the corrupter."""
    random = Random(seed)
    robot = case.begin()
    noise, latency = random.choice((0.0, 1.0)), random.choice((0, 0, 3))
    senses = Senses(robot, random, noise=noise, latency=latency)
    names = SENSED if case.estimates else MOTION
    corrupter = Corrupter.drawn(random, names, steps, **drawn)
    return run(case, robot, senses, corrupter, steps), corrupter


def run(case, robot, senses, corrupter, steps, disturb=None):
    """A closed loop; returns its `Watch`."""
    watch, places, located = Watch(case), [], False
    acting = IDLE._replace(steering_angle=robot.angle)
    for n in range(steps):
        true = senses.measure() if case.estimates else robot.motion
        measured = corrupter.spoil(true, n) if corrupter else true
        located = located or readable(measured)
        if disturb:
            disturb(n, robot, case.stepper)
        command = case.stepper.step(measured)
        watch.check(command, located)
        robot.move(acting if case.delay else command, PERIOD)
        acting = command
        places.append((robot.x, robot.y))
    gaps = case.away(places[::5])
    watch.robot, watch.widest = robot, float(gaps.max())
    watch.counts["corridor exits"] += case.guarded and watch.widest > case.width
    watch.counts["moves after a stop"] += watch.rested and abs(robot.speed) > MOVES
    watch.counts["steps"] += steps
    return watch


def corrected(robot, curve, speed, width, *, estimates, seed):
    """Message of the stop of a robot whose poses are corrected by 2 to 5 cm now and then; empty if none.

    A correction is a step of what is measured: the robot is where it is believed to be only afterwards.
    """
    case = Case("curvature-tracker", estimates, True, robot, curve, speed, width=width)
    random = Random(seed)
    driven, spans = case.begin(), []
    steps = int(min(case.path.length / speed * 1.6 + 4.0, 60.0) / PERIOD)
    for begin in range(200, steps, 400):
        size = random.choice((-1.0, 1.0)) * random.uniform(0.02, 0.05)
        name = random.choice(("x", "y"))
        spans.append(Span(name, "jump", begin, begin + 200, size))
    run(case, driven, Senses(driven, random), Corrupter(tuple(spans), random), steps)
    return case.stepper.message if case.stepper.stopping else ""


def faults_of(watch):
    """What was counted and must not be: name to count."""
    counts = watch if isinstance(watch, Counter) else watch.counts
    return {name: count for name, count in counts.items() if count and name != "steps"}


def readable(measured):
    """Whether a pose could be in a measurement."""
    values = (measured.fix or (None,)) if isinstance(measured, Measurement) else measured
    return all(v is not None and np.isfinite(v) for v in values)
