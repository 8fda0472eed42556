"""Template: a pilot decides at instants; it needs neither time nor target."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import kernel
from osculate.simulation.records import Thought
from osculate.target.contract import TargetMemory

if TYPE_CHECKING:  # part, bound by `compose`
    from osculate.control.templates.pilot import pilot


@kernel
def step(
    t: float, period: float, seen: Any, target: TargetMemory, memory: Any, p: Thought,
    tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """Command, next memory, what was wanted and missed."""
    return pilot(seen, memory, p.control, tables)
