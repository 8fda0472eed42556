"""Template: a continuous law as one that decides at instants: its memory moves on by one period."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import axpy, kernel
from osculate.simulation.records import Thought
from osculate.target.contract import TargetMemory
from osculate.vehicle.motion import Motion

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.templates.curvature_law import curvature_law as control
    from osculate.target.modified import refer_modified as refer
    from osculate.target.profile import exponential_pace as pace


@kernel
def step(
    t: float, period: float, motion: Motion, target: TargetMemory, memory: Any, p: Thought,
    tables: NDArray[np.float64],
) -> Any:  # fmt: skip
    """Command, next memory, what was wanted and missed."""
    reference = refer(motion, pace(t, p.pace, tables), target, p.target, p.curve, tables)
    command, rate, errors = control(t, motion, reference, memory, p.control, tables)
    return command, axpy(period, rate, memory), reference, errors
