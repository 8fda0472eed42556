"""What a run amounts to: one number per question, each with its unit."""

from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np

from osculate.simulation.records import DIVERGED, FINISHED, RUNNING, STOPPED, Progress, Row

ENDINGS = {RUNNING: "time", FINISHED: "path end", DIVERGED: "diverged", STOPPED: "safety stop"}


def _metric(unit: str, label: str) -> Any:
    return field(metadata={"unit": unit, "label": label})


@dataclass(frozen=True)
class Metrics:
    """Exactness and effort of one run (floats) or of many (arrays of one shape)."""

    path_length: Any = _metric("m", "path length")
    travelled: Any = _metric("m", "distance travelled")
    duration: Any = _metric("s", "duration")
    cross_track_rms: Any = _metric("m", "cross-track error, RMS")
    cross_track_max: Any = _metric("m", "cross-track error, max")
    heading_error_rms: Any = _metric("rad", "heading error, RMS")
    heading_error_max: Any = _metric("rad", "heading error, max")
    clearance_min: Any = _metric("m", "clearance to the obstacle, min")
    speed_max: Any = _metric("m/s", "speed, peak")
    steering_angle_max: Any = _metric("rad", "steering angle, peak")
    steering_rate_max: Any = _metric("rad/s", "steering rate, peak")
    torque_left_max: Any = _metric("N m", "torque left, peak")
    torque_right_max: Any = _metric("N m", "torque right, peak")
    steering_travel: Any = _metric("rad", "steering effort (sum of movements)")
    torque_travel: Any = _metric("N m", "torque ripple (sum of changes)")
    energy: Any = _metric("J", "work of the drives")
    end_position_error: Any = _metric("m", "distance to the end of the path")
    ended: Any = _metric("", "ended by")

    @classmethod
    def items(cls) -> list[tuple[str, str, str]]:
        """Name, unit and label of every metric, in order."""
        return [(f.name, f.metadata["unit"], f.metadata["label"]) for f in fields(cls)]

    def as_dict(self) -> dict[str, Any]:
        """Names to values."""
        return asdict(self)


def summarise(final: Progress, last: Row, length: Any, end: tuple[Any, Any]) -> Metrics:
    """Metrics of many runs.

    Args:
        final: The runs at their last instant; leaves of shape (runs,).
        last: Their last rows, likewise.
        length: Length of the curve (m), one or one for every run.
        end: Where the curve ends (m), likewise.

    The errors of a run that ended before the arc length from which they count are not known: NaN.
    """
    tally = final.tally
    samples = np.where(tally.counted > 0.0, tally.counted, np.nan)
    return Metrics(
        path_length=np.broadcast_to(length, np.shape(samples)),
        travelled=last.arc_length,
        duration=final.status.time,
        cross_track_rms=np.sqrt(tally.cross_track_squares / samples),
        cross_track_max=np.where(tally.counted > 0.0, tally.cross_track_max, np.nan),
        heading_error_rms=np.sqrt(tally.heading_error_squares / samples),
        heading_error_max=np.where(tally.counted > 0.0, tally.heading_error_max, np.nan),
        clearance_min=None,
        speed_max=tally.speed_max,
        steering_angle_max=tally.steering_angle_max,
        steering_rate_max=tally.steering_rate_max,
        torque_left_max=tally.torque_left_max,
        torque_right_max=tally.torque_right_max,
        steering_travel=tally.steering_travel,
        torque_travel=tally.torque_travel,
        energy=tally.energy,
        end_position_error=np.hypot(last.motion.x - end[0], last.motion.y - end[1]),
        ended=np.array([ENDINGS[code] for code in np.atleast_1d(final.status.code).tolist()]),
    )
