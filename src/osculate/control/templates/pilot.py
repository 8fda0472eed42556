"""Template: an estimator before a path tracker, which steers the robot as it is believed to be."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.estimation.contract import Told
from osculate.control.pilot import PilotMemory, PilotParameters
from osculate.kernel import kernel
from osculate.kernel.maths import clip
from osculate.vehicle.measurement import Measurement

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.estimation.filter import estimate_kinematics as estimate
    from osculate.control.templates.tracking import track

    DELAYED = True

HARDEST = 5.0  # m/s², that drives produce at most, as far as an estimator is told


@kernel
def pilot(
    measurement: Measurement, memory: PilotMemory, p: PilotParameters, tables: NDArray[np.float64]
) -> Any:
    """One decision from measurements: command, next memory, what was wanted and missed."""
    sight, belief = estimate(measurement, memory.told, memory.belief, p.estimator)
    command, law, reference, errors = track(sight, memory.law, p.law, tables)
    acting = memory.law.pending[len(memory.law.pending) - 1].steering_angle
    angle = acting if DELAYED else command.steering_angle
    gain = (law.speed.model - memory.law.speed.model) / p.law.period
    told = Told(angle, clip(gain, -HARDEST, HARDEST))
    return command, PilotMemory(law, belief, told), reference, errors
