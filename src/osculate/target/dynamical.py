"""The dynamical target, eq. (24): the yaw rate follows the speed that the robot really has."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.curve.table import CurveTable, curvature_at
from osculate.kernel import Nothing, Tables, kernel
from osculate.target.contract import Reference, Target, TargetMemory, TargetPart
from osculate.target.profile import AnyProfile, Exponential, Pace
from osculate.vehicle.motion import Motion
from osculate.vehicle.tricycle import Tricycle


@kernel
def refer_dynamical(
    motion: Motion,
    pace: Pace,
    memory: TargetMemory,
    p: Nothing,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Reference:
    """v̂ = ϕ̇(t), ω̂ = κ(s) v with the actual speed v and s = ∫v dt."""
    k, dk = curvature_at(memory.arc_length, curve, tables)
    return Reference(
        speed=pace.rate,
        speed_drift=pace.acceleration,
        speed_slaving=0.0,
        yaw_rate=k * motion.speed,
        yaw_drift=dk * motion.speed * motion.speed,
        yaw_slaving=k,
        curvature=k,
        heading=memory.heading,
    )


class Dynamical(Target):
    """Prescribe the speed, slave the yaw rate: speed errors change when, not where."""

    kind: Literal["dynamical"] = "dynamical"
    profile: AnyProfile = Exponential()

    def part(self, curve: Curve, table: CurveTable, robot: Tricycle, tables: Tables) -> TargetPart:
        """See `Target.part`."""
        pace = self.profile.part(curve.length, curve, tables)
        return TargetPart(refer_dynamical, Nothing(), pace, None)
