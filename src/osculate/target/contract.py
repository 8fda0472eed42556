"""What a target tells the law: the speeds to drive now, and how they will change.

Both speeds of a robot on a curve are tied by ω = κ v. A target prescribes one channel and may slave
the other to what the robot really does. A slaved speed changes with the robot's own acceleration, so
its rate is affine in it; the law, which decides the accelerations, resolves the loop.
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.curve.table import CurveTable
from osculate.kernel import Tables
from osculate.spec import Spec
from osculate.target.profile import ExponentialPace, PacePart
from osculate.vehicle.tricycle import Tricycle


class TargetMemory(NamedTuple):
    """What a target remembers: integrated together with the plant."""

    arc_length: float  # m, s = ∫ v dt: where on the curve the robot believes to be
    heading: float  # rad, θ̂ = θ̂(0) + ∫ ω̂ dt


class Reference(NamedTuple):
    """Target speeds (v̂, ω̂); v̂̇ = speed_drift + speed_slaving · ω̇ and likewise for ω̂̇ with v̇."""

    speed: float  # m/s, v̂
    speed_drift: float  # m/s²
    speed_slaving: float  # m/rad, ∂v̂/∂ω
    yaw_rate: float  # rad/s, ω̂
    yaw_drift: float  # rad/s²
    yaw_slaving: float  # rad/m, ∂ω̂/∂v
    curvature: float  # 1/m, κ(s) of the target curve where the target reads it
    heading: float  # rad, θ̂


class SampledYaw(NamedTuple):
    """A yaw acceleration known in advance, sampled uniformly from t = 0 and zero afterwards."""

    step: float  # s
    accelerations: NDArray[np.float64]  # rad/s², shape (n,)


@dataclass(frozen=True)
class TargetPart:
    """A target ready to run: its kernels, their parameters, and what is known in advance."""

    refer: Any  # kernel (motion, pace, memory, parameters, curve, tables) -> Reference
    parameters: NamedTuple
    pace: PacePart
    known_yaw: ExponentialPace | SampledYaw | None  # None when the yaw target follows the robot
    follows_path: bool = True  # whether it ends where the path does; else with its timetable


class Target(Spec):
    """A rule that turns a curve and a profile into the speeds to drive."""

    @abstractmethod
    def part(self, curve: Curve, table: CurveTable, robot: Tricycle, tables: Tables) -> TargetPart:
        """Kernels and parameters of this target on ``curve`` (``table`` is its tabulated form)."""
