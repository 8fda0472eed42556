"""Everything that a run leaves behind in a folder."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from osculate.errors import InvalidInput
from osculate.simulation.metrics import Metrics
from osculate.strict_json import strict_json

if TYPE_CHECKING:
    from osculate.simulation import Run, Verdict
    from osculate.study.scenario import Scenario


def write_output(
    run: "Run",
    output: Path,
    scenario: "Scenario",
    animate: bool = False,
    report: Callable[[float], None] | None = None,
) -> list[Path]:
    """Write ``report.html``, ``metrics.json``, ``run.nc``, ``scenario.json``, PNGs, and an animation.

    Args:
        run: The run.
        output: Folder; made if missing.
        scenario: What was run, for the title and for ``scenario.json``.
        animate: Also write ``animation.gif``.
        report: Called with the fraction that is written.

    Returns:
        The files written, the report first.

    Raises:
        InvalidInput: The folder cannot be made or written.
    """
    from osculate.study.figures import write_animation, write_figures
    from osculate.study.report import write_report

    tell = report or (lambda fraction: None)
    try:
        output.mkdir(parents=True, exist_ok=True)
        files = [
            write_report(run, output / "report.html", scenario.name, scenario.description),
            _write_metrics(run, output / "metrics.json"),
            run.save(output / "run.nc"),
            _write_scenario(scenario, output / "scenario.json"),
        ]
        tell(0.2)
        files += write_figures(run, output)
        tell(0.4 if animate else 1.0)
        if animate:
            gif = output / "animation.gif"
            files.append(write_animation(run, gif, lambda f: tell(0.4 + 0.6 * f)))
    except OSError as error:
        raise InvalidInput("output", str(output), f"must be a writable folder ({error})") from None
    return files


def write_refusal(verdict: "Verdict", output: Path, scenario: "Scenario") -> Path:
    """Write ``report.html`` and ``metrics.json`` of a scenario that the robot cannot drive.

    Returns:
        The report.

    Raises:
        InvalidInput: The folder cannot be made or written.
    """
    from osculate.study.report import write_refusal_report

    try:
        output.mkdir(parents=True, exist_ok=True)
        content = strict_json({"verdict": verdict.as_dict()}, indent=2)
        (output / "metrics.json").write_text(content + "\n", encoding="utf-8")
        _write_scenario(scenario, output / "scenario.json")
        return write_refusal_report(verdict, scenario, output / "report.html")
    except OSError as error:
        raise InvalidInput("output", str(output), f"must be a writable folder ({error})") from None


def _write_metrics(run: "Run", path: Path) -> Path:
    values = run.metrics.as_dict()
    units = {name: unit for name, unit, _ in Metrics.items()}
    content = {"verdict": run.verdict.as_dict(), **values, "units": units}
    path.write_text(strict_json(content, indent=2) + "\n", encoding="utf-8")
    return path


def _write_scenario(scenario: "Scenario", path: Path) -> Path:
    fields = scenario.model_dump(mode="json")
    path.write_text(strict_json(fields, indent=2) + "\n", encoding="utf-8")
    return path
