"""Tables as text: lines of cells behind commas, semicolons, tabs, bars or spaces."""

from collections.abc import Sequence

from osculate.curve.files.columns import Columns, as_column, by_content, by_name, wished
from osculate.curve.files.found import Array, Found, Wishes, refuse
from osculate.curve.files.header import PREAMBLE, Row, names_place
from osculate.curve.files.numbers import decimal, explain_number, is_number
from osculate.curve.files.sheet import DELIMITERS, Sheet, read_sheet
from osculate.curve.files.track import track


def read_delimited(text: str, label: str, wishes: Wishes) -> Found:
    """The path in a table.

    Raises:
        InvalidInput: No table, no x and y in it, or a cell that is no number (names line and column).
    """
    sheet = read_sheet(text, label)
    columns = _columns(sheet, label, wishes)
    picked = [columns.x, columns.y, *([columns.speed] if columns.speed is not None else [])]
    values = {n: _numbers(sheet, n, label, required=n != columns.speed) for n in picked}
    names = sheet.header or [f"column {n + 1}" for n in range(max(picked) + 1)]
    shown = f"{names[columns.x].strip()}, {names[columns.y].strip()}"
    if sheet.header:
        shown += f" (columns {columns.x + 1} and {columns.y + 1})"
    written = f"table with {DELIMITERS[sheet.delimiter]}"
    if sheet.decimal_commas:
        written += " and decimal commas"
    return track(
        columns, values, written, ("columns", shown), label,
        names=names, places=[row.line for row in sheet.rows], place="line", warnings=sheet.warnings,
    )  # fmt: skip


def _columns(sheet: Sheet, label: str, wishes: Wishes) -> Columns:
    if sheet.header is not None:
        return by_name(sheet.header, wishes.columns, label, wishes.scale)
    width = len(sheet.rows[0].cells)
    if wishes.columns is not None:
        x, y = wished(wishes.columns, width, label)
        return Columns(x, y, units="m (no header)")
    _refuse_transposed(sheet, label)
    numbers = [
        as_column(decimal, [row.cells[n] for row in sheet.rows])  # type: ignore[arg-type]
        for n in range(width)
    ]
    _refuse_mixed(sheet, numbers, label)
    _refuse_counted(sheet, numbers, label)
    return by_content(numbers, label)


def _refuse_transposed(sheet: Sheet, label: str) -> None:
    """Rows that are called x and y."""
    names = [row.cells[0] for row in sheet.rows[:PREAMBLE]]
    if names_place(names):
        shown = ", ".join(names)
        raise refuse(label, f"its rows are {shown}; write one point a line, under the header x,y")


def _refuse_mixed(sheet: Sheet, numbers: Sequence[Array | None], label: str) -> None:
    """A column that is a number in most lines but not in all is no text: name the line."""
    for n in [n for n, column in enumerate(numbers) if column is None]:
        if sum(column is not None for column in numbers[:n]) >= 2:
            return
        wrong = [row for row in sheet.rows if not is_number(row.cells[n])]
        if len(wrong) < len(sheet.rows):
            raise _no_point(wrong[0], n, label)


def _refuse_counted(sheet: Sheet, numbers: Sequence[Array | None], label: str) -> None:
    """A first line 0, 1, 2, … over numbers with points is the header of a table without names."""
    first, rest = sheet.rows[0].cells, sheet.rows[1:4]
    counts = [cell for cell in first if cell]
    if len(rest) > 1 and counts == [str(n) for n in range(len(counts))]:
        columns = [n for n, cell in enumerate(first) if cell]
        if all("." in row.cells[n] for row in rest for n in columns if numbers[n] is not None):
            message = "counts the columns and is no point; leave it out"
            raise refuse(label, message, f"line {sheet.rows[0].line}")


def _numbers(sheet: Sheet, n: int, label: str, *, required: bool) -> list[float] | None:
    values = []
    for row in sheet.rows:
        cell = row.cells[n] if n < len(row.cells) else ""
        try:
            values.append(decimal(cell))
        except ValueError:
            if not required:
                return None
            raise _no_point(row, n, label) from None
    return values


def _no_point(row: Row, n: int, label: str) -> Exception:
    cell = row.cells[n] if n < len(row.cells) else ""
    numbers = [f"cell {k + 1} is {c}" for k, c in enumerate(row.cells) if is_number(c)]
    message = f"is no point: cell {n + 1} {explain_number(cell)}"
    if numbers and row.line <= 2:
        message += f" (a header has no number in it; here {numbers[0]})"
    return refuse(label, message, f"line {row.line}")
