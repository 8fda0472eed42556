"""Notations of text that hold paths and are not read: each is told by how it begins, and named."""

import re

FOREIGN = {
    r"version https://git-lfs": "a Git LFS pointer, not the file itself; fetch it (git lfs pull)",
    r"\$[A-Z]{2,5}[0-9A-Z]*,.*\*[0-9A-Fa-f]{2}\s*$": "NMEA 0183; convert it to GPX",
    r"(?:SRID=\d+;)?(?:MULTI)?(?:POINT|LINESTRING|POLYGON)\s*[ZM]*\s*\(": (
        "well-known text (WKT); write one point a line, x,y, or GeoJSON"
    ),
    r"\[\[?[A-Za-z_][\w.-]*\]\]?\s*\n\s*[\w.-]+\s*=": "TOML or INI; write JSON, YAML or a table",
    r"\s*0\s*\nSECTION\b": "DXF; export the points, one a line: x,y",
    r"(?:%|O\d+|;.*)?\s*[GM]\d+(?:\.\d+)?\s+[GMXYZF]-?\d": "G-code; write one point a line: x,y",
    r"[Mm]\s*-?[\d.]+[ ,]-?[\d.]+\s*[LlCcQqHhVv]": "an SVG path; write one point a line: x,y",
    r"#VRML|ply\s*$|# \.PCD": "a model or a point cloud, no path",
}
_FOREIGN = [(re.compile(begin, re.MULTILINE), kind) for begin, kind in FOREIGN.items()]


def foreign(content: str) -> str:
    """What a text is, and what to do, if it is a notation that is not read; else nothing."""
    head = content[:2000].lstrip()
    return next((kind for begin, kind in _FOREIGN if begin.match(head)), "")
