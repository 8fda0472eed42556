"""Points in JSON and YAML: ROS messages, lists of waypoints, columns, tables with named or bare rows."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from osculate.curve.files.candidates import (
    CUT,
    PREFERRED,
    Candidate,
    Path,
    candidates,
    is_record,
    leaves,
)
from osculate.curve.files.columns import Columns, as_column, by_content, by_name, wished
from osculate.curve.files.found import Array, Found, Wishes, refuse
from osculate.curve.files.numbers import number
from osculate.curve.files.track import of_points, track


def read_messages(documents: Sequence[Any], label: str, wishes: Wishes, written: str) -> Found:
    """The path in plain data.

    Raises:
        InvalidInput: None, several of equal right, cut, or a value that is no number (says which one).
    """
    if len(documents) > 1 and all(map(is_record, documents)):
        return _one_each(documents, label, wishes, written)
    every = [list(candidates(document, "", label)) for document in documents]
    found = [c for some in every for c in some]
    if all(c.empty for c in found) and any(map(is_record, documents)):
        return _one_each(documents, label, wishes, written)
    if found and all(c.key.endswith("transforms") for c in found):
        return _transforms(found, label, wishes, written)
    full = [c for c in found if not c.empty]
    if not full:
        what = f"the list {found[0].key} in it is empty" if found else _what_it_is(documents)
        raise refuse(label, f"holds no points: {what}")
    chosen, warnings = _choose(full, label, wishes)
    without = [n for n, some in enumerate(every) if not some]
    if without:
        said = (
            f"{len(without)} of {len(every)} documents hold no path, number {without[0]} the first"
        )
        warnings = (*warnings, said)
    if chosen.kind == "columns":
        return _columns(chosen, label, wishes, written, warnings)
    if chosen.kind == "rows":
        return _rows(chosen, label, wishes, written, warnings)
    return _records(chosen, label, wishes, written, "point", warnings)


def _one_each(documents: Sequence[Any], label: str, wishes: Wishes, written: str) -> Found:
    """One message a document, each with a position."""
    for n, document in enumerate(documents):
        if not is_record(document):
            raise refuse(label, "has no position, others have; was it cut?", f"message {n}")
    return _records(Candidate("", "records", documents), label, wishes, written, "message")


def _what_it_is(documents: Sequence[Any]) -> str:
    keys = sorted({str(k) for d in documents if isinstance(d, Mapping) for k in d})
    if not keys:
        return "must be a VDA 5050 order, a nav_msgs/Path, a list of [x, y] or the like"
    shown = ", ".join(keys[:8]) + (" …" if len(keys) > 8 else "")
    return (
        f"it has the keys {shown}; must be a VDA 5050 order, a nav_msgs/Path or a list of points "
        "with x and y"
    )


def _choose(
    found: Sequence[Candidate], label: str, wishes: Wishes
) -> tuple[Candidate, tuple[str, ...]]:
    """One of several: the user's, the usual name's, of several messages the last."""
    groups: dict[str, list[Candidate]] = {}
    for candidate in found:
        groups.setdefault(candidate.key, []).append(candidate)
    listed = ", ".join(key or "(the document)" for key in groups)
    if wishes.take:
        if wishes.take not in groups:
            raise refuse(label, f"has no list {wishes.take!r}; it has {listed}")
        group, warnings = groups[wishes.take], []
    else:
        rank = {key: _rank(key) for key in groups}
        best = [key for key in groups if rank[key] == min(rank.values())]
        if len(best) > 1:
            raise refuse(label, f"holds several lists of points: {listed}; say --take NAME")
        group = groups[best[0]]
        other = ", ".join(key for key in groups if key != best[0])
        warnings = [f"{best[0]} is read; {other} are there too (--take NAME)"] if other else []
    if len(group) > 1 and any(c.data != group[-1].data for c in group):
        name = group[-1].key.rpartition(".")[2] or "path"
        warnings.append(
            f"{len(group)} messages hold {name}; the last one is read ({len(group[-1].data)} points)"
        )
    return group[-1], tuple(warnings)


def _rank(key: str) -> int:
    last = key.rpartition(".")[2].lower()
    return PREFERRED.index(last) if last in PREFERRED else len(PREFERRED)


def _columns(
    chosen: Candidate, label: str, wishes: Wishes, written: str, warnings: tuple[str, ...]
) -> Found:
    """``{x: [...], y: [...]}``."""
    names = list(chosen.data)
    columns = by_name(names, wishes.columns, label, wishes.scale)
    picked = {columns.x, columns.y} | ({columns.speed} - {None})
    counts = {names[n]: len(chosen.data[names[n]]) for n in (columns.x, columns.y)}
    if len(set(counts.values())) > 1:
        lengths = " and ".join(f"{n} {name}" for name, n in counts.items())
        raise refuse(label, f"holds {lengths}: as many of each are needed")
    values = {n: _all(chosen.data[names[n]], names[n], label) for n in picked if n is not None}
    count = len(chosen.data[names[columns.x]])
    if columns.speed is not None and len(values[columns.speed]) != count:
        values[columns.speed] = None  # type: ignore[assignment]
    return track(
        columns, values, f"{written}, columns", ("keys", f"{names[columns.x]}, {names[columns.y]}"),
        label, names=names, places=range(count), place="point", warnings=warnings,
    )  # fmt: skip


def _all(values: Sequence[Any], name: str, label: str) -> list[float]:
    numbers = []
    for n, value in enumerate(values):
        try:
            numbers.append(number(value))
        except ValueError as error:
            if value == CUT:
                said = "was cut; record it again with `ros2 topic echo --full-length`"
                raise refuse(label, f"its {name} {said}", f"point {n}") from None
            raise refuse(label, f"its {name} {error}", f"point {n}") from None
    return numbers


def _rows(
    chosen: Candidate, label: str, wishes: Wishes, written: str, warnings: tuple[str, ...]
) -> Found:
    """``[[x, y], ...]``, perhaps with more columns."""
    rows = chosen.data
    width = len(rows[0])
    for n, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != width:
            count = len(row) if isinstance(row, list) else "no"
            raise refuse(label, f"has {count} numbers, point 0 has {width}", f"point {n}")
    if len(rows) == 2 and width > 4:
        raise refuse(
            label, f"holds two lists of {width} numbers; write {{x: […], y: […]}} or pairs"
        )
    if wishes.columns is not None:
        columns = Columns(*wished(wishes.columns, width, label))
    elif width == 2:
        columns = Columns(0, 1)
    else:
        of_points(rows, label, "point")  # says which one is no number
        numbers: list[Array | None] = [
            as_column(number, [r[n] for r in rows]) for n in range(width)
        ]
        columns = by_content(numbers, label)
    pair = [[row[columns.x], row[columns.y]] for row in rows]
    points = of_points(pair, label, "point")
    values = {columns.x: points[:, 0], columns.y: points[:, 1]}
    shown = f"{chosen.key or 'the list'}, entries {columns.x + 1} and {columns.y + 1}"
    return track(
        columns._replace(units="m"), values, f"{written}, list of points", ("points in", shown), label,
        names=[f"entry {n + 1}" for n in range(width)], places=range(len(rows)), place="point",
        warnings=warnings,
    )  # fmt: skip


def _records(
    chosen: Candidate, label: str, wishes: Wishes, written: str, place: str,
    warnings: tuple[str, ...] = (),
) -> Found:  # fmt: skip
    """Mappings with a position somewhere in each."""
    records = chosen.data
    ways = leaves(records[0])
    names = list(ways)
    columns = by_name(names, wishes.columns, label, wishes.scale)
    values: dict[int, list[float] | None] = {
        n: _dig(records, names[n], ways[names[n]], label, place) for n in (columns.x, columns.y)
    }
    if columns.speed is not None and columns.speed not in values:
        try:
            values[columns.speed] = _dig(
                records, names[columns.speed], ways[names[columns.speed]], label, place
            )
        except ValueError:
            values[columns.speed] = None
    message = _message(chosen, names)
    shown = f"{names[columns.x]}, {names[columns.y]}" + (f" in {chosen.key}" if chosen.key else "")
    more = (("message", message),) if message else ()
    return track(
        columns._replace(units="m" if message else columns.units), values, written,
        ("fields", shown), label, names=names, places=range(len(records)), place=place,
        warnings=warnings, more=more,
    )  # fmt: skip


def _dig(records: Sequence[Any], name: str, way: Path, label: str, place: str) -> list[float]:
    numbers = []
    for n, record in enumerate(records):
        value = record
        try:
            for step in way:
                value = value[step]
            numbers.append(number(value))
        except (KeyError, IndexError, TypeError):
            raise refuse(label, f"has no {name}", f"{place} {n}") from None
        except ValueError as error:
            raise refuse(label, f"its {name} {error}", f"{place} {n}") from None
    return numbers


def _message(chosen: Candidate, names: Sequence[str]) -> str:
    """The ROS message that looks like this, or nothing."""
    held = {re.sub(r"\.[xyzw]$", "", name) for name in names}
    poses = chosen.key.rpartition(".")[2] == "poses"
    if poses:
        return "nav_msgs/Path" if "pose.position" in held else "geometry_msgs/PoseArray"
    if "pose.pose.position" in held:
        odometry = "twist.twist.linear" in held
        return "nav_msgs/Odometry" if odometry else "geometry_msgs/PoseWithCovarianceStamped"
    if "pose.position" in held:
        return "geometry_msgs/PoseStamped"
    return "geometry_msgs/TransformStamped" if "transform.translation" in held else ""


def _transforms(found: Sequence[Candidate], label: str, wishes: Wishes, written: str) -> Found:
    """tf2_msgs/TFMessage: the way of one frame."""
    every = [record for c in found for record in c.data if isinstance(record, Mapping)]
    frames = sorted({str(record.get("child_frame_id", "")) for record in every})
    frame = wishes.take or (frames[0] if len(frames) == 1 else "")
    if frame not in frames:
        raise refuse(label, f"holds the frames {', '.join(frames)}; say --take FRAME")
    own = [record for record in every if str(record.get("child_frame_id", "")) == frame]
    return _records(Candidate(found[0].key, "records", own), label, wishes, written, "transform")
