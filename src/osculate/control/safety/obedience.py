"""Whether the steering does what it is told.

A model of the servo starts wherever the servo was last seen to move. When the model has moved on and the
servo has not, for longer than an unknown delay could explain, the steering is stuck. A servo that is late
or slow moves, and is no reason to stop: whether it keeps the robot in its corridor is judged there.
"""

from typing import NamedTuple

from osculate.kernel import kernel, select
from osculate.vehicle.actuators import ServoStep, Steering, servo_move

SHARE = 0.25  # of the model's way, that a servo which obeys goes at least


class ObedienceParameters(NamedTuple):
    """Parameters of `watch_servo`."""

    servo: ServoStep  # one period
    period: float  # s
    noise: float  # rad, that a servo seems to move when it stands
    disobedience: float  # rad, of the model's way from which on the servo is expected to have moved
    patience: float  # s, for which it may not have


class ObedienceMemory(NamedTuple):
    """Memory of `watch_servo`."""

    anchor: float  # rad, where the servo was last seen to move
    shadow: Steering  # the model, which started there
    stuck: float  # s, for which only the model has been moving


@kernel
def watch_servo(
    steering: Steering, command: float, now: ObedienceMemory, p: ObedienceParameters
) -> ObedienceMemory:
    """The memory one period later; ``command`` (rad) acts until then."""
    way = abs(now.shadow.angle - now.anchor)
    gone = abs(steering.angle - now.anchor)
    moves = gone > SHARE * way + p.noise or way < p.noise
    start = select(moves, steering, now.shadow)
    waiting = not moves and way > p.disobedience
    return ObedienceMemory(
        steering.angle if moves else now.anchor,
        servo_move(start, command, p.servo),
        now.stuck + p.period if waiting else 0.0,
    )
