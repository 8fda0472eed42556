"""Why a robot is slowed down, stopped or kept waiting, and what caused it: numbers that records hold."""

from typing import NamedTuple

from osculate.kernel import kernel

#: Reasons of interventions; 0 is none.
REASONS = {
    1: "lateral acceleration limited",
    2: "slowed down for the steering rate",
    3: "slowed down to be able to stop inside the corridor",
    4: "stopped: would leave the corridor",
    5: "stopped: no pose",
    6: "stopped: impossible measurements",
    7: "stopped: the steering does not obey",
    8: "stopped: no wheel encoders",
    9: "stopped: outside the corridor before the start",
    10: "stopped: from outside",
    11: "stopped: no finite decision",
    12: "waiting for a pose",
    13: "goes on without the steering encoder",
    14: "goes on without the gyro",
    15: "at the end of the path",
}
(
    LATERAL, RATE, CLOSE, LEAVING, BLIND, IMPOSSIBLE, DISOBEYED, UNDRIVEN, OUTSIDE, EXTERNAL,
    UNDECIDED, WAITING, NO_STEERING, NO_GYRO, ARRIVED,
) = (float(n) for n in REASONS)  # fmt: skip

#: What caused an intervention; 0 is nothing in particular.
CAUSES = {
    1: "position",
    2: "heading",
    3: "speed",
    4: "yaw rate",
    5: "steering angle",
    6: "pose",
    7: "wheel encoders",
    8: "steering encoder",
    9: "gyro",
    10: "stop input",
    11: "steering law",
}
(
    POSITION, HEADING, SPEED, YAW_RATE, STEERING_ANGLE, POSE, WHEELS, STEERING, GYRO, STOP_INPUT, LAW,
) = (float(n) for n in CAUSES)  # fmt: skip


class Alarm(NamedTuple):
    """An intervention."""

    reason: float  # see `REASONS`
    excess: float  # m, by which the robot would leave its corridor; 0 where that is not the reason
    cause: float  # see `CAUSES`


#: All is well.
CALM = Alarm(0.0, 0.0, 0.0)


@kernel
def is_stop(reason: float) -> bool:
    """Whether a reason stops the robot for good."""
    return LEAVING <= reason <= UNDECIDED


def explain(reason: float, excess: float, cause: float) -> str:
    """An intervention in words."""
    text = REASONS[int(reason)]
    if excess > 0.0:
        text += f" by {excess:.3g} m"
    return f"{text} ({CAUSES[int(cause)]})" if int(cause) else text
