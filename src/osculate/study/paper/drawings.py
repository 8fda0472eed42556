"""Figures 1 and 2: the robot with its letters, and its task."""

from typing import Any

import numpy as np

from osculate.scene import Wall
from osculate.simulation import Run
from osculate.simulation.plot import BLUE, GREEN, GREY, ORANGE, RED, new_figure
from osculate.study.paper.cases import CURVE, ROBOT

HEADING, ANGLE = 0.5, 0.55  # rad, of the robot that is drawn


def robot_drawing() -> Any:
    """Figure 1: wheels, rod, O and P, heading θ, steering angle φ, and the centre of the turn."""
    figure, axes = new_figure(7.0, 5.2)
    ax = axes["only"]
    a, d, r = ROBOT.wheelbase, ROBOT.track_width, ROBOT.wheel_radius
    along = np.array([np.cos(HEADING), np.sin(HEADING)])
    left = np.array([-along[1], along[0]])
    front = a * along
    turned = np.array([np.cos(HEADING + ANGLE), np.sin(HEADING + ANGLE)])
    centre = a / np.tan(ANGLE) * left
    for middle, direction in (
        (0.5 * d * left, along), (-0.5 * d * left, along), (front, turned)
    ):  # fmt: skip
        ends = np.array([middle - r * direction, middle + r * direction])
        ax.plot(*ends.T, color=GREY, linewidth=9, solid_capstyle="round")
    ax.plot(*np.array([0.5 * d * left, -0.5 * d * left]).T, color=BLUE, linewidth=2)
    ax.plot(*np.array([0.0 * front, front]).T, color=BLUE, linewidth=2, label="rod, a = |OP|")
    ax.plot(*np.array([0.0 * front, centre, front]).T, color=GREY, linewidth=0.8, linestyle="--")
    for start, direction, length, colour, label in (
        (0.0 * front, along, 0.25, GREEN, "v, speed of O"),
        (front, turned, 0.25 / np.cos(ANGLE), RED, "speed of P"),
    ):
        ax.annotate(
            "", start + length * direction, start,
            arrowprops={"arrowstyle": "->", "color": colour, "linewidth": 2},
        )  # fmt: skip
        ax.plot([], [], color=colour, label=label)
    _arc(ax, np.zeros(2), 0.0, HEADING, 0.16, "θ")
    _arc(ax, front, HEADING, HEADING + ANGLE, 0.2, "φ")
    ax.plot([0.0, 0.25], [0.0, 0.0], color=GREY, linewidth=0.8)
    ax.plot(*np.array([front, front + 0.3 * along]).T, color=GREY, linewidth=0.8)
    for point, name in ((np.zeros(2), "O"), (front, "P"), (centre, "centre of the turn")):
        ax.plot(*point, "o", color=ORANGE, markersize=5)
        ax.annotate(name, point, xytext=(6, -14), textcoords="offset points")
    ax.set_aspect("equal")
    ax.set(xlabel="x (m)", ylabel="y (m)", title="The robot: θ̇ = v tan φ / a, eq. (6)")
    ax.legend(loc="lower right", frameon=False, fontsize="small")
    return figure


def _arc(ax: Any, middle: Any, begin: float, end: float, radius: float, name: str) -> None:
    """An angle with its letter."""
    angles = np.linspace(begin, end, 40)
    x, y = middle[0] + radius * np.cos(angles), middle[1] + radius * np.sin(angles)
    ax.plot(x, y, color=GREY, linewidth=1.0)
    half = 0.5 * (begin + end)
    ax.annotate(
        name, (middle[0] + 1.2 * radius * np.cos(half), middle[1] + 1.2 * radius * np.sin(half))
    )


def task_drawing(run: Run) -> Any:
    """Figure 2: obstacle, target curve, D, h and ĥ, and the path that the robot drives undisturbed."""
    from matplotlib.patches import Polygon

    figure, axes = new_figure(9.0, 4.2)
    ax = axes["only"]
    point = CURVE.at(np.linspace(0.0, CURVE.length, 1001))
    x, y = float(point.x[0]), float(point.y[0])
    wall = Wall(distance=CURVE.distance, height=CURVE.height)
    ax.add_patch(Polygon(wall.outline((x, y)), facecolor="#d6d9de", edgecolor=GREY))
    whole = np.linspace(0.0, 2.0 * np.pi, 1001)
    ax.plot(
        CURVE.radius * (whole - np.sin(whole)), CURVE.radius * (1.0 - np.cos(whole)), color=GREY,
        linewidth=0.8, linestyle=":", label="the whole cycloid",
    )  # fmt: skip
    ax.plot(point.x, point.y, color=ORANGE, linewidth=3.0, alpha=0.55, label="target curve")
    ax.plot(run.columns["x"], run.columns["y"], color=BLUE, linewidth=1.1, label="driven")
    middle, top = x + CURVE.distance, y + CURVE.height
    for start, end, name in (
        ((x, y), (middle, y), f"D = {CURVE.distance:g} m"),
        ((middle, y), (middle, top), f"h = {CURVE.height:g} m"),
        ((middle, top), (middle, top + CURVE.margin), f"ĥ = {CURVE.margin:g} m"),
    ):
        ax.annotate("", end, start, arrowprops={"arrowstyle": "<->", "color": RED})
        where = (0.5 * (start[0] + end[0]) + 0.15, 0.5 * (start[1] + end[1]) + 0.12)
        ax.annotate(name, where, fontsize="small", color=RED)
    ax.plot(x, y, "o", color=GREEN, markersize=5, label=f"start ({x:.4f}, {y:.4f}) m")
    ax.set_aspect("equal", adjustable="datalim")
    length, name = CURVE.length, "l = 8α cos(β/2)"
    ax.set(
        xlabel="x (m)",
        ylabel="y (m)",
        title=f"The task: a truncated cycloid, {name} = {length:.4f} m",
    )
    ax.legend(
        loc="lower center", frameon=False, fontsize="small", ncols=4, bbox_to_anchor=(0.5, 0.0)
    )
    return figure
