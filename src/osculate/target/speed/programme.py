"""The linear programmes of a speed plan, in the coefficients of its spline (see `grid`)."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.target.speed.grid import Problem
from osculate.target.speed.limits import Limits

Array = NDArray[np.float64]

TOLERANCE = 1e-10  # of the solver; E of 1 mm/s is 5e-7 m²/s²
LEAST = 1e-4  # m/s, that keeps 1 / v finite; no plan is that slow
STEADY = 1e-3  # change of E, per its largest, at which the iteration ends


class Margin(NamedTuple):
    """Parts of the limits that the programme may use on every cell, shape (n,)."""

    jerk: Array
    motor: Array


def ordinates(c: Array) -> tuple[Array, Array, Array]:
    """Bézier ordinates of E on every cell, each of shape (n,)."""
    node = 0.5 * (c[:-1] + c[1:])
    return node[:-1], c[1:-1], node[1:]


def passes(problem: Problem, limits: Limits) -> Array:
    """The largest coefficients under speeds and accelerations alone: no plan is faster anywhere."""
    c = problem.most.copy()
    for place, end in zip((slice(0, 2), slice(-2, None)), problem.ends, strict=True):
        if end is not None:
            c[place] = np.minimum(end, c[place].min())
    way = problem.step * np.arange(len(c))
    for _ in range(2 if problem.around else 1):  # the second pass closes the lap
        if problem.around:
            c[0] = c[-2] = min(c[0], c[-2])
            c[1] = c[-1] = min(c[1], c[-1])
        c = np.minimum.accumulate(c - limits.acceleration * way) + limits.acceleration * way
        back = (c + limits.deceleration * way)[::-1]
        c = np.minimum.accumulate(back)[::-1] - limits.deceleration * way
    return c


class _Matrices(NamedTuple):
    slope: Any  # E' at the nodes
    bend: Any  # E'' on the cells
    node: Any  # E at the nodes
    ordinate: tuple[Any, Any, Any]  # of E on the cells


def _matrices(problem: Problem) -> _Matrices:
    from scipy.sparse import diags_array

    n, h = len(problem.s) - 1, problem.step

    def band(*values: float, rows: int = n) -> Any:
        return diags_array(values, offsets=range(len(values)), shape=(rows, n + 2)).tocsr()

    return _Matrices(
        band(-1.0 / h, 1.0 / h, rows=n + 1),
        band(1.0 / h**2, -2.0 / h**2, 1.0 / h**2),
        band(0.5, 0.5, rows=n + 1),
        (band(0.5, 0.5), band(0.0, 1.0), band(0.0, 0.5, 0.5)),
    )


def _scaled(values: Array, matrix: Any) -> Any:
    from scipy.sparse import diags_array

    return diags_array(values) @ matrix


def _inverse_speed(c: Array) -> Array:
    """1 / v for coefficients or ordinates."""
    inverse: Array = 1.0 / np.sqrt(2.0 * np.maximum(c, LEAST**2 / 2.0))
    return inverse


def _jerk_rows(
    limits: Limits, m: _Matrices, c: Array, margin: Margin
) -> tuple[list[Any], list[Array]]:
    """±E'' ≤ j / v, with the tangent of 1 / v where the cell was fastest at the last iterate."""
    parts = np.stack(ordinates(c))
    chosen = parts.argmax(axis=0)
    fastest: Any = sum(_scaled((chosen == k).astype(float), m.ordinate[k]) for k in range(3))
    inverse = limits.jerk * margin.jerk * _inverse_speed(parts.max(axis=0))
    lean = _scaled(0.5 * inverse / np.maximum(parts.max(axis=0), LEAST**2 / 2.0), fastest)
    return [m.bend + lean, -m.bend + lean], [1.5 * inverse, 1.5 * inverse]


def _motor_rows(
    problem: Problem, limits: Limits, m: _Matrices, c: Array, margin: Margin
) -> tuple[list[Any], list[Array]]:
    """Torque and power at the nodes where the bounds of E and E' do not keep them already."""
    drive = problem.drive
    least_mass, mass = _by_node(drive.least_mass, np.minimum), _by_node(drive.mass, np.maximum)
    least_turn, turn = _by_node(drive.least_turn, np.minimum), _by_node(drive.turn, np.maximum)
    share = _by_node(margin.motor, np.minimum)
    top = np.minimum(np.maximum(problem.most[:-1], problem.most[1:]), problem.caps["speed"][0])
    rows: list[Any] = []
    bounds: list[Array] = []

    def add(inertia: Array, lean: Array, sign: float, bound: Array, needed: Array) -> None:
        """Rows ± (m E' + q E) ≤ bound where they are needed, per mass."""
        where = np.flatnonzero(needed)
        row = _scaled(inertia / mass, m.slope) + _scaled(lean / mass, m.node)
        rows.append(sign * row[where])
        bounds.append((bound / mass)[where])

    force = drive.force * share
    high, low = force - drive.rolling, force + drive.rolling
    rise, fall = np.maximum(turn, 0.0) * top, np.maximum(-least_turn, 0.0) * top
    up, down = mass * limits.acceleration, mass * limits.deceleration
    add(mass, turn, 1.0, high, up + rise > high)
    add(least_mass, turn, 1.0, high, rise > high)
    add(mass, least_turn, -1.0, low, down + fall > low)
    add(least_mass, least_turn, -1.0, low, fall > low)
    if drive.power < np.inf:
        energy = np.maximum(0.5 * (c[:-1] + c[1:]), LEAST**2 / 2.0)
        most = drive.power * share * _inverse_speed(energy)
        least = drive.power * share * _inverse_speed(top) - drive.rolling
        for inertia, reach in ((mass, up), (least_mass, 0.0)):
            lean = turn + 0.5 * most / energy
            add(inertia, lean, 1.0, 1.5 * most - drive.rolling, reach + rise > least)
    return rows, bounds


def _by_node(cells: Array, choose: Any) -> Array:
    """The larger or smaller value of the two cells that meet at every node."""
    values: Array = choose(np.append(cells, cells[-1]), np.insert(cells, 0, cells[0]))
    return values


def _ends(problem: Problem, most: Array) -> tuple[Array, Array, Any]:
    """Bounds of the coefficients, and rows that are zero: no acceleration at ends with a given speed."""
    from scipy.sparse import csr_array

    upper = most.copy()
    lower = np.minimum(LEAST**2 / 2.0, upper)
    last = len(upper) - 1
    pairs = []
    for pair, end, given in zip(
        ((0, 1), (last - 1, last)), problem.ends, problem.given, strict=True
    ):
        if end is not None:
            pairs.append(pair)
            upper[list(pair)] = np.minimum(end, upper[list(pair)])
            lower[list(pair)] = end if given else lower[list(pair)]
    if problem.around:
        pairs = [(0, last - 1), (1, last)]
    count = np.arange(len(pairs))
    rows = np.repeat(count, 2)
    columns = np.array(pairs, dtype=int).reshape(-1)
    values = np.tile([1.0, -1.0], len(pairs))
    return lower, upper, csr_array((values, (rows, columns)), shape=(len(pairs), last + 1))


def solve(
    problem: Problem, limits: Limits, c: Array, margin: Margin, most: Array | None
) -> Array | None:
    """One linear programme around the last iterate; None if nothing keeps all limits.

    Args:
        problem: Grid and bounds.
        limits: The task.
        c: Coefficients of the last iterate.
        margin: Parts of the limits to use.
        most: A known upper bound of the coefficients, if starting from it is worth it.
    """
    from scipy.optimize import linprog
    from scipy.sparse import vstack

    m = _matrices(problem)
    nodes = len(problem.s)
    jerk, jerks = _jerk_rows(limits, m, c, margin)
    motor, motors = _motor_rows(problem, limits, m, c, margin)
    rises = [np.full(nodes, limits.acceleration), np.full(nodes, limits.deceleration)]
    lower, upper, equal = _ends(problem, problem.most if most is None else most)
    gain = (2.0 * np.maximum(c, LEAST**2 / 2.0)) ** -1.5
    programme: Any = linprog  # its stubs know no sparse matrices
    solved = programme(
        -gain / gain.max(),
        A_ub=vstack([m.slope, -m.slope, *jerk, *motor], format="csr"),
        b_ub=np.concatenate([*rises, *jerks, *motors]),
        A_eq=equal,
        b_eq=np.zeros(equal.shape[0]),
        bounds=np.stack([lower, upper], axis=1),
        method="highs",
        options={"primal_feasibility_tolerance": TOLERANCE},
    )
    return None if solved.x is None else np.asarray(solved.x, dtype=float)
