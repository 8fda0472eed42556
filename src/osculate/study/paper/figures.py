"""Figures 3–7 in the paper's panels, and the energy figure of erratum 1."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from osculate.folder import OutputFolder
from osculate.simulation import Run
from osculate.simulation.plot import BLUE, GREEN, ORANGE, RED, new_figure, readable, thinned
from osculate.study.paper.cases import CASES, CURVE, rms
from osculate.study.paper.claims import Runs

#: Number of the figure to the cases it shows: the paper's first, other readings below it.
FIGURES = {
    3: ("modified_d1", "modified_d1_minus"),
    4: ("static_d1", "static_d1_minus"),
    5: ("modified_d11", "modified_d11_minus"),
    6: ("modified_d12", "modified_d12_heading_disturbed"),
}


def write_figures(
    runs: Runs, output: OutputFolder, report: Callable[[float], None] | None = None
) -> list[Path]:
    """Write ``figure3.png`` … ``figure7.png`` into ``output``; returns the paths of those written."""
    draw = {number: partial(_errors_and_path, runs, names) for number, names in FIGURES.items()} | {
        7: partial(_commands, runs["modified_d12"])
    }
    paths = []
    for done, (number, figure) in enumerate(draw.items(), 1):
        paths.append(output.write(f"figure{number}.png", partial(_write, figure)))
        if report:
            report(done / len(draw))
    return [path for path in paths if path is not None]


def _write(figure: Callable[[], Any], path: Path) -> None:
    figure().savefig(path)


def _errors_and_path(runs: Runs, names: tuple[str, ...]) -> Any:
    """One row for every reading: (a) speed errors, (b) path driven over the target."""
    mosaic = [[f"errors {name}", f"path {name}"] for name in names]
    figure, axes = new_figure(10.0, 3.6 * len(names), mosaic)
    for name in names:
        _errors(axes[f"errors {name}"], runs[name], CASES[name].meaning)
        _path(axes[f"path {name}"], runs[name])
    return figure


def _errors(ax: Any, run: Run, title: str) -> None:
    column = thinned(run)
    ax.plot(column["time"], column["speed_error"], color=BLUE, label="z = v − v̂ (m/s)")
    ax.plot(column["time"], column["yaw_rate_error"], color=ORANGE, label="y₂ = θ̇ − θ̂̇ (rad/s)")
    both = np.abs([column["speed_error"], column["yaw_rate_error"]])
    if both.max() > 100.0:
        ax.set_yscale("symlog", linthresh=1.0)
    ax.set(title=title, xlabel="time (s)", ylabel="speed errors (m/s, rad/s)")
    ax.legend(loc="best", frameon=False, fontsize="small")


def _path(ax: Any, run: Run) -> None:
    point = CURVE.at(np.linspace(0.0, CURVE.length, 1001))
    ax.plot(point.x, point.y, color=ORANGE, linewidth=3.0, alpha=0.55, label="target")
    inside = np.abs(run.columns["cross_track_error"]) < 10.0  # the rest has left the picture
    x, y = np.where(inside, run.columns["x"], np.nan), np.where(inside, run.columns["y"], np.nan)
    ax.plot(x, y, color=BLUE, linewidth=1.1, label="driven")
    ax.plot(run.columns["x"][0], run.columns["y"][0], "o", color=GREEN, markersize=5)
    error = rms(run)
    factor, unit = readable(error)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set(title=f"rms error {error * factor:.3g} {unit}", xlabel="x (m)", ylabel="y (m)")
    ax.legend(loc="best", frameon=False, fontsize="small")


def _commands(run: Run) -> Any:
    """Figure 7: (a) the steering angle, (b) both torques."""
    figure, axes = new_figure(10.0, 3.6, [["angle", "torque"]])
    column = thinned(run, 4000)
    axes["angle"].plot(column["time"], column["steering_angle"], color=GREEN)
    axes["angle"].set(title="steering angle φ", xlabel="time (s)", ylabel="φ (rad)")
    axes["torque"].plot(column["time"], column["torque_left"], color=BLUE, label="left wheel")
    axes["torque"].plot(
        column["time"], column["torque_right"], color=RED, linewidth=0.9, label="right wheel"
    )
    axes["torque"].set(title="drive torques", xlabel="time (s)", ylabel="torque (N m)")
    axes["torque"].legend(loc="best", frameon=False, fontsize="small")
    return figure
