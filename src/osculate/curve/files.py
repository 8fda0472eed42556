"""Curves from files: waypoints, race tracks, race lines, VDA 5050 trajectories, ROS paths."""

import csv
import io
import json
import re
import warnings
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.curve.contract import Curve, CurvePoint
from osculate.curve.spline import Nurbs, Spline
from osculate.errors import InvalidInput
from osculate.spec import quantity

Array = NDArray[np.float64]

CLOSE_GAP = 3.0  # steps: a list of points whose ends are nearer than this is a loop
HUGE = 2e4  # m, extent beyond which coordinates look like millimetres or degrees of a globe


class CurveFile(Curve):
    """A curve read from a file.

    Formats, told apart by their content: waypoint CSV (x, y in the first columns, or named so),
    TUMFTM race track (``# x_m,y_m,w_tr_right_m,w_tr_left_m``), f1tenth race line
    (``# s_m; x_m; y_m; ...``), VDA 5050 trajectory (JSON), nav_msgs/Path (JSON or YAML).

    Raises:
        InvalidInput: No such file, unknown format, a line that is no point (says which one).
    """

    kind: Literal["file"] = "file"
    path: str
    scale: float = quantity("1", "factor on all coordinates", default=1.0, gt=0)
    loop: bool | None = quantity(
        "1", "whether it is closed; by default if its ends are close", default=None
    )
    tolerance: float = quantity(
        "m", "largest distance from the (scaled) points; 0 goes through them", default=0.0, ge=0
    )

    @cached_property
    def curve(self) -> Curve:
        """The curve that the file describes."""
        return read_curve(self.path, self.scale, self.loop, self.tolerance)

    @property
    def closed(self) -> bool:
        """See `Curve.closed`."""
        return self.curve.closed

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return self.curve.length

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        return self.curve.at(arc_length)


def read_curve(
    path: str | Path, scale: float = 1.0, loop: bool | None = None, tolerance: float = 0.0
) -> Curve:
    """Read a curve from a file; see `CurveFile`."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InvalidInput("path", str(path), f"must be a readable text file ({error})") from None
    suffix = Path(path).suffix.lower()
    if suffix in (".json", ".yaml", ".yml"):
        data = _structured(text, str(path), suffix)
        trajectory = _find(data, "controlPoints")
        if trajectory is not None:
            return _nurbs(trajectory, str(path), scale)
        points = _poses(data, str(path))
    else:
        points = _table(text, str(path))
    points = points * scale
    _warn_units(points, str(path))
    closed = _is_loop(points) if loop is None else loop
    return Spline(points=tuple(map(tuple, points.tolist())), loop=closed, tolerance=tolerance)


def _table(text: str, label: str) -> Array:
    """Points of a CSV file, separated by commas, semicolons, tabs or spaces."""
    lines = [(n, line.strip()) for n, line in enumerate(io.StringIO(text), start=1) if line.strip()]
    names: list[str] = []
    rows: list[list[float]] = []
    for number, line in lines:
        separator = ";" if ";" in line else "," if "," in line else None
        cells = (
            [c.strip() for c in line.lstrip("#").split(separator)]
            if separator
            else line.lstrip("#").split()
        )
        if line.startswith("#") or (not rows and not _is_number(cells[0])):
            names = [re.sub(r"\W.*", "", cell.lower()) for cell in cells]
            continue
        try:
            rows.append([float(cell) for cell in next(csv.reader([",".join(cells)]))])
        except ValueError:
            raise InvalidInput(
                "path", f"{label}, line {number}", f"is no point: {line!r}"
            ) from None
    if not rows or min(map(len, rows)) < 2:
        raise InvalidInput("path", label, "must hold lines with x and y (m)")
    x, y = (_column(names, name, fallback) for name, fallback in (("x", 0), ("y", 1)))
    points = np.array([[row[x], row[y]] for row in rows])
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        number = int(bad.argmax())
        raise InvalidInput("path", f"{label}, point {number}", "must be finite")
    return points


def _column(names: list[str], name: str, fallback: int) -> int:
    wanted = [f"{name}_m", name, f"pos_{name}", f"{name}_pos"]
    return next((names.index(w) for w in wanted if w in names), fallback)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _structured(text: str, label: str, suffix: str) -> Any:
    try:
        if suffix == ".json":
            return json.loads(text)
        import yaml

        documents = [d for d in yaml.safe_load_all(text) if d is not None]
        return documents[0] if documents else None
    except (json.JSONDecodeError, ValueError) as error:
        raise InvalidInput("path", label, f"is not valid {suffix[1:].upper()}: {error}") from None
    except Exception as error:  # yaml's own errors share no base with anything else
        raise InvalidInput("path", label, f"is not valid YAML: {error}") from None


def _find(data: Any, key: str) -> dict[str, Any] | None:
    """The first mapping that has ``key``, at any depth."""
    if isinstance(data, dict):
        if key in data:
            return data
        data = list(data.values())
    if isinstance(data, list):
        for item in data:
            found = _find(item, key)
            if found is not None:
                return found
    return None


def _nurbs(trajectory: dict[str, Any], label: str, scale: float) -> Nurbs:
    try:
        control = trajectory["controlPoints"]
        degree = int(trajectory["degree"])
        knots = tuple(float(k) for k in trajectory["knotVector"])
        points = tuple((scale * float(c["x"]), scale * float(c["y"])) for c in control)
        weights = tuple(float(c.get("weight", 1.0)) for c in control)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InvalidInput(
            "path", label, f"a trajectory needs degree, knotVector and controlPoints ({error})"
        ) from None
    return Nurbs(degree=degree, knots=knots, points=points, weights=weights)


def _poses(data: Any, label: str) -> Array:
    path = _find(data, "poses")
    try:
        poses = path["poses"] if path is not None else data
        return np.array([_position(pose) for pose in poses], dtype=float).reshape(-1, 2)
    except (KeyError, TypeError, ValueError, IndexError):
        raise InvalidInput(
            "path", label, "must be a VDA 5050 trajectory, a nav_msgs/Path or a list of [x, y]"
        ) from None


def _position(pose: Any) -> tuple[float, float]:
    while isinstance(pose, dict) and "x" not in pose:
        pose = pose["pose"] if "pose" in pose else pose["position"]
    if isinstance(pose, dict):
        return float(pose["x"]), float(pose["y"])
    return float(pose[0]), float(pose[1])


def _is_loop(points: Array) -> bool:
    if len(points) < 8:
        return bool(len(points) > 3 and (points[0] == points[-1]).all())
    steps = np.hypot(*np.diff(points, axis=0).T)
    gap = float(np.hypot(*(points[-1] - points[0])))
    return gap <= CLOSE_GAP * float(np.median(steps))


def _warn_units(points: Array, label: str) -> None:
    extent = float(np.ptp(points, axis=0).max())
    looks_global = len(points) > 2 and extent < 0.2 and bool((np.abs(points) > 1.0).any())
    if extent > HUGE:
        warnings.warn(
            f"{label}: {extent:.3g} m wide; are the coordinates in millimetres? (scale: 0.001)",
            stacklevel=3,
        )
    elif looks_global and bool((np.abs(points) <= 180.0).all()):
        warnings.warn(
            f"{label}: {extent:.3g} m wide, far from the origin; are these degrees of latitude and "
            "longitude? osculate needs metres",
            stacklevel=3,
        )
