"""Template: a path tracker that is told the motion itself."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.estimation.contract import Evidence, Sight
from osculate.control.tracking.contract import TrackingMemory, TrackingParameters
from osculate.kernel import kernel, select
from osculate.kernel.maths import PI
from osculate.vehicle.measurement import FARTHEST, FASTEST, TURNS
from osculate.vehicle.motion import Motion

if TYPE_CHECKING:  # part, bound by `compose`
    from osculate.control.templates.tracking import track


@kernel
def plausible(m: Motion) -> bool:
    """Whether a motion may be that of a robot; false for what is not a number."""
    place = abs(m.x) < FARTHEST and abs(m.y) < FARTHEST and abs(m.heading) < TURNS
    pace = abs(m.speed) < FASTEST and abs(m.yaw_rate) < FASTEST
    return place and pace and abs(m.steering_angle) < PI


@kernel
def decide(
    motion: Motion, memory: TrackingMemory, p: TrackingParameters, tables: NDArray[np.float64]
) -> Any:
    """One decision from a motion; one that is missing is replaced by what was expected."""
    good = plausible(motion)
    before = memory.evidence
    age = 0.0 if good else before.fix_age + p.period
    located = 1.0 if good else before.located
    evidence = Evidence(age, 1.0, age, 0.0, 0.0, located)
    seen = select(good, motion, memory.expected)
    return track(Sight(seen, 0.0, 1.0, evidence), memory, p, tables)
