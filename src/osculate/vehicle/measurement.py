"""What sensors report: the record that passes from a robot (or its simulation) to an estimator.

Whatever did not arrive since the last instant is missing: NaN (on a robot also None). A reading that is
infinite or impossible counts as missing. How long each sensor may be missing is in the documentation
("What a robot is told").
"""

import math
from typing import NamedTuple

FARTHEST = 1e8  # m: no map is larger, not even in UTM coordinates
TURNS = 1e4  # rad, of a heading that is not wrapped
FASTEST = 100.0  # m/s and rad/s: nothing that rolls is faster


class Fix(NamedTuple):
    """A pose measured from outside: laser, camera, tags.

    It is believed whole or not at all: a value that is missing or not finite, an age below zero or
    beyond the estimator's ``history``, or a pose that was reported before refuse all of it.
    """

    x: float  # m, rear-axle midpoint O in the map frame (REP-105)
    y: float  # m
    heading: float  # rad, counter-clockwise from x; may be wrapped or not
    age: float  # s, time since it was taken; 0 is now


class Measurement(NamedTuple):
    """One instant of all sensors; missing is NaN or None."""

    left: float  # m/s, left drive wheel's encoder: spin times the nominal radius, forward positive
    right: float  # m/s, right drive wheel's encoder
    steering_angle: float  # rad, of the servo, positive turns left when driving forward
    yaw_rate: float  # rad/s, gyro, counter-clockwise
    fix: Fix  # the newest pose that arrived; `NO_FIX` or None if there is none


#: No pose arrived.
NO_FIX = Fix(math.nan, math.nan, math.nan, 0.0)
