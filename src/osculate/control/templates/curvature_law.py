"""Template: the paper's law with one way to anticipate the yaw target."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import Errors
from osculate.control.curvature import CurvatureMemory, CurvatureParameters, speed_torque
from osculate.kernel import kernel
from osculate.kernel.maths import atan
from osculate.target.contract import Reference
from osculate.vehicle.model import driven_curvature
from osculate.vehicle.motion import Command, Motion

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.control.curvature import anticipate_exponential as anticipate


@kernel
def curvature_law(
    t: float,
    motion: Motion,
    reference: Reference,
    memory: CurvatureMemory,
    p: CurvatureParameters,
    tables: NDArray[np.float64],
) -> Any:
    """Steering angle and torques of eq. (42), the memory's rate and the errors."""
    heading_error = motion.heading - reference.heading
    rate_error = motion.yaw_rate - reference.yaw_rate
    speed_error = motion.speed - reference.speed

    feedback = -(p.heading_gain * heading_error + p.rate_gain * rate_error)
    yaw_acceleration = anticipate(t, feedback, speed_error, reference, p, tables)
    difference = yaw_acceleration * p.model.differential  # u₁

    curvature = driven_curvature(motion.speed, motion.yaw_rate, p.at_rest)
    total, target_rate = speed_torque(
        p, motion, reference, memory, yaw_acceleration, curvature
    )  # u₂

    command = Command(
        steering_angle=atan(p.model.wheelbase * curvature),
        torque_left=0.5 * (total - difference),
        torque_right=0.5 * (total + difference),
        brake=0.0,
    )
    errors = Errors(heading_error, rate_error, speed_error)
    return command, CurvatureMemory(target_rate), errors
