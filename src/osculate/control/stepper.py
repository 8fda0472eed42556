"""One decision at a time: how a real robot, or any simulator, calls a path tracker.

The same compiled step that runs in batches, behind a small object: a measured motion in, a command out.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import ControlPart, Start
from osculate.control.tracking.contract import PathTracker, TrackingMemory, survey
from osculate.control.tracking.external import ExternalTracker
from osculate.curve.contract import Curve
from osculate.errors import InvalidInput
from osculate.kernel import Tables, compose, leaves, rebuild
from osculate.target.speed import Limits
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
        begin = curve.at(progress)
        start = Start(
            float(begin.x), float(begin.y), float(begin.heading),
            0.0 if motion is None else motion.speed, 0.0, float(begin.curvature),
        )  # fmt: skip
        part: ControlPart = law.tracking_part(road, start, progress)
        self.length, self.table = curve.length, road.curve
        self._like: Any = part.memory
        shape = {"LIKE": _zeros(part.memory), "LIKE_PARAMETERS": _zeros(part.parameters)}
        template = "osculate.control.templates.stepper"
        self._engine = compose(template, {"track": part.control, "LANES": 1, **shape})
        self._memory = _column(part.memory)
        self._parameters = _column(part.parameters)
        self.tables = tables.array
        self._motion = np.zeros((len(Motion._fields), 1))
        self._out = np.zeros((len(Command._fields), 1))

    def step(self, motion: Motion) -> Command:
        """The command for the motion measured now; to be called once a period."""
        self._motion[:, 0] = motion
        self._engine.step_block(
            self._memory, self._parameters, self._motion, self._out, self.tables
        )
        return Command(*self._out[:, 0].tolist())

    @property
    def memory(self) -> TrackingMemory:
        """What the law remembers after the last step."""
        memory: TrackingMemory = rebuild(self._like, iter(self._memory[:, 0].tolist()))
        return memory

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


def _zeros(value: Any) -> Any:
    return rebuild(value, iter([0.0] * len(list(leaves(value)))))
