"""Drawing a run: panels that only draw what the record holds, and one overview of them."""

from collections.abc import Callable
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from osculate.simulation.run import Run

BLUE, ORANGE, GREEN, GREY, RED = "#1f5fa8", "#d9730d", "#2e8b57", "#8a8f98", "#b3261e"
FOOTPRINTS = 12  # drawn along the path
POINTS = 1500  # drawn of a line
LETTERS = 14  # of a title, per inch


def new_figure(width: float, height: float, mosaic: Any = (("only",),), **layout: Any) -> Any:
    """A figure and its named axes, without the state machine of pyplot."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=120)
    FigureCanvasAgg(figure)
    axes = figure.subplot_mosaic([list(row) for row in mosaic], **layout)
    # margins in inches; a layout engine would draw everything several times
    figure.subplots_adjust(
        left=0.8 / width,
        right=1.0 - 0.25 / width,
        bottom=0.55 / height,
        top=1.0 - 0.4 / height,
        wspace=0.22,
        hspace=0.42,
    )
    for ax in axes.values():
        ax.grid(color="#e4e6ea", linewidth=0.8)
        ax.set_axisbelow(True)
        for side in ("top", "right"):
            ax.spines[side].set_visible(False)
    return figure, axes


def unmarked(text: str) -> str:
    """A text in which Matplotlib finds no formula."""
    return text.replace("$", r"\$")


def path_panel(ax: "Axes", run: "Run") -> None:
    """Target curve, path driven, obstacles, and the robot's footprint along the way."""
    from matplotlib.patches import Polygon

    curve = run.setup.curve
    point = curve.at(np.linspace(0.0, curve.length, 1001))
    start = (float(point.x[0]), float(point.y[0]))
    for obstacle in run.scene.obstacles:
        ax.add_patch(Polygon(obstacle.outline(start), facecolor="#d6d9de", edgecolor=GREY))
    ax.plot(point.x, point.y, color=ORANGE, linewidth=3.0, alpha=0.55, label="target")
    column = thinned(run)
    ax.plot(column["x"], column["y"], color=BLUE, linewidth=1.2, label="driven")
    for outline in footprints(run):
        ax.add_patch(Polygon(outline, fill=False, edgecolor=BLUE, linewidth=0.9))
    ax.plot(*start, "o", color=GREEN, markersize=5, label="start")
    ax.set_aspect("equal", adjustable="datalim")
    ax.set(xlabel="x (m)", ylabel="y (m)")
    _verdict_title(ax, run)
    ax.legend(loc="best", frameon=False, fontsize="small")


def _verdict_title(ax: "Axes", run: "Run") -> None:
    """The verdict as the title, red unless the end was reached, and a cross where something happened."""
    verdict, width = run.verdict, ax.figure.get_figwidth()  # type: ignore[union-attr]
    colour, sign = (GREEN, "✓") if verdict.reached else (RED, "✗")
    lines = wrap(f"{sign} {verdict}", round(LETTERS * width))
    ax.set_title("\n".join(lines), color=colour, fontsize=8, loc="left")
    if not verdict.reached:
        ax.plot([verdict.x], [verdict.y], "x", color=RED, markersize=9, zorder=9)


def footprints(run: "Run", count: int = FOOTPRINTS) -> list[Any]:
    """Outlines of the robot (m), each of shape (4, 2), evenly spaced along the path driven."""
    travelled = run.columns["arc_length"]
    at = np.searchsorted(travelled, np.linspace(0.0, travelled[-1], count)).clip(
        0, len(travelled) - 1
    )
    body = np.array(run.setup.robot.footprint.corners)
    outlines = []
    for n in at:
        c, s = np.cos(run.columns["heading"][n]), np.sin(run.columns["heading"][n])
        centre = np.array([run.columns["x"][n], run.columns["y"][n]])
        outlines.append(body @ np.array([[c, s], [-s, c]]) + centre)
    return outlines


def speed_panel(ax: "Axes", run: "Run") -> None:
    """Speed and yaw rate with their targets."""
    _lines(ax, run, [("speed", "v", BLUE, "-"), ("target_speed", "v̂", BLUE, ":")])
    _lines(ax, run, [("yaw_rate", "ω", ORANGE, "-"), ("target_yaw_rate", "ω̂", ORANGE, ":")])
    ax.set(title="Speeds", ylabel="v (m/s), ω (rad/s)")


def error_panel(ax: "Axes", run: "Run") -> None:
    """Distance from the curve, in the unit that suits it."""
    column = thinned(run)
    error = column["cross_track_error"]
    factor, unit = readable(float(np.abs(error).max()))
    ax.plot(column["time"], error * factor, color=RED, linewidth=1.2)
    ax.set(title="Cross-track error", xlabel="time (s)", ylabel=f"left of the curve ({unit})")


def steering_panel(ax: "Axes", run: "Run") -> None:
    """Steering angle."""
    column = thinned(run)
    ax.plot(column["time"], np.degrees(column["steering_angle"]), color=GREEN)
    ax.set(title="Steering angle", xlabel="time (s)", ylabel="φ (°)")


def torque_panel(ax: "Axes", run: "Run") -> None:
    """Drive torques of both wheels, cut where an initial peak would hide everything else."""
    _lines(ax, run, [("torque_left", "left", BLUE, "-"), ("torque_right", "right", ORANGE, "--")])
    both = np.stack([run.columns["torque_left"], run.columns["torque_right"]])
    peak, usual = np.abs(both).max(), 3.0 * np.quantile(np.abs(both), 0.99)
    title = "Drive torque"
    if peak > 3.0 * usual > 0.0:
        ax.set_ylim(-usual, usual)
        title += f" (peak {peak:.0f} N m is cut off)"
    ax.set(title=title, ylabel="torque (N m)")


def thinned(run: "Run", points: int = POINTS) -> dict[str, Any]:
    """The record at about ``points`` samples, the last one among them: enough for a picture."""
    count = len(run.columns["time"])
    keep = np.append(np.arange(0, count - 1, max(1, count // points)), count - 1)
    return {name: values[keep] for name, values in run.columns.items()}


def readable(size: float) -> tuple[float, str]:
    """Factor and unit in which a length (m) reads well."""
    for factor, unit in ((1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")):
        if size * factor >= 1.0:
            return factor, unit
    return 1e9, "nm"


PANELS: dict[str, Callable[["Axes", "Run"], None]] = {
    "path": path_panel,
    "speeds": speed_panel,
    "errors": error_panel,
    "steering": steering_panel,
    "torques": torque_panel,
}


def overview(run: "Run") -> "Figure":
    """All panels on one page: the path above, the time series below."""
    mosaic = [["path", "path"], ["speeds", "errors"], ["steering", "torques"]]
    figure, axes = new_figure(10.0, 9.0, mosaic, height_ratios=[1.35, 1.0, 1.0])
    for name, panel in PANELS.items():
        panel(axes[name], run)
    return figure  # type: ignore[no-any-return]


def _lines(ax: "Axes", run: "Run", lines: list[tuple[str, str, str, str]]) -> None:
    column = thinned(run)
    for name, label, colour, style in lines:
        ax.plot(column["time"], column[name], style, color=colour, label=label)
    ax.set_xlabel("time (s)")
    ax.legend(loc="best", frameon=False, fontsize="small")
