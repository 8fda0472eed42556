"""The projected family of targets: both speeds slaved, regular where the curvature vanishes.

The actual speeds are projected on the line ω = κ v in the metric dv² + ℓ² dω²:

    v̂ = (v_p + ℓ² κ ω) / (1 + ℓ² κ²),     ω̂ = κ (v + ℓ² κ² v_p) / (1 + ℓ² κ²)

ℓ = 0 is the dynamical target, ℓ → ∞ the modified one. The product of both slaving gains is
ℓ² κ² / (1 + ℓ² κ²)² ≤ ¼, so that slaving never feeds back unstably.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.curve.table import CurveTable, curvature_at
from osculate.kernel import Tables, kernel
from osculate.spec import quantity
from osculate.target.contract import Reference, Target, TargetMemory, TargetPart
from osculate.target.profile import AnyProfile, Exponential, Pace
from osculate.vehicle.motion import Motion
from osculate.vehicle.tricycle import Tricycle


class ProjectedParameters(NamedTuple):
    """Parameters of `refer_projected`."""

    length_squared: float  # m², ℓ²


@kernel
def refer_projected(
    motion: Motion,
    pace: Pace,
    memory: TargetMemory,
    p: ProjectedParameters,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Reference:
    """v̂ and ω̂ by projection, with their rates as s = ∫v dt moves along the curve."""
    k, dk = curvature_at(memory.arc_length, curve, tables)
    square = p.length_squared * k * k
    share = 1.0 / (1.0 + square)
    speed = (pace.rate + p.length_squared * k * motion.yaw_rate) * share
    yaw_rate = k * (motion.speed + square * pace.rate) * share
    # partial derivatives with respect to κ, times dκ/dt = κ' v
    narrowing = 2.0 * p.length_squared * k * share
    speed_turn = p.length_squared * motion.yaw_rate * share - speed * narrowing
    yaw_turn = (motion.speed + 3.0 * square * pace.rate) * share - yaw_rate * narrowing
    turn = dk * motion.speed
    return Reference(
        speed=speed,
        speed_drift=pace.acceleration * share + speed_turn * turn,
        speed_slaving=p.length_squared * k * share,
        yaw_rate=yaw_rate,
        yaw_drift=k * square * pace.acceleration * share + yaw_turn * turn,
        yaw_slaving=k * share,
        curvature=k,
        heading=memory.heading,
    )


class Projected(Target):
    """Slave both speeds by projection: for any curve, straights and inflections included."""

    kind: Literal["projected"] = "projected"
    profile: AnyProfile = Exponential()
    metric_length: float | None = quantity(
        "m", "ℓ of the metric dv² + ℓ² dω²; by default the wheelbase", default=None, ge=0
    )

    def part(self, curve: Curve, table: CurveTable, robot: Tricycle, tables: Tables) -> TargetPart:
        """See `Target.part`."""
        length = robot.wheelbase if self.metric_length is None else self.metric_length
        pace = self.profile.part(curve.length, curve, tables)
        return TargetPart(refer_projected, ProjectedParameters(length**2), pace, None)
