"""Template: a law that decides at instants and a plant that moves on in between, the robot's world.

At every instant the law sees the motion and decides a command; the command acts ``delay`` steps
later and is held until the next one acts. What an odometer does, the integration of the travelled
distance, goes on between the instants.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import Nothing, kernel, select
from osculate.simulation.records import Action, Held, Parameters, Progress, State
from osculate.target.contract import TargetMemory

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.plant.disturbance import disturb, perceive
    from osculate.plant.reduced import measure_reduced as measure
    from osculate.plant.reduced import reduced_rates as plant_rates
    from osculate.simulation.templates.held import step

NOTHING = Nothing()


@kernel
def decide(
    t: float, period: float, run: Progress, p: Parameters, tables: NDArray[np.float64]
) -> Held:
    """Let the law see the motion and decide; its memory moves on by one period."""
    state, held = run.state, run.held
    motion = perceive(measure(state.plant, p.plant), state.disturbance)
    command, memory, reference, errors = step(
        t, period, motion, state.target, held.memory, p, tables
    )
    return Held(memory, reference, errors, (command,) + held.commands[:-1])


@kernel
def hold(age: int, substeps: int, held: Held, p: Parameters) -> Action:
    """What acts ``age`` steps after the last instant: the newest command that is old enough."""
    active = held.commands[-1]
    for n in range(len(held.commands) - 2, -1, -1):
        active = select(age + n * substeps >= p.delay, held.commands[n], active)
    return Action(active, held.reference, held.errors)


@kernel
def respond(
    t: float, state: State, action: Action, p: Parameters, tables: NDArray[np.float64]
) -> Any:
    """What is seen now, what was wanted and decided, and the rate of the whole state."""
    motion = perceive(measure(state.plant, p.plant), state.disturbance)
    push, disturbance_rate = disturb(t, action.errors, p.disturbance)
    rate = State(
        plant=plant_rates(state.plant, action.command, push, p.plant),
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
