"""Planning the speed, and the plan."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.curve.contract import Curve
from osculate.errors import InvalidInput, NoSolution
from osculate.kernel import Grid, Tables
from osculate.target.speed.grid import Problem, make_problem
from osculate.target.speed.limits import Ceiling, Limits
from osculate.target.speed.programme import STEADY, Margin, passes, solve
from osculate.target.speed.reach import explain_infeasible, require_ends, require_strength
from osculate.target.speed.use import binding, overuse
from osculate.vehicle.tricycle import Tricycle

Array = NDArray[np.float64]

ITERATIONS = 30
LONG = 5000  # nodes from which on a programme starts from the fastest profile of two passes,
SELDOM = 0.01  # if jerk and motors would change it at no larger part of the nodes
SLACK = 1e-7  # part of a limit by which a plan may exceed it
SPARE = 2e-5  # part of jerk, torque and power that is spared where the programme exceeded them


class PlannedMotion(NamedTuple):
    """A plan at some arc lengths; arrays of one shape."""

    speed: Array  # m/s
    acceleration: Array  # m/s², along the path
    jerk: Array  # m/s³, rate of the acceleration


@dataclass(frozen=True)
class SpeedPlan:
    """A speed over arc length: v² / 2 is a quadratic between two nodes and smooth at them."""

    arc_length: Array  # m, nodes, shape (n,), uniform, to the curve's end
    energy: Array  # m²/s², v²/2, shape (n,)
    acceleration: Array  # m/s², along the path, shape (n,), linear between the nodes
    binding: list[str]  # which limit holds the speed down there, shape (n,)

    @property
    def _step(self) -> float:
        return float(self.arc_length[1] - self.arc_length[0])

    @property
    def speed(self) -> Array:
        """Speed (m/s), shape (n,)."""
        return np.sqrt(2.0 * self.energy)

    def at(self, arc_length: ArrayLike) -> PlannedMotion:
        """The plan at arc lengths (m), of any shape; clipped to those that are planned."""
        s = np.clip(np.asarray(arc_length, dtype=float), self.arc_length[0], self.arc_length[-1])
        cell = np.minimum(((s - self.arc_length[0]) / self._step).astype(int), len(self.energy) - 2)
        beyond = s - self.arc_length[cell]
        first = self.acceleration[cell]
        bend = (self.acceleration[cell + 1] - first) / self._step
        energy = self.energy[cell] + beyond * (first + 0.5 * bend * beyond)
        speed = np.sqrt(2.0 * np.maximum(energy, 0.0))
        return PlannedMotion(speed, first + bend * beyond, bend * speed)

    @property
    def duration(self) -> float:
        """Time for the whole curve (s)."""
        nodes, weights = np.polynomial.legendre.leggauss(6)
        places = self.arc_length[:-1, None] + 0.5 * self._step * (nodes + 1.0)
        return float((0.5 * self._step * weights / self.at(places).speed).sum())

    def shares(self) -> dict[str, float]:
        """Which part of the length each limit binds on, the largest first."""
        names, counts = np.unique(np.array(self.binding), return_counts=True)
        order = np.argsort(-counts)
        return {str(names[n]): float(counts[n] / len(self.binding)) for n in order}

    def table(self, tables: Tables) -> Grid:
        """Append the columns (E, E') for kernels."""
        rows = np.stack([self.energy, self.acceleration], axis=1)
        return tables.add(rows, float(self.arc_length[0]), self._step)


def plan_speed(
    curve: Curve, robot: Tricycle, limits: Limits | None = None, ceiling: Ceiling | None = None
) -> SpeedPlan:
    """The fastest speed over arc length that keeps all limits.

    Args:
        curve: Where to drive.
        robot: Its steering, motors, masses and tipping.
        limits: What the task allows.
        ceiling: One more limit of the speed over arc length.

    Raises:
        InvalidInput: The slowest speed is above the largest.
        NoSolution: The robot cannot follow the curve at any speed (says the limit and the place), or not
            with the given speeds at the ends (says the distance that it needs).
    """
    return _plan(curve, robot, limits or Limits(), ceiling, 0.0)


def _plan(
    curve: Curve, robot: Tricycle, limits: Limits, ceiling: Ceiling | None, begin: float
) -> SpeedPlan:
    for name in ("creep", "start_speed", "end_speed"):
        value = getattr(limits, name)
        if value is not None and value > limits.speed:
            message = f"must be at most speed = {limits.speed:g} m/s"
            raise InvalidInput(f"limits.{name}", value, message)
    problem = make_problem(curve, robot, limits, ceiling, begin)
    require_strength(problem, limits)
    require_ends(problem, limits)
    c = _iterate(problem, limits)
    node = 0.5 * (c[:-1] + c[1:])
    return SpeedPlan(problem.s, node, np.diff(c) / problem.step, binding(problem, limits, c))


class Begin(NamedTuple):
    """Where a robot begins, and how fast."""

    arc_length: float = 0.0  # m
    speed: float = 0.0  # m/s


#: At rest at the start of the curve.
RESTING = Begin()


def plan_from(
    begin: Begin, curve: Curve, robot: Tricycle, limits: Limits, ceiling: Ceiling | None = None
) -> SpeedPlan:
    """The plan for a robot that moves already: where it is faster than planned, from there on.

    Raises:
        InvalidInput: See `plan_speed`.
        NoSolution: See `plan_speed`; or the robot begins faster than any plan may be there.
    """
    plan = plan_speed(curve, robot, limits, ceiling)
    allowed = float(plan.at(begin.arc_length).speed)
    if not begin.speed > allowed * (1.0 + SLACK):
        return plan
    given = limits.start_speed is not None and begin.arc_length == 0.0
    if begin.speed > limits.speed or given:
        hint = "limits.start_speed" if given else "limits.speed"
        raise NoSolution(
            f"the robot begins with {begin.speed:.4g} m/s at s = {begin.arc_length:.4g} m, where the plan "
            f"allows {allowed:.4g} m/s; start slower, or raise {hint}"
        )
    return _plan(curve, robot, limits.but(start_speed=begin.speed), ceiling, begin.arc_length)


def _iterate(problem: Problem, limits: Limits) -> Array:
    """The coefficients of the fastest plan."""
    c = passes(problem, limits)
    most = _known_bound(problem, limits, c)
    margin = Margin(np.ones(len(c) - 2), np.ones(len(c) - 2))
    for _ in range(ITERATIONS):
        found = solve(problem, limits, c, margin, most)
        if found is None:
            raise explain_infeasible(problem, limits)
        change = float(np.abs(found - c).max() / found.max())
        c = found
        excess = overuse(problem, limits, c)
        worst = max(float(part.max()) for part in excess)
        if worst <= 1.0 + SLACK and change <= STEADY:
            return c
        margin = Margin(*map(_tightened, margin, excess))
    if worst > 1.0 + SLACK:
        raise explain_infeasible(problem, limits)
    return c


def _tightened(margin: Array, excess: Array) -> Array:
    """The part of a limit to use next, where more than all of it was used."""
    less: Array = np.where(excess > 1.0 + SLACK, margin / (excess + SPARE), margin)
    return less


def _known_bound(problem: Problem, limits: Limits, first: Array) -> Array | None:
    """The first guess as an upper bound, where starting from it saves most of the work."""
    if len(first) <= LONG:
        return None
    jerk, motor = overuse(problem, limits, first)
    bound = np.maximum(jerk, motor) > 1.0 + 1e-9
    return first if bound.mean() < SELDOM else None
