"""What is given acts, or is refused: parts that the plant of a setup cannot do anything with."""

from osculate.errors import InvalidInput
from osculate.simulation.loop import Setup

YAWING = (
    "yaw_rate_feedback",
    "yaw_rate_amplitude",
)  # parts of a disturbance on the yaw acceleration


def require_effect(setup: Setup) -> None:
    """Refuse what would change nothing on the plant.

    Raises:
        InvalidInput: A yaw rate at the start, or a yaw acceleration, where the steering decides it; says
            what to change.
    """
    plant, initial = setup.plant, setup.initial
    kind = type(plant).__name__
    if initial.yaw_rate != 0.0 and not plant.starts_turning:
        message = (
            f"follows from speed and steering on the plant {kind}; must be 0, set initial.speed"
        )
        raise InvalidInput("initial.yaw_rate", initial.yaw_rate, message)
    if "yaw_acceleration" not in plant.feels:
        for name in YAWING:
            value = getattr(setup.disturbance, name)
            if value != 0.0:
                message = f"steering alone turns the plant {kind}; must be 0, or plant Slip(...)"
                raise InvalidInput(f"disturbance.{name}", value, message)
