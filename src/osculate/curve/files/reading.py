"""The front door: a file in, a curve and what was understood out."""

import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from osculate.curve.contract import Curve
from osculate.curve.files.checks import check_flat, check_places, check_reversal, doubts
from osculate.curve.files.delimited import read_delimited
from osculate.curve.files.documents import load_json, load_yaml
from osculate.curve.files.foreign import foreign
from osculate.curve.files.found import Array, Choice, Found, Wishes, refuse
from osculate.curve.files.geojson import is_geojson, read_geojson
from osculate.curve.files.loop import closure
from osculate.curve.files.markup import read_markup
from osculate.curve.files.mcap import read_mcap
from osculate.curve.files.messages import read_messages
from osculate.curve.files.source import MCAP, check_regular, read_text, starts_with
from osculate.curve.files.vda import find_vda, read_vda
from osculate.curve.spline import Spline
from osculate.errors import InvalidInput

_YAML_LINE = re.compile(r"---|\s*-( .*)?|\s*(- )*[\w\"']+:( [^:]*| *| .*[\"'{\[].*)")
_ONE_PATH = ("table", "VDA 5050")  # formats in which there is nothing to take,
_COLUMNS = ("table", "JSON", "YAML")  # and in which there are columns
_SHARES = (0.8, 0.9)  # of the progress: read, points checked


@dataclass(frozen=True)
class Reading:
    """What was understood of a file."""

    path: str
    format: str
    curve: Curve
    found: Found
    points: Array | None  # m, shape (n, 2): those the curve goes through, if there are any
    speeds: Array | None  # m/s, shape (n,): the file's own, at the points
    closed: bool
    why: str  # it is closed or open
    warnings: tuple[str, ...]

    def rows(self) -> list[tuple[str, str]]:
        """Labels and values for printing."""
        rows = [("format", self.format), *self.found.rows]
        if self.points is not None:
            rows.append(("points", str(len(self.points))))
        rows += [
            ("units", self.found.units),
            ("ends", f"{'closed' if self.closed else 'open'}: {self.why}"),
        ]
        return rows


def read_file(
    path: str | Path,
    scale: float = 1.0,
    loop: bool | None = None,
    tolerance: float = 0.0,
    columns: Sequence[int | str] | None = None,
    take: str = "",
    on_progress: Callable[[float], None] | None = None,
) -> Reading:
    """Read a curve from a file and say what was understood; see `CurveFile`.

    Args:
        path: The file.
        scale: Factor on all coordinates.
        loop: Whether it is closed; None: its ends decide.
        tolerance: Largest distance from the (scaled) points (m); 0 goes through them.
        columns: Columns of x and y, as numbers from 1 or as names.
        take: Which path, topic, vehicle type or road, where a file holds several.
        on_progress: Told the fraction done.

    Raises:
        InvalidInput: No regular file, an unknown format, or a path that is none (says what and where).
        MissingExtra: The format needs an optional package.
        NoSolution: The tolerance cannot be kept.
    """
    report = on_progress or (lambda fraction: None)
    wishes = Wishes(
        scale, loop, tolerance, _pair(columns), take, lambda f: report(_SHARES[0] * min(f, 1.0))
    )
    where = Path(path)
    try:
        found = _found(where, wishes)
    except RecursionError:
        raise refuse(str(path), "is nested too deeply") from None
    reading = _reading(found, str(path), wishes, report)
    for said in reading.warnings:
        warnings.warn(said, stacklevel=2)
    report(1.0)
    return reading


def _pair(columns: Sequence[int | str] | None) -> Choice | None:
    if columns is None:
        return None
    if len(columns) != 2:
        raise InvalidInput("columns", columns, "must be two: x and y, such as 2,3")
    return columns[0], columns[1]


def _found(path: Path, wishes: Wishes) -> Found:
    """What a file holds, by its content first and its suffix second."""
    label, suffix = str(path), path.suffix.lower()
    check_regular(path)
    if starts_with(path, MCAP):
        return read_mcap(path, wishes)
    text = read_text(path)
    content, start = text.content, text.content.lstrip()[:1]
    other = foreign(content)
    if other:
        raise refuse(label, f"is {other}")
    yaml = suffix in (".yaml", ".yml")
    if start == "<":
        found = read_markup(content, label, wishes)
    elif suffix in (".json", ".geojson", ".jsonl") or (start in ("{", "[") and not yaml):
        found = _structured(load_json(content, label), label, wishes, "JSON")
    elif yaml or (suffix not in (".csv", ".tsv") and _looks_like_yaml(content)):
        found = _structured(load_yaml(content, label, wishes.on_progress), label, wishes, "YAML")
    else:
        found = read_delimited(content, label, wishes)
    if text.encoding in ("utf-8", "utf-8-sig"):
        return found
    rows = (*found.rows, ("encoding", text.encoding.upper()))
    return Found(**{**vars(found), "rows": rows})


def _looks_like_yaml(content: str) -> bool:
    lines = [line for line in content[:20_000].split("\n")[:40] if line.strip()]
    lines = [line.rstrip() for line in lines if not line.lstrip().startswith("#")][:20]
    marked = any(":" in line or line.startswith("- ") for line in lines)
    return len(lines) > 1 and marked and all(map(_YAML_LINE.fullmatch, lines))


def _structured(documents: list[Any], label: str, wishes: Wishes, written: str) -> Found:
    if not documents:
        raise refuse(label, f"is empty {written}: it holds no points")
    if is_geojson(documents[0]):
        return read_geojson(documents[0], label, wishes)
    orders = find_vda(documents)
    if orders:
        return read_vda(orders, label, wishes)
    return read_messages(documents, label, wishes, written)


def _reading(found: Found, label: str, wishes: Wishes, report: Callable[[float], None]) -> Reading:
    report(_SHARES[0])
    _check_options(found, label, wishes)
    if found.points is None:
        curve = found.curve
        assert curve is not None
        if wishes.loop and not curve.closed:
            raise refuse(label, f"is a {found.format} with its own ends; --loop is for points")
        why = "it is driven once, from its first edge to its last"
        said = tuple(f"{label}: {text}" for text in found.warnings)
        return Reading(label, found.format, curve, found, None, None, curve.closed, why, said)
    points = found.points * wishes.scale
    check_places(points, label)
    closed, why, kept, more = closure(points, wishes.loop)
    if wishes.loop is None and found.closed is not None:
        closed, why = found.closed
    points = points[:kept]
    speeds = None if found.speeds is None else found.speeds[:kept]
    if closed:
        check_flat(points, label)
    check_reversal(points, found, label, wishes.tolerance)
    said = (
        *(f"{label}: {text}" for text in (*found.warnings, *more)),
        *doubts(points, found, label),
    )
    report(_SHARES[1])
    curve = _spline(points, label, closed, wishes.tolerance)
    return Reading(label, found.format, curve, found, points, speeds, closed, why, said)


def _check_options(found: Found, label: str, wishes: Wishes) -> None:
    """Refuse options that say nothing about a file of this format."""
    if wishes.take and found.format.startswith(_ONE_PATH):
        message = f"chooses among several paths; {label} ({found.format}) holds one"
        raise InvalidInput("take", wishes.take, message)
    if wishes.columns and not found.format.startswith(_COLUMNS):
        message = f"are for tables and lists; {label} is {found.format}"
        raise InvalidInput("columns", wishes.columns, message)


def _spline(points: Array, label: str, closed: bool, tolerance: float) -> Spline:
    try:
        return Spline(points=tuple(map(tuple, points.tolist())), loop=closed, tolerance=tolerance)
    except InvalidInput as error:
        raise refuse(label, error.valid) from None
