"""One decision at a time: how a real robot, or any simulator, calls a pilot.

The same compiled step that runs in batches, behind a small object: a measurement in, a command out.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import Start
from osculate.control.estimation.ekf import Ekf
from osculate.control.pilot import pilot_part
from osculate.control.safety import Safety
from osculate.control.tracking.contract import PathTracker, TrackingMemory, survey
from osculate.control.tracking.external import ExternalTracker
from osculate.curve.contract import Curve
from osculate.errors import InvalidInput
from osculate.kernel import Tables, compose, leaves, rebuild, zeros
from osculate.target.speed import Limits
from osculate.vehicle.measurement import NO_FIX, Measurement
from osculate.vehicle.motion import Command, Motion
from osculate.vehicle.tricycle import Tricycle


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

    Raises:
        InvalidInput: A period that is not positive, or a delay that is not a multiple of it.
        NoSolution: The robot cannot follow the curve.
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
        if not period > 0:
            raise InvalidInput("period", period, "must be positive (s)")
        slots = round(delay / period)
        if delay < 0 or abs(slots * period - delay) > 1e-9:
            raise InvalidInput("delay", delay, f"must be a multiple of period = {period:g} s")
        if isinstance(law, ExternalTracker):
            raise InvalidInput(
                "law", type(law).__name__, "decides in Python itself; call its decider"
            )
        tables = Tables()
        road, self.plan = survey(
            curve, robot or Tricycle(), limits or Limits(), period, slots, tables
        )
        place = curve.at(progress)
        if motion is None:
            angle = math.atan(road.robot.wheelbase * float(place.curvature))
            motion = Motion(float(place.x), float(place.y), float(place.heading), 0.0, 0.0, angle)
        start = Start(*motion[:5], float(place.curvature))
        part = pilot_part(law, road, start, progress, motion, estimator, safety)
        self.length, self.table = curve.length, road.curve
        self._like: Any = part.memory
        shape = {"LIKE": zeros(part.memory), "LIKE_PARAMETERS": zeros(part.parameters)}
        template = "osculate.control.templates.stepper"
        like = zeros(motion if estimator is None else Measurement(0.0, 0.0, 0.0, 0.0, NO_FIX))
        shape["LIKE_MEASURED"] = like
        self._engine = compose(template, {"decide": part.decide, "LANES": 1, **shape})
        self._memory = _column(part.memory)
        self._parameters = _column(part.parameters)
        self.tables = tables.array
        self._measured = _column(like)
        self._out = np.zeros((len(Command._fields), 1))
        self._estimates, self._guarded = estimator is not None, safety is not None

    def step(self, measured: Motion | Measurement) -> Command:
        """The command for what was measured now; to be called once a period.

        Args:
            measured: A `Measurement` with an estimator, else a `Motion`.

        Raises:
            InvalidInput: The other one.
        """
        if isinstance(measured, Measurement) != self._estimates:
            wanted = "Measurement" if self._estimates else "Motion"
            raise InvalidInput("measured", measured, f"must be a {wanted}")
        self._measured[:, 0] = [*leaves(measured)] if self._estimates else measured
        self._engine.step_block(
            self._memory, self._parameters, self._measured, self._out, self.tables
        )
        return Command(*self._out[:, 0].tolist())

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
    def _whole(self) -> Any:
        return rebuild(self._like, iter(self._memory[:, 0].tolist()))

    @property
    def intervention(self) -> int:
        """Number of the safety layer's reason at the last step (`safety.REASONS`); 0 is none."""
        return int(self.memory.guard.alarm) if self._guarded else 0

    @property
    def stopping(self) -> bool:
        """Whether the safety layer stops the robot, or has."""
        return self._guarded and self.memory.guard.stop > 0.0

    @property
    def progress(self) -> float:
        """Arc length (m) of the curve's point nearest to the last motion."""
        return float(self.memory.progress)

    @property
    def finished(self) -> bool:
        """Whether the end of the curve is reached."""
        return self.progress >= self.length


def _column(value: Any) -> NDArray[np.float64]:
    return np.array(list(leaves(value)), dtype=float).reshape(-1, 1)
