"""What the filter remembers from one instant to the next, and its parameters."""

from typing import Any, NamedTuple

from osculate.control.estimation.contract import Evidence
from osculate.control.estimation.gates import GateMemory, GateParameters
from osculate.control.estimation.kinematics import Covariance, Kinematics
from osculate.vehicle.actuators import ServoStep


class Place(NamedTuple):
    """A pose of dead reckoning, which no correction moves."""

    x: float  # m
    y: float  # m
    heading: float  # rad


class Heard(NamedTuple):
    """Which sensors have ever reported something: 1 or 0."""

    steering: float
    gyro: float


class Belief(NamedTuple):
    """Memory of the filter."""

    mean: Kinematics
    covariance: Covariance
    trail: Any  # tuple of `Place` at the last instants, the newest first
    evidence: Evidence
    gates: GateMemory
    heard: Heard
    rejected: float  # number of poses in a row that did not fit, but fitted each other
    off: Place  # what the last of them was off
    fix_nis: float  # of the last pose: squared normalised innovation, 3 degrees of freedom


class EkfParameters(NamedTuple):
    """Parameters of `estimate_kinematics`."""

    half: ServoStep  # half a period
    wheelbase: float  # m
    track: float  # m
    period: float  # s
    wander: Kinematics  # variance that every period adds
    doubt: Kinematics  # likewise, for every unit by which the poses surprise too much
    swerve: float  # part of δ that is left after a period
    speed: float  # variances of the sensors: (m/s)², mean of the wheels
    difference: float  # (m/s)², of the wheels
    wheel_slip: float  # standard deviation, part of the speed
    per_load: float  # 1 / ρ
    steering: float  # rad²
    gyro: float  # (rad/s)²
    position: float  # m²
    heading: float  # rad²
    gate: float  # square of the largest normalised innovation of a pose
    surprising: float  # likewise of wheels and gyro, beyond which they lose weight
    patience: float  # number of poses in a row that are not believed before one is
    gates: GateParameters
