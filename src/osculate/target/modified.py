"""The modified target, eqs (25) and (30): the speed follows the yaw rate that the robot really has."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.curve.table import CurveTable, curvature_at
from osculate.errors import InvalidInput
from osculate.kernel import Nothing, Tables, kernel
from osculate.target.contract import Reference, SampledYaw, Target, TargetMemory, TargetPart
from osculate.target.profile import AnyProfile, Exponential, ExponentialPace, Pace
from osculate.target.static import SAMPLES
from osculate.vehicle.motion import Motion
from osculate.vehicle.tricycle import Tricycle


@kernel
def refer_modified(
    motion: Motion,
    pace: Pace,
    memory: TargetMemory,
    p: Nothing,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Reference:
    """ω̂ prescribed, v̂ = ω / κ(s) with the actual yaw rate ω and s = ∫v dt.

    v̂̇ = ω̇ / κ − κ' v ω / κ², which on the cycloid is eq. (37).
    """
    k, dk = curvature_at(memory.arc_length, curve, tables)
    radius = 1.0 / (k if k != 0.0 else 1.0)  # κ = 0 is refused beforehand
    return Reference(
        speed=motion.yaw_rate * radius,
        speed_drift=-dk * motion.speed * motion.yaw_rate * (radius * radius),
        speed_slaving=radius,
        yaw_rate=pace.rate,
        yaw_drift=pace.acceleration,
        yaw_slaving=0.0,
        curvature=k,
        heading=memory.heading,
    )


class Modified(Target):
    """Prescribe the yaw rate, slave the speed; for curves that bend one way everywhere.

    The profile is one of heading (rad): its consistent amplitude is the curve's total turn, on the
    cycloid −(π − β). The paper prints θ̂̇ = −¾ t e^{−t/2}, whose amplitude is −3 rad.
    """

    kind: Literal["modified"] = "modified"
    profile: AnyProfile = Exponential()

    def part(self, curve: Curve, table: CurveTable, robot: Tricycle, tables: Tables) -> TargetPart:
        """See `Target.part`.

        Raises:
            InvalidInput: The curvature vanishes or changes sign somewhere.
        """
        _require_bent(curve)
        pace = self.profile.part(curve.total_turn, curve, tables, heading=True)
        if isinstance(pace.parameters, ExponentialPace):
            return TargetPart(refer_modified, Nothing(), pace, pace.parameters)
        t = np.linspace(0.0, pace.horizon, SAMPLES)
        yaw = np.asarray(pace.sample(t).acceleration)
        return TargetPart(refer_modified, Nothing(), pace, SampledYaw(float(t[1]), yaw))


def _require_bent(curve: Curve) -> None:
    s = np.linspace(0.0, curve.length, 4097)
    curvature = curve.at(s).curvature
    bad = curvature * curvature[len(s) // 2] <= 0.0
    if bad.any():
        where = int(bad.argmax())
        raise InvalidInput(
            "target.kind",
            "modified",
            f"divides by the curvature, which is {curvature[where]:.3g} 1/m at s = {s[where]:.4g} m;"
            " use the projected target for curves with straights or inflections",
        )
