"""Pictures of a run as files: one PNG for every panel, one overview, and an animation."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from osculate.files import complete_file, write_by
from osculate.simulation.plot import BLUE, PANELS, new_figure, overview, path_panel

if TYPE_CHECKING:
    from osculate.simulation import Run

FRAMES = 120
FRAME_MILLISECONDS = 50


def write_figures(run: "Run", output: Path) -> list[Path]:
    """Write ``overview.png`` and one PNG for every panel; returns their paths."""
    return [write_by(write, output / name) for name, write in figure_writers(run).items()]


def figure_writers(run: "Run") -> dict[str, Callable[[Path], None]]:
    """Names of the pictures of a run, and what writes each of them to a path."""
    return {
        "overview.png": lambda path: overview(run).savefig(path),
        **{f"{name}.png": partial(_write_panel, run, name) for name in PANELS},
    }


def _write_panel(run: "Run", name: str, path: Path) -> None:
    wide = name == "path"
    figure, axes = new_figure(8.0 if wide else 7.0, 4.2 if wide else 3.4)
    PANELS[name](axes["only"], run)
    figure.savefig(path)


def write_animation(run: "Run", path: Path, report: Callable[[float], None] | None = None) -> Path:
    """Write an animated GIF: the robot with its steered wheel drives along the path."""
    from PIL import Image

    pictures = map(Image.fromarray, _pictures(run))
    first, rest = next(pictures).quantize(256), []
    for n, picture in enumerate(pictures, 2):
        rest.append(picture.quantize(palette=first, dither=Image.Dither.NONE))
        if report:
            report(n / FRAMES)
    with complete_file(path) as temporary:
        first.save(
            temporary, save_all=True, append_images=rest, duration=FRAME_MILLISECONDS, loop=0
        )
    return path


def _pictures(run: "Run") -> Iterator[NDArray[np.uint8]]:
    """The pictures of the animation, shape (height, width, 3)."""
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
    times = np.linspace(0.0, column["time"][-1], FRAMES)
    for n in np.searchsorted(column["time"], times).clip(0, last).tolist():
        trace.set_data(column["x"][: n + 1], column["y"][: n + 1])
        at, heading = (column["x"][n], column["y"][n]), column["heading"][n]
        body.set_xy(_placed(run.setup.robot.footprint.corners, at, heading))
        wheel.set_xy(_front_wheel(run, at, heading, column["steering_angle"][n]))
        clock.set_text(f"t = {column['time'][n]:5.2f} s   v = {column['speed'][n]:5.2f} m/s")
        figure.canvas.draw()
        yield np.asarray(figure.canvas.buffer_rgba())[..., :3]


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
