"""The command line: thin commands over the same calls that Python users make."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.table import Table

from osculate.errors import OsculateError

if TYPE_CHECKING:
    from osculate.simulation import Run

app = typer.Typer(
    name="osculate",
    help="Make a three-wheeled robot follow a curve exactly.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)
out = Console(highlight=False)
err = Console(stderr=True, highlight=False)

ScenarioArgument = Annotated[
    str, typer.Argument(help="A scenario file (YAML) or the name of a built-in scenario.")
]


def main() -> None:
    """Entry point: runs a command and turns the package's errors into one message and exit code 2."""
    try:
        app()
    except OsculateError as error:
        err.print("[bold red]error:[/bold red]", end=" ")
        err.print(str(error), markup=False)
        sys.exit(2)


@app.command()
def run(
    scenario: ScenarioArgument = "paper",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder for report, data and figures.")
    ] = None,
    animate: Annotated[bool, typer.Option("--animate", help="Also write animation.gif.")] = False,
) -> None:
    """Run a scenario: obstacle, curve, speed target, controllers, simulation, report."""
    from osculate.study.scenario import Scenario

    chosen = Scenario.load(scenario)
    with progress("simulating") as report:
        result = chosen.run(report)
    _print_metrics(result, chosen.name)
    if output:
        from osculate.study.output import write_output

        with progress("writing") as report:
            written = write_output(result, output, chosen, animate=animate, report=report)
        out.print(f"Report: [bold]{written[0]}[/bold]", soft_wrap=True)
    if result.diverged:
        raise typer.Exit(1)


@app.command()
def scenarios() -> None:
    """List the built-in scenarios."""
    from osculate.study.scenario import Scenario, built_in

    table = Table("name", "what it shows", box=None, header_style="bold")
    for name in built_in():
        table.add_row(name, Scenario.load(name).description)
    out.print(table)


@app.command()
def paper(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for claims, figures and data.")
    ] = Path("paper"),
) -> None:
    """Reproduce the paper: Figures 3-7, and a verdict on every number and claim."""
    from osculate.study.paper import reproduce

    with progress("reproducing") as report:
        result = reproduce(report=report)
        written = result.write(output)
    table = Table("statement", "source", "paper", "ours", "verdict", header_style="bold")
    for row in result.rows:
        colour = {"holds": "green", "does not hold": "red"}.get(row.verdict, "yellow")
        table.add_row(
            row.statement, row.source, row.expected_text, row.measured_text,
            f"[{colour}]{row.verdict}[/{colour}]",
        )  # fmt: skip
    out.print(table)
    out.print(f"Written: {len(written)} files in [bold]{output}[/bold]", soft_wrap=True)


@app.command()
def model() -> None:
    """Print the derived equations of motion as LaTeX."""
    from osculate.vehicle.derivation import derive

    out.print(derive().latex(), markup=False, soft_wrap=True)


@contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """A progress bar on the terminal; the function it gives takes the fraction done."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=err, transient=True) as bar:
        task = bar.add_task(what, total=1.0)

        def report(fraction: float) -> None:
            bar.update(task, completed=fraction)

        yield report


def _print_metrics(result: "Run", title: str) -> None:
    from osculate.study.report import metric_rows

    table = Table(
        title=title, title_justify="left", title_style="bold", show_header=False, box=None
    )
    table.add_column(style="dim")
    table.add_column(justify="right")
    for label, value in metric_rows(result.metrics):
        table.add_row(label, value)
    out.print(table)
    style: Any = "bold red" if result.diverged else "none"
    out.print(f"The run {result.message}.", style=style)


if __name__ == "__main__":
    main()
