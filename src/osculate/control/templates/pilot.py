"""Template: an estimator before a path tracker, which steers the robot as it is believed to be."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.estimation.contract import Sight, Told
from osculate.control.pilot import PilotMemory, PilotParameters
from osculate.kernel import kernel
from osculate.kernel.maths import atan, tan
from osculate.vehicle.measurement import Measurement
from osculate.vehicle.motion import Command

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.estimation.ekf import estimate_kinematics as estimate
    from osculate.control.templates.tracking import track

    DELAY = 1


@kernel
def servo_angle(twin: float, sight: Sight) -> float:
    """Angle (rad) of the servo at which the robot turns as its twin with the angle ``twin`` does."""
    return atan(sight.stretch * tan(twin)) - sight.bias


@kernel
def pilot(
    measurement: Measurement, memory: PilotMemory, p: PilotParameters, tables: NDArray[np.float64]
) -> Any:
    """One decision from measurements: command, next memory, what was wanted and missed."""
    sight, belief = estimate(measurement, memory.told, memory.belief, p.estimator)
    decided, law, reference, errors = track(sight.motion, sight.evidence, memory.law, p.law, tables)
    angle = servo_angle(decided.steering_angle, sight)
    sent = (angle,) + memory.sent[:-1]
    gain = (law.speed.model - memory.law.speed.model) / p.law.period
    following = PilotMemory(law, belief, Told(sent[DELAY], gain), sent)
    command = Command(angle, decided.torque_left, decided.torque_right)
    return command, following, reference, errors
