"""Faults and disturbances: composable pieces, each of which changes one thing of the world.

Any number of them acts together, on any plant that has what they change. Random ones are seeded.
"""

import math
from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from pydantic import Field

from osculate.errors import InvalidInput
from osculate.plant.contract import Plant
from osculate.plant.sensors import Outage, Outages
from osculate.plant.tyre import Patch
from osculate.plant.weather import STILL, Blow, Impairment
from osculate.spec import Spec, quantity

SILENT = Outage(math.inf, math.inf)
#: No sensor is silent.
HEARD = Outages(SILENT, SILENT, SILENT, SILENT)
#: Actuators that do what they are told.
WELL = Impairment(math.inf, math.inf, 1.0, math.inf, 1.0)
REMEDY = "must act along the robot, or on the plant Slip(...) or Mujoco(...)"
STREAMS = 16  # random streams below this one belong to sensors


@dataclass(frozen=True)
class World:
    """What a run takes place in: the plant and everything that is wrong with it."""

    plant: Plant
    delay: float = 0.0  # s, that no law knows
    outages: Outages = HEARD
    blows: tuple[Blow, ...] = ()
    impairment: Impairment = WELL

    @property
    def calm(self) -> bool:
        """Whether nothing pushes the robot and its actuators do what they are told."""
        return not self.blows and self.impairment == WELL

    @property
    def padded_blows(self) -> tuple[Blow, ...]:
        """The blows, filled up so that few counts need machine code of their own."""
        count = max(2, 1 << max(0, len(self.blows) - 1).bit_length())
        return self.blows + (STILL,) * (count - len(self.blows))

    def with_plant(self, fault: "Fault", **fields: Any) -> "World":
        """The world with other fields of the plant."""
        known = type(self.plant).model_fields
        for name in fields:
            if name not in known:
                message = f"does not fit the plant {type(self.plant).__name__}, which has no {name}"
                raise InvalidInput("faults", fault, message)
        return replace(self, plant=self.plant.but(**fields))

    def with_outage(self, fault: "Fault", sensor: str, outage: Outage) -> "World":
        """The world with one more time in which a sensor is silent.

        Raises:
            InvalidInput: It was silent before, and heard in between.
        """
        before: Outage = getattr(self.outages, sensor)
        if before != SILENT:
            if max(before.begin, outage.begin) > min(before.end, outage.end):
                message = "one sensor falls silent once; these times must overlap or touch"
                raise InvalidInput("faults", fault, message)
            outage = Outage(min(before.begin, outage.begin), max(before.end, outage.end))
        return replace(self, outages=self.outages._replace(**{sensor: outage}))

    def with_weak_motor(self, fault: "Fault", side: str, begin: float, strength: float) -> "World":
        """The world with a motor that is weaker still; losses at one time multiply.

        Raises:
            InvalidInput: It is weakened at another time already.
        """
        earlier = getattr(self.impairment, f"{side}_begin")
        if earlier not in (math.inf, begin):
            message = f"the {side} motor weakens at {earlier:g} s already; must be at the same time"
            raise InvalidInput("faults", fault, message)
        left = strength * getattr(self.impairment, f"{side}_strength")
        fields = {f"{side}_begin": begin, f"{side}_strength": left}
        return replace(self, impairment=self.impairment._replace(**fields))

    def with_blow(self, fault: "Fault", blow: Blow) -> "World":
        """The world with one more push, which gets random numbers of its own.

        Raises:
            InvalidInput: A push that this plant cannot feel, or a part of one that was asked for.
        """
        felt, kind = self.plant.feels, type(self.plant).__name__
        unfelt = {"aside": "aside" not in felt, "yaw": "yaw_acceleration" not in felt}
        for name, lost in unfelt.items():
            if lost and name in fault.model_fields_set and getattr(fault, name) != 0.0:
                raise InvalidInput(
                    "faults", fault, f"{name} moves nothing on the plant {kind}; {REMEDY}"
                )
        sizes = {True: [], False: [blow.along, blow.x, blow.y]}  # of what is lost, and of what acts
        for name, lost in unfelt.items():
            sizes[lost].append(getattr(blow, name))
        if any(sizes[True]) and not any(sizes[False]):
            raise InvalidInput("faults", fault, f"moves nothing on the plant {kind}; {REMEDY}")
        stream = float(STREAMS + len(self.blows))
        return replace(self, blows=(*self.blows, blow._replace(stream=stream)))


class Fault(Spec):
    """One thing that is wrong."""

    @abstractmethod
    def on(self, world: World) -> World:
        """The world with this fault."""


class Payload(Fault):
    """A load that no law knows."""

    kind: Literal["payload"] = "payload"
    mass: float = quantity("kg", "of the load, on the body's centre", gt=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        return world.with_plant(self, payload=getattr(world.plant, "payload", 0.0) + self.mass)


class WheelWear(Fault):
    """Wheels smaller than the encoders believe."""

    kind: Literal["wheel-wear"] = "wheel-wear"
    loss: float = quantity("1", "of radius, part of the radius", default=0.02, gt=0, lt=0.5)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        left = (1.0 - getattr(world.plant, "wheel_wear", 0.0)) * (1.0 - self.loss)
        return world.with_plant(self, wheel_wear=1.0 - left)


class SteeringOffset(Fault):
    """A steered wheel that does not stand where its encoder says."""

    kind: Literal["steering-offset"] = "steering-offset"
    angle: float = quantity("rad", "wheel minus encoder", default=math.radians(1.0))

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        before = getattr(world.plant, "steering_offset", 0.0)
        return world.with_plant(self, steering_offset=before + self.angle)


class SlowServo(Fault):
    """A steering servo slower than known."""

    kind: Literal["slow-servo"] = "slow-servo"
    frequency: float = quantity("1", "natural frequency, per the known one", default=0.7, gt=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        before = getattr(world.plant, "servo", 1.0)
        return world.with_plant(self, servo=before * self.frequency)


class Late(Fault):
    """Commands that act later than known."""

    kind: Literal["late"] = "late"
    delay: float = quantity("s", "added to the known delay", default=0.04, gt=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        return replace(world, delay=world.delay + self.delay)


class Slope(Fault):
    """A floor that is not level."""

    kind: Literal["slope"] = "slope"
    grade: float = quantity("1", "rise per distance", default=0.05, ge=-0.5, le=0.5)
    direction: float = quantity("rad", "in which the floor rises, in the map frame", default=0.0)
    gravity: float = quantity("m/s²", "gravitational acceleration", default=9.8, gt=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        pull = self.gravity * self.grade / math.hypot(1.0, self.grade)
        x, y = -pull * math.cos(self.direction), -pull * math.sin(self.direction)
        return world.with_blow(self, STILL._replace(end=math.inf, x=x, y=y))


class Gusts(Fault):
    """Wind or rough ground: accelerations that wander; standard deviations."""

    kind: Literal["gusts"] = "gusts"
    along: float = quantity("m/s²", "along the robot", default=0.3, ge=0)
    aside: float = quantity("m/s²", "across the robot", default=0.3, ge=0)
    yaw: float = quantity("rad/s²", "yaw acceleration", default=0.0, ge=0)
    time: float = quantity("s", "time in which they change", default=0.3, gt=0)
    seed: int = quantity("1", "of the random numbers", default=1, ge=0, lt=2**53)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        blow = STILL._replace(
            end=math.inf, along=self.along, aside=self.aside, yaw=self.yaw, time=self.time,
            seed=float(self.seed),
        )  # fmt: skip
        return world.with_blow(self, blow)


class Shove(Fault):
    """Something bumps into the robot."""

    kind: Literal["shove"] = "shove"
    time: float = quantity("s", "when", default=2.0, ge=0)
    duration: float = quantity("s", "for how long", default=0.1, gt=0)
    along: float = quantity("m/s²", "acceleration along the robot", default=0.0)
    aside: float = quantity("m/s²", "acceleration across the robot, to the left", default=3.0)
    yaw: float = quantity("rad/s²", "yaw acceleration", default=0.0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        blow = STILL._replace(
            begin=self.time, end=self.time + self.duration, along=self.along, aside=self.aside,
            yaw=self.yaw,
        )  # fmt: skip
        return world.with_blow(self, blow)


class FrictionPatch(Fault):
    """A slippery (or sticky) round patch on the floor."""

    kind: Literal["friction-patch"] = "friction-patch"
    x: float = quantity("m", "centre, in the map frame")
    y: float = quantity("m", "centre, in the map frame")
    radius: float = quantity("m", "of the patch", default=0.5, gt=0)
    friction: float = quantity("1", "of tyres on the patch", default=0.2, gt=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        patch = Patch(x=self.x, y=self.y, radius=self.radius, friction=self.friction)
        return world.with_plant(self, patches=(*getattr(world.plant, "patches", ()), patch))


class Slippery(Fault):
    """A floor with little friction everywhere."""

    kind: Literal["slippery"] = "slippery"
    friction: float = quantity("1", "of tyres on the floor", default=0.3, gt=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        return world.with_plant(self, friction=self.friction)


class SensorLoss(Fault):
    """A sensor that falls silent: pose, wheel encoders, steering encoder or gyro."""

    kind: Literal["sensor-loss"] = "sensor-loss"
    sensor: Literal["pose", "wheels", "steering", "gyro"] = "pose"
    time: float = quantity("s", "when", default=2.0, ge=0)
    duration: float | None = quantity("s", "for how long; by default for good", default=None, gt=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        end = math.inf if self.duration is None else self.time + self.duration
        return world.with_outage(self, self.sensor, Outage(self.time, end))


class WeakMotor(Fault):
    """A drive motor that gives less than it is told."""

    kind: Literal["weak-motor"] = "weak-motor"
    side: Literal["left", "right"] = "left"
    strength: float = quantity("1", "torque that is left, part of it", default=0.5, ge=0, lt=1)
    time: float = quantity("s", "when it begins", default=0.0, ge=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        return world.with_weak_motor(self, self.side, self.time, self.strength)


class StuckSteering(Fault):
    """A steering servo that obeys no command any more: it stays where it was told to be last."""

    kind: Literal["stuck-steering"] = "stuck-steering"
    time: float = quantity("s", "when", default=2.0, ge=0)

    def on(self, world: World) -> World:
        """See `Fault.on`."""
        stuck = min(world.impairment.stuck, self.time)
        return replace(world, impairment=world.impairment._replace(stuck=stuck))


AnyFault = Annotated[
    Payload | WheelWear | SteeringOffset | SlowServo | Late | Slope | Gusts | Shove | FrictionPatch
    | Slippery | SensorLoss | WeakMotor | StuckSteering,
    Field(discriminator="kind"),
]  # fmt: skip


def world_of(plant: Plant, faults: Iterable[Fault]) -> World:
    """A plant with everything that is wrong with it.

    Raises:
        InvalidInput: A fault of something that this plant does not have.
    """
    world = World(plant)
    for fault in faults:
        world = fault.on(world)
    return world
