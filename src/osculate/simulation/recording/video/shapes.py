"""Meshes of a film: closed bodies whose triangles are counter-clockwise seen from outside."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Mesh(NamedTuple):
    """Triangles in space."""

    vertices: Array  # m, shape (n, 3)
    faces: NDArray[np.int64]  # three vertices each, shape (m, 3)


def ribbon(points: Array, width: float, height: float) -> Mesh:
    """A band (m) on the floor along points, shape (n, 2): four vertices for each of them."""
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-12)[:, None]  # a cusp has none
    left = 0.5 * width * np.stack([-along[:, 1], along[:, 0]], axis=1)
    count = len(points)
    vertices = np.zeros((count, 4, 3))
    # narrower below, so that from above its sides are never seen
    for n, side in enumerate((left, -left, -0.5 * left, 0.5 * left)):
        vertices[:, n, :2] = points + side
    vertices[:, :2, 2] = height
    turn = [(a, (a + 1) % 4) for a in range(4)]
    once = np.array([t for a, b in turn for t in ((a, b, b + 4), (a, b + 4, a + 4))])
    sides = (once + 4 * np.arange(count - 1)[:, None, None]).reshape(-1, 3)
    end = 4 * count - 4
    caps = [[0, 2, 1], [0, 3, 2], [end, end + 1, end + 2], [end, end + 2, end + 3]]
    return Mesh(vertices.reshape(-1, 3), np.concatenate([sides, caps]))


def prism(outline: Any, low: float, high: float) -> Mesh:
    """A Shapely polygon, holes and all, extruded from one height (m) to another."""
    import shapely

    polygon = shapely.remove_repeated_points(shapely.geometry.polygon.orient(outline), 1e-6)
    flat = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    top = np.concatenate([_corners(shapely.geometry.polygon.orient(part)) for part in flat])
    triangles = [_at(top, high).reshape(-1, 3, 3), _at(top, low).reshape(-1, 3, 3)[:, ::-1]]
    for ring in (polygon.exterior, *polygon.interiors):
        a = shapely.get_coordinates(ring)
        b, a = a[1:], a[:-1]
        a0, b0, a1, b1 = _at(a, low), _at(b, low), _at(a, high), _at(b, high)
        triangles += [np.stack([a0, b0, b1], axis=1), np.stack([a0, b1, a1], axis=1)]
    vertices = np.concatenate(triangles).reshape(-1, 3)
    return Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3))


def _corners(triangle: Any) -> Array:
    corners: Array = np.array(triangle.exterior.coords)[:3]
    return corners


def _at(points: Array, height: float) -> Array:
    return np.column_stack([points, np.full(len(points), height)])
