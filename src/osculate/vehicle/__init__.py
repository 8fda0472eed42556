"""The robot: parameters with units and sources, its dynamics, what it does and is told."""

from osculate.vehicle.actuators import Actuators
from osculate.vehicle.brake import Brake
from osculate.vehicle.catalogue import VEHICLES, vehicle_named
from osculate.vehicle.model import ReducedModel
from osculate.vehicle.motion import Command, Motion
from osculate.vehicle.tricycle import Footprint, Tricycle

__all__ = [
    "VEHICLES",
    "Actuators",
    "Brake",
    "Command",
    "Footprint",
    "Motion",
    "ReducedModel",
    "Tricycle",
    "vehicle_named",
]
