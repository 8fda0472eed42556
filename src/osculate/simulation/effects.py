"""What is given acts, or is refused: parts that the plant of a setup cannot do anything with."""

from collections.abc import Mapping
from typing import Any

from osculate.control.tracking import PathTracker
from osculate.errors import InvalidInput
from osculate.simulation.loop import Setup

READ = {  # what only one kind of law reads, and what the other does instead
    "target": "is for a law that follows speeds over time; a path tracker drives as limits=Limits(...) say",
    "limits": "are for a path tracker, which plans its speeds; this law drives at the speeds of its target",
}
#: Parts of a disturbance on the yaw acceleration.
YAWING = ("yaw_rate_feedback", "yaw_rate_amplitude")


def require_read(given: Mapping[str, Any]) -> None:
    """Refuse a part that the law never reads.

    Args:
        given: The parts that were given, by name.

    Raises:
        InvalidInput: A target for a path tracker, limits for a law that follows a target.
    """
    unread = "target" if isinstance(given.get("controller"), PathTracker) else "limits"
    if unread in given:
        raise InvalidInput(unread, given[unread], READ[unread])


def require_effect(setup: Setup) -> None:
    """Refuse what would change nothing.

    Raises:
        InvalidInput: A yaw rate at the start, or a yaw acceleration, where the steering decides it; a
            heading of a target where there is none. Says what to change.
    """
    plant, initial = setup.plant, setup.initial
    kind = type(plant).__name__
    if initial.yaw_rate != 0.0 and not plant.starts_turning:
        message = (
            f"follows from speed and steering on the plant {kind}; must be 0, set initial.speed"
        )
        raise InvalidInput("initial.yaw_rate", initial.yaw_rate, message)
    if initial.target_heading is not None and isinstance(setup.controller, PathTracker):
        message = "is of a target, which a path tracker has not; leave it out"
        raise InvalidInput("initial.target_heading", initial.target_heading, message)
    if "yaw_acceleration" not in plant.feels:
        for name in YAWING:
            value = getattr(setup.disturbance, name)
            if value != 0.0:
                message = f"steering alone turns the plant {kind}; must be 0, or plant Slip(...)"
                raise InvalidInput(f"disturbance.{name}", value, message)
