"""What happens: one file per plant, and what disturbs it."""

from typing import Annotated

from pydantic import Field

from osculate.plant.actuated import Actuated, ActuatedPlant
from osculate.plant.contract import Plant, PlantPart, Push
from osculate.plant.disturbance import Disturbance
from osculate.plant.faults import (
    AnyFault,
    Fault,
    FrictionPatch,
    Gusts,
    Late,
    Payload,
    SensorLoss,
    Shove,
    Slippery,
    Slope,
    SlowServo,
    SteeringOffset,
    StuckSteering,
    WeakMotor,
    WheelWear,
    World,
    world_of,
)
from osculate.plant.mujoco import Mujoco
from osculate.plant.reduced import Reduced
from osculate.plant.sensors import Sensors
from osculate.plant.slip import Slip
from osculate.plant.tyre import Patch

AnyPlant = Annotated[Reduced | Actuated | Slip | Mujoco, Field(discriminator="kind")]

__all__ = [
    "Actuated",
    "ActuatedPlant",
    "AnyFault",
    "AnyPlant",
    "Disturbance",
    "Fault",
    "FrictionPatch",
    "Gusts",
    "Late",
    "Mujoco",
    "Patch",
    "Payload",
    "Plant",
    "PlantPart",
    "Push",
    "Reduced",
    "SensorLoss",
    "Sensors",
    "Shove",
    "Slip",
    "Slippery",
    "Slope",
    "SlowServo",
    "SteeringOffset",
    "StuckSteering",
    "WeakMotor",
    "WheelWear",
    "World",
    "world_of",
]
