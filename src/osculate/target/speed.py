"""The fastest speed over arc length under all limits of robot and task, and which limit binds where.

With E(s) = v² / 2 the acceleration along the path is E' = dE/ds, and the limits are:

    speed, steering rate, lateral acceleration, tipping:   E ≤ E_max(s)
    acceleration:                                          −a_brake ≤ E' ≤ a_drive
    motor torque:   |(M + I κ²) E' + 2 I κ κ' E + F_roll| ≤ F_max        (linear in E and E')
    motor power:    the same force times v ≤ P_max
    jerk:           |v E''| ≤ j_max

The fastest profile minimises ∫ ds / v. Power and jerk are taken at the last iterate, the objective is
linearised there, and the linear programmes that follow are solved by HiGHS: a few suffice. Nothing is
faster than the profile without jerk and motors, which two passes give; on long curves where jerk and
motors seldom bind it is the bound that the solver starts from.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve, CurvePoint
from osculate.errors import InvalidInput, NoSolution
from osculate.kernel import Grid, Tables
from osculate.spec import Spec, quantity
from osculate.vehicle.tricycle import Tricycle

Array = NDArray[np.float64]

ITERATIONS = 5
NODES = 1200  # of the programme; more on long curves is seldom worth its time
FINEST = 0.01  # m, no step is shorter
COARSEST = 0.15  # m, no step is longer
MOST_NODES = 1_000_000
LONG = 5000  # nodes from which on a programme starts from the fastest profile of two passes,
SELDOM = 0.01  # if jerk and motors would change it at no larger part of the nodes


class Limits(Spec):
    """What the task allows, on top of what the robot can do."""

    speed: float = quantity("m/s", "largest speed", default=1.0, gt=0)
    lateral_acceleration: float = quantity("m/s²", "largest v² κ", default=2.0, gt=0)
    acceleration: float = quantity("m/s²", "largest speed-up", default=0.8, gt=0)
    deceleration: float = quantity("m/s²", "largest slow-down", default=0.8, gt=0)
    jerk: float = quantity("m/s³", "largest rate of the acceleration", default=10.0, gt=0)
    steering: float = quantity(
        "1", "part of the steering rate limit that the path may use", default=0.6, gt=0, le=1
    )
    torque: float = quantity(
        "1", "part of the motors' torque that the path may use", default=0.8, gt=0, le=1
    )
    tipping: float = quantity(
        "1", "part of the tipping acceleration that may be used", default=0.7, gt=0, le=1
    )
    creep: float = quantity("m/s", "slowest speed on the way and at the ends", default=0.05, gt=0)
    start_speed: float | None = quantity(
        "m/s", "speed at the start; by default creeping, on closed curves free", default=None, ge=0
    )
    end_speed: float | None = quantity(
        "m/s", "speed with which the end is passed; by default the robot comes to rest there, on closed "
        "curves it is free", default=None, ge=0,
    )  # fmt: skip


def rests_at_end(curve: Curve, limits: Limits) -> bool:
    """Whether the robot comes to rest at the end: of an open curve that it is not to pass with a speed."""
    return not (curve.closed or limits.end_speed)


def rest_deceleration(robot: Tricycle, limits: Limits) -> float:
    """Deceleration (m/s²) with which a robot comes to rest at the end of a path.

    Rolling resistance is not counted on: what it gives is left for a load that nobody knows.
    """
    return min(limits.deceleration, limits.torque * robot.motor_deceleration)


class Ceiling(NamedTuple):
    """One more limit of the speed over arc length."""

    name: str
    arc_length: tuple[float, ...]  # m, increasing
    speed: tuple[float, ...]  # m/s, there

    def at(self, s: Array) -> Array:
        """The limit (m/s) at arc lengths ``s`` (m)."""
        return np.interp(s, self.arc_length, self.speed)


@dataclass(frozen=True)
class SpeedPlan:
    """A speed over arc length."""

    arc_length: Array  # m, shape (n,), uniform
    energy: Array  # m²/s², v²/2, shape (n,)
    binding: list[str]  # which limit holds the speed down there, shape (n,)

    @property
    def speed(self) -> Array:
        """Speed (m/s), shape (n,)."""
        return np.sqrt(2.0 * self.energy)

    @property
    def acceleration(self) -> Array:
        """Acceleration along the path (m/s²), shape (n,)."""
        slopes: Array = np.gradient(self.energy, self.arc_length)
        return slopes

    @property
    def duration(self) -> float:
        """Time for the whole curve (s)."""
        middle = np.sqrt(self.energy[1:]) + np.sqrt(self.energy[:-1])
        return float((2.0 * np.diff(self.arc_length) / (np.sqrt(2.0) * middle)).sum())

    def shares(self) -> dict[str, float]:
        """Which part of the length each limit binds on, the largest first."""
        names, counts = np.unique(np.array(self.binding), return_counts=True)
        order = np.argsort(-counts)
        return {str(names[n]): float(counts[n] / len(self.binding)) for n in order}

    def table(self, tables: Tables) -> Grid:
        """Append the columns (E, E') for kernels."""
        rows = np.stack([self.energy, self.acceleration], axis=1)
        return tables.add(rows, 0.0, float(self.arc_length[1] - self.arc_length[0]))


class _Problem(NamedTuple):
    s: Array
    point: CurvePoint
    around: bool  # whether it is a lap that ends as fast as it starts
    caps: dict[str, Array]  # limit to the largest E
    low: float  # smallest E
    ends: tuple[float | None, float | None]  # largest E at both ends; None where it is free

    @property
    def step(self) -> float:
        """Distance of the nodes (m)."""
        return float(self.s[1])


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
        NoSolution: The robot cannot follow the curve at any speed (says the limit and the place).
    """
    limits = limits or Limits()
    if limits.creep > limits.speed:
        raise InvalidInput(
            "limits.creep", limits.creep, f"must be at most speed = {limits.speed:g} m/s"
        )
    problem = _problem(curve, robot, limits)
    if ceiling is not None:
        problem.caps[ceiling.name] = ceiling.at(problem.s) ** 2 / 2.0
    energy = _first_guess(problem, limits)
    most = _known_bound(problem, robot, limits, energy)
    for _ in range(ITERATIONS):
        before = energy
        energy = _solve(problem, robot, limits, energy, most)
        if np.abs(energy - before).max() <= 1e-4 * energy.max():
            break
    return SpeedPlan(problem.s, energy, _binding(problem, robot, limits, energy))


def _problem(curve: Curve, robot: Tricycle, limits: Limits) -> _Problem:
    wanted = np.clip(curve.length / FINEST, 20, max(NODES, curve.length / COARSEST))
    if not wanted <= MOST_NODES:
        raise InvalidInput(
            "curve.length", curve.length, f"a speed plan would need {wanted / 1e6:.3g} M nodes, at most "
            f"{MOST_NODES / 1e6:g} M: must be at most {MOST_NODES * COARSEST:g} m; drive it in parts, or "
            "fewer laps",
        )  # fmt: skip
    cells = int(wanted)
    s = np.linspace(0.0, curve.length, cells + 1)
    point = curve.at(s)
    act, a = robot.actuators, robot.wheelbase
    bend = np.abs(point.curvature)
    _require_steerable(curve, robot, s, point.curvature)
    turning = a * np.abs(point.curvature_rate) / (1.0 + (a * bend) ** 2)
    tiny = 1e-12
    caps = {
        "speed": np.full(len(s), limits.speed**2 / 2.0),
        "lateral acceleration": limits.lateral_acceleration / 2.0 / np.maximum(bend, tiny),
        "tipping": limits.tipping * robot.tipping_acceleration / 2.0 / np.maximum(bend, tiny),
        "steering rate": (
            (limits.steering * act.steering_rate_limit / np.maximum(turning, tiny)) ** 2 / 2.0
        ),
    }
    own = curve.speed_limit(s)
    if own is not None:
        caps["the curve's own speeds"] = own**2 / 2.0
    low = limits.creep**2 / 2.0
    braking = rest_deceleration(robot, limits)
    if rests_at_end(curve, limits) and braking < limits.deceleration:
        caps["coming to rest"] = low + braking * (curve.length - s)

    def energy(given: float | None) -> float | None:
        if given is None:
            return None if curve.closed else low
        return max(given, limits.creep) ** 2 / 2.0

    ends = energy(limits.start_speed), energy(limits.end_speed)
    return _Problem(s, point, curve.closed and ends == (None, None), caps, low, ends)


def _require_steerable(curve: Curve, robot: Tricycle, s: Array, curvature: Array) -> None:
    """Refuse a curve that bends more than the robot can, at a node or at a tight place between."""
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


def _cap(problem: _Problem) -> Array:
    cap: Array = np.maximum(np.min(list(problem.caps.values()), axis=0), problem.low)
    for place, energy in zip((0, -1), problem.ends, strict=True):
        if energy is not None:
            cap[place] = min(cap[place], energy)
    return cap


def _first_guess(problem: _Problem, limits: Limits) -> Array:
    """Forward and backward passes under the caps and the accelerations alone."""
    energy = _cap(problem)
    step = problem.step
    for _ in range(2 if problem.around else 1):  # the second pass closes the lap
        if problem.around:
            energy[0] = energy[-1] = min(energy[0], energy[-1])
        for n in range(1, len(energy)):
            energy[n] = min(energy[n], energy[n - 1] + limits.acceleration * step)
        for n in range(len(energy) - 2, -1, -1):
            energy[n] = min(energy[n], energy[n + 1] + limits.deceleration * step)
    return energy


def _drive_rows(
    problem: _Problem, robot: Tricycle, limits: Limits, energy: Array
) -> tuple[Array, Array, Array, Array]:
    """Drive force g E' + f E + rolling on every cell, and its bounds: (g, f, low, high), N."""
    act, r = robot.actuators, robot.wheel_radius
    k = 0.5 * (problem.point.curvature[1:] + problem.point.curvature[:-1])
    dk = np.diff(problem.point.curvature) / problem.step
    mass = robot.total_mass + 2.0 * robot.wheel_inertia / r**2 + robot.turn_inertia * k**2
    centrifugal = 2.0 * robot.turn_inertia * k * dk
    rolling = act.rolling_resistance * robot.weight
    most = np.full(len(k), limits.torque * 2.0 * act.torque_limit / r)
    high = most
    if act.power_limit is not None:
        speed = np.sqrt(energy[1:] + energy[:-1])
        high = np.minimum(most, limits.torque * act.power_limit / np.maximum(speed, limits.creep))
    return mass, centrifugal, -most - rolling, high - rolling


def _known_bound(problem: _Problem, robot: Tricycle, limits: Limits, first: Array) -> Array | None:
    """The first guess as an upper bound, where starting from it saves most of the work."""
    if len(first) <= LONG:
        return None
    use = _use(problem, robot, limits, first)
    bound = (use["jerk"] > 1.0 + 1e-9) | (use["motor"] > 1.0 + 1e-9)
    return first.copy() if bound.mean() < SELDOM else None


def _inequalities(
    problem: _Problem, robot: Tricycle, limits: Limits, energy: Array
) -> tuple[Any, Array]:
    """Rows and bounds of ``rows @ E ≤ bounds`` around the last iterate."""
    from scipy.sparse import diags_array, vstack

    n, step = len(energy), problem.step
    slope: Any = diags_array([-1.0 / step, 1.0 / step], offsets=[0, 1], shape=(n - 1, n))
    mean: Any = diags_array([0.5, 0.5], offsets=[0, 1], shape=(n - 1, n))
    mass, centrifugal, low, high = _drive_rows(problem, robot, limits, energy)
    force: Any = _diagonal(mass) @ slope + _diagonal(centrifugal) @ mean
    bend: Any = diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(n - 2, n)) / step**2
    jerk = limits.jerk / np.sqrt(2.0 * np.maximum(energy[1:-1], problem.low))
    scale = _diagonal(1.0 / mass)
    rows: list[Any] = [slope, -slope, scale @ force, -(scale @ force), bend, -bend]
    bounds = [
        np.full(n - 1, limits.acceleration),
        np.full(n - 1, limits.deceleration),
        high / mass,
        -low / mass,
        jerk,
        jerk,
    ]
    if problem.around:
        around: Any = diags_array([1.0], offsets=[0], shape=(1, n)) - diags_array(
            [1.0], offsets=[n - 1], shape=(1, n)
        )
        rows += [around, -around]
        bounds += [np.zeros(1), np.zeros(1)]
    return vstack(rows, format="csr"), np.concatenate(bounds)


def _solve(
    problem: _Problem, robot: Tricycle, limits: Limits, energy: Array, most: Array | None
) -> Array:
    """One linear programme around the last iterate, below an upper bound if one is known."""
    from scipy.optimize import linprog

    rows, bounds = _inequalities(problem, robot, limits, energy)
    gain = (2.0 * np.maximum(energy, problem.low)) ** -1.5
    cap = _cap(problem) if most is None else most
    programme: Any = linprog  # its stubs know no sparse matrices
    solved = programme(
        -gain / gain.max(),
        A_ub=rows,
        b_ub=bounds,
        bounds=np.stack([np.minimum(problem.low, cap), cap], axis=1),
        method="highs",
    )
    if solved.x is None:
        raise NoSolution(
            "no speed profile keeps all limits: the motors cannot hold the slowest speed "
            f"({limits.creep:g} m/s); raise the torque limit or lower the rolling resistance"
        )
    return np.asarray(solved.x, dtype=float)


def _diagonal(values: Array) -> Any:
    from scipy.sparse import diags_array

    return diags_array(values)


def _use(problem: _Problem, robot: Tricycle, limits: Limits, energy: Array) -> dict[str, Array]:
    """How far every limit is used at every node, 1 where it binds."""
    step = problem.step
    slope = np.diff(energy) / step
    mass, centrifugal, low, high = _drive_rows(problem, robot, limits, energy)
    force = mass * slope + centrifugal * 0.5 * (energy[1:] + energy[:-1])
    cells = {
        "acceleration": slope / limits.acceleration,
        "deceleration": -slope / limits.deceleration,
        "motor": np.maximum(force / high, force / low),
    }
    use = {name: energy / cap for name, cap in problem.caps.items()}
    use |= {
        name: np.maximum(np.append(values, 0.0), np.insert(values, 0, 0.0))
        for name, values in cells.items()
    }
    bend = np.abs(np.diff(energy, 2)) / step**2 * np.sqrt(2.0 * energy[1:-1])
    use["jerk"] = np.pad(bend / limits.jerk, 1)
    return use


def _binding(problem: _Problem, robot: Tricycle, limits: Limits, energy: Array) -> list[str]:
    """The limit with the least room at every node."""
    use = _use(problem, robot, limits, energy)
    names = np.array(list(use))
    chosen = names[np.array(list(use.values())).argmax(axis=0)]
    return np.where(energy <= 1.001 * problem.low, "creep", chosen).tolist()
