"""The contract of estimators: measurements in, a believed motion out.

    estimate(measurement, told, belief, parameters) -> (Sight, belief)

is a kernel; it works in lanes and on a robot alike.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

from osculate.vehicle.motion import Motion


class Told(NamedTuple):
    """What acted on the robot since the last instant."""

    steering_angle: float  # rad, command of the servo
    acceleration: float  # m/s², that the drives were to produce


class Evidence(NamedTuple):
    """How far measurements can be trusted: for how long each has been missing or refused.

    A sensor that has never reported anything is not missed: its age is 0 until its first reading.
    """

    fix_age: float  # s, since the last pose that fitted
    surprise: float  # mean square of normalised innovations of the poses; about 1 when all is well
    wheels_age: float  # s, since the last reading of both wheel encoders that was believed
    steering_age: float  # s, likewise of the steering encoder
    gyro_age: float  # s, likewise of the gyro
    located: float  # 1 once a pose was believed


class Sight(NamedTuple):
    """A robot as a law may see it: a twin that rolls without slip and steers without offset.

    Its heading is the direction in which O moves, its steering angle the one that gives the yaw rate.
    A steering angle φ of the twin is the servo's angle atan(stretch tan φ) − bias.
    """

    motion: Motion
    bias: float  # rad
    stretch: float
    evidence: Evidence


#: Nothing is doubted: a motion that is known exactly.
TRUSTED = Evidence(0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class EstimatorPart:
    """An estimator ready to run."""

    estimate: Any  # kernel, see the module's docstring
    parameters: Any
    belief: Any  # initial value
