"""What a robot does, what its encoders report, and what it is told."""

from typing import NamedTuple


class Motion(NamedTuple):
    """What can be known of the robot at one instant (frames of REP-103/105)."""

    x: float  # m, rear-axle midpoint O in the map frame
    y: float  # m
    heading: float  # rad, counter-clockwise from x, unwrapped
    speed: float  # m/s, of O along the heading
    yaw_rate: float  # rad/s
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

    steering_angle: float  # rad
    torque_left: float  # N m
    torque_right: float  # N m
