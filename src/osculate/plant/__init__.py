"""What happens: one file per plant, and what disturbs it."""

from osculate.plant.contract import Plant, PlantPart, Push
from osculate.plant.disturbance import Disturbance
from osculate.plant.reduced import Reduced

__all__ = ["Disturbance", "Plant", "PlantPart", "Push", "Reduced"]
