"""Template: law and plant as one continuous-time system, the paper's world."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import Nothing, kernel
from osculate.simulation.records import Parameters, State
from osculate.target.contract import TargetMemory

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.templates.curvature_law import curvature_law as control
    from osculate.plant.disturbance import disturb, perceive
    from osculate.plant.reduced import measure_reduced as measure
    from osculate.plant.reduced import reduced_rates as plant_rates
    from osculate.target.modified import refer_modified as refer
    from osculate.target.profile import exponential_pace as pace


@kernel
def hold(age: int, substeps: int, held: Nothing, p: Parameters) -> Nothing:
    """A continuous law has no command to hold."""
    return held


@kernel
def halted(held: Nothing) -> float:
    """A continuous law stops nothing."""
    return 0.0


@kernel
def look(action: Nothing) -> Nothing:
    """A continuous law knows what it sees."""
    return action


@kernel
def respond(
    t: float, state: State, action: Nothing, p: Parameters, tables: NDArray[np.float64]
) -> Any:
    """What is seen, wanted and commanded at one instant, and the rate of the whole state."""
    motion = perceive(measure(state.plant, p.plant), state.disturbance)
    reference = refer(motion, pace(t, p.pace, tables), state.target, p.target, p.curve, tables)
    command, control_rate, errors = control(t, motion, reference, state.control, p.control, tables)
    push, disturbance_rate = disturb(t, errors, p.disturbance)
    rate = State(
        plant=plant_rates(state.plant, command, push, p.plant),
        disturbance=disturbance_rate,
        target=TargetMemory(motion.speed, reference.yaw_rate),
        control=control_rate,
    )
    return motion, reference, command, errors, rate


@kernel
def rates(
    t: float, state: State, action: Nothing, p: Parameters, tables: NDArray[np.float64]
) -> State:
    """The rate of the whole state, for `rk4`."""
    _, _, _, _, rate = respond(t, state, action, p, tables)
    return rate
