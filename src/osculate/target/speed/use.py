"""How far a speed plan uses its limits, between its nodes too."""

import numpy as np
from numpy.typing import NDArray

from osculate.target.speed.grid import MANY, Problem
from osculate.target.speed.limits import Limits
from osculate.target.speed.programme import Margin, ordinates

Array = NDArray[np.float64]

FINE = 16  # places of every cell at which the motors' use is taken, where there are not many cells
NAMED = 1.001  # energy per that of the creeping speed below which a plan counts as creeping


def _spread(problem: Problem, c: Array) -> tuple[Array, Array, Array]:
    """E and E' at places of every cell, shape (n, k), and E'', shape (n,)."""
    count, h = (FINE if len(c) <= MANY else problem.samples), problem.step
    way = h * np.arange(count + 1) / count
    first, _, _ = ordinates(c)
    slope, bend = np.diff(c)[:-1] / h, np.diff(c, 2) / h**2
    energy = first[:, None] + way * (slope[:, None] + 0.5 * bend[:, None] * way)
    return energy, slope[:, None] + bend[:, None] * way, bend


def overuse(problem: Problem, limits: Limits, c: Array) -> Margin:
    """Largest use of jerk and motors on every cell, 1 where they bind, shape (n,)."""
    energy, slope, bend = _spread(problem, c)
    speed = np.sqrt(2.0 * np.maximum(energy, 0.0))
    h = problem.step
    node, _, _ = ordinates(c)
    first = np.diff(c)[:-1] / h
    turn = np.where(bend < 0.0, -first / np.where(bend < 0.0, bend, 1.0), -1.0)  # where E' = 0
    peak = node + turn * (first + 0.5 * bend * turn)
    inside = (turn > 0.0) & (turn < h)
    fastest = np.maximum(
        speed.max(axis=1), np.where(inside, np.sqrt(2.0 * np.maximum(peak, 0.0)), 0.0)
    )
    return Margin(np.abs(bend) * fastest / limits.jerk, _peak(_motor_use(problem, energy, slope)))


def _peak(samples: Array) -> Array:
    """Largest value on every cell, with as much as a parabola rises between two samples at most."""
    dip = np.pad(np.maximum(-np.diff(samples, 2), 0.0), ((0, 0), (1, 1)), mode="edge")
    peak: Array = (samples + dip / 8.0).max(axis=1)
    return peak


def _motor_use(problem: Problem, energy: Array, slope: Array) -> Array:
    """Use of torque and power for E and E' of every cell, shape (n, k): at the worst curvature there."""
    drive = problem.drive
    mass = np.where(slope > 0.0, drive.mass[:, None], drive.least_mass[:, None])
    rise = mass * slope + drive.turn[:, None] * energy + drive.rolling
    mass = np.where(slope < 0.0, drive.mass[:, None], drive.least_mass[:, None])
    fall = mass * slope + drive.least_turn[:, None] * energy + drive.rolling
    speed = np.sqrt(2.0 * np.maximum(energy, 0.0))
    torque = np.maximum(rise, -fall) / drive.force
    return np.maximum(torque, rise * speed / drive.power)


def binding(problem: Problem, limits: Limits, c: Array) -> list[str]:
    """The limit with the least room at every node."""
    m = problem.samples
    node = 0.5 * (c[:-1] + c[1:])
    slope = np.diff(c) / problem.step
    cells = dict(zip(("jerk", "motor"), overuse(problem, limits, c), strict=True))
    use = {name: node / cap[::m] for name, cap in problem.caps.items()}
    use |= {
        "acceleration": slope / limits.acceleration,
        "deceleration": -slope / limits.deceleration,
    }
    use |= {
        name: np.maximum(np.append(values, 0.0), np.insert(values, 0, 0.0))
        for name, values in cells.items()
    }
    names = np.array(list(use))
    chosen = names[np.array(list(use.values())).argmax(axis=0)]
    low = limits.creep**2 / 2.0
    return np.where(node <= NAMED * low, "creep", chosen).tolist()
