"""Contacts: which obstacle a robot touches first, and how deep it goes into it."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.scene.obstacle import Scene, bodies_at

SPACING = 0.01  # s, between the samples at which the depth is measured

Array = NDArray[np.float64]


class Contact(NamedTuple):
    """A robot touches an obstacle."""

    obstacle: int  # its number in the scene, from 1
    kind: str  # of obstacle
    sample: int  # at which they touch first
    #: m, the deepest: how far it would have to be moved, without turning, to be free
    penetration: float


def first_contact(
    scene: Scene, start: tuple[float, float], corners: tuple[tuple[float, float], ...],
    clearance: Array, time: Array, x: Array, y: Array, heading: Array,
) -> Contact | None:  # fmt: skip
    """The first obstacle that is touched, and the deepest that the robot goes into it; None if none is.

    Args:
        scene: The obstacles.
        start: Where the path begins (m).
        corners: The robot's footprint in its own frame (m); it is convex.
        clearance: See `Scene.clearance` (m), shape (n,).
        time: Of the samples (s), shape (n,).
        x: Positions of O (m), shape (n,); likewise ``y``.
        y: See ``x``.
        heading: Headings (rad), shape (n,).
    """
    touching = np.flatnonzero(clearance <= 0.0)
    if not touching.size:
        return None
    import shapely

    bodies = bodies_at(corners, x[touching], y[touching], heading[touching])
    shapes = [shapely.Polygon(obstacle.outline(start)) for obstacle in scene.obstacles]
    number = int(np.argmin(shapely.distance(shapes, bodies[0])))
    touches = shapely.intersects(shapes[number], bodies)
    touches[0] = True  # where rounding tells an obstacle from the union of all
    with_it = touching[touches]
    # a fixed grid of times: the same samples whoever recorded them; and how deep it is in the end
    cells = np.floor(time[with_it] / SPACING)
    kept = with_it[np.concatenate([[True], np.diff(cells) > 0.0])]
    kept = np.union1d(kept, with_it[-1:])
    outline = scene.obstacles[number].outline(start)
    depth = max(penetration(outline, corners, x[n], y[n], heading[n]) for n in kept)
    return Contact(number + 1, scene.obstacles[number].kind, int(touching[0]), depth)


def penetration(
    outline: Array, corners: tuple[tuple[float, float], ...], x: float, y: float, heading: float
) -> float:
    """How far (m) a robot would have to be moved, without turning, to be out of an obstacle; 0 if it is.

    The robot touches the obstacle where O is in the obstacle's Minkowski difference with the footprint:
    the union of the hulls of every edge minus every corner, and of the obstacle minus one of them.

    Args:
        outline: Corners of the obstacle (m), shape (n, 2).
        corners: The footprint in the robot's frame (m); it is convex.
        x: Position of O (m).
        y: Likewise.
        heading: Heading (rad).
    """
    import shapely

    cosine, sine = np.cos(heading), np.sin(heading)
    body = np.array(corners) @ np.array([[cosine, sine], [-sine, cosine]])
    edges = np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)  # (n, 2, 2)
    swept = edges[:, :, None, :] - body[None, None, :, :]
    pieces: Any = shapely.convex_hull(shapely.multipoints(swept.reshape(len(edges), -1, 2)))
    forbidden = shapely.union_all([*pieces, shapely.Polygon(outline - body[0])])
    place = shapely.Point(x, y)
    if not shapely.intersects(forbidden, place):
        return 0.0
    return float(shapely.distance(forbidden.boundary, place))
