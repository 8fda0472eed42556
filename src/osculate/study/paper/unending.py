"""The modified target with the numbers of eq. (50), which goes on beyond the end of the path."""

from math import sqrt
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve import Curve, CurveTable, Cycloid
from osculate.kernel import Tables, kernel
from osculate.spec import quantity
from osculate.target import Exponential, Reference, Target, TargetMemory
from osculate.target.contract import TargetPart
from osculate.target.profile import ExponentialPace, Pace
from osculate.vehicle import Motion, Tricycle


class Root(NamedTuple):
    """Parameters of `refer_unending`: 1/k² = constant + linear s − s²."""

    constant: float  # m²
    linear: float  # m


@kernel
def refer_unending(
    motion: Motion,
    pace: Pace,
    memory: TargetMemory,
    p: Root,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Reference:
    """v̂ = −√(C + B s − s²) θ̇, eq. (50); standing where the root vanishes, at the cusp."""
    s = memory.arc_length
    square = p.constant + (p.linear - s) * s
    before = square > 0.0
    root = sqrt(square if before else 1.0)
    slope = (0.5 * p.linear - s) / root
    return Reference(
        speed=-root * motion.yaw_rate if before else 0.0,
        speed_drift=-slope * motion.speed * motion.yaw_rate if before else 0.0,
        speed_slaving=-root if before else 0.0,
        yaw_rate=pace.rate,
        yaw_drift=pace.acceleration,
        yaw_slaving=0.0,
        curvature=-1.0 / root,
        heading=memory.heading,
    )


class Unending(Target):
    """Eq. (50) as it stands, also after s = l: the cycloid's curvature as a root, up to its cusp."""

    kind: Literal["unending"] = "unending"
    profile: Exponential = Exponential(amplitude=-3.0)
    constant: float = quantity("m²", "16 α² sin²(β/2), printed as 10.5476", gt=0)
    linear: float = quantity("m", "8 α cos(β/2), printed as 24.8089", gt=0)

    @classmethod
    def of(cls, curve: Cycloid, profile: Exponential) -> "Unending":
        """With the exact numbers of a cycloid."""
        sine = np.sin(curve.truncation / 2.0)
        return cls(
            profile=profile, constant=float(16.0 * (curve.radius * sine) ** 2), linear=curve.length
        )

    def part(self, curve: Curve, table: CurveTable, robot: Tricycle, tables: Tables) -> TargetPart:
        """See `Target.part`."""
        pace = self.profile.part(curve.total_turn, curve, tables)
        assert isinstance(pace.parameters, ExponentialPace)
        root = Root(self.constant, self.linear)
        return TargetPart(refer_unending, root, pace, pace.parameters, follows_path=False)
