"""What sensors report: the record that passes from a robot (or its simulation) to an estimator.

Whatever did not arrive since the last instant is not a number.
"""

import math
from typing import NamedTuple


class Fix(NamedTuple):
    """A pose measured from outside: laser, camera, tags."""

    x: float  # m, O in the map frame
    y: float  # m
    heading: float  # rad
    age: float  # s, time since it was taken


class Measurement(NamedTuple):
    """One instant of all sensors."""

    left: float  # m/s, left drive wheel's encoder, with the nominal radius
    right: float  # m/s
    steering_angle: float  # rad, of the servo
    yaw_rate: float  # rad/s, gyro
    fix: Fix


NO_FIX = Fix(math.nan, math.nan, math.nan, 0.0)
