"""Pictures of a run as files: one PNG for every panel, one overview, and an animation."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from osculate.simulation.plot import BLUE, PANELS, new_figure, overview, path_panel

if TYPE_CHECKING:
    from osculate.simulation import Run

FRAMES = 120
FRAME_MILLISECONDS = 50


def write_figures(run: "Run", output: Path) -> list[Path]:
    """Write ``overview.png`` and one PNG for every panel; returns their paths."""
    paths = [output / "overview.png"]
    overview(run).savefig(paths[0])
    for name, panel in PANELS.items():
        wide = name == "path"
        figure, axes = new_figure(8.0 if wide else 7.0, 4.2 if wide else 3.4)
        panel(axes["only"], run)
        paths.append(output / f"{name}.png")
        figure.savefig(paths[-1])
    return paths


def write_animation(run: "Run", path: Path, report: Callable[[float], None] | None = None) -> Path:
    """Write an animated GIF: the robot with its steered wheel drives along the path."""
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.patches import Polygon

    figure, axes = new_figure(8.0, 4.2)
    ax = axes["only"]
    path_panel(ax, run)
    for patch in list(ax.patches)[len(run.scene.obstacles) :]:
        patch.remove()
    ax.lines[1].remove()
    (trace,) = ax.plot([], [], color=BLUE, linewidth=1.6)
    body = ax.add_patch(Polygon(np.zeros((4, 2)), facecolor="#bcd3ee", edgecolor=BLUE))
    wheel = ax.add_patch(Polygon(np.zeros((4, 2)), facecolor=BLUE, edgecolor=BLUE))
    clock = ax.text(0.02, 0.95, "", transform=ax.transAxes, va="top", family="monospace")
    column = run.columns
    last = len(column["time"]) - 1
    frames = np.searchsorted(column["time"], np.linspace(0.0, column["time"][-1], FRAMES))

    def draw(frame: int) -> None:
        n = min(int(frames[frame]), last)
        trace.set_data(column["x"][: n + 1], column["y"][: n + 1])
        at, heading = (column["x"][n], column["y"][n]), column["heading"][n]
        body.set_xy(_placed(run.setup.robot.footprint.corners, at, heading))
        wheel.set_xy(_front_wheel(run, at, heading, column["steering_angle"][n]))
        speed = column["speed"][n]
        clock.set_text(f"t = {column['time'][n]:5.2f} s   v = {speed:5.2f} m/s")
        if report:
            report((frame + 1) / FRAMES)

    animation = FuncAnimation(figure, draw, frames=FRAMES, init_func=lambda: None)  # type: ignore[arg-type, return-value]
    animation.save(path, writer=PillowWriter(fps=1000 // FRAME_MILLISECONDS))
    return path


def _placed(corners: object, at: tuple[float, float], heading: float) -> np.ndarray:
    c, s = np.cos(heading), np.sin(heading)
    placed: np.ndarray = np.asarray(corners) @ np.array([[c, s], [-s, c]]) + at
    return placed


def _front_wheel(
    run: "Run", at: tuple[float, float], heading: float, steering: float
) -> np.ndarray:
    robot = run.setup.robot
    r, w = robot.wheel_radius, robot.wheel_width / 2.0
    outline = _placed([(-r, -w), (r, -w), (r, w), (-r, w)], (robot.wheelbase, 0.0), steering)
    return _placed(outline, at, heading)
