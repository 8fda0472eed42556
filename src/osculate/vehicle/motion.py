"""What a robot does, what its encoders report, and what it is told."""

from typing import NamedTuple


class Motion(NamedTuple):
    """What can be known of the robot at one instant (frames of REP-103/105).

    Where motions are measured themselves (`Stepper` without an estimator) a reading that is missing is
    NaN or None. A motion with a missing, infinite or impossible value counts as missing as a whole.
    """

    x: float  # m, rear-axle midpoint O in the map frame
    y: float  # m
    heading: float  # rad, counter-clockwise from x; may be wrapped or not
    speed: float  # m/s, of O along the heading, negative when driving backwards
    yaw_rate: float  # rad/s, counter-clockwise
    steering_angle: float  # rad, of the steered wheel, positive turns left when driving forward


class Wheels(NamedTuple):
    """Speeds of the drive wheels' treads: spin times the radius that the robot's maker states."""

    left: float  # m/s
    right: float  # m/s


class Command(NamedTuple):
    """What a law asks of the actuators; left and right as seen by somebody standing on the robot.

    The paper's labels are mirrored: its T_l is the torque that grows for a left turn, which on a
    robot with x forward and y left is the right wheel's. This is the one place that says so.
    """

    steering_angle: float  # rad, of the servo
    torque_left: float  # N m
    torque_right: float  # N m
    brake: float = 0.0  # part of the full brake, 0 to 1; nothing on a robot without one
