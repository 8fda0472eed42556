"""Template: a path tracker that is told the motion itself."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.estimation.contract import TRUSTED
from osculate.control.tracking.contract import TrackingMemory, TrackingParameters
from osculate.kernel import kernel
from osculate.vehicle.motion import Motion

if TYPE_CHECKING:  # part, bound by `compose`
    from osculate.control.templates.tracking import track


@kernel
def decide(
    motion: Motion, memory: TrackingMemory, p: TrackingParameters, tables: NDArray[np.float64]
) -> Any:
    """One decision from a motion: command, next memory, what was wanted and missed."""
    return track(motion, TRUSTED, memory, p, tables)
