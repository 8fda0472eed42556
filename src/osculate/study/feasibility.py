"""Inspecting a curve: how long, how tight, and whether a robot can follow it at a speed."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from osculate.curve import Curve, CurveFile
from osculate.curve.spline import PolylineError, Spline
from osculate.errors import InvalidInput
from osculate.simulation.plot import BLUE, ORANGE, RED, new_figure
from osculate.study.comparison.suite import CURVES
from osculate.study.scenario import Scenario
from osculate.target import Limits
from osculate.vehicle import Tricycle

SAMPLES = 20001
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

    @property
    def feasible(self) -> bool:
        """Whether the robot can follow the curve, at some speed."""
        return self.steering_angle < self.steering_angle_limit

    @property
    def verdict(self) -> str:
        """One sentence."""
        if not self.feasible:
            return (
                f"This robot cannot follow the curve: at s = {self.tightest:.4g} m it needs a steering "
                f"angle of {np.degrees(self.steering_angle):.4g}°, its limit is "
                f"{np.degrees(self.steering_angle_limit):.4g}°."
            )
        slowest = min(self.rate_speed, self.lateral_speed, self.tipping_speed)
        if slowest >= self.speed:
            return f"This robot can follow the curve at {self.speed:g} m/s everywhere."
        return (
            f"This robot can follow the curve, but not at {self.speed:g} m/s everywhere: it has to slow "
            f"down to {slowest:.3g} m/s at the worst place."
        )

    def rows(self) -> list[tuple[str, str]]:
        """Labels and values with units."""
        low, high = self.curvature
        rows = [
            ("length", f"{self.length:.6g} m{', closed' if self.closed else ''}"),
            ("curvature", f"{low:.4g} … {high:.4g} 1/m"),
            ("tightest place", f"s = {self.tightest:.4g} m, R = {self.radius:.4g} m"),
            (
                "steering angle",
                f"{np.degrees(self.steering_angle):.4g}° of {np.degrees(self.steering_angle_limit):.4g}°",
            ),
            ("steering rate limit at", f"{self.rate_speed:.4g} m/s (s = {self.rate_place:.4g} m)"),
            ("lateral acceleration limit at", f"{self.lateral_speed:.4g} m/s"),
            ("tips at", f"{self.tipping_speed:.4g} m/s"),
        ]
        if self.deviation:
            worst, rms = self.deviation
            rows.insert(1, ("distance from the points", f"max {worst:.3g} m, RMS {rms:.3g} m"))
        if self.polyline:
            far = self.polyline
            where = f" near ({far.x:.4g}, {far.y:.4g})" if far.largest > SHOWN else ""
            told = f"max {far.largest:.3g} m{where}, RMS {far.rms:.3g} m"
            rows.insert(2, ("distance from the polyline", told))
        return rows

    @property
    def radius(self) -> float:
        """Smallest radius (m)."""
        return 1.0 / max(abs(self.curvature[0]), abs(self.curvature[1]), 1e-12)


def load_curve(source: str, scale: float = 1.0, tolerance: float = 0.0) -> Curve:
    """A built-in curve, the curve of a scenario file, or a curve file.

    Raises:
        InvalidInput: Not readable, or no curve.
    """
    if source in CURVES:
        return CURVES[source]
    path = Path(source)
    if not path.is_file():
        raise InvalidInput("curve", source, f"must be a file or one of {', '.join(CURVES)}")
    if path.suffix.lower() in (".yaml", ".yml"):
        text = path.read_text(encoding="utf-8")
        if "\ncurve:" in f"\n{text}" or "\nscene:" in f"\n{text}":
            return Scenario.load(path).curve
    return CurveFile(path=source, scale=scale, tolerance=tolerance)


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
    )


def draw(curve: Curve, report: Feasibility, folder: Path) -> Path:
    """Draw the curve and its curvature as ``curve.png`` into a folder."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidInput("output", str(folder), f"must be a writable folder ({error})") from None
    s = np.linspace(0.0, curve.length, 2001)
    point = curve.at(s)
    figure, axes = new_figure(10.0, 4.0, [["path", "bend"]])
    path, bend = axes["path"], axes["bend"]
    inner = curve.curve if isinstance(curve, CurveFile) else curve
    if isinstance(inner, Spline):
        path.plot(*inner.waypoints.T, ".", color=ORANGE, markersize=4, label="points")
    path.plot(point.x, point.y, color=BLUE, linewidth=1.0, label="curve")
    tight = curve.at(report.tightest)
    path.plot(tight.x, tight.y, "o", color=RED, markersize=6, label="tightest")
    path.set_aspect("equal", adjustable="datalim")
    path.set(xlabel="x (m)", ylabel="y (m)", title=f"{report.length:.5g} m")
    path.legend(loc="best", frameon=False, fontsize="small")
    bend.plot(s, point.curvature, color=BLUE)
    bend.plot(report.tightest, tight.curvature, "o", color=RED, markersize=6)
    bend.set(xlabel="arc length (m)", ylabel="curvature (1/m)", title=f"R ≥ {report.radius:.4g} m")
    target = folder / "curve.png"
    figure.savefig(target)
    return target
