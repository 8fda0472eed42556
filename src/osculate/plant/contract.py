"""The contract of every plant: how a state changes under a command, and what it looks like."""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from osculate.control.contract import Start
from osculate.spec import Spec
from osculate.vehicle.model import ReducedModel
from osculate.vehicle.tricycle import Tricycle


class Push(NamedTuple):
    """What acts on a robot besides its command."""

    acceleration: float  # m/s², added to v̇
    yaw_acceleration: float  # rad/s², added to ω̇
    yaw_rate: float  # rad/s, added to θ̇: turns the robot without its wheels
    aside: float = 0.0  # m/s², left, on the body's centre; moves only what can slip


@dataclass(frozen=True)
class PlantPart:
    """A plant ready to run."""

    rates: Any  # kernel (state, command, push, parameters) -> state's rate
    measure: Any  # kernel (state, parameters) -> Motion
    wheels: Any  # kernel (state, parameters) -> Wheels, as the encoders report
    parameters: NamedTuple
    state: NamedTuple  # initial value


class Plant(Spec):
    """A robot's equations of motion."""

    feels: ClassVar[frozenset[str]] = frozenset(Push._fields)  # what of a push can move it
    starts_turning: ClassVar[bool] = False  # whether a yaw rate is a state of its own at the start

    def model(self, robot: Tricycle) -> ReducedModel:
        """The reduced model that a law may assume for this plant."""
        return robot.reduced_model()

    def longest_step(self, robot: Tricycle) -> float:
        """The longest step (s) of `rk4` for which the plant itself is stable; no limit by default."""
        return math.inf

    @abstractmethod
    def part(self, robot: Tricycle, start: Start) -> PlantPart:
        """Kernels, parameters and initial state."""
