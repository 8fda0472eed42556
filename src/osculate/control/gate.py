"""The gate: the last thing before a command, the same for every law, with or without estimator and safety.

Whatever was measured and decided, what leaves the gate is finite and within the actuators' limits in
their own coordinates: steering angle, steering rate (against the command before), torque, brake. A decision
that is not finite is replaced by the last command, for `PATIENCE` seconds; then it is a stop.
"""

from typing import Any, NamedTuple

from osculate.kernel import finite_sum, kernel, select
from osculate.kernel.maths import clip
from osculate.vehicle.actuators import Actuators
from osculate.vehicle.motion import Command

PATIENCE = 0.1  # s, for which decisions may not be finite


class GateParameters(NamedTuple):
    """Parameters of `gate_command`."""

    angle_limit: float  # rad
    step_limit: float  # rad, of the steering command from one period to the next
    torque_limit: float  # N m, each wheel
    period: float  # s


class GateMemory(NamedTuple):
    """Memory of `gate_command`."""

    last: Command  # that left the gate
    missed: float  # number of decisions that were not finite, in all
    undecided: float  # s, for which decisions have not been finite without a break


@kernel
def gate_command(decided: Command, sound: bool, now: GateMemory, p: GateParameters) -> Any:
    """The command that leaves, and the memory; ``sound`` is false where the law gave nothing finite."""
    finite = finite_sum(decided) == 0.0
    asked = select(finite, decided, now.last)
    last = now.last.steering_angle
    angle = clip(asked.steering_angle, last - p.step_limit, last + p.step_limit)
    command = Command(
        clip(angle, -p.angle_limit, p.angle_limit),
        clip(asked.torque_left, -p.torque_limit, p.torque_limit),
        clip(asked.torque_right, -p.torque_limit, p.torque_limit),
        clip(asked.brake, 0.0, 1.0),
    )
    good = finite and sound
    missed = 0.0 if good else 1.0
    undecided = 0.0 if good else now.undecided + p.period
    return command, GateMemory(command, now.missed + missed, undecided)


def gate_of(act: Actuators, period: float, angle: float) -> tuple[GateParameters, GateMemory]:
    """Parameters, and the memory of a servo that stands at ``angle`` (rad)."""
    limit = act.steering_angle_limit
    parameters = GateParameters(limit, act.steering_rate_limit * period, act.torque_limit, period)
    held = min(max(angle, -limit), limit)
    return parameters, GateMemory(Command(held, 0.0, 0.0, 0.0), 0.0, 0.0)
