"""One decision at a time: how a real robot, or any simulator, calls a pilot.

The same compiled step that runs in batches, behind a small object: a measurement in, a command out.
Whatever is measured, the command is finite and within the actuators' limits; a stop stays a stop.
"""

import math
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import Start
from osculate.control.estimation.ekf import Ekf
from osculate.control.pilot import PilotPart, pilot_part
from osculate.control.reasons import ARRIVED, WAITING, Alarm, explain
from osculate.control.safety import Safety, foresee
from osculate.control.tracking.contract import PathTracker, TrackingMemory, survey
from osculate.control.tracking.external import ExternalTracker
from osculate.curve.contract import Curve
from osculate.errors import InvalidInput, require_kind
from osculate.kernel import Tables, compose, leaves, rebuild, zeros
from osculate.target.speed import RESTING, Begin, Limits
from osculate.vehicle.measurement import NO_FIX, Fix, Measurement
from osculate.vehicle.motion import Command, Motion
from osculate.vehicle.tricycle import Tricycle

STANDING = 0.02  # m/s, below which a robot may be reset
NEARBY = 2000  # places of the curve at which a reset looks for the nearest
#: Parts and their kinds.
PARTS = {
    "law": PathTracker, "curve": Curve, "robot": Tricycle, "limits": Limits, "estimator": Ekf,
    "safety": Safety,
}  # fmt: skip
NOTHING = Measurement(math.nan, math.nan, math.nan, math.nan, NO_FIX)


class Stepper:
    """A path tracker on one curve, ready to be called once a period.

    Args:
        law: The tracker.
        curve: Where to drive.
        robot: What drives.
        limits: What the task allows.
        period: Time between two calls of `step` (s).
        delay: Time from a decision to its effect (s), in whole periods.
        motion: Where the robot is; by default at the start of the curve, at rest.
        progress: Arc length (m) of the curve near which it is.
        estimator: What makes motions of measurements; by default motions are measured themselves.
        safety: What guards the tracker; by default nothing.

    Attributes:
        plan: The speed over arc length.
        length: Length of the curve (m).
        caution: Where a stuck steering would take the robot out of its corridor, in a sentence; None if
            nowhere, or without a safety layer.

    Raises:
        InvalidInput: A period that is not positive, a delay that is not a multiple of it, a motion that is
            not finite, a place that is not on the curve, or a part of another kind.
        NoSolution: The robot cannot follow the curve, or moves too fast at its start.
    """

    def __init__(
        self,
        law: PathTracker,
        curve: Curve,
        robot: Tricycle | None = None,
        limits: Limits | None = None,
        *,
        period: float = 0.01,
        delay: float = 0.01,
        motion: Motion | None = None,
        progress: float = 0.0,
        estimator: Ekf | None = None,
        safety: Safety | None = None,
    ) -> None:
        slots = _slots(period, delay)
        robot = Tricycle() if robot is None else robot
        limits = Limits() if limits is None else limits
        parts = (law, curve, robot, limits, estimator, safety)
        for (name, kind), given in zip(PARTS.items(), parts, strict=True):
            if given is not None or name in ("law", "curve"):
                require_kind(name, given, kind)
        if isinstance(law, ExternalTracker):
            raise InvalidInput(
                "law", type(law).__name__, "decides in Python itself; call its decider"
            )
        _require_start(motion, progress, curve.length)
        tables = Tables()
        task = (curve, robot, limits, period, slots)
        foreseen, ceiling = foresee(safety, *task)
        begin = RESTING if motion is None or progress > 0.0 else Begin(0.0, motion.speed)
        self._road, self.plan = survey(*task, tables, ceiling, begin)
        self._law, self._curve, self._estimator, self._safety = law, curve, estimator, safety
        self.caution = foreseen.caution(self.plan) if foreseen else None
        self.length, self.table = curve.length, self._road.curve
        part = self._part(motion, progress)
        self._like: Any = part.memory
        shape = {"LIKE": zeros(part.memory), "LIKE_PARAMETERS": zeros(part.parameters)}
        template = "osculate.control.templates.stepper"
        like = Motion(*[0.0] * 6) if estimator is None else NOTHING
        shape["LIKE_MEASURED"] = zeros(like)
        self._engine = compose(template, {"decide": part.decide, "LANES": 1, **shape})
        self._memory = _column(part.memory)
        self._parameters = _column(part.parameters)
        self.tables = tables.array
        self._measured = _column(like)
        self._out = np.zeros((len(Command._fields), 1))
        self._estimates = estimator is not None

    def step(self, measured: Motion | Measurement, *, stop: bool = False) -> Command:
        """The command for what was measured now; to be called once a period.

        Args:
            measured: A `Measurement` with an estimator, else a `Motion`. What is missing is NaN or None,
                also the whole pose.
            stop: Whether somebody outside asks for a stop; it is final, as every stop.

        Raises:
            InvalidInput: The other kind of measurement, or a value that is no number.
        """
        if stop:  # first: whatever was measured, a stop that is asked for is one
            self.stop()
        wanted = Measurement if self._estimates else Motion
        if not isinstance(measured, wanted):
            raise InvalidInput("measured", measured, f"must be a {wanted.__name__}")
        self._measured[:, 0] = _numbers(measured)
        self._engine.step_block(
            self._memory, self._parameters, self._measured, self._out, self.tables
        )
        return Command(*self._out[:, 0].tolist())

    def stop(self) -> None:
        """Ask for a stop from outside: it begins with the next step and is final until `reset`."""
        whole = self._whole
        law = whole.law if self._estimates else whole
        asked = law._replace(stop=law.stop._replace(requested=1.0))
        self._memory = _column(whole._replace(law=asked) if self._estimates else asked)

    def reset(self, motion: Motion | None = None, progress: float | None = None) -> None:
        """Begin anew: no stop, no memory, no belief. The robot must stand.

        Args:
            motion: Where the robot is; by default where it is believed to be.
            progress: Arc length (m) of the curve near which it is; by default the nearest place.

        Raises:
            InvalidInput: The robot moves, or the motion is not finite.
        """
        speed = self.memory.expected.speed
        if abs(speed) > STANDING:
            message = "the robot moves; it can be reset once it stands"
            raise InvalidInput("speed", f"{speed:.3g} m/s", message)
        motion = self.memory.expected if motion is None else motion
        _require_start(motion, progress or 0.0, self.length)
        if abs(motion.speed) > STANDING:
            raise InvalidInput(
                "motion.speed", motion.speed, "must be 0 (m/s): the robot must stand"
            )
        near = self._nearest(motion) if progress is None else progress
        self._memory = _column(self._part(motion, near).memory)

    @property
    def memory(self) -> TrackingMemory:
        """What the tracker remembers after the last step."""
        whole = self._whole
        memory: TrackingMemory = whole.law if self._estimates else whole
        return memory

    @property
    def belief(self) -> Any:
        """What the estimator believes after the last step; None without one."""
        return self._whole.belief if self._estimates else None

    @property
    def alarm(self) -> Alarm:
        """Reason, excess (m) and cause of the last step's intervention, see `control.reasons`."""
        return self.memory.alarm

    @property
    def intervention(self) -> int:
        """Number of the reason for the last step's intervention (`safety.REASONS`); 0 is none."""
        return int(self.alarm.reason)

    @property
    def message(self) -> str:
        """The last step's intervention in words, with place, excess and cause; empty if there is none."""
        alarm, memory = self.alarm, self.memory
        if alarm.reason == 0.0:
            return ""
        place = memory.stop.place if self.stopping else memory.progress
        return f"{explain(*alarm)} at s = {place:.3f} m"

    @property
    def stopping(self) -> bool:
        """Whether the robot brakes or stands for good, other than at the end of the path."""
        return self.memory.stop.alarm.reason not in (0.0, ARRIVED)

    @property
    def standing(self) -> bool:
        """Whether the robot gets no drive: it was stopped, has arrived, or waits for its first pose."""
        memory = self.memory
        return memory.stop.resting > 0.0 or memory.alarm.reason == WAITING

    @property
    def arrived(self) -> bool:
        """Whether the robot is at the end of the path, where it brakes and stands."""
        return self.memory.stop.alarm.reason == ARRIVED

    @property
    def not_finite(self) -> int:
        """Number of decisions so far that were not finite and were replaced."""
        return int(self.memory.gate.missed)

    @property
    def progress(self) -> float:
        """Arc length (m) of the curve's point nearest to the last motion."""
        return float(self.memory.progress)

    @property
    def finished(self) -> bool:
        """Whether the path is done: the robot stands at its end, or passes it where it shall do so."""
        passes = self._road.arrival.end == math.inf
        return self.arrived and (passes or self.standing)

    @property
    def _whole(self) -> Any:
        return rebuild(self._like, iter(self._memory[:, 0].tolist()))

    def _part(self, motion: Motion | None, progress: float) -> PilotPart:
        """The pilot of a robot at the beginning."""
        place, robot = self._curve.at(progress), self._road.robot
        if motion is None:
            angle = math.atan(robot.wheelbase * float(place.curvature))
            motion = Motion(float(place.x), float(place.y), float(place.heading), 0.0, 0.0, angle)
        start = Start(*motion[:5], math.tan(motion.steering_angle) / robot.wheelbase)
        return pilot_part(
            self._law, self._road, start, progress, motion, self._estimator, self._safety
        )

    def _nearest(self, motion: Motion) -> float:
        """Arc length (m) of the place nearest to a motion that leads the same way."""
        s = np.linspace(0.0, self.length, NEARBY)
        point = self._curve.at(s)
        away = np.hypot(point.x - motion.x, point.y - motion.y)
        ahead = np.cos(point.heading - motion.heading) > 0.0
        return float(s[np.where(ahead | ~ahead.any(), away, np.inf).argmin()])


def _require_start(motion: Motion | None, progress: float, length: float) -> None:
    """Refuse a motion that is none, and a place beyond the curve."""
    if motion is not None:
        require_kind("motion", motion, Motion)
        if not np.isfinite(motion).all():
            raise InvalidInput("motion", motion, "must be finite")
    if not isinstance(progress, Real) or not 0.0 <= progress <= length:
        raise InvalidInput("progress", progress, f"must be on the curve, from 0 to {length:.6g} m")


def _slots(period: float, delay: float) -> int:
    """Periods from a decision to its effect."""
    if not isinstance(period, Real) or not 0.0 < period < math.inf:
        raise InvalidInput("period", period, "must be positive (s)")
    if not isinstance(delay, Real) or not 0.0 <= delay < math.inf:
        raise InvalidInput("delay", delay, "must be 0 or more (s)")
    slots = round(delay / period)
    if abs(slots * period - delay) > 1e-9:
        raise InvalidInput("delay", delay, f"must be a multiple of period = {period:g} s")
    return slots


def _numbers(measured: Motion | Measurement) -> list[float]:
    """The leaves of a measurement; what is missing is NaN."""
    try:
        values = [*measured]
        if isinstance(measured, Measurement):
            values[4:] = NO_FIX if measured.fix is None else Fix(*measured.fix)
        return [math.nan if value is None else float(value) for value in values]
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput("measured", measured, "must hold numbers, NaN or None") from None


def _column(value: Any) -> NDArray[np.float64]:
    return np.array(list(leaves(value)), dtype=float).reshape(-1, 1)
