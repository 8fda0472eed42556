"""Template: one decision of a pilot for ``LANES`` robots, called from outside."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import compiled, load, store

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.templates.pilot import pilot as decide

    LANES = 1
    LIKE: Any = None
    LIKE_PARAMETERS: Any = None
    LIKE_MEASURED: Any = None


@compiled
def step_block(
    memory: NDArray[np.float64],
    parameters: NDArray[np.float64],
    measured: NDArray[np.float64],
    command: NDArray[np.float64],
    tables: NDArray[np.float64],
) -> None:
    """Decide for every lane.

    Args:
        memory: Shape (leaves, LANES), read and overwritten.
        parameters: Shape (leaves, LANES).
        measured: Shape (leaves, LANES), motions or measurements.
        command: Shape (3, LANES), overwritten.
        tables: Shape (n,).
    """
    for lane in range(LANES):
        decided, following, _, _ = decide(
            load(LIKE_MEASURED, measured, lane),
            load(LIKE, memory, lane),
            load(LIKE_PARAMETERS, parameters, lane),
            tables,
        )
        store(following, memory, lane)
        store(decided, command, lane)
