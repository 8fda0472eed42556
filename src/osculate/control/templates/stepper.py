"""Template: one decision of a path tracker for ``LANES`` robots, called from outside."""

from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking.contract import TrackingMemory, TrackingParameters
from osculate.kernel import compiled, load, store
from osculate.vehicle.motion import Motion

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.templates.tracking import track

    LANES = 1
    LIKE = cast(TrackingMemory, None)
    LIKE_PARAMETERS = cast(TrackingParameters, None)

MOTION = Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled
def step_block(
    memory: NDArray[np.float64],
    parameters: NDArray[np.float64],
    motion: NDArray[np.float64],
    command: NDArray[np.float64],
    tables: NDArray[np.float64],
) -> None:
    """Decide for every lane.

    Args:
        memory: Shape (leaves, LANES), read and overwritten.
        parameters: Shape (leaves, LANES).
        motion: Shape (6, LANES), measured.
        command: Shape (3, LANES), overwritten.
        tables: Shape (n,).
    """
    for lane in range(LANES):
        decided, following, _, _ = track(
            load(MOTION, motion, lane),
            load(LIKE, memory, lane),
            load(LIKE_PARAMETERS, parameters, lane),
            tables,
        )
        store(following, memory, lane)
        store(decided, command, lane)
