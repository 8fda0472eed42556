"""Template: what a sampled law sees and suffers, for plants that are no kernels."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import compiled, load, store
from osculate.plant.contract import Push
from osculate.vehicle.motion import Command, Motion, Wheels

if TYPE_CHECKING:  # parts, bound by `compose`
    from osculate.plant.sensors import sense_exactly as sense
    from osculate.plant.weather import blow_nothing as blow
    from osculate.plant.weather import impair_nothing as impair

    LIKE_SENSORS: Any = None
    LIKE_MEMORY: Any = None
    LIKE_BLOWS: Any = None
    LIKE_IMPAIRMENT: Any = None

MOTION = Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
WHEELS = Wheels(0.0, 0.0)
COMMAND = Command(0.0, 0.0, 0.0, 0.0)


@compiled
def sense_once(
    motion: NDArray[np.float64],
    wheels: NDArray[np.float64],
    memory: NDArray[np.float64],
    parameters: NDArray[np.float64],
    seen: NDArray[np.float64],
) -> None:
    """What the sensors report of one robot.

    Args:
        motion: Shape (6, 1).
        wheels: Shape (2, 1).
        memory: Shape (leaves, 1), read and overwritten.
        parameters: Shape (leaves, 1).
        seen: Shape (leaves, 1), overwritten.
    """
    measured, following = sense(
        load(MOTION, motion, 0),
        load(WHEELS, wheels, 0),
        load(LIKE_MEMORY, memory, 0),
        load(LIKE_SENSORS, parameters, 0),
    )
    store(following, memory, 0)
    store(measured, seen, 0)


@compiled
def act_once(
    t: float,
    motion: NDArray[np.float64],
    before: NDArray[np.float64],
    decided: NDArray[np.float64],
    blows: NDArray[np.float64],
    impairment: NDArray[np.float64],
    push: NDArray[np.float64],
) -> None:
    """What becomes of a decision, and what pushes the robot.

    Args:
        t: Time (s).
        motion: Shape (6, 1).
        before: Shape (4, 1), the command before.
        decided: Shape (4, 1), overwritten by what the actuators are told.
        blows: Shape (leaves, 1).
        impairment: Shape (leaves, 1).
        push: Shape (4, 1), overwritten.
    """
    command: Command = load(COMMAND, decided, 0)
    told = impair(t, load(COMMAND, before, 0), command, load(LIKE_IMPAIRMENT, impairment, 0))
    pushed: Push = blow(t, load(MOTION, motion, 0), load(LIKE_BLOWS, blows, 0))
    store(told, decided, 0)
    store(pushed, push, 0)
