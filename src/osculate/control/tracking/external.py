"""Steering laws that are no kernels: an optimiser, another program, a person.

Progress, servo observer and speed loop stay compiled and are those of every tracker; the steering
angle of each decision is put into the law's memory just before the decision is made. Such laws run one
robot at a time.
"""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking.contract import (
    FREE,
    PathTracker,
    Road,
    SteerPart,
    TrackingMemory,
    View,
)
from osculate.curve.contract import Curve
from osculate.curve.table import CurveTable
from osculate.kernel import Nothing, kernel
from osculate.vehicle.motion import Motion

#: What was measured and what the law remembers -> the steering angle (rad) of this decision.
Decide = Callable[[Motion, TrackingMemory], float]


class GivenSteering(NamedTuple):
    """A decision made elsewhere."""

    steering_angle: float  # rad


@kernel
def steer_given(
    view: View, memory: GivenSteering, p: Nothing, curve: CurveTable, tables: NDArray[np.float64]
) -> Any:
    """What was put into the memory."""
    return memory.steering_angle, FREE, memory


class ExternalTracker(PathTracker):
    """A tracker whose steering angles come from Python."""

    def load(self) -> Any:
        """The optional package that it needs, asked for before long work; None if none.

        Raises:
            MissingExtra: It is not installed.
        """
        return None

    def steering_part(self, road: Road) -> SteerPart:
        """See `PathTracker.steering_part`."""
        return SteerPart(steer_given, Nothing(), GivenSteering(0.0))

    @abstractmethod
    def decider(self, curve: Curve, road: Road, tables: NDArray[np.float64]) -> Decide:
        """The function that decides, made once for a curve and a robot."""
