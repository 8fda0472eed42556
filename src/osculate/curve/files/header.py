"""The header of a table: the names above its columns, in a line or in a comment."""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from osculate.curve.files.names import UNITS, axis_of, globe, parse_name, positions
from osculate.curve.files.numbers import is_number

PREAMBLE = 10  # lines before the header that may hold a title
COMMA_NUMBER = re.compile(r"\s*[+-]?\d*,\d+(?:[eE][+-]?\d+)?\s*")

Cells = list[str]


class Row(NamedTuple):
    """One line, taken apart."""

    line: int  # from 1
    cells: Cells


def take_header(
    rows: list[Row], comments: Sequence[tuple[bool, str]], delimiter: str
) -> tuple[Cells | None, list[Row], tuple[str, ...]]:
    """The header, the rows under it, and what was left out above it."""
    if any(_is_value(cell, delimiter) for cell in rows[0].cells):
        header = _commented([c for above, c in comments if above], rows[0].cells, delimiter)
        lost = [
            comment
            for above, comment in comments
            if header is None and _lost_header(comment, delimiter, above)
        ]
        return (
            header,
            rows,
            tuple(
                f"the comment {c[:60]!r} may be a header, but not here or not of this many columns"
                for c in lost[:1]
            ),
        )
    start = 0
    for n, row in enumerate(rows[:PREAMBLE]):
        if any(_is_value(cell, delimiter) for cell in row.cells):
            break
        if names_place(row.cells):
            start = n
            break
    header, rest = rows[start].cells, rows[start + 1 :]
    warnings = (f"the lines before the header in line {rows[start].line} are left out",) * (
        start > 0
    )
    if rest and _units_only(rest[0].cells):
        header = [
            f"{name} [{unit}]" if unit else name for name, unit in _zip(header, rest[0].cells)
        ]
        rest = rest[1:]
    return header, rest, warnings


def _is_value(cell: str, delimiter: str) -> bool:
    """Whether a cell is a number, with a decimal comma perhaps, and so no name."""
    return is_number(cell.strip("'`")) or (delimiter != "," and bool(COMMA_NUMBER.fullmatch(cell)))


def _zip(header: Cells, units: Cells) -> Iterator[tuple[str, str]]:
    padded = [*units, *[""] * len(header)]
    return ((name, padded[n].strip("[]() ")) for n, name in enumerate(header))


def _lost_header(comment: str, delimiter: str, above: bool) -> bool:
    """Whether a comment that is no header was one, perhaps."""
    cells = _split(comment, delimiter)
    if not above:
        return names_place(cells)
    words = delimiter != " " and not any(re.search(r"\s", cell) for cell in cells)
    return _hints(cells) or (words and len(cells) > 2)


def _hints(cells: Cells) -> bool:
    """Whether some cell names an axis."""
    return any(axis_of(parse_name(cell)) for cell in cells)


def names_place(cells: Cells) -> bool:
    """Whether some cells name x and y, or latitude and longitude."""
    names = [parse_name(cell) for cell in cells]
    return bool(positions(names) or globe(names))


def _units_only(cells: Cells) -> bool:
    bare = [cell.strip("[]() ").lower() for cell in cells]
    return all(cell in UNITS or not cell for cell in bare) and any(
        cell in UNITS and not is_number(cell) for cell in bare
    )


def _split(comment: str, sign: str) -> Cells:
    bare = comment.lstrip("#%/ ").strip()
    cells = [cell.strip() for cell in (bare.split() if sign == " " else bare.split(sign))]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _commented(comments: Sequence[str], first: Cells, delimiter: str) -> Cells | None:
    """The last comment above the rows that has a name for each column."""
    width = len(first) - (first[-1] == "")
    for comment in reversed(comments):
        for sign in (delimiter, ";", "\t", ",", " "):
            cells = _split(comment, sign)
            if len(cells) != width or any(map(is_number, cells)):
                continue
            words = all(re.fullmatch(r"\S+|\S+ ?[\[(].*", cell.strip("\"'")) for cell in cells)
            if names_place(cells) or (words and sign != " ") or _hints(cells):
                return cells
    return None
