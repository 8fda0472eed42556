"""Running a loop whose steering decisions come from Python, one period at a time."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import names, rebuild
from osculate.simulation.blocks import Finished, Report
from osculate.simulation.loop import Loop, blank_row, size
from osculate.simulation.records import RUNNING


def run_with_decisions(
    loop: Loop, runs: NDArray[np.float64], parameters: NDArray[np.float64], report: Report | None
) -> Finished:
    """Like `run_block` for one lane and every step recorded; asks the loop's decider every period."""
    assert loop.decide is not None
    engine, clock, row = loop.engine(1), loop.setup.clock, blank_row()
    likes = (loop.initial, loop.parameters, row)
    fields = list(names(loop.initial))
    at = {name: fields.index(name) for name in ("held.memory.steer.steering_angle", "status.code")}
    runs = np.array(runs)
    record = np.empty((clock.steps, size(row), 1))
    measure: Any = loop.bindings["measure"]
    made = 0
    while made < clock.steps and runs[at["status.code"], 0] == RUNNING:
        run: Any = rebuild(loop.initial, iter(runs[:, 0].tolist()))
        motion = measure(run.state.plant, loop.parameters.plant)
        runs[at["held.memory.steer.steering_angle"], 0] = loop.decide(motion, run.held.memory)
        steps = min(clock.substeps, clock.steps - made)
        made += engine.run_block(
            *likes, runs, parameters, loop.tables, made, steps, clock.step, clock.substeps, 1,
            record[made:],
        )  # fmt: skip
        if report and made % (50 * clock.substeps) == 0:
            report(made / clock.steps)
    last = np.empty((size(row), 1))
    engine.land_block(*likes, runs, parameters, loop.tables, clock.step, clock.substeps, last)
    return Finished(runs, record[:made], last)
