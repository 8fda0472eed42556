"""What controllers are compared on: curves, starts, conditions. And what they are tuned on."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import Field

from osculate.control import Safety
from osculate.curve import Chain, Curve, CurveFile, Cycloid, Parametric, Segment, Spline
from osculate.errors import InvalidInput, choose
from osculate.files import is_file
from osculate.plant import (
    Actuated,
    AnyFault,
    Fault,
    Gusts,
    Late,
    Mujoco,
    Payload,
    SensorLoss,
    Sensors,
    Shove,
    Slip,
    Slippery,
    Slope,
    SteeringOffset,
    StuckSteering,
    WeakMotor,
    WheelWear,
)
from osculate.simulation import InitialState
from osculate.spec import Spec, quantity
from osculate.vehicle import VEHICLES, Tricycle

PAPER = VEHICLES["paper"]


class Condition(Spec):
    """How the robot differs from what its law believes."""

    plant: Actuated | Slip | Mujoco = Field(default=Actuated(), discriminator="kind")
    unknown_delay: float = quantity("s", "delay that the law does not know", default=0.0, ge=0)
    sensors: Sensors | None = None
    faults: tuple[AnyFault, ...] = ()
    safety: Safety | None = None

    @property
    def seeded(self) -> bool:
        """Whether random numbers make one run differ from the next."""
        return self.sensors is not None or any(isinstance(f, Gusts) for f in self.faults)

    def drawn(self, seed: int) -> "Condition":
        """The condition with other random numbers."""
        if not self.seeded:
            return self
        sensors = self.sensors and self.sensors.but(seed=seed)
        faults = tuple(f.but(seed=seed) if isinstance(f, Gusts) else f for f in self.faults)
        return self.but(sensors=sensors, faults=faults)

    def suited(self, robot: Tricycle) -> "Condition":
        """The condition for another robot than the paper's, for which the numbers are written.

        A payload is the same part of the robot's mass. Gusts along the robot and the slope take at most
        half of the acceleration that its motors have to spare: what stops every law tells nothing.
        """
        part = _mass(robot) / _mass(PAPER)
        faults = tuple(_suited(fault, part, _spare(robot) / 2.0) for fault in self.faults)
        load = getattr(self.plant, "payload", 0.0)
        plant = self.plant.model_copy(update={"payload": load * part}) if load else self.plant
        return self.model_copy(update={"plant": plant, "faults": faults})


def _suited(fault: AnyFault, part: float, push: float) -> AnyFault:
    if isinstance(fault, Payload):
        return fault.model_copy(update={"mass": fault.mass * part})
    if isinstance(fault, Gusts):
        return fault.model_copy(update={"along": min(fault.along, push)})
    if isinstance(fault, Slope):
        grade = min(abs(fault.grade), push / fault.gravity)
        return fault.model_copy(update={"grade": math.copysign(grade, fault.grade)})
    return fault


def _mass(robot: Tricycle) -> float:
    """Everything that is weighed (kg)."""
    return robot.body_mass + 3.0 * robot.wheel_mass


def _spare(robot: Tricycle) -> float:
    """Acceleration (m/s²) that the motors give beyond what rolling takes."""
    rolling = robot.actuators.rolling_resistance * robot.gravity
    return max(robot.motor_deceleration - rolling, 0.0)


#: Conditions by name, with the numbers of the paper's robot.
CONDITIONS: dict[str, Condition] = {
    "ideal": Condition(),
    "slow-servo": Condition(plant=Actuated(servo=0.7)),
    "late": Condition(unknown_delay=0.04),
    "payload": Condition(plant=Actuated(payload=5.0)),
    "worn-wheels": Condition(plant=Actuated(wheel_wear=0.02)),
    "mujoco": Condition(plant=Mujoco()),
    "bent-steering": Condition(plant=Actuated(steering_offset=math.radians(1.0))),
}


def _seen(*faults: Fault, **fields: Any) -> Condition:
    """A robot seen through noisy sensors, with faults."""
    return Condition(sensors=Sensors(), faults=faults, **fields)


#: The conditions of the reality suite, from the ideal robot to what no law can be ready for.
REALITY = {
    "ideal": Condition(),
    "slip": Condition(plant=Slip()),
    "slippery": Condition(plant=Slip(), faults=(Slippery(friction=0.3),)),
    "mujoco": Condition(plant=Mujoco()),
    "payload": CONDITIONS["payload"],
    "slow-servo": CONDITIONS["slow-servo"],
    "late": CONDITIONS["late"],
    "noisy": _seen(),
    "noisy-real": _seen(Payload(mass=4.5), WheelWear(loss=0.02), SteeringOffset()),
    "noisy-slip": _seen(plant=Slip()),
    "noisy-slippery": _seen(Slippery(friction=0.3), plant=Slip()),
    "noisy-mujoco": _seen(plant=Mujoco()),
    "wheel-wear": _seen(WheelWear(loss=0.05)),
    "steering-offset": _seen(SteeringOffset(angle=math.radians(2.0))),
    "gusts": _seen(Gusts(along=0.5, aside=0.5), plant=Slip()),
    "shove": _seen(Shove(time=4.0, aside=4.0), plant=Slip()),
    "slope": _seen(Slope(grade=0.05, direction=1.0), plant=Slip()),
    "weak-motor": _seen(WeakMotor(strength=0.5, time=2.0), plant=Slip()),
    "pose-outage": _seen(SensorLoss(sensor="pose", time=4.0, duration=1.0)),
    "outliers": Condition(
        sensors=Sensors(pose_outliers=0.05, pose_dropout=0.2, pose_latency=0.04, pose_jitter=0.03)
    ),
}

#: Faults with which a robot must stop; it is guarded.
STOPS = {
    "stuck-steering": _seen(StuckSteering(time=2.0), safety=Safety()),
    "no-pose": _seen(SensorLoss(sensor="pose", time=2.0), safety=Safety()),
    "late-60": _seen(Late(delay=0.06), safety=Safety()),
}
CONDITIONS |= {name: state for name, state in REALITY.items() if name not in CONDITIONS} | STOPS


def _slalom(places: Iterable[float], step: float) -> Spline:
    return Spline(points=tuple((step * n, y) for n, y in enumerate(places)))


#: The curves on which results are reported.
CURVES: dict[str, Curve] = {
    "cycloid": Cycloid.over(),
    "lemniscate": Parametric(
        x="3 * cos(p) / (1 + sin(p)**2)",
        y="3 * sin(p) * cos(p) / (1 + sin(p)**2)",
        end=2.0 * math.pi,
        loop=True,
    ),
    "slalom": _slalom([0.0, 0.5, 0.0, -0.5, 0.0, 0.5, 0.0, -0.5, 0.0], 1.5),
    "corner": Chain.corner(turn=math.pi / 2.0, radius=0.8, ramp=0.4, straight=2.0),
}


def curves(names: Iterable[str] | None = None, scale: float = 1.0) -> dict[str, Curve]:
    """Curves by name: built-in ones, or files (``scale`` multiplies their coordinates).

    Raises:
        InvalidInput: Neither a name nor a file, a file named as another curve, or a scale without a file.
    """
    chosen: dict[str, Curve] = {}
    for name in names or CURVES:
        if name in CURVES:
            chosen[name] = CURVES[name]
        elif is_file(Path(name)):
            stem = Path(name).stem  # two files may share it, also with a built-in curve
            title = name if stem in {**CURVES, **chosen} else stem
            text = title.encode("utf-8", errors="backslashreplace").decode()
            curve = CurveFile(path=name, scale=scale)
            if curve in chosen.values():
                raise InvalidInput("curve", name, "is given twice")
            chosen[text] = curve
        else:
            raise InvalidInput("curve", name, f"must be a file or one of {', '.join(CURVES)}")
    if scale != 1.0 and not any(isinstance(curve, CurveFile) for curve in chosen.values()):
        raise InvalidInput("scale", scale, "is for curves from files; none of these is one")
    return chosen


#: Starts by name; errors count once the robot had room to make them good.
STARTS = {
    "on-path": InitialState(),
    "running": InitialState(settled=3.0),
    "offset": InitialState(cross_track=0.2, heading_error=math.radians(10.0), settled=3.0),
    "metre": InitialState(cross_track=1.0, settled=3.0),
    "across": InitialState(heading_error=math.radians(90.0), settled=3.0),
}


SUITES = {"ideal": ("ideal",), "reality": (*REALITY, *STOPS)}


def starts(names: Iterable[str] | None = None) -> dict[str, InitialState]:
    """Starts by name.

    Raises:
        InvalidInput: No such start.
    """
    return {name: choose("start", name, STARTS) for name in names or ("on-path", "offset")}


def conditions(
    names: Iterable[str] | None = None, suite: str = "ideal", robot: Tricycle = PAPER
) -> dict[str, Condition]:
    """Conditions by name, suited to a robot; without names those of a suite, ``ideal`` or ``reality``.

    Raises:
        InvalidInput: No such condition.
    """
    return {
        name: choose("plant", name, CONDITIONS).suited(robot)
        for name in names or choose("suite", suite, SUITES)
    }


def training_curves() -> dict[str, Curve]:
    """Curves for tuning; none of them is reported."""
    weave = Parametric(x="2 * p", y="0.4 * sin(1.3 * p) + 0.2 * sin(2.3 * p)", end=5.0)
    hairpin = Chain.corner(turn=-2.4, radius=1.1, ramp=0.7, straight=1.5)
    chicane = Chain(
        segments=(
            Segment(length=1.5),
            Segment(length=0.5, end_curvature=0.9),
            Segment(length=0.4, curvature=0.9),
            Segment(length=1.0, curvature=0.9, end_curvature=-0.9),
            Segment(length=0.4, curvature=-0.9),
            Segment(length=0.5, curvature=-0.9, end_curvature=0.0),
            Segment(length=1.5),
        )
    )
    return {"weave": weave, "hairpin": hairpin, "chicane": chicane}
