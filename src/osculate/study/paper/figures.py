"""Figures 3–7 in the paper's panels, with the error along the path and one time axis."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from osculate.folder import OutputFolder
from osculate.simulation import Run
from osculate.simulation.plot import BLUE, GREEN, GREY, ORANGE, RED, new_figure, readable, thinned
from osculate.study.paper.cases import CASES, CURVE, DURATION, Runs
from osculate.study.paper.drawings import robot_drawing, task_drawing
from osculate.study.paper.measures import path_end, rms

#: Number of the figure to the cases it shows: the paper's first, other readings below it.
FIGURES = {
    3: ("modified_d1", "modified_d1_minus"),
    4: ("static_d1", "static_d1_minus"),
    5: ("modified_d11", "modified_d11_minus"),
    6: ("modified_d12", "modified_d12_heading_disturbed"),
}
SEEN = 10.0  # m, beyond which a robot has left the picture


def write_figures(
    runs: Runs, output: OutputFolder, report: Callable[[float], None] | None = None
) -> list[Path]:
    """Write ``figure1.png`` … ``figure7.png`` into ``output``; returns the paths of those written."""
    draw: dict[int, Callable[[], Any]] = {
        1: robot_drawing,
        2: partial(task_drawing, runs["modified"]),
    }
    draw |= {number: partial(_errors_and_path, runs, names) for number, names in FIGURES.items()}
    draw[7] = partial(_commands, runs["modified_d12"])
    paths = []
    for done, (number, figure) in enumerate(draw.items(), 1):
        paths.append(output.write(f"figure{number}.png", partial(_write, figure)))
        if report:
            report(done / len(draw))
    return [path for path in paths if path is not None]


def _write(figure: Callable[[], Any], path: Path) -> None:
    figure().savefig(path)


def _errors_and_path(runs: Runs, names: tuple[str, ...]) -> Any:
    """One row for every reading: (a) speed errors, (b) path driven over the target, error along it."""
    mosaic = [[f"errors {name}", f"path {name}", f"along {name}"] for name in names]
    figure, axes = new_figure(15.0, 3.7 * len(names), mosaic)
    for name in names:
        _errors(axes[f"errors {name}"], runs[name], CASES[name].meaning)
        _path(axes[f"path {name}"], runs[name])
        _along(axes[f"along {name}"], runs[name])
    return figure


def _errors(ax: Any, run: Run, title: str) -> None:
    column = thinned(run)
    ax.plot(column["time"], column["speed_error"], color=BLUE, label="z = v − v̂ (m/s)")
    ax.plot(column["time"], column["yaw_rate_error"], color=ORANGE, label="y₂ = θ̇ − θ̂̇ (rad/s)")
    both = np.abs([column["speed_error"], column["yaw_rate_error"]])
    if both.max() > 100.0:
        ax.set_yscale("symlog", linthresh=1.0)
    _time_axis(ax, run)
    ax.set(title=title, ylabel="speed errors (m/s, rad/s)")
    ax.legend(loc="best", frameon=False, fontsize="small")


def _time_axis(ax: Any, run: Run) -> None:
    """0 to 20 s in every figure, with the end of the path marked."""
    ax.set(xlim=(0.0, DURATION), xlabel="time (s)")
    end = path_end(run)
    if end is not None:
        ax.axvline(end, color=GREY, linewidth=1.0, linestyle="--", label=f"s = l at {end:.2f} s")


def _path(ax: Any, run: Run) -> None:
    point = CURVE.at(np.linspace(0.0, CURVE.length, 1001))
    ax.plot(point.x, point.y, color=ORANGE, linewidth=3.0, alpha=0.55, label="target")
    inside = np.abs(run.columns["cross_track_error"]) < SEEN
    x, y = np.where(inside, run.columns["x"], np.nan), np.where(inside, run.columns["y"], np.nan)
    ax.plot(x, y, color=BLUE, linewidth=1.1, label="driven")
    ax.plot(run.columns["x"][0], run.columns["y"][0], "o", color=GREEN, markersize=5)
    error = rms(run)
    factor, unit = readable(error)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set(title=f"√(J_a/N) = {error * factor:.3g} {unit}", xlabel="x (m)", ylabel="y (m)")
    ax.legend(loc="best", frameon=False, fontsize="small")


def _along(ax: Any, run: Run) -> None:
    """The distance from the path over the arc length: what cannot be seen at the scale of the path."""
    column = thinned(run)
    seen = np.abs(column["cross_track_error"]) < SEEN
    largest = float(np.abs(column["cross_track_error"][seen]).max())
    factor, unit = readable(largest)
    ax.plot(column["foot"][seen], factor * column["cross_track_error"][seen], color=RED)
    ax.set(xlim=(0.0, 1.02 * CURVE.length), title=f"at most {largest * factor:.3g} {unit} off")
    ax.set(xlabel="arc length (m)", ylabel=f"cross-track error ({unit})")


def _commands(run: Run) -> Any:
    """Figure 7: (a) the steering angle, (b) both torques, and u₁ and u₂."""
    figure, axes = new_figure(15.0, 3.9, [["angle", "torque", "input"]])
    column = thinned(run, 4000)
    axes["angle"].plot(column["time"], column["steering_angle"], color=GREEN)
    axes["angle"].set(title="(a) steering angle φ = arctan(aθ̇/v)", ylabel="φ (rad)")
    left, right = column["torque_left"], column["torque_right"]
    axes["torque"].plot(column["time"], left, color=BLUE, label="left wheel")
    axes["torque"].plot(column["time"], right, color=RED, linewidth=0.9, label="right wheel")
    axes["torque"].set(title="(b) drive torques", ylabel="torque (N m)")
    axes["input"].plot(column["time"], left + right, color=BLUE, label="u₂ = T_l + T_r")
    axes["input"].plot(column["time"], right - left, color=ORANGE, label="u₁ = T_l − T_r")
    axes["input"].set(title="the laws' inputs u₁ and u₂", ylabel="torque (N m)")
    for name, ax in axes.items():
        _time_axis(ax, run)
        if name != "angle":
            ax.legend(loc="best", frameon=False, fontsize="small")
    return figure
