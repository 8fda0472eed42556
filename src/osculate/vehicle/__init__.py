"""The robot: parameters with units and sources, its reduced dynamics, what it does and is told."""

from osculate.vehicle.model import ReducedModel
from osculate.vehicle.motion import Command, Motion
from osculate.vehicle.tricycle import Footprint, Tricycle

__all__ = ["Command", "Footprint", "Motion", "ReducedModel", "Tricycle"]
