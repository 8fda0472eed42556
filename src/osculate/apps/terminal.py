"""What the command line prints: texts as they are, never as markup, and how far something is."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Column, Table
from rich.text import Text

out = Console(highlight=False, markup=False, emoji=False)
err = Console(stderr=True, highlight=False, markup=False, emoji=False)


def shown(text: object) -> str:
    """A text without characters that command a terminal, and without what is no character."""
    visible = re.sub(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", lambda c: f"\\x{ord(c[0]):02x}", str(text))
    return visible.encode("utf-8", errors="backslashreplace").decode()


def tell_path(label: str, path: str | Path) -> None:
    """Print where something lies."""
    out.print(Text.assemble(f"{label}: ", (shown(path), "bold")), soft_wrap=True)


def tell_error(error: object) -> None:
    """Print an error."""
    err.print(Text.assemble(("error:", "bold red"), " ", shown(error)), soft_wrap=True)


def tell_warning(message: object) -> None:
    """Print a warning."""
    err.print(Text.assemble(("warning:", "bold yellow"), " ", shown(message)), soft_wrap=True)


def tell_verdict(verdict: object, console: Console, *, good: bool) -> None:
    """Print what became of something, in a line of its own: red unless it is good."""
    console.print(Text(shown(verdict), "green" if good else "bold red"), soft_wrap=True)


def print_table(rows: list[list[str]]) -> None:
    """Print rows, the header first."""
    header, *body = rows
    columns = (
        Column(Text(shown(name)), overflow="fold", no_wrap=n == 0) for n, name in enumerate(header)
    )
    table = Table(*columns, header_style="bold")
    for row in body:
        table.add_row(*(Text(shown(cell)) for cell in row))
    out.print(table)


def print_rows(title: str, rows: list[tuple[str, str]]) -> None:
    """Print labels and values below a title."""
    table = Table(
        title=Text(shown(title)), title_justify="left", title_style="bold", show_header=False,
        box=None,
    )  # fmt: skip
    table.add_column(style="dim")
    table.add_column(justify="right")
    for label, value in rows:
        table.add_row(Text(shown(label)), Text(shown(value)))
    out.print(table)


@contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """A progress bar on the terminal; the function it gives takes the fraction done."""
    from osculate.kernel.watching import watch_compiling

    columns = (
        SpinnerColumn(), TextColumn("{task.description}", markup=False), BarColumn(),
        TaskProgressColumn(), TimeElapsedColumn(), TimeRemainingColumn(),
    )  # fmt: skip
    with Progress(*columns, console=err, transient=True, disable=not err.is_terminal) as bar:
        task = bar.add_task(shown(what), total=1.0)

        def report(fraction: float) -> None:
            bar.update(task, completed=fraction)

        def compiling(begins: bool) -> None:
            doing = f"{what}: compiling, once for these parts" if begins else what
            bar.update(task, description=shown(doing))

        with watch_compiling(compiling):
            yield report
