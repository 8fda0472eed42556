"""Stops: from the decision to stop until the robot stands without drive, and stays there.

A stop brakes along the path as it is believed, by the brake if there is one, else by the motors, which
only ever act against the motion. When the robot stands, or when it should, the torque is zero; only a reset
ends that. The end of the path and the wait for a first pose are the same standstill.

Where the speed is not known, the motors spend no more than the momentum that the robot had: what they and
rolling resistance take from its speed is summed up, and at zero the robot stands as far as anybody can say.
"""

from typing import NamedTuple

from osculate.control.estimation.contract import Evidence
from osculate.control.gate import PATIENCE
from osculate.control.reasons import (
    ARRIVED,
    BLIND,
    EXTERNAL,
    LAW,
    POSE,
    STOP_INPUT,
    UNDECIDED,
    UNDRIVEN,
    WAITING,
    WHEELS,
    Alarm,
    is_stop,
)
from osculate.kernel import kernel, select

ROLLING = 0.05  # m/s, up to which a robot without drive keeps its steering still
REST = 2e-3  # m/s, below which a robot that brakes stands
GRACE = 0.5  # s, that braking may take beyond one and a half times what it should


class StopParameters(NamedTuple):
    """Parameters of `watch_readings` and `come_to_rest`."""

    period: float  # s
    pose: float  # s, for which poses may be missing
    wheels: float  # s, for which the wheel encoders may be missing
    deceleration: float  # m/s², of a stop
    brake: float  # part of the full brake that a stop applies; 0 without a brake
    parking: float  # likewise at rest
    end: float  # m, arc length at which the path ends
    inertia: float  # kg m: torque of both wheels per acceleration
    rolling: float  # m/s², by rolling resistance


class StopMemory(NamedTuple):
    """Memory of a stop."""

    alarm: Alarm  # of the stop; no reason while there is none
    place: float  # m, arc length at which it was decided
    left: float  # s, that braking may still take
    speed: float  # m/s, that braking has not taken yet
    doubtful: float  # 1 once the speed was not known while the robot braked
    resting: float  # 1 once the robot stands
    requested: float  # 1 once somebody outside has asked for a stop


@kernel
def watch_readings(
    evidence: Evidence, undecided: float, arrived: bool, now: StopMemory, p: StopParameters
) -> Alarm:
    """The alarm of what is missing, of the stop input, and of the path's end."""
    alarm = select(arrived, Alarm(ARRIVED, 0.0, 0.0), Alarm(0.0, 0.0, 0.0))
    alarm = select(evidence.wheels_age > p.wheels, Alarm(UNDRIVEN, 0.0, WHEELS), alarm)
    alarm = select(evidence.fix_age > p.pose, Alarm(BLIND, 0.0, POSE), alarm)
    alarm = select(evidence.located > 0.0, alarm, Alarm(WAITING, 0.0, POSE))
    alarm = select(undecided > PATIENCE, Alarm(UNDECIDED, 0.0, LAW), alarm)
    return select(now.requested > 0.0, Alarm(EXTERNAL, 0.0, STOP_INPUT), alarm)


@kernel
def come_to_rest(
    alarm: Alarm, speed: float, known: bool, torque: float, progress: float, now: StopMemory,
    p: StopParameters,
) -> StopMemory:  # fmt: skip
    """The memory after this instant's alarm; the first stop stays.

    Args:
        alarm: Of this instant.
        speed: As believed (m/s).
        known: Whether that was measured and is not doubted.
        torque: Of both wheels since the last instant (N m).
        progress: Arc length (m).
        now: The memory.
        p: The parameters.
    """
    final = is_stop(alarm.reason) or alarm.reason == ARRIVED
    fresh = final and now.alarm.reason == 0.0
    due = 1.5 * abs(speed) / p.deceleration + GRACE
    begun = StopMemory(alarm, progress, due, abs(speed), 0.0, now.resting, now.requested)
    after = select(fresh, begun, now)
    braking = after.alarm.reason > 0.0
    left = after.left - p.period if braking else 0.0
    taken = p.period * (abs(torque) / p.inertia + p.rolling)
    momentum = after.speed - taken if now.alarm.reason > 0.0 else after.speed
    doubtful = 1.0 if braking and not known else after.doubtful
    stands = braking and (abs(speed) < REST or left <= 0.0 or (doubtful > 0.0 and momentum <= 0.0))
    resting = 1.0 if stands else after.resting
    return StopMemory(after.alarm, after.place, left, momentum, doubtful, resting, after.requested)


@kernel
def oppose(torque: float, speed: float) -> float:
    """A torque that only brakes."""
    forward = torque if torque < 0.0 else 0.0
    backward = torque if torque > 0.0 else 0.0
    return forward if speed > 0.0 else backward


#: No stop.
DRIVING = StopMemory(Alarm(0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
