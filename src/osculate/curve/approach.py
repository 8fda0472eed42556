"""A way onto a curve from a pose that no tracker should be asked to recover from.

The shortest path of arcs and lines (Dubins 1957) from the pose to places of the curve further on, rounded
by a quintic spline that leaves the pose straight ahead and meets the curve with its heading and
curvature. The shortest one that the robot can steer, as far and as fast as it has to, is taken; where there
is none, wider arcs are tried.
"""

import itertools
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.arclength import ArcLength, along
from osculate.curve.composite import Composite, Part
from osculate.curve.contract import Curve
from osculate.curve.sampled import Points, Sampled
from osculate.curve.spirals import Pose
from osculate.curve.spline import DEGREE
from osculate.errors import NoSolution
from osculate.spec import quantity

Array = NDArray[np.float64]

EASES = (
    0.55,
    0.4,
    0.28,
    0.2,
    0.14,
)  # parts of what the robot can bend, for arcs: the spline bends more
USABLE = 0.9  # part of the robot's curvature that the approach may use
PLACES = 24  # of the curve that are tried


class Leg(NamedTuple):
    """One piece of a Dubins path: a turn (1 left, −1 right) or straight (0), over a length."""

    side: int
    length: float  # m


class Approach(Sampled):
    """A quintic spline with given headings and curvatures at both ends."""

    kind: str = "approach"
    points: Points = quantity("m", "points (x, y)")
    ends: tuple[tuple[float, float], tuple[float, float]] = quantity(
        "rad, 1/m", "heading and curvature at both ends"
    )

    @cached_property
    def _arc(self) -> ArcLength:
        from scipy.interpolate import make_interp_spline

        points = np.array(self.points)
        u = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        conditions: Any = tuple(
            [
                (1, np.array([np.cos(heading), np.sin(heading)])),
                (2, curvature * np.array([-np.sin(heading), np.cos(heading)])),
            ]
            for heading, curvature in self.ends
        )
        return along(make_interp_spline(u, points, k=DEGREE, bc_type=conditions), 1024)


def plan_approach(
    curve: Curve,
    start: Pose,
    tightest: float,
    begin: float = 0.0,
    wheelbase: float = 1.0,
    turning: float = np.inf,
) -> tuple[Composite, float]:
    """A curve from ``start`` onto ``curve`` and along it to its end.

    Args:
        curve: Where to go.
        start: From where.
        tightest: Largest curvature (1/m) that the robot can steer.
        begin: Arc length (m) of the curve before which it is not joined.
        wheelbase: Of the robot (m).
        turning: Largest change of the steering angle along the way (rad/m): its rate over the least speed.

    Returns:
        The curve, and the length (m) of its approach.

    Raises:
        NoSolution: No approach reaches the curve before its end.
    """
    for ease in EASES:
        found = _shortest(
            curve, start, begin, 1.0 / (ease * tightest), (tightest, wheelbase, turning)
        )
        if found is not None:
            break
    else:
        raise NoSolution(
            f"no approach from ({start.x:.4g}, {start.y:.4g}) m, heading {start.heading:.4g} rad, "
            f"joins the curve within {max(curve.length - begin, 0.0):.4g} m and bends less than "
            f"{USABLE * tightest:.4g} 1/m, with less than {turning:.4g} rad/m of steering; start nearer to "
            "the curve or leave it more length"
        )
    best, joined = found
    rest = Part(curve=curve, start=joined, end=curve.length)
    return Composite(pieces=(best, rest), heading_jump=1e-4, curvature_jump=1e-2), best.length


def _shortest(
    curve: Curve, start: Pose, begin: float, radius: float, steering: tuple[float, float, float]
) -> tuple[Approach, float] | None:
    """The shortest way of arcs of one radius that can be steered, and where it joins the curve (m)."""
    reach = min(curve.length - 1e-3, begin + 12.0 * radius)
    best: Approach | None = None
    joined = begin
    places = np.linspace(begin, reach, PLACES + 1)[1:] if reach > begin else ()
    for place in places:
        way = _way(curve, start, float(place), radius)
        steerable = _is_steerable(way, *steering)
        if steerable and (best is None or way.length < best.length + 0.5 * (joined - place)):
            best, joined = way, float(place)
    return None if best is None else (best, joined)


def _is_steerable(way: Curve, tightest: float, wheelbase: float, turning: float) -> bool:
    point = way.at(np.linspace(0.0, way.length, 400))
    bends = np.abs(point.curvature)
    turns = wheelbase * np.abs(point.curvature_rate) / (1.0 + (wheelbase * bends) ** 2)
    return bool(bends.max() <= USABLE * tightest and turns.max() <= turning)


def _way(curve: Curve, start: Pose, place: float, radius: float) -> Approach:
    end = curve.at(place)
    goal = Pose(x=float(end.x), y=float(end.y), heading=float(end.heading))
    legs = dubins(start, goal, radius)
    points = _points(start, legs, radius)
    points[-1] = (goal.x, goal.y)
    return Approach(
        points=tuple(points),
        ends=((start.heading, 0.0), (goal.heading, float(end.curvature))),
    )


def _points(start: Pose, legs: list[Leg], radius: float) -> list[tuple[float, float]]:
    """Evenly spaced points of the path, a third of a radius apart or less."""
    total = sum(leg.length for leg in legs)
    count = max(6, int(np.ceil(3.0 * total / radius)))
    points = []
    for s in np.linspace(0.0, total, count + 1):
        pose, left = start, float(s)
        for leg in legs:
            step = min(leg.length, left)
            pose, left = _moved(pose, leg.side, step, radius), left - step
        points.append((pose.x, pose.y))
    return points


def _moved(pose: Pose, side: int, length: float, radius: float) -> Pose:
    turn = side * length / radius
    chord = length * np.sinc(turn / (2.0 * np.pi))
    direction = pose.heading + 0.5 * turn
    return Pose(
        x=pose.x + float(chord * np.cos(direction)),
        y=pose.y + float(chord * np.sin(direction)),
        heading=pose.heading + turn,
    )


def dubins(start: Pose, goal: Pose, radius: float) -> list[Leg]:
    """The shortest path of arcs of one radius and lines from pose to pose (Dubins 1957)."""
    candidates = [
        _straight(start, goal, radius, a, b) for a, b in itertools.product((1, -1), (1, -1))
    ]
    candidates += [
        _three_arcs(start, goal, radius, side, middle)
        for side, middle in itertools.product((1, -1), (1, -1))
    ]
    found = [legs for legs in candidates if legs is not None]
    return min(found, key=lambda legs: sum(leg.length for leg in legs))


def _centre(pose: Pose, side: int, radius: float) -> complex:
    return complex(pose.x, pose.y) + side * radius * 1j * np.exp(1j * pose.heading)


def _straight(start: Pose, goal: Pose, radius: float, first: int, last: int) -> list[Leg] | None:
    """Arc, line, arc."""
    span = _centre(goal, last, radius) - _centre(start, first, radius)
    distance = abs(span)
    across = 0.0 if first == last else 2.0 * radius
    if distance < across or (distance < 1e-9 and first != last):
        return None
    if distance < 1e-9:  # one circle serves both poses
        return [Leg(first, radius * _turn(first, goal.heading - start.heading))]
    direction = np.angle(span) + first * np.arcsin(across / distance)
    line = float(np.sqrt(max(distance**2 - across**2, 0.0)))
    return [
        Leg(first, radius * _turn(first, direction - start.heading)),
        Leg(0, line),
        Leg(last, radius * _turn(last, goal.heading - direction)),
    ]


def _three_arcs(start: Pose, goal: Pose, radius: float, side: int, which: int) -> list[Leg] | None:
    """Arc, arc to the other side, arc; the middle circle lies to one side of the line or the other."""
    a, b = _centre(start, side, radius), _centre(goal, side, radius)
    distance = abs(b - a)
    if distance > 4.0 * radius or distance < 1e-9:
        return None
    angle = np.angle(b - a) - which * np.arccos(distance / (4.0 * radius))
    middle = a + 2.0 * radius * np.exp(1j * angle)
    leave = float(angle) + side * np.pi / 2.0  # heading where the first arc ends
    arrive = float(np.angle(middle - b)) + side * np.pi / 2.0  # heading where the last one begins
    return [
        Leg(side, radius * _turn(side, leave - start.heading)),
        Leg(-side, radius * _turn(-side, arrive - leave)),
        Leg(side, radius * _turn(side, goal.heading - arrive)),
    ]


def _turn(side: int, angle: float) -> float:
    """The angle to turn to one side, in [0, 2π)."""
    turn = float(np.mod(side * angle, 2.0 * np.pi))
    return 0.0 if 2.0 * np.pi - turn < 1e-9 else turn
