"""What cannot be planned, and why: motors too weak, speeds at the ends that cannot be reached in time."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.errors import NoSolution
from osculate.target.speed.grid import Problem
from osculate.target.speed.limits import Limits

Array = NDArray[np.float64]

ROUNDING = 1e-9


def needed_distance(first: Any, last: Any, acceleration: float, jerk: float) -> Array:
    """Distance (m) in which a speed changes, without acceleration at both ends.

    Args:
        first: Speeds at the beginning (m/s), any shape.
        last: Speeds at the end (m/s).
        acceleration: Largest size of the acceleration (m/s²).
        jerk: Largest size of its rate (m/s³); infinite for none.
    """
    change = np.abs(np.subtract(last, first))
    whole = change / acceleration + acceleration / jerk
    ramps = 2.0 * np.sqrt(change / jerk)  # the largest acceleration is not reached
    time = np.where(change >= acceleration**2 / jerk, whole, ramps)
    distance: Array = 0.5 * np.add(first, last) * np.where(change > 0.0, time, 0.0)
    return distance


class _Reach(NamedTuple):
    """What a given speed at an end needs, where that is most beyond what there is."""

    name: str  # of the end
    speed: float  # m/s, given
    other: float  # m/s, largest at the place
    place: float  # m, arc length
    hard: float  # m, needed with the largest deceleration or acceleration alone
    smooth: float  # m, needed within the jerk limit
    room: float  # m, between the end and the place
    length: float  # m, of the path

    def __str__(self) -> str:
        whole = self.room >= self.length * (1.0 - 1e-9)
        needs = f"it needs {self.hard:.3g} m"
        jerk = f"({self.smooth:.3g} m within the jerk limit)"
        if self.name == "start":
            aim = f"slow down to the {self.other:.3g} m/s allowed at s = {self.place:.4g} m"
            text = f"from {self.speed:.3g} m/s {needs} to {'stop' if whole else aim} {jerk}"
            limit, lower = "deceleration", "start slower"
        else:
            begin = f"from the {self.other:.3g} m/s allowed at s = {self.place:.4g} m"
            text = f"{begin} {needs} to reach {self.speed:.3g} m/s at the end {jerk}"
            limit, lower = "acceleration", "lower limits.end_speed"
        there = "" if whole else " for that"
        return (
            f"the {self.name} speed cannot be kept: {text}, the path has {self.room:.3g} m{there}; "
            f"{lower}, or raise limits.{limit} or limits.jerk"
        )


def require_strength(problem: Problem, limits: Limits) -> None:
    """Refuse motors that cannot overcome the rolling resistance.

    Raises:
        NoSolution: Says by how much.
    """
    drive = problem.drive
    if drive.rolling >= drive.force:
        raise NoSolution(
            f"no speed profile keeps all limits: the motors cannot hold the slowest speed "
            f"({limits.creep:g} m/s): rolling takes {drive.rolling:.4g} N, they may give "
            f"{drive.force:.4g} N; raise the torque limit or lower the rolling resistance"
        )


def require_ends(problem: Problem, limits: Limits) -> None:
    """Refuse given speeds at the ends that no deceleration and jerk allowed reaches in time.

    Raises:
        NoSolution: Says which distance they need.
    """
    middle = problem.s[:-1] + 0.5 * problem.step
    places = np.concatenate([problem.s[:1], middle, problem.s[-1:]])
    speeds = np.sqrt(2.0 * np.pad(problem.most[1:-1], 1, mode="edge"))
    for place, end in zip((0, -1), problem.ends, strict=True):
        if end is not None:
            speeds[place] = min(speeds[place], np.sqrt(2.0 * end))
    sizes = {"start": limits.deceleration, "end": limits.acceleration}
    for place, (name, size) in zip((0, -1), sizes.items(), strict=True):
        if not problem.given[place]:
            continue
        wanted = float(np.sqrt(2.0 * (problem.ends[place] or 0.0)))
        _require_allowed(problem, name, place, wanted)
        room = np.abs(places - places[place])
        smooth = np.where(speeds < wanted, needed_distance(speeds, wanted, size, limits.jerk), 0.0)
        worst = int((smooth - room).argmax())
        if smooth[worst] - room[worst] > ROUNDING:
            hard = float(needed_distance(speeds[worst], wanted, size, np.inf))
            numbers = (
                speeds[worst],
                places[worst],
                hard,
                smooth[worst],
                room[worst],
                np.ptp(places),
            )
            raise NoSolution(str(_Reach(name, wanted, *map(float, numbers))))


def _require_allowed(problem: Problem, name: str, place: int, wanted: float) -> None:
    """Refuse a given speed above what another limit allows at that end."""
    cap, limit = min((float(caps[place]), limit) for limit, caps in problem.caps.items())
    allowed = np.sqrt(2.0 * min(cap, float(problem.most[1:-1][place])))
    if wanted > allowed * (1.0 + ROUNDING):
        raise NoSolution(
            f"the {name} speed of {wanted:.4g} m/s cannot be kept: {limit} allows {allowed:.4g} m/s at the "
            f"{name} of the path; lower it, or raise that limit"
        )


def explain_infeasible(problem: Problem, limits: Limits) -> NoSolution:
    """Why the programme has no solution though deceleration and jerk alone would allow one."""
    ends = [
        f"{name} at {np.sqrt(2.0 * (end or 0.0)):.3g} m/s"
        for name, end, given in zip(("start", "end"), problem.ends, problem.given, strict=True)
        if given
    ]
    if ends:
        return NoSolution(
            f"no speed profile keeps all limits with the {' and the '.join(ends)} on "
            f"{np.ptp(problem.s):.4g} m: motors, jerk and the other limits together do not allow it; "
            f"lower these speeds, or raise limits.torque or limits.jerk = {limits.jerk:g} m/s³"
        )
    return NoSolution(
        "no speed profile keeps all limits: the motors cannot hold the slowest speed "
        f"({limits.creep:g} m/s) where the curvature changes; raise the torque limit"
    )
