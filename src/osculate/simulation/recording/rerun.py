"""A run as a Rerun recording: obstacles, target curve, path driven, footprint, and all time series."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from osculate.errors import import_extra
from osculate.simulation.variables import BY_NAME

if TYPE_CHECKING:
    from osculate.simulation.run import Run

RATE = 50.0  # Hz, of the footprint and the series
SERIES = (
    "speed", "target_speed", "yaw_rate", "target_yaw_rate", "cross_track_error", "heading_error",
    "steering_angle", "commanded_steering_angle", "torque_left", "torque_right",
)  # fmt: skip


def write_rerun(run: "Run", path: Path) -> Path:
    """Write a run as ``.rrd`` (extra ``rerun``).

    Raises:
        MissingExtra: Rerun is not installed.
    """
    rr = load_rerun()
    stream = rr.RecordingStream("osculate")
    memory = stream.binary_stream()  # Rerun's own writer keeps errors of the disk to itself
    _map(rr, stream, run)
    _series(rr, stream, run)
    path.write_bytes(memory.read())
    stream.disconnect()
    return path


def load_rerun() -> Any:
    """The module.

    Raises:
        MissingExtra: It is not installed.
    """
    return import_extra("rerun", "rerun", "rerun-sdk")


def _map(rr: Any, stream: Any, run: "Run") -> None:
    curve, c = run.setup.curve, run.columns
    point = curve.at(np.linspace(0.0, curve.length, 1001))
    start = (float(point.x[0]), float(point.y[0]))
    outlines = [o.outline(start) for o in run.scene.obstacles]
    closed = [np.concatenate([outline, outline[:1]]) for outline in outlines]
    stream.log("map/obstacles", rr.LineStrips2D(closed, colors=[120, 126, 135]), static=True)
    target = np.stack([point.x, point.y], axis=1)
    stream.log("map/target", rr.LineStrips2D([target], colors=[217, 115, 13]), static=True)
    driven = np.stack([c["x"], c["y"]], axis=1)[:: max(1, len(c["x"]) // 4000)]
    stream.log("map/driven", rr.LineStrips2D([driven], colors=[31, 95, 168]), static=True)


def _series(rr: Any, stream: Any, run: "Run") -> None:
    c = run.columns
    wanted = np.arange(0.0, c["time"][-1] + 1e-9, 1.0 / RATE)
    kept = np.minimum(np.searchsorted(c["time"], wanted - 1e-9), len(c["time"]) - 1)
    units = {name: variable.unit for name, variable in BY_NAME.items()}
    times = rr.TimeColumn("time", duration=c["time"][kept])
    for name in SERIES:
        label = rr.SeriesLines(names=f"{name} ({units[name]})")
        stream.log(f"series/{name}", label, static=True)
        stream.send_columns(
            f"series/{name}", indexes=[times], columns=rr.Scalars.columns(scalars=c[name][kept])
        )
    body = np.array([*run.setup.robot.footprint.corners, run.setup.robot.footprint.corners[0]])
    for n in kept:
        cosine, sine = np.cos(c["heading"][n]), np.sin(c["heading"][n])
        outline = body @ np.array([[cosine, sine], [-sine, cosine]]) + [c["x"][n], c["y"][n]]
        stream.set_time("time", duration=float(c["time"][n]))
        stream.log("map/robot", rr.LineStrips2D([outline], colors=[31, 95, 168]))
