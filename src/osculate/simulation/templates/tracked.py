"""Template: a path tracker decides at instants; it needs neither time nor target."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import kernel
from osculate.simulation.records import Parameters
from osculate.target.contract import TargetMemory
from osculate.vehicle.motion import Motion

if TYPE_CHECKING:  # part, bound by `compose`
    from osculate.control.templates.tracking import track


@kernel
def step(
    t: float, period: float, motion: Motion, target: TargetMemory, memory: Any, p: Parameters,
    tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """Command, next memory, what was wanted and missed."""
    return track(motion, memory, p.control, tables)
