"""XML: GPX tracks and routes, KML lines, OpenDRIVE roads. No document types, no entities."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from osculate.curve.files.found import Found, Wishes, refuse
from osculate.curve.files.globe import project
from osculate.curve.files.numbers import decimal
from osculate.curve.files.opendrive import read_opendrive

_FORBIDDEN = re.compile(r"<!(DOCTYPE|ENTITY)", re.IGNORECASE)
_HTML = re.compile(r"\s*<(!DOCTYPE\s+)?html\b", re.IGNORECASE)


class Line(NamedTuple):
    """A track, route or line."""

    name: str
    points: list[tuple[Any, Any]]  # longitude and latitude as they are written
    parts: int = 1  # that follow each other


def read_markup(text: str, label: str, wishes: Wishes) -> Found:
    """The path in an XML file.

    Raises:
        InvalidInput: Not XML, with a document type or entities, of an unknown kind, or without a path.
    """
    if _HTML.match(text):
        raise refuse(label, "is an HTML page, no curve (a download that failed?)")
    forbidden = _FORBIDDEN.search(text)
    if forbidden:
        line = text[: forbidden.start()].count("\n") + 1
        raise refuse(
            label, "is XML with a document type or entities, which are not read", f"line {line}"
        )
    try:
        root = ET.fromstring(text)
    except (ET.ParseError, ValueError) as error:
        raise refuse(label, f"is not valid XML: {error}") from None
    kind = tag(root)
    if kind == "OpenDRIVE":
        return read_opendrive(root, label, wishes)
    if kind == "gpx":
        return _globe("GPX", list(_gpx(root)), label, wishes)
    if kind == "kml":
        return _globe("KML", list(_kml(root)), label, wishes)
    raise refuse(label, f"is XML with the root <{kind}>; GPX, KML and OpenDRIVE are read")


def tag(element: ET.Element) -> str:
    """The name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]


def _all(element: ET.Element, *names: str) -> Iterator[ET.Element]:
    return (inner for inner in element.iter() if tag(inner) in names)


def _name(element: ET.Element, other: str) -> str:
    own = next((inner.text for inner in element if tag(inner) == "name" and inner.text), "")
    return own.strip() or other


def _gpx(root: ET.Element) -> Iterator[Line]:
    """Tracks and routes; if there are none, the waypoints."""
    number, points = 0, []
    for line in _all(root, "trk", "rte"):
        number += 1
        points = [(p.get("lon"), p.get("lat")) for p in _all(line, "trkpt", "rtept")]
        if points:
            parts = sum(1 for _ in _all(line, "trkseg"))
            yield Line(_name(line, str(number)), points, max(parts, 1))
    if not number:
        points = [(p.get("lon"), p.get("lat")) for p in _all(root, "wpt")]
        if points:
            yield Line("waypoints", points)


def _kml(root: ET.Element) -> Iterator[Line]:
    number = 0
    for place in _all(root, "Placemark"):
        for line in _all(place, "LineString", "LinearRing"):
            text = " ".join(inner.text or "" for inner in _all(line, "coordinates"))
            number += 1
            cells = [entry.split(",") for entry in re.sub(r"\s*,\s*", ",", text).split()]
            pairs = [(c[0], c[1] if len(c) > 1 else None) for c in cells]
            yield Line(_name(place, str(number)), pairs)


def _globe(kind: str, lines: list[Line], label: str, wishes: Wishes) -> Found:
    names = [line.name for line in lines]
    if not lines:
        raise refuse(label, f"holds no track, route or line ({kind})")
    chosen = [line for line in lines if line.name == wishes.take] if wishes.take else lines
    if len(chosen) != 1:
        raise refuse(label, f"holds the lines {', '.join(names[:8])} ({kind}); say --take NAME")
    name, written, parts = chosen[0]
    degrees = np.empty((len(written), 2))
    for n, pair in enumerate(written):
        for k, word in enumerate(("longitude", "latitude")):
            try:
                degrees[n, k] = decimal((pair[k] or "").strip())
            except ValueError:
                raise refuse(label, f"its {word} is {pair[k]!r}, no number", f"point {n}") from None
    if not len(degrees):
        raise refuse(label, f"the line {name} holds no points ({kind})")
    points, origin = project(degrees[:, 0], degrees[:, 1], lambda n: f"point {n}", label)
    rows = (("line", name), ("origin", origin))
    said = (f"{parts} segments are joined in the order of the file",) if parts > 1 else ()
    return Found(kind, points, None, rows, "degrees, projected to m", warnings=said)
