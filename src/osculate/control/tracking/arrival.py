"""How a robot comes to rest at the end of an open path: its speed follows from the way that is left.

With r the way left when a decision acts, b the deceleration of the plan's end, and the time T,

    v = √(2 b (r − b T²/2))     while r > b T²,       v = r / T     after that,

which join with the same slope, b / v. The first part is a plan's constant deceleration; the second is a
linear feedback of the place, so that neither a wrong mass nor a delay leaves a distance. T is long beside
the time from a decision to its effect, or the feedback would swing. `LEAST` ends the second part, which
would take for ever; it takes about T ln(b T / `LEAST`) more than the plan, 0.3 to 0.6 s for the robots of
the catalogue.
"""

import math
from math import sqrt
from typing import NamedTuple

from osculate.curve.contract import Curve
from osculate.kernel import kernel
from osculate.target.speed import Limits, rest_deceleration, rests_at_end
from osculate.vehicle.tricycle import Tricycle

LEAST = 0.005  # m/s, with which the last fractions of a millimetre are driven
SHORTEST = 0.1  # s, shortest T
STEADY = 2.0  # T per time from a decision to its effect, at least


class ArrivalParameters(NamedTuple):
    """Parameters of `arrival_speed`."""

    end: float  # m, arc length at which the robot comes to rest; infinite if it passes the end
    deceleration: float  # m/s², b
    time: float  # s, T


@kernel
def arrival_speed(s: float, p: ArrivalParameters) -> float:
    """Largest speed (m/s) of a robot that is to come to rest; the decision acts at arc length ``s`` (m)."""
    left = p.end - s
    reach = p.deceleration * p.time * p.time
    room = left - 0.5 * reach
    far = sqrt(2.0 * p.deceleration * (room if room > 0.0 else 0.0))
    wanted = far if left > reach else left / p.time
    return wanted if wanted > LEAST else LEAST


def arrival_parameters(
    curve: Curve, robot: Tricycle, limits: Limits, ahead: float
) -> ArrivalParameters:
    """The numbers for the kernels.

    Args:
        curve: Where to drive.
        robot: What drives.
        limits: What the task allows.
        ahead: Time from a decision to its effect, motors included (s).
    """
    end = curve.length if rests_at_end(curve, limits) else math.inf
    return ArrivalParameters(end, rest_deceleration(robot, limits), max(SHORTEST, STEADY * ahead))
