"""The grid of a speed plan: a quadratic spline, and its coefficients' bounds.

The plan has n cells of the length h. On cell i, E is the quadratic whose Bézier ordinates are

    (cᵢ + cᵢ₊₁) / 2,    cᵢ₊₁,    (cᵢ₊₁ + cᵢ₊₂) / 2

with the coefficients c₀ … cₙ₊₁ of a uniform quadratic B-spline: E is the mean of two coefficients at a
node, E' their difference per h, and E'' the second difference per h². A quadratic lies in the hull of its
ordinates, so that a limit which is linear on the cell and holds for them holds everywhere. Another limit of
E is replaced on each cell by a line below it, found from samples and from the lower of each two
neighbours, so that jumps between samples (of the rate of curvature, where two pieces meet) are kept too;
the lines are turned into one bound for each coefficient.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.errors import InvalidInput, NoSolution
from osculate.target.speed.limits import Ceiling, Limits, rest_deceleration, rests_at_end
from osculate.vehicle.tricycle import Tricycle

Array = NDArray[np.float64]

NODES = 1200  # of the programme; more on long curves is seldom worth its time
FINEST = 0.01  # m, no step is shorter
COARSEST = 0.15  # m, no step is longer
MOST_NODES = 1_000_000
SAMPLES = 8  # of the curve in every cell
FEWER = 2  # likewise of plans with more than MANY cells
MANY = 20_000
CRAWL = 0.02  # m/s, slowest speed that a limit may ask for
TINY = 1e-12


class Drive(NamedTuple):
    """Drive force m E' + q E + rolling on every cell: least and largest coefficients, shape (n,)."""

    least_mass: Array  # kg, m = M + I κ²
    mass: Array  # kg
    least_turn: Array  # kg/m, q = 2 I κ κ'
    turn: Array  # kg/m
    force: float  # N, that the motors may use
    rolling: float  # N
    power: float  # W, that both drives may use; infinite without a limit


class Problem(NamedTuple):
    """What the programme is about."""

    s: Array  # m, nodes, shape (n + 1,)
    around: bool  # whether it is a lap that ends as fast as it starts
    caps: dict[str, Array]  # limit to the largest E at samples, shape (n m + 1,)
    most: Array  # m²/s², largest coefficients, shape (n + 2,)
    drive: Drive
    ends: tuple[float | None, float | None]  # E at both ends; None where it is free
    given: tuple[bool, bool]  # whether it has to be that; else it is only the most
    curvature: Array  # 1/m, at samples
    curvature_rate: Array  # 1/m², at samples

    @property
    def step(self) -> float:
        """Distance of the nodes (m)."""
        return float(self.s[1] - self.s[0])

    @property
    def samples(self) -> int:
        """Samples of every cell."""
        return (len(self.curvature) - 1) // (len(self.s) - 1)


def make_problem(
    curve: Curve, robot: Tricycle, limits: Limits, ceiling: Ceiling | None, begin: float
) -> Problem:
    """Nodes and bounds from the arc length ``begin`` (m) on.

    Raises:
        InvalidInput: The curve is too long for one plan.
        NoSolution: The robot cannot follow the curve at any speed.
    """
    cells = _cells(curve, curve.length - begin)
    m = SAMPLES if cells <= MANY else FEWER
    s = np.linspace(begin, curve.length, cells * m + 1)
    point = curve.at(s)
    _require_steerable(curve, robot, s, point.curvature)
    caps = _caps(curve, robot, limits, s, (point.curvature, point.curvature_rate))
    if ceiling is not None:
        caps[ceiling.name] = ceiling.at(s) ** 2 / 2.0
    _require_drivable(caps, limits, s)
    ends = tuple(
        _end(given, curve.closed, limits) for given in (limits.start_speed, limits.end_speed)
    )
    around = curve.closed and ends == (None, None)
    nodes, middle = bound_cells(np.min(list(caps.values()), axis=0), m)
    return Problem(
        s=s[::m],
        around=around,
        caps=caps,
        most=bound_coefficients(nodes, middle, around),
        drive=_drive(robot, limits, point.curvature, point.curvature_rate, m),
        ends=(ends[0], ends[1]),
        given=(
            (limits.start_speed or 0.0) > limits.creep,
            (limits.end_speed or 0.0) > limits.creep,
        ),
        curvature=point.curvature,
        curvature_rate=point.curvature_rate,
    )


def _cells(curve: Curve, length: float) -> int:
    wanted = np.clip(length / FINEST, 20, max(NODES, length / COARSEST))
    if not wanted <= MOST_NODES:
        raise InvalidInput(
            "curve.length", curve.length, f"a speed plan would need {wanted / 1e6:.3g} M nodes, at most "
            f"{MOST_NODES / 1e6:g} M: must be at most {MOST_NODES * COARSEST:g} m; drive it in parts, or "
            "fewer laps",
        )  # fmt: skip
    return int(wanted)


def _end(given: float | None, closed: bool, limits: Limits) -> float | None:
    if given is None and closed:
        return None
    return max(given or 0.0, limits.creep) ** 2 / 2.0


def _caps(
    curve: Curve, robot: Tricycle, limits: Limits, s: Array, bend: tuple[Array, Array]
) -> dict[str, Array]:
    a, curvature = robot.wheelbase, np.abs(bend[0])
    beside = np.pad(curvature, 1, mode="edge")  # where the rate jumps between two samples
    least = np.minimum(np.minimum(beside[:-2], beside[2:]), curvature)
    turning = a * np.abs(bend[1]) / (1.0 + (a * least) ** 2)
    steering = limits.steering * robot.actuators.steering_rate_limit
    caps = {
        "speed": np.full(len(s), limits.speed**2 / 2.0),
        "lateral acceleration": limits.lateral_acceleration / 2.0 / np.maximum(curvature, TINY),
        "tipping": limits.tipping * robot.tipping_acceleration / 2.0 / np.maximum(curvature, TINY),
        "steering rate": (steering / np.maximum(turning, TINY)) ** 2 / 2.0,
    }
    own = curve.speed_limit(s)
    if own is not None:
        caps["the curve's own speeds"] = np.maximum(own, limits.creep) ** 2 / 2.0
    braking = rest_deceleration(robot, limits)
    if rests_at_end(curve, limits) and braking < limits.deceleration:
        caps["coming to rest"] = limits.creep**2 / 2.0 + braking * (curve.length - s)
    return caps


def _require_steerable(curve: Curve, robot: Tricycle, s: Array, curvature: Array) -> None:
    """Refuse a curve that bends more than the robot can, at a sample or at a tight place between."""
    limit, a = robot.actuators.steering_angle_limit, robot.wheelbase
    places = np.append(s, curve.tight_places)
    bends = np.append(curvature, curve.at(curve.tight_places).curvature)
    worst = int(np.abs(bends).argmax())
    if abs(bends[worst]) > np.tan(limit) / a:
        raise NoSolution(
            f"the robot cannot follow the curve: at s = {places[worst]:.4g} m it bends with "
            f"{bends[worst]:.4g} 1/m, which needs a steering angle of "
            f"{np.degrees(np.arctan(a * abs(bends[worst]))):.4g}°; the limit is {np.degrees(limit):.4g}°"
        )


def _require_drivable(caps: dict[str, Array], limits: Limits, s: Array) -> None:
    """Refuse a limit that asks for hardly any speed at some place."""
    slowest = min(CRAWL, limits.creep)
    for name, cap in caps.items():
        worst = int(cap.argmin())
        if cap[worst] < slowest**2 / 2.0:
            raise NoSolution(
                f"no speed profile keeps all limits: at s = {s[worst]:.4g} m {name} allows "
                f"{np.sqrt(2.0 * cap[worst]):.2g} m/s, less than {slowest:g} m/s; raise that limit or "
                "smooth the curve"
            )


def _drive(robot: Tricycle, limits: Limits, curvature: Array, rate: Array, m: int) -> Drive:
    act, r = robot.actuators, robot.wheel_radius
    bare = robot.total_mass + 2.0 * robot.wheel_inertia / r**2
    mass = _by_cell(bare + robot.turn_inertia * curvature**2, m)
    bends, rates = _by_cell(2.0 * robot.turn_inertia * curvature, m), _by_cell(rate, m)
    # the rate may jump between two samples, where the curvature is between theirs
    turn = np.stack(
        [
            edge(bends, axis=1) * other(rates, axis=1)
            for edge in (np.min, np.max)
            for other in (np.min, np.max)
        ]
    )
    return Drive(
        mass.min(axis=1), mass.max(axis=1), turn.min(axis=0), turn.max(axis=0),
        force=limits.torque * 2.0 * act.torque_limit / r,
        rolling=act.rolling_resistance * robot.weight,
        power=np.inf if act.power_limit is None else limits.torque * act.power_limit,
    )  # fmt: skip


def _by_cell(samples: Array, m: int) -> Array:
    """Samples of every cell, both ends included, shape (n, m + 1)."""
    return np.column_stack([samples[:-1].reshape(-1, m), samples[m::m]])


def bound_cells(cap: Array, m: int) -> tuple[Array, Array]:
    """Largest E at the nodes and in the middle of the cells: of lines below ``cap`` on every cell.

    Args:
        cap: The limit at m n + 1 samples.
        m: Samples of a cell.
    """
    dip = np.pad(np.maximum(np.diff(cap, 2), 0.0) / 8.0, 1, mode="edge")  # of a parabola, between
    dip = np.minimum(np.maximum(dip[:-1], dip[1:]), 1e-3 * np.minimum(cap[:-1], cap[1:]))
    below = (np.minimum(cap[:-1], cap[1:]) - dip).reshape(-1, m)
    left, right = cap[:-1:m], cap[m::m]
    f = np.arange(m + 1) / m
    line = left[:, None] + (right - left)[:, None] * f
    gap = np.maximum(0.0, (np.maximum(line[:, :-1], line[:, 1:]) - below).max(axis=1))
    least = below.min(axis=1)
    sloped = np.minimum(left, right) - gap >= 0.95 * least  # a jump is kept by a level line instead
    left = np.where(sloped, left - gap, least)
    right = np.where(sloped, right - gap, least)
    return np.minimum(np.append(left, np.inf), np.insert(right, 0, np.inf)), 0.5 * (left + right)


def bound_coefficients(nodes: Array, middle: Array, around: bool) -> Array:
    """Largest coefficients, shape (n + 2,), of which each two neighbours keep the bound of their node."""
    most = np.concatenate([[np.inf], middle, [np.inf]])
    if around:
        nodes = nodes.copy()
        nodes[0] = nodes[-1] = min(nodes[0], nodes[-1])
        most[0], most[-1] = most[-2], most[1]
    low = np.minimum(np.minimum(most[:-1], most[1:]), nodes)
    high = 2.0 * nodes - low
    first = np.where(most[:-1] <= most[1:], low, high)  # of the two neighbours of a node
    second = np.where(most[:-1] <= most[1:], high, low)
    most[:-1] = np.minimum(most[:-1], first)
    most[1:] = np.minimum(most[1:], second)
    if around:
        most[0] = most[-2] = min(most[0], most[-2])
        most[1] = most[-1] = min(most[1], most[-1])
    return most
