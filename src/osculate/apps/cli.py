"""The command line: thin commands over the same calls that Python users make."""

import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from osculate.apps.interrupt import farewell, interruptible
from osculate.apps.terminal import (
    err,
    out,
    print_rows,
    print_table,
    progress,
    shown,
    tell_error,
    tell_path,
    tell_verdict,
    tell_warning,
)
from osculate.errors import InvalidInput, NoSolution, NotWritten, OsculateError, choose

if TYPE_CHECKING:
    from osculate.curve import CurveFile
    from osculate.simulation import Run
    from osculate.study.scenario import Scenario

app = typer.Typer(
    name="osculate",
    help="Make a three-wheeled robot follow a curve exactly.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)

GO_ON = "are kept in {}; the same command goes on from there."
ScenarioArgument = Annotated[
    str, typer.Argument(help="A scenario file (YAML) or the name of a built-in scenario.")
]


def main() -> None:
    """Entry point: runs a command and turns the package's errors into one message and an exit code.

    Wrong input is exit code 2, files that could not be written are 1, Ctrl-C is 130.
    """
    warnings.showwarning = _show_warning
    try:
        with interruptible():
            app()
    except NotWritten as error:
        tell_error(error)
        sys.exit(1)
    except OsculateError as error:
        from osculate.simulation.verdict import WRONG_INPUT

        tell_error(error)
        sys.exit(WRONG_INPUT)


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    tell_warning(message)


@app.command()
def run(
    scenario: ScenarioArgument = "paper",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder for report, data and figures.")
    ] = None,
    animate: Annotated[bool, typer.Option("--animate", help="Also write animation.gif.")] = False,
    plant: Annotated[
        str, typer.Option(help="Another plant than the scenario's: actuated, slip or mujoco.")
    ] = "",
    save: Annotated[
        list[Path] | None,
        typer.Option(
            "--save", help="Also save the run here: .nc, .mcap (ROS 2), .rrd (Rerun), .mp4."
        ),
    ] = None,
    video: Annotated[
        Path | None, typer.Option("--video", help="Film the run: .mp4 or .gif; needs no display.")
    ] = None,
    view: Annotated[bool, typer.Option("--view", help="Show the run in MuJoCo's viewer.")] = False,
) -> None:
    """Run a scenario: obstacle, curve, speed target, controllers, simulation, report.

    The first line is the verdict: what happened first, where and when. It is also the exit code: 0 reached,
    1 internal error, 2 wrong input or infeasible, 10 hit, 11 left, 12 stopped, 13 diverged, 14 late,
    15 reversed. If files could not be written, it is 1; after Ctrl-C it is 130.
    """
    from osculate.study.scenario import Scenario

    if animate and not output:
        raise InvalidInput("animate", animate, "goes into the output folder: give --output as well")
    also = [*(save or ()), *([video] if video else [])]
    _check_places(output, also, video, animate, view)
    chosen = Scenario.load(scenario)
    if plant:
        chosen = chosen.on(plant)
    result = _simulate(chosen, output)
    tell_verdict(result.verdict, out, good=result.verdict.reached)
    _print_metrics(result, chosen.name)
    if output or also:
        from osculate.study.output import write_output

        with progress("writing") as report:
            written = write_output(result, output, chosen, animate, report, also)
        if output:
            tell_path("Report", written[0])
        for path in also:
            tell_path("Film" if path == video else "Saved", path)
    if view:
        from osculate.simulation.recording.video import view as show

        show(result)
    raise typer.Exit(result.verdict.exit_code)


def _simulate(chosen: "Scenario", output: Path | None) -> "Run":
    """Run a scenario; where the plan says that the robot cannot, that is the verdict."""
    try:
        if caution := chosen.caution():
            _show_warning(caution)
        with progress("simulating") as report:
            return chosen.run(report)
    except NoSolution as error:
        from osculate.simulation.verdict import infeasible

        verdict = infeasible(error)
        tell_verdict(verdict, err, good=False)
        if output:
            from osculate.study.output import write_refusal

            tell_path("Report", write_refusal(verdict, output, chosen))
        raise typer.Exit(verdict.exit_code) from None


def _check_places(
    output: Path | None, also: list[Path], video: Path | None, animate: bool, view: bool
) -> None:
    """Complain before a simulation that may take long, not after it; the film is the last of ``also``."""
    from osculate.files import check_folder
    from osculate.simulation.recording.formats import check_save
    from osculate.simulation.recording.video import check_video, require_display

    if output:
        check_folder("output", output)
    taken = [(output / "animation.gif").resolve()] if output and animate else []
    for path in also:
        check_video(path) if path is video else check_save(path)
        if path.resolve() in taken:
            raise InvalidInput("path", str(path), "is written already; give another name")
        taken.append(path.resolve())
    if view:
        require_display()


@app.command()
def scenarios() -> None:
    """List the built-in scenarios."""
    from osculate.study.scenario import Scenario, built_in

    table = Table("name", "what it shows", box=None, header_style="bold")
    for name in built_in():
        table.add_row(Text(name), Text(Scenario.load(name).description))
    out.print(table)


@app.command()
def paper(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for claims, figures and data.")
    ] = Path("paper"),
    yaw_origin: Annotated[
        str,
        typer.Option(
            help="Where the target's heading begins: start (as the robot) or printed (0)."
        ),
    ] = "start",
    after_end: Annotated[
        str, typer.Option(help="What happens at the end of the path: stop or continue (to 20 s).")
    ] = "stop",
) -> None:
    """Reproduce the paper: Figures 1-7, and a judgement on every number and statement."""
    from osculate.files import check_folder
    from osculate.study.paper import Interpretation, reproduce

    chosen = Interpretation.checked(yaw_origin, after_end)
    check_folder("output", output)
    with progress("reproducing") as report:
        result = reproduce(chosen, report=report)
    with progress("writing") as report:
        written = result.write(output, report)
    table = Table("statement", "source", "paper", "ours", "judgement", header_style="bold")
    for row in result.rows:
        colour = {"holds": "green", "does not hold": "red"}.get(row.judgement, "yellow")
        texts = (row.statement, row.source, row.expected_text, row.measured_text)
        table.add_row(*map(Text, texts), Text(row.judgement, colour))
    out.print(table)
    tell_path(f"Written: {len(written)} files in", output)


@app.command()
def curve(
    source: Annotated[
        str,
        typer.Argument(help="A curve file, a built-in curve or a scenario file.", metavar="FILE"),
    ],
    robot: Annotated[
        str, typer.Option(help="A robot of the catalogue; by default the scenario's own, or paper.")
    ] = "",
    scale: Annotated[float, typer.Option(help="Factor on all coordinates.")] = 1.0,
    tolerance: Annotated[
        float, typer.Option(help="Largest distance from the points (m); 0 goes through them.")
    ] = 0.0,
    columns: Annotated[
        str, typer.Option(help="Columns of x and y: numbers from 1 or names, such as 2,3.")
    ] = "",
    loop: Annotated[
        bool | None,
        typer.Option("--loop/--no-loop", help="Closed or open; by default its ends decide."),
    ] = None,
    take: Annotated[
        str, typer.Option(help="Which path, topic, vehicle type or road, if there are several.")
    ] = "",
    speeds: Annotated[
        bool, typer.Option("--speeds", help="Keep to the file's own speeds.")
    ] = False,
    speed: Annotated[float, typer.Option(help="Speed (m/s) that is asked for.")] = 1.0,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder for a figure of the curve.")
    ] = None,
) -> None:
    """Inspect a curve: what the file holds, length, curvature, and whether a robot can follow it."""
    from osculate.curve import CurveFile
    from osculate.files import check_folder
    from osculate.study.feasibility import draw, inspect_curve, load_source
    from osculate.vehicle import vehicle_named

    if output:
        check_folder("output", output)
    named = vehicle_named(robot) if robot else None
    chosen, own = load_source(
        source, scale=scale, tolerance=tolerance, columns=_columns(columns), loop=loop, take=take,
        speeds=speeds,
    )  # fmt: skip
    if isinstance(chosen, CurveFile):
        with progress("reading") as told:
            chosen.read(told)
        _print_reading(chosen)
    with progress("inspecting") as told:
        report = inspect_curve(chosen, named or own or vehicle_named("paper"), speed)
        told(1.0)
    print_rows("" if isinstance(chosen, CurveFile) else source, report.rows())
    out.print(shown(report.conclusion), style="none" if report.feasible else "bold red")
    if output:
        tell_path("Figure", draw(chosen, report, output))
    if not report.feasible:
        raise typer.Exit(1)


def _columns(text: str) -> tuple[int | str, int | str] | None:
    """Two numbers or names, separated by a comma."""
    if not text:
        return None
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(parts):
        raise InvalidInput("columns", text, "must be two numbers from 1 or two names, such as 2,3")
    x, y = (int(part) if part.isdecimal() else part for part in parts)
    return x, y


def _print_reading(chosen: "CurveFile") -> None:
    """What was understood of a file."""
    for label, value in [("file", chosen.path), *chosen.reading.rows()]:
        out.print(Text.assemble((f"{label}: ", "dim"), shown(value)), soft_wrap=True)
    name = chosen.reading.found.speed_name
    if name and not chosen.speeds:
        out.print(shown(f"speeds: {name} is in the file and not used; --speeds keeps to it"))


@app.command()
def compare(
    controllers: Annotated[
        str, typer.Option(help="Names, separated by commas; all by default.")
    ] = "",
    curves: Annotated[str, typer.Option(help="Built-in curves or files, by commas.")] = "",
    speeds: Annotated[str, typer.Option(help="Largest speeds (m/s), by commas.")] = "0.5,1,2",
    starts: Annotated[
        str,
        typer.Option(
            help="on-path, running (counted after 3 m), offset, metre, across; by commas. By default "
            "on-path and offset, in the reality suite running."
        ),
    ] = "",
    plants: Annotated[
        str,
        typer.Option(
            "--plants", "--plant", help="Conditions, by commas: ideal, noisy, slip, late, …"
        ),
    ] = "",
    suite: Annotated[
        str,
        typer.Option(
            help="ideal (the default), or reality: noise, slip, MuJoCo and every fault. Instead of "
            "--plants."
        ),
    ] = "",
    draws: Annotated[
        int | None,
        typer.Option(
            min=1, help="Runs of every combination that has random numbers; 3 by default."
        ),
    ] = None,
    robot: Annotated[str, typer.Option(help="A robot of the catalogue.")] = "paper",
    scale: Annotated[float, typer.Option(help="Factor on the coordinates of files.")] = 1.0,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for page, figures and data.")
    ] = Path("comparison"),
) -> None:
    """Compare controllers on curves, speeds, starts and plants."""
    from osculate.control.tracking import Nmpc
    from osculate.files import check_folder
    from osculate.study.comparison import compare as run_comparison
    from osculate.study.comparison import curves as known_curves
    from osculate.study.comparison import starts as known_starts
    from osculate.study.comparison import trackers_for
    from osculate.study.comparison.kept import Kept
    from osculate.study.comparison.report import MEANING, OURS, ranking_table
    from osculate.study.comparison.significance import condition_table, paired_comparisons, summary
    from osculate.study.comparison.suite import conditions
    from osculate.vehicle import vehicle_named

    body = vehicle_named(robot)
    compiled = trackers_for(body)
    laws: dict[str, Any] = {**compiled, "nmpc": Nmpc()}
    chosen = {n: choose("controller", n, laws) for n in _names(controllers) or compiled}
    if suite and plants:
        raise InvalidInput(
            "suite", suite, "names conditions, and so does --plants: give one of them"
        )
    states = conditions(_names(plants), suite or "ideal", body)
    random = any(state.seeded for state in states.values())
    check_folder("output", output)
    kept = Kept(output / "cells")
    farewell.append(f"finished cells {GO_ON.format(shown(kept.folder))}")
    with progress("comparing") as report:
        result = run_comparison(
            chosen,
            known_curves(_names(curves), scale),
            speeds=_numbers("speeds", speeds),
            start=known_starts(_names(starts) or (["running"] if suite == "reality" else None)),
            condition=states,
            robot=body,
            draws=draws or (3 if random else 1),
            keep=kept,
            report=report,
        )
    tell_verdict(result.verdict, out, good=result.reached)
    if kept.taken:
        tell_path(f"Taken over: {kept.taken} of {len(result.cells)} cells, kept in", kept.folder)
    print_table(ranking_table(result))
    if len({cell["plant"] for cell in result.cells}) > 1 and OURS in result.controllers:
        print_table(condition_table(result, OURS))
        out.print(MEANING, style="dim")
        out.print(summary(paired_comparisons(result, OURS)))
    written = result.write(output)
    tell_path("Report", written[0])


@app.command()
def tune(
    controller: Annotated[str, typer.Argument(help="Name of a path tracker.")],
    curves: Annotated[
        str,
        typer.Option(help="Training curves (built-in names or files); the package's by default."),
    ] = "",
    robot: Annotated[str, typer.Option(help="A robot of the catalogue.")] = "paper",
    scale: Annotated[float, typer.Option(help="Factor on the coordinates of files.")] = 1.0,
    generations: Annotated[int, typer.Option(min=1, help="Generations of the search.")] = 12,
    population: Annotated[
        int | None,
        typer.Option(min=4, help="Controllers per generation; 10 by default, 8 if --quick."),
    ] = None,
    seed: Annotated[int, typer.Option(min=1, help="Seed of the search.")] = 1,
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Two curves, one speed, two starts, eight controllers."),
    ] = False,
    output: Annotated[Path, typer.Option("--output", "-o", help="Result file (JSON).")] = Path(
        "tuned.json"
    ),
) -> None:
    """Tune a controller on training curves by CMA-ES."""
    from osculate.control.tracking import TRACKERS
    from osculate.files import check_file
    from osculate.study.comparison import curves as known_curves
    from osculate.study.comparison import quick_search
    from osculate.study.comparison import tune as run_tuning
    from osculate.study.comparison.kept import Kept
    from osculate.vehicle import vehicle_named

    law = choose("controller", controller, TRACKERS)
    search: dict[str, Any] = quick_search() if quick else {}
    if population is not None:
        search["population"] = population
    if curves or scale != 1.0:
        search["on"] = known_curves(_names(curves), scale)
    check_file("output", output)
    kept = Kept(output.with_name(f"{output.stem}.generations"))
    farewell.append(f"finished generations {GO_ON.format(shown(kept.folder))}")
    with progress(f"tuning {controller}") as report:
        result = run_tuning(
            law, robot=vehicle_named(robot), generations=generations, seed=seed, keep=kept,
            report=report, **search,
        )  # fmt: skip
    if kept.taken:
        again = f"{kept.taken - 1} of {generations} generations"  # one is the start of the search
        tell_path(f"Taken over: {again}, kept in", kept.folder)
    for name in result.controller.tunable:
        out.print(f"{name}: {getattr(result.controller, name):.6g}")
    before, after = 10**result.initial_cost, 10**result.cost
    out.print(f"geometric mean of the RMS: {before:.4g} mm before, {after:.4g} mm after")
    tell_path("Written", result.write(output))


@app.command()
def init(
    path: Annotated[Path, typer.Argument(help="File to write.")] = Path("scenario.yaml"),
) -> None:
    """Write a commented scenario to start from, and the schema that editors check it with."""
    from osculate.study.scenario import write_template

    for written in write_template(path):
        tell_path("Written", written)


@app.command()
def schema() -> None:
    """Print the JSON schema of scenario files."""
    from osculate.strict_json import strict_json
    from osculate.study.scenario import Scenario

    out.print_json(strict_json(Scenario.model_json_schema()))


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _numbers(field: str, text: str) -> list[float]:
    try:
        values = [float(part) for part in _names(text)]
    except ValueError:
        values = []
    if not values or min(values) <= 0.0:
        raise InvalidInput(field, text, "must be positive numbers (m/s), separated by commas")
    return values


@app.command()
def model() -> None:
    """Print the derived equations of motion as LaTeX."""
    from osculate.vehicle.derivation import derive

    out.print(derive().latex(), soft_wrap=True)


def _print_metrics(result: "Run", title: str) -> None:
    from osculate.study.report import metric_rows

    print_rows(title, metric_rows(result.metrics))
    for done in result.interventions:
        out.print(shown(done), style="yellow")


if __name__ == "__main__":
    main()
