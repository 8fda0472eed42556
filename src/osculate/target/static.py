"""The static target, eqs (21)–(22) and (51): both speeds are functions of time alone."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.curve.table import CurveTable, curvature_at
from osculate.kernel import Nothing, Tables, kernel
from osculate.target.contract import Reference, SampledYaw, Target, TargetMemory, TargetPart
from osculate.target.profile import AnyProfile, Exponential, Pace
from osculate.vehicle.motion import Motion
from osculate.vehicle.tricycle import Tricycle

SAMPLES = 16385  # of the yaw acceleration that the preview looks ahead on


@kernel
def refer_static(
    motion: Motion,
    pace: Pace,
    memory: TargetMemory,
    p: Nothing,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Reference:
    """v̂ = ϕ̇(t), ω̂ = κ(ϕ(t)) ϕ̇(t), eq. (22)."""
    k, dk = curvature_at(pace.progress, curve, tables)
    return Reference(
        speed=pace.rate,
        speed_drift=pace.acceleration,
        speed_slaving=0.0,
        yaw_rate=k * pace.rate,
        yaw_drift=dk * pace.rate * pace.rate + k * pace.acceleration,
        yaw_slaving=0.0,
        curvature=k,
        heading=memory.heading,
    )


class Static(Target):
    """Drive a timetable: neither speed looks at what the robot does.

    With the profile ``natural`` on a cycloid this is eq. (51).
    """

    kind: Literal["static"] = "static"
    profile: AnyProfile = Exponential()

    def part(self, curve: Curve, table: CurveTable, robot: Tricycle, tables: Tables) -> TargetPart:
        """See `Target.part`."""
        pace = self.profile.part(curve.length, curve, tables)
        t = np.linspace(0.0, pace.horizon, SAMPLES)
        ahead = pace.sample(t)
        point = curve.at(np.asarray(ahead.progress))
        yaw = point.curvature_rate * ahead.rate**2 + point.curvature * ahead.acceleration
        return TargetPart(
            refer_static, Nothing(), pace, SampledYaw(float(t[1]), yaw), follows_path=False
        )
