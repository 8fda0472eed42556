"""Inspecting a curve: how long, how tight, and whether a robot can follow it at a speed."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from osculate.curve import Curve, CurveFile
from osculate.curve.files.source import read_text
from osculate.curve.spline import PolylineError, Spline
from osculate.errors import InvalidInput
from osculate.files import write_by
from osculate.simulation.plot import BLUE, ORANGE, RED, new_figure
from osculate.study.comparison.suite import CURVES
from osculate.study.scenario import Scenario
from osculate.target import Limits
from osculate.vehicle import Tricycle

SAMPLES = 20001
STRAIGHT = 1e-6  # rad, a curve that turns less on its whole length is a straight line
SHOWN = 1e-6  # m, distance from the polyline of which the place is told


@dataclass(frozen=True)
class Feasibility:
    """What a curve asks of a robot at a speed."""

    length: float  # m
    closed: bool
    curvature: tuple[float, float]  # 1/m, smallest and largest
    tightest: float  # m, arc length of the largest |κ|
    deviation: tuple[float, float] | None  # m, largest and RMS distance of given points
    polyline: PolylineError | None  # m, how far it leaves the polyline through them
    steering_angle: float  # rad, largest that is needed
    steering_angle_limit: float  # rad
    rate_speed: float  # m/s, at which the steering rate limit is reached
    rate_place: float  # m, arc length where
    lateral_speed: float  # m/s, at which the lateral acceleration reaches the task's default limit
    tipping_speed: float  # m/s, at which the robot tips
    speed: float  # m/s, asked for
    slowest: (
        float  # m/s, largest speed at the worst of the places that allow less than is asked for
    )
    file_speeds: tuple[float, float] | None = (
        None  # m/s, smallest and largest that the file asks for
    )

    @property
    def feasible(self) -> bool:
        """Whether the robot can follow the curve, at some speed."""
        return self.steering_angle < self.steering_angle_limit

    @property
    def conclusion(self) -> str:
        """One sentence."""
        if not self.feasible:
            return (
                f"This robot cannot follow the curve: at s = {self.tightest:.4g} m it needs a steering "
                f"angle of {np.degrees(self.steering_angle):.4g}°, its limit is "
                f"{np.degrees(self.steering_angle_limit):.4g}°."
            )
        asked = f"{self.speed:g} m/s"
        if self.file_speeds:
            asked += " or the file's speed, whichever is less,"
        if self.slowest >= self.speed:
            return f"This robot can follow the curve at {asked} everywhere."
        return (
            f"This robot can follow the curve, but not at {asked} everywhere: it has to slow "
            f"down to {self.slowest:.3g} m/s at the worst place."
        )

    def rows(self) -> list[tuple[str, str]]:
        """Labels and values with units."""
        low, high = (round(bend, 12) + 0.0 for bend in self.curvature)
        rows = [
            ("length", f"{self.length:.6g} m{', closed' if self.closed else ''}"),
            ("curvature", f"{low:.4g} … {high:.4g} 1/m"),
            *self._tight(),
        ]
        if self.file_speeds:
            rows.append(("speeds of the file", "{:.4g} … {:.4g} m/s".format(*self.file_speeds)))
        if self.deviation:
            worst, rms = self.deviation
            rows.insert(1, ("distance from the points", f"max {worst:.3g} m, RMS {rms:.3g} m"))
        if self.polyline:
            far = self.polyline
            told = f"max {far.largest:.3g} m, RMS {far.rms:.3g} m"
            rows.insert(2, ("distance from the polyline", told))
            if far.largest > SHOWN:
                rows.insert(3, ("largest near", f"({_place(far.x)}, {_place(far.y)})"))
        return rows

    def _tight(self) -> list[tuple[str, str]]:
        """What the curvature asks for."""
        if self.straight:
            return [("tightest place", "none, it is straight")]
        angle, limit = np.degrees([self.steering_angle, self.steering_angle_limit])
        return [
            ("tightest place", f"s = {self.tightest:.4g} m, R = {self.radius:.4g} m"),
            ("steering angle", f"{angle:.4g}° of {limit:.4g}°"),
            ("steering rate limit at", f"{self.rate_speed:.4g} m/s (s = {self.rate_place:.4g} m)"),
            ("lateral acceleration limit at", f"{self.lateral_speed:.4g} m/s"),
            ("tips at", f"{self.tipping_speed:.4g} m/s"),
        ]

    @property
    def straight(self) -> bool:
        """Whether the curve does not bend at all, up to rounding."""
        return self.length < STRAIGHT * self.radius

    @property
    def radius(self) -> float:
        """Smallest radius (m)."""
        return 1.0 / max(abs(self.curvature[0]), abs(self.curvature[1]), 1e-12)


def _place(coordinate: float) -> str:
    """A coordinate (m) to the millimetre, however large."""
    return f"{round(coordinate, 3) + 0.0:.12g}"


class Loaded(NamedTuple):
    """A curve and the robot that comes with it."""

    curve: Curve
    robot: Tricycle | None  # of a scenario


def load_curve(source: str, scale: float = 1.0, tolerance: float = 0.0, **options: Any) -> Curve:
    """A built-in curve, the curve of a scenario file, or a curve file; see `load_source`."""
    return load_source(source, scale=scale, tolerance=tolerance, **options).curve


def load_source(source: str, **options: Any) -> Loaded:
    """A built-in curve, the curve and the robot of a scenario file, or a curve file.

    Args:
        source: Name or path.
        **options: Fields of `osculate.CurveFile` other than ``path``.

    Raises:
        InvalidInput: Not readable, or no curve; options for a curve that comes from no file.
    """
    given = {
        name: value
        for name, value in options.items()
        if value != CurveFile.model_fields[name].default
    }
    if source in CURVES:
        return Loaded(_with(CURVES[source], source, given), None)
    path = Path(source)
    if not _exists(path):
        raise InvalidInput("curve", source, f"must be a file or one of {', '.join(CURVES)}")
    if path.suffix.lower() in (".yaml", ".yml") and _is_scenario(read_text(path).content):
        scenario = Scenario.load(path)
        return Loaded(_with(scenario.curve, source, given), scenario.robot)
    return Loaded(CurveFile(path=source, **given), None)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # a name that is too long
        return False


def _is_scenario(text: str) -> bool:
    """Whether the keys at the left margin are those of a scenario."""
    keys = set(re.findall(r"^([A-Za-z_]\w*)[ \t]*:", text, flags=re.MULTILINE))
    return bool(keys & {"curve", "scene"}) or bool(keys and keys <= set(Scenario.model_fields))


def _with(curve: Curve, source: str, given: Mapping[str, Any]) -> Curve:
    if not given:
        return curve
    if not isinstance(curve, CurveFile):
        name, value = next(iter(given.items()))
        raise InvalidInput(name, value, f"is for curves from files; {source} is none")
    fields = {name: getattr(curve, name) for name in CurveFile.model_fields}
    return CurveFile(**{**fields, **given})


def inspect_curve(curve: Curve, robot: Tricycle, speed: float = 1.0) -> Feasibility:
    """What a curve asks of a robot at a speed (m/s).

    Raises:
        InvalidInput: The speed is not positive.
    """
    if not speed > 0:
        raise InvalidInput("speed", speed, "must be positive (m/s)")
    inner = curve.curve if isinstance(curve, CurveFile) else curve
    given = len(inner.points) if isinstance(inner, Spline) else 0
    even = np.linspace(0.0, curve.length, max(SAMPLES, 4 * given + 1))
    s = np.union1d(even, inner.tight_places)
    point = curve.at(s)
    bend = np.abs(point.curvature)
    a, act = robot.wheelbase, robot.actuators
    turning = a * np.abs(point.curvature_rate) / (1.0 + (a * bend) ** 2)
    worst = int(turning.argmax())
    most = float(max(bend.max(), 1e-12))
    lateral = min(Limits().lateral_acceleration, robot.tipping_acceleration)
    able = np.minimum(
        act.steering_rate_limit / np.maximum(turning, 1e-12),
        np.sqrt(lateral / np.maximum(bend, 1e-12)),
    )
    limit = curve.speed_limit(s)
    asked = np.full(len(s), speed) if limit is None else np.minimum(limit, speed)
    return Feasibility(
        length=curve.length,
        closed=curve.closed,
        curvature=(float(point.curvature.min()), float(point.curvature.max())),
        tightest=float(s[bend.argmax()]),
        deviation=inner.deviation if isinstance(inner, Spline) else None,
        polyline=inner.polyline_error if isinstance(inner, Spline) else None,
        steering_angle=float(np.arctan(a * most)),
        steering_angle_limit=act.steering_angle_limit,
        rate_speed=float(act.steering_rate_limit / max(turning.max(), 1e-12)),
        rate_place=float(s[worst]),
        lateral_speed=float(np.sqrt(Limits().lateral_acceleration / most)),
        tipping_speed=float(np.sqrt(robot.tipping_acceleration / most)),
        speed=speed,
        slowest=float(np.where(able < asked, able, np.inf).min()),
        file_speeds=None if limit is None else (float(limit.min()), float(limit.max())),
    )


def draw(curve: Curve, report: Feasibility, folder: Path) -> Path:
    """Draw the curve and its curvature as ``curve.png`` into a folder."""
    s = np.linspace(0.0, curve.length, 2001)
    point = curve.at(s)
    figure, axes = new_figure(10.0, 4.0, [["path", "bend"]])
    path, bend = axes["path"], axes["bend"]
    inner = curve.curve if isinstance(curve, CurveFile) else curve
    if isinstance(inner, Spline):
        path.plot(*inner.waypoints.T, ".", color=ORANGE, markersize=4, label="points")
    path.plot(point.x, point.y, color=BLUE, linewidth=1.0, label="curve")
    tight = curve.at(report.tightest)
    if not report.straight:
        path.plot(tight.x, tight.y, "o", color=RED, markersize=6, label="tightest")
        bend.plot(report.tightest, tight.curvature, "o", color=RED, markersize=6)
    path.set_aspect("equal", adjustable="datalim")
    path.locator_params(axis="x", nbins=6)
    path.set(xlabel="x (m)", ylabel="y (m)", title=f"length {report.length:.5g} m")
    path.legend(loc="best", frameon=False, fontsize="small")
    bend.plot(s, point.curvature, color=BLUE)
    least = "straight" if report.straight else f"R ≥ {report.radius:.4g} m"
    bend.set(xlabel="arc length (m)", ylabel="curvature (1/m)", title=least)
    try:
        return write_by(figure.savefig, folder / "curve.png")
    except OSError as error:
        raise InvalidInput("output", str(folder), f"must be a writable folder ({error})") from None
