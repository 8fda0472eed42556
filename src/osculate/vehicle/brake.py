"""A brake on the drive wheels: optional, and the only thing that holds a robot on a slope."""

from typing import NamedTuple

from osculate.kernel import kernel
from osculate.kernel.maths import clip
from osculate.spec import Spec, quantity


class Brake(Spec):
    """A friction brake on the drive wheels, as trucks have; it is applied in part or wholly."""

    deceleration: float = quantity(
        "m/s²", "of the robot without load under the full brake", default=1.5, gt=0
    )
    holding_torque: float = quantity(
        "N m", "of both drive wheels together, that it holds at standstill", gt=0
    )


class BrakeParameters(NamedTuple):
    """Parameters of `brake_torque`."""

    moving: float  # N m, both wheels, of the full brake at speed
    holding: float  # N m, both wheels, at standstill
    crawl: float  # m/s, speed at which friction has half of its size


#: No brake.
NO_BRAKE = BrakeParameters(0.0, 0.0, 1.0)


@kernel
def brake_torque(command: float, speed: float, p: BrakeParameters) -> float:
    """Torque (N m, both wheels) against the motion; friction is smooth around standstill."""
    near = abs(speed) + p.crawl
    size = p.moving + (p.holding - p.moving) * p.crawl / near
    return clip(command, 0.0, 1.0) * size * speed / near


def brake_parameters(brake: Brake | None, mass_radius: float, crawl: float) -> BrakeParameters:
    """The numbers for `brake_torque`.

    Args:
        brake: The brake; None is none.
        mass_radius: Mass of the robot times the radius of its wheels (kg m).
        crawl: Speed (m/s) at which friction has half of its size.
    """
    if brake is None:
        return NO_BRAKE
    return BrakeParameters(brake.deceleration * mass_radius, brake.holding_torque, crawl)
