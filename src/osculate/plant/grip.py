"""Before a run: whether the tyres can do what the limits and the speed plan ask for.

A tyre on a floor with the friction µ carries µ g across the robot. Only the drive wheels push and brake;
they carry the part 1 − x / a of the weight, with the centre of mass x ahead of their axle, and so give
µ g (1 − x / a) along it. Both at once have to stay within an ellipse.
"""

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.plant.contract import Plant
from osculate.plant.tyre import Patch
from osculate.target.speed import Limits, SpeedPlan
from osculate.vehicle.tricycle import Tricycle

Array = NDArray[np.float64]

USUAL = 0.8  # friction of rubber on a dry floor, for plants whose wheels cannot slide


def foresee_sliding(
    plant: Plant, robot: Tricycle, limits: Limits, curve: Curve, plan: SpeedPlan
) -> str | None:
    """Why a robot may slide, in a sentence; None if limits and plan are within what the floor gives.

    Args:
        plant: What it drives on, with all faults.
        robot: What drives.
        limits: Its task.
        curve: Where it drives.
        plan: Its speed there.
    """
    friction = float(getattr(plant, "friction", USUAL))
    aside = robot.gravity * float(getattr(plant, "lateral_friction", 1.0))
    along = robot.gravity * min(1.0, max(0.0, 1.0 - robot.centre_ahead / robot.wheelbase))
    reasons = _beyond(robot, limits, friction, aside, along)
    place = _worst(_friction(plant, curve, plan, friction), aside, along, curve, plan)
    if not reasons and place is None:
        return None
    floor = f"on a floor with the friction {friction:.3g}"
    where = f"; as planned it does at s = {place:.4g} m" if place is not None else ""
    if not reasons:
        return (
            f"the robot may slide: at s = {place:.4g} m the plan asks for more than the floor's grip; "
            "lower limits.lateral_acceleration, limits.acceleration or limits.deceleration"
        )
    return f"the robot may slide {floor}: {' and '.join(reasons)}; lower these limits{where}"


def _beyond(
    robot: Tricycle, limits: Limits, friction: float, aside: float, along: float
) -> list[str]:
    """The limits that bind, beyond the grip of the floor."""
    across = min(limits.lateral_acceleration, limits.tipping * robot.tipping_acceleration)
    drive = limits.torque * robot.motor_deceleration
    asked = {
        "lateral_acceleration": (across, friction * aside, "µ g"),
        "acceleration": (
            min(limits.acceleration, drive),
            friction * along,
            "µ g on the drive wheels",
        ),
        "deceleration": (
            min(limits.deceleration, drive),
            friction * along,
            "µ g on the drive wheels",
        ),
    }
    return [
        f"limits.{name} = {getattr(limits, name):.3g} m/s² exceeds {what} = {grip:.3g} m/s²"
        for name, (size, grip, what) in asked.items()
        if size > grip
    ]


def _friction(plant: Plant, curve: Curve, plan: SpeedPlan, friction: float) -> Array:
    """Friction below the axle at the plan's nodes: the last patch counts."""
    point = curve.at(plan.arc_length)
    floor = np.full(len(plan.arc_length), friction)
    patches: tuple[Patch, ...] = getattr(plant, "patches", ())
    for patch in patches:
        inside = np.hypot(point.x - patch.x, point.y - patch.y) <= patch.radius
        floor[inside] = patch.friction
    return floor


def _worst(
    friction: Array, aside: float, along: float, curve: Curve, plan: SpeedPlan
) -> float | None:
    """Arc length (m) at which the plan is furthest beyond the grip; None if nowhere."""
    across = plan.speed**2 * curve.at(plan.arc_length).curvature
    use = (across / (friction * aside)) ** 2 + (
        plan.acceleration / (friction * max(along, 1e-9))
    ) ** 2
    worst = int(use.argmax())
    return float(plan.arc_length[worst]) if use[worst] > 1.0 + 1e-6 else None
