"""Template: a plant that moves on between the instants at which a law decides.

A decided command acts ``delay`` steps later and is held until the next one acts. What pushes the robot is
held as well. What an odometer does, the integration of the travelled distance, goes on between instants.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import Nothing, axpy, kernel, select
from osculate.simulation.records import Action, Held, Parameters, State
from osculate.target.contract import TargetMemory

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.plant.disturbance import disturb, perceive
    from osculate.plant.reduced import measure_reduced as measure
    from osculate.plant.reduced import reduced_rates as plant_rates

NOTHING = Nothing()


@kernel
def halted(held: Held) -> float:
    """Reason for which the law stops the robot for good; 0 is none."""
    return held.stop


@kernel
def hold(age: int, substeps: int, held: Held, p: Parameters) -> Action:
    """What acts ``age`` steps after the last instant: the newest command that is old enough."""
    active = held.commands[-1]
    for n in range(len(held.commands) - 2, -1, -1):
        active = select(age + n * substeps >= p.delay, held.commands[n], active)
    return Action(active, held.push, held.insight, held.reference, held.errors)


@kernel
def look(action: Action) -> Any:
    """What the law believed and did at its last instant."""
    return action.insight


@kernel
def respond(
    t: float, state: State, action: Action, p: Parameters, tables: NDArray[np.float64]
) -> Any:
    """What is seen now, what was wanted and decided, and the rate of the whole state."""
    motion = perceive(measure(state.plant, p.plant), state.disturbance)
    push, disturbance_rate = disturb(t, action.errors, p.disturbance)
    rate = State(
        plant=plant_rates(state.plant, action.command, axpy(1.0, action.push, push), p.plant),
        disturbance=disturbance_rate,
        target=TargetMemory(motion.speed, action.reference.yaw_rate),
        control=NOTHING,
    )
    return motion, action.reference, action.command, action.errors, rate


@kernel
def rates(
    t: float, state: State, action: Action, p: Parameters, tables: NDArray[np.float64]
) -> State:
    """The rate of the whole state, for `rk4`."""
    _, _, _, _, rate = respond(t, state, action, p, tables)
    return rate
