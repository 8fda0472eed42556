"""The contract of every continuous law, and what it reports besides its command.

A law is a continuous-time system: a kernel

    control(t, motion, reference, memory, parameters, tables) -> (Command, memory_rate, Errors)

The engine integrates its memory together with the plant (the paper's way) or samples it: period,
zero-order hold and delay (the way of a real robot).
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple

from osculate.kernel import Tables
from osculate.spec import Spec
from osculate.target.contract import TargetPart
from osculate.vehicle.model import ReducedModel


class Errors(NamedTuple):
    """The law's own view of how far it is from its target."""

    heading: float  # rad, y₁ = θ − θ̂ in the law's heading coordinate
    yaw_rate: float  # rad/s, y₂ = ω − ω̂
    speed: float  # m/s, z = v − v̂


class Start(NamedTuple):
    """The robot's state when a run begins."""

    x: float  # m
    y: float  # m
    heading: float  # rad
    speed: float  # m/s
    yaw_rate: float  # rad/s
    curvature: float  # 1/m, of the path driven, to which the steering is set at standstill


@dataclass(frozen=True)
class ControlPart:
    """A law ready to run."""

    control: Any  # kernel, see the module's docstring
    parameters: NamedTuple
    memory: NamedTuple  # initial value
    fastest_rate: float  # 1/s, magnitude of the closed loop's fastest eigenvalue


class Controller(Spec):
    """A law that turns target speeds into a steering angle and two torques."""

    @abstractmethod
    def part(
        self, model: ReducedModel, target: TargetPart, start: Start, tables: Tables
    ) -> ControlPart:
        """Kernel, parameters and initial memory for a robot described by ``model``."""
