"""What happens: one file per plant, and what disturbs it."""

from typing import Annotated

from pydantic import Field

from osculate.plant.actuated import Actuated
from osculate.plant.contract import Plant, PlantPart, Push
from osculate.plant.disturbance import Disturbance
from osculate.plant.mujoco import Mujoco
from osculate.plant.reduced import Reduced

AnyPlant = Annotated[Reduced | Actuated | Mujoco, Field(discriminator="kind")]

__all__ = ["Actuated", "AnyPlant", "Disturbance", "Mujoco", "Plant", "PlantPart", "Push", "Reduced"]
