"""Template: one decision of a sampled law for a block of ``LANES`` runs, and what it sees and suffers."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import compiled, kernel, load, select, store
from osculate.simulation.records import RUNNING, Held, Mind, Progress, Thought

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.pilot import no_insight as insight
    from osculate.control.pilot import no_stop as stop
    from osculate.plant.disturbance import perceive
    from osculate.plant.reduced import measure_reduced as measure
    from osculate.plant.reduced import reduced_wheels as wheels
    from osculate.plant.sensors import sense_exactly as sense
    from osculate.plant.weather import blow_nothing as blow
    from osculate.plant.weather import impair_nothing as impair
    from osculate.simulation.templates.held import step

    LANES = 1
    LIKE: Any = None
    LIKE_MIND: Any = None
    LIKE_THOUGHT: Any = None


@kernel
def decide(
    t: float, period: float, run: Progress, mind: Mind, p: Thought, tables: NDArray[np.float64]
) -> Any:
    """Sense, decide, and see what becomes of the command; the law's memory moves on by one period."""
    state, held = run.state, run.held
    motion = perceive(measure(state.plant, p.plant), state.disturbance)
    seen, sensors = sense(motion, wheels(state.plant, p.plant), mind.sensors, p.sensors)
    decided, memory, reference, errors = step(t, period, seen, state.target, mind.memory, p, tables)
    command = impair(t, held.commands[0], decided, p.impairment)
    following = Held(
        blow(t, motion, p.blows),
        insight(seen, memory),
        reference,
        errors,
        stop(memory),
        (command,) + held.commands[:-1],
    )
    return following, Mind(memory, sensors)


@compiled
def decide_block(
    runs: NDArray[np.float64],
    minds: NDArray[np.float64],
    thoughts: NDArray[np.float64],
    tables: NDArray[np.float64],
    t: float,
    period: float,
) -> None:
    """Decide for every run that has not ended.

    Args:
        runs: Shape (leaves of `Progress`, LANES); what is held is overwritten.
        minds: Shape (leaves of `Mind`, LANES), read and overwritten.
        thoughts: Shape (leaves of `Thought`, LANES).
        tables: Shape (n,).
        t: Time (s).
        period: Time to the next instant (s).
    """
    for lane in range(LANES):
        run = load(LIKE, runs, lane)
        mind = load(LIKE_MIND, minds, lane)
        held, following = decide(t, period, run, mind, load(LIKE_THOUGHT, thoughts, lane), tables)
        going = run.status.code == RUNNING
        store(select(going, following, mind), minds, lane)
        held = select(going, held, run.held)
        store(Progress(run.state, run.tally, run.events, run.status, held), runs, lane)
