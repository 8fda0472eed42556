"""GeoJSON (RFC 7946): one line, a ring, or points in order; in degrees, or in metres as robots write it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from osculate.curve.files.found import Array, Found, Wishes, refuse
from osculate.curve.files.globe import project
from osculate.curve.files.track import of_points

TYPES = {
    "FeatureCollection", "Feature", "GeometryCollection", "Point", "MultiPoint", "LineString",
    "MultiLineString", "Polygon", "MultiPolygon",
}  # fmt: skip
INSIDE = ("features", "geometry", "geometries", "coordinates")
FAR = 2.0  # extents from the origin: degrees of a place lie further away, metres around it
WIDE = 5.0  # degrees, the widest path that may be one on the globe


def is_geojson(document: Any) -> bool:
    """Whether a document is GeoJSON."""
    return (
        isinstance(document, Mapping)
        and str(document.get("type")) in TYPES
        and any(key in document for key in INSIDE)
    )


def read_geojson(document: Mapping[str, Any], label: str, wishes: Wishes) -> Found:
    """The line in a GeoJSON document.

    Raises:
        InvalidInput: No line, several (says how many), or a coordinate that is no number.
    """
    geometries = list(_geometries(document))
    lines: list[Any] = []
    rings: list[Any] = []
    singles: list[Any] = []
    for geometry in geometries:
        kind, inside = geometry.get("type"), geometry.get("coordinates")
        if not isinstance(inside, list):
            raise refuse(label, f"the GeoJSON {kind} has no list of coordinates")
        if kind == "LineString":
            lines.append(inside)
        elif kind == "MultiLineString":
            lines += inside
        elif kind in ("Polygon", "MultiPolygon"):
            rings += [
                polygon[:1] for polygon in (inside if kind[0] == "M" else [inside]) if polygon
            ]
        elif kind in ("Point", "MultiPoint"):
            singles += inside if kind == "MultiPoint" else [inside]
    chosen, kind, warnings = _one(lines, [r[0] for r in rings], singles, label, wishes)
    points = of_points(chosen, label, "coordinate")
    rows: tuple[tuple[str, str], ...] = (("geometry", f"{kind} with {len(points)} coordinates"),)
    ring = (True, "it is a polygon") if kind == "Polygon" else None
    written = "GeoJSON"
    if _in_degrees(points, document):
        flat, origin = project(points[:, 0], points[:, 1], lambda n: f"coordinate {n}", label)
        rows = (*rows, ("origin", origin))
        return Found(written, flat, None, rows, "degrees, projected to m", ring, warnings=warnings)
    said = "GeoJSON is in degrees by its norm; these are taken as metres"
    if _crs(document):
        said = f"the coordinates are taken as metres of {_crs(document)}"
    return Found(written, points, None, rows, "m", ring, warnings=(*warnings, said))


def _geometries(node: Any) -> Iterator[Mapping[str, Any]]:
    """All geometries, in the order of the file."""
    open_nodes = [node]
    while open_nodes:
        node = open_nodes.pop()
        if not isinstance(node, Mapping):
            continue
        if str(node.get("type")) in TYPES and "coordinates" in node:
            yield node
        for key in ("geometry", "features", "geometries"):
            inner = node.get(key)
            open_nodes += reversed(inner) if isinstance(inner, list) else [inner]


def _one(
    lines: Sequence[Any], rings: Sequence[Any], singles: Sequence[Any], label: str, wishes: Wishes
) -> tuple[Sequence[Any], str, tuple[str, ...]]:
    every = [(line, "LineString") for line in lines] + [(ring, "Polygon") for ring in rings]
    if wishes.take:
        if not wishes.take.isdigit() or not 1 <= int(wishes.take) <= len(every):
            raise refuse(label, f"has {len(every)} lines; --take takes a number up to that")
        return (*every[int(wishes.take) - 1], ())
    if len(lines) == 1 or (len(every) == 1 and not lines):
        rest = len(every) - 1 + len(singles)
        said = (f"{rest} other geometries are not read",) if rest else ()
        return (*every[0], said)
    if every:
        raise refuse(label, f"holds {len(every)} lines (GeoJSON); say --take NUMBER, from 1")
    if len(singles) > 1:
        return singles, "Point", (f"the {len(singles)} points are joined in the order of the file",)
    raise refuse(label, "holds no line (GeoJSON); a path is a LineString")


def _crs(document: Mapping[str, Any]) -> str:
    """The name of the coordinate system that old GeoJSON may give."""
    crs = document.get("crs")
    properties = crs.get("properties") if isinstance(crs, Mapping) else None
    return str(properties.get("name", "")) if isinstance(properties, Mapping) else ""


def _in_degrees(points: Array, document: Mapping[str, Any]) -> bool:
    name = _crs(document)
    if name:
        return "4326" in name or "CRS84" in name
    if (np.abs(points) > [180.0, 90.0]).any() or len(points) == 0:
        return False
    extent = float(np.ptp(points, axis=0).max())
    middle = float(np.abs(points.mean(axis=0)).max())
    return extent <= WIDE and middle > max(1.0, FAR * extent)
