"""A text taken apart into a header and rows of cells.

No line is dropped without a word: it is the header, a comment, a line of units, or a row.
"""

import csv
import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from osculate.curve.files.found import refuse
from osculate.curve.files.header import COMMA_NUMBER, Cells, Row, take_header
from osculate.curve.files.numbers import is_number

COMMENT = ("#", "%", "//")
REMARK = re.compile(r"(?<=[\d.']) +(?:#|%|//)(?:\s.*|[^\s\d].*)?$")  # behind numbers; #1 is a name
HEADER_REMARK = re.compile(r"(?<=\S) +# +\w[^,;\t|]*$")  # behind names
QUOTED = re.compile(r"'([^']*)'")
SNIFFED = 30  # lines the delimiter is told from
DELIMITERS = {";": "semicolons", "\t": "tabs", "|": "bars", ",": "commas", " ": "spaces"}


class Sheet(NamedTuple):
    """A table, taken apart."""

    header: Cells | None
    rows: list[Row]
    delimiter: str
    decimal_commas: bool
    warnings: tuple[str, ...]


def read_sheet(text: str, label: str) -> Sheet:
    """Header and rows.

    Raises:
        InvalidInput: None, quotes that do not fit, or rows of different widths (names the line).
    """
    lines = (
        text.replace("\r\n", "\n").replace("\r", "\n").replace("\N{MINUS SIGN}", "-").split("\n")
    )
    numbered = [(n, line.strip(" \v\f")) for n, line in enumerate(lines, start=1) if line.strip()]
    forced = None
    if numbered and re.fullmatch(r"sep=.", numbered[0][1].strip()):
        forced, numbered = numbered[0][1].strip()[-1], numbered[1:]
    body = [(n, line) for n, line in numbered if not line.startswith(COMMENT)]
    if not body:
        raise refuse(label, "must hold lines with x and y (m); it holds none")
    body = _without_remarks(body)
    _refuse_brackets(body[0], label)
    delimiter = forced or _delimiter([line for _, line in body[:SNIFFED]])
    if delimiter not in DELIMITERS:
        raise refuse(label, f"has the delimiter {delimiter!r}; use one of {' '.join(DELIMITERS)}")
    rows = [Row(n, cells) for n, cells in _cells(body, delimiter, label)]
    first = body[0][0]
    comments = [(n < first, line) for n, line in numbered if line.startswith(COMMENT)]
    header, rows, warnings = take_header(rows, comments, delimiter)
    if not rows:
        raise refuse(label, "must hold lines with x and y (m); it holds a header only")
    rows, commas = _decimal_commas(rows, delimiter, label)
    rows, more = _even(header, rows, label)
    return Sheet(header, rows, delimiter, commas, (*warnings, *more))


def _without_remarks(body: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Lines without a comment behind their numbers, or behind the names of the first one."""
    bare = [
        (n, REMARK.sub("", line) if '"' not in line and any(c in line for c in COMMENT) else line)
        for n, line in body
    ]
    first, line = bare[0]
    if '"' not in line and any(sign in line for sign in ",;\t|"):
        bare[0] = first, HEADER_REMARK.sub("", line)
    return bare


def _refuse_brackets(first: tuple[int, str], label: str) -> None:
    """``(1, 2)``: numbers in brackets are points of another notation."""
    number, line = first
    if re.match(r"[(\[{]+\s*[-+]?[\d.]", line):
        message = "has brackets around its numbers; write one point a line: x,y"
        raise refuse(label, message, f"line {number}")


def _delimiter(lines: Sequence[str]) -> str:
    """The first of ; tab | that a line has, else the comma unless it is the decimal one, else space."""
    for strong in (";", "\t", "|"):
        if any(strong in line for line in lines):
            return strong
    if not any("," in line for line in lines):
        return " "
    spaced = [[c for c in line.split() if "," in c] for line in lines[1:] or lines]
    if all(len(cells) > 1 and all(map(COMMA_NUMBER.fullmatch, cells)) for cells in spaced):
        return " "
    return ","


def _cells(
    body: Sequence[tuple[int, str]], delimiter: str, label: str
) -> Iterator[tuple[int, Cells]]:
    for n, line in body:
        if '"' in line:
            try:
                cells = next(
                    csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True)
                )
            except csv.Error as error:
                raise refuse(label, f"has quotes that do not fit ({error})", f"line {n}") from None
        else:
            cells = line.split() if delimiter == " " else line.split(delimiter)
        cells = [cell.strip() for cell in cells]
        yield n, [_unquoted(cell, delimiter) for cell in cells] if "'" in line else cells


def _unquoted(cell: str, delimiter: str) -> str:
    """A number without its single quotes; anything else as it is."""
    inner = QUOTED.fullmatch(cell)
    if inner and (is_number(inner[1]) or (delimiter != "," and COMMA_NUMBER.fullmatch(inner[1]))):
        return inner[1]
    return cell


def _decimal_commas(rows: list[Row], delimiter: str, label: str) -> tuple[list[Row], bool]:
    """Commas inside numbers become points; a file has either the one or the other."""
    if delimiter == "," and not any("," in cell for row in rows for cell in row.cells):
        _refuse_split_numbers(rows, label)
        return rows, False
    if not any(COMMA_NUMBER.fullmatch(cell) for row in rows for cell in row.cells):
        return rows, False
    for row in rows:
        for n, cell in enumerate(row.cells):
            if is_number(cell) and "." in cell:
                message = (
                    f"has a decimal point in cell {n + 1} ({cell}), other lines have decimal commas"
                )
                raise refuse(label, message, f"line {row.line}")
    return [
        Row(n, [c.replace(",", ".") if COMMA_NUMBER.fullmatch(c) else c for c in cells])
        for n, cells in rows
    ], True


def _refuse_split_numbers(rows: list[Row], label: str) -> None:
    """``0,25,0,20`` may be 0.25 and 0.20: whole numbers in pairs, some with leading zeros."""
    width = len(rows[0].cells)
    if width < 4 or width % 2:
        return
    whole = all(re.fullmatch(r"-?\d+", cell) for row in rows for cell in row.cells)
    halves = [cell for row in rows for cell in row.cells[1::2]]
    if whole and any(len(cell) > 1 and cell[0] == "0" for cell in halves):
        message = (
            "looks like decimal commas between commas; write points or separate with semicolons"
        )
        raise refuse(label, message, f"line {rows[0].line}")


def _even(header: Cells | None, rows: list[Row], label: str) -> tuple[list[Row], tuple[str, ...]]:
    """Rows of one width: trailing delimiters go, empty rows at the end go with a word."""
    kept = list(rows)
    while kept and not any(kept[-1].cells):
        kept.pop()
    if not kept:
        raise refuse(label, "must hold lines with x and y (m); it holds empty cells only")
    warnings = [f"{len(rows) - len(kept)} empty rows at the end are left out"] * (kept != rows)
    width = len(header) if header is not None else max(_filled(row) for row in kept)
    short = []
    for row in kept:
        if _filled(row) > width:
            named = "the header names" if header is not None else "others have"
            raise refuse(
                label,
                f"has {_filled(row)} cells, {named} {width}; what is missing?",
                f"line {row.line}",
            )
        if len(row.cells) < width:
            short.append(row)
    if short and header is None:
        message = f"has {len(short[0].cells)} cells, others have {width}"
        raise refuse(label, message, f"line {short[0].line}")
    if short:
        warnings.append(
            f"{len(short)} lines have fewer cells than the header, line {short[0].line} the first"
        )
    return [Row(n, cells[:width]) for n, cells in kept], tuple(warnings)


def _filled(row: Row) -> int:
    """How many cells there are up to the last one that holds something."""
    return max((n for n, cell in enumerate(row.cells, start=1) if cell), default=0)
