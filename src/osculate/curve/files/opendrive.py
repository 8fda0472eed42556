"""The reference line of an OpenDRIVE road: its planView of lines, arcs, spirals and cubic pieces."""

from collections.abc import Callable
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from osculate.curve.contract import Curve
from osculate.curve.files.found import Array, Found, Wishes, refuse
from osculate.curve.files.numbers import decimal
from osculate.curve.files.pieces import Piece, joined
from osculate.curve.segments import Clothoid, Line
from osculate.curve.spirals import Pose

STEP = 0.25  # m, between the points that a cubic piece is taken at
MOST = 4000  # points of one cubic piece


def read_opendrive(root: Element, label: str, wishes: Wishes) -> Found:
    """The one road, or the one that the user names by its id.

    Raises:
        InvalidInput: No road or several, a value that is no number, or pieces that do not join.
    """
    roads = {str(road.get("id")): road for road in root.iter() if _tag(road) == "road"}
    chosen = roads.get(wishes.take) if wishes.take else next(iter(roads.values()), None)
    if chosen is None or (len(roads) > 1 and not wishes.take):
        listed = ", ".join(list(roads)[:12]) or "none"
        raise refuse(label, f"holds the roads {listed} (OpenDRIVE); say --take ID")
    geometries = [item for item in chosen.iter() if _tag(item) == "geometry"]
    pieces: list[Piece] = []
    cubic = False
    for n, geometry in enumerate(geometries):
        where = f"geometry {n}"
        made = _piece(geometry, label, where)
        cubic = cubic or callable(made)
        if isinstance(made, Curve):
            pieces.append(Piece(where, _scaled(made, wishes.scale)))
    if not geometries:
        raise refuse(label, f"the road {chosen.get('id')} has no planView")
    rows = (("road", f"{chosen.get('id')}, {len(geometries)} geometries"),)
    if cubic:
        said = f"the road has cubic pieces; the curve goes through points every {STEP} m"
        return Found(
            "OpenDRIVE planView", _sampled(geometries, label), None, rows, warnings=(said,)
        )
    points, curve = joined(pieces, label, wishes)
    return Found("OpenDRIVE planView", points, curve, rows)


def _tag(element: Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _value(element: Element, name: str, label: str, where: str) -> float:
    text = element.get(name)
    try:
        return decimal((text or "").strip())
    except ValueError:
        raise refuse(label, f"its {name} is {text!r}, no number", where) from None


def _piece(geometry: Element, label: str, where: str) -> Curve | Callable[[Array], tuple[Any, Any]]:
    """A line or a spiral, or for a cubic piece the function from its parameter to its own x and y."""
    x, y, heading, length = (_value(geometry, n, label, where) for n in ("x", "y", "hdg", "length"))
    if not length > 0.0:
        raise refuse(label, f"its length is {length:g}, must be positive", where)
    start = Pose(x=x, y=y, heading=heading)
    shape = next(iter(geometry), None)
    kind = _tag(shape) if shape is not None else "nothing"
    if shape is None or kind == "line":
        if kind != "line":
            raise refuse(label, "says no shape", where)
        return Line(start=start, distance=length)
    if kind in ("arc", "spiral"):
        names = ("curvature", "curvature") if kind == "arc" else ("curvStart", "curvEnd")
        a, b = (_value(shape, name, label, where) for name in names)
        return Clothoid(start=start, distance=length, start_curvature=a, end_curvature=b)
    if kind == "paramPoly3":
        u, v = (
            [_value(shape, f"{letter}{axis}", label, where) for letter in "abcd"] for axis in "UV"
        )
        last = 1.0 if shape.get("pRange") == "normalized" else length
        return lambda p: (np.polyval(u[::-1], p * last), np.polyval(v[::-1], p * last))
    if kind == "poly3":
        v = [_value(shape, letter, label, where) for letter in "abcd"]
        return lambda p: (p * length, np.polyval(v[::-1], p * length))
    raise refuse(
        label, f"has the shape {kind}; line, arc, spiral, paramPoly3 and poly3 are read", where
    )


def _scaled(curve: Curve, scale: float) -> Curve:
    if scale == 1.0:
        return curve
    if isinstance(curve, Line):
        start = curve.start
        return Line(start=_moved(start, scale), distance=scale * curve.distance)
    assert isinstance(curve, Clothoid)
    return Clothoid(
        start=_moved(curve.start, scale), distance=scale * curve.distance,
        start_curvature=curve.start_curvature / scale, end_curvature=curve.end_curvature / scale,
    )  # fmt: skip


def _moved(start: Pose, scale: float) -> Pose:
    return Pose(x=scale * start.x, y=scale * start.y, heading=start.heading)


def _sampled(geometries: list[Element], label: str) -> Array:
    """Points along all pieces, shape (n, 2)."""
    parts: list[Array] = []
    for n, geometry in enumerate(geometries):
        made = _piece(geometry, label, f"geometry {n}")
        length = float(geometry.get("length", "0"))
        p = np.linspace(0.0, 1.0, int(min(MOST, max(4, np.ceil(length / STEP)))) + 1)
        if isinstance(made, Curve):
            point = made.at(p * length)
            place = np.stack([point.x, point.y], axis=1)
        else:
            x, y, heading = (_value(geometry, k, label, f"geometry {n}") for k in ("x", "y", "hdg"))
            u, v = made(p)
            cosine, sine = np.cos(heading), np.sin(heading)
            place = np.stack([x + u * cosine - v * sine, y + u * sine + v * cosine], axis=1)
        if parts and np.hypot(*(place[0] - parts[-1][-1])) > 0.01:
            gap = np.hypot(*(place[0] - parts[-1][-1]))
            raise refuse(
                label, f"begins {gap:.4g} m beside the end of the one before", f"geometry {n}"
            )
        parts.append(place[bool(parts) :])
    return np.concatenate(parts)
