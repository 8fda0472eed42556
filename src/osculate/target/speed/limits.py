"""What a task allows, and one more limit of the speed that others may add."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.spec import Spec, quantity
from osculate.vehicle.tricycle import Tricycle

Array = NDArray[np.float64]


class Limits(Spec):
    """What the task allows, on top of what the robot can do.

    A plan keeps all of them everywhere. On an open curve it begins and ends without acceleration.
    """

    speed: float = quantity("m/s", "largest speed", default=1.0, gt=0)
    lateral_acceleration: float = quantity("m/s²", "largest v² κ", default=2.0, gt=0)
    acceleration: float = quantity("m/s²", "largest speed-up", default=0.8, gt=0)
    deceleration: float = quantity("m/s²", "largest slow-down", default=0.8, gt=0)
    jerk: float = quantity("m/s³", "largest rate of the acceleration", default=10.0, gt=0)
    steering: float = quantity(
        "1", "part of the steering rate limit that the path may use", default=0.6, gt=0, le=1
    )
    torque: float = quantity(
        "1", "part of the motors' torque that the path may use", default=0.8, gt=0, le=1
    )
    tipping: float = quantity(
        "1", "part of the tipping acceleration that may be used", default=0.7, gt=0, le=1
    )
    creep: float = quantity(
        "m/s",
        "speed at the ends of an open curve, and where a file asks for less; other limits may ask for less",
        default=0.05,
        gt=0,
    )
    start_speed: float | None = quantity(
        "m/s",
        "speed at the start, at least creep; by default that of the robot there, on closed curves free",
        default=None,
        ge=0,
    )
    end_speed: float | None = quantity(
        "m/s",
        "speed with which the end is passed, at least creep; by default the robot comes to rest there, on "
        "closed curves it is free",
        default=None,
        ge=0,
    )


def rests_at_end(curve: Curve, limits: Limits) -> bool:
    """Whether the robot comes to rest at the end: of an open curve that it is not to pass with a speed."""
    return not (curve.closed or limits.end_speed)


def rest_deceleration(robot: Tricycle, limits: Limits) -> float:
    """Deceleration (m/s²) with which a robot comes to rest at the end of a path.

    Rolling resistance is not counted on: what it gives is left for a load that nobody knows.
    """
    return min(limits.deceleration, limits.torque * robot.motor_deceleration)


class Ceiling(NamedTuple):
    """One more limit of the speed over arc length."""

    name: str
    arc_length: tuple[float, ...]  # m, increasing
    speed: tuple[float, ...]  # m/s, there

    def at(self, s: Array) -> Array:
        """The limit (m/s) at arc lengths ``s`` (m)."""
        return np.interp(s, self.arc_length, self.speed)
