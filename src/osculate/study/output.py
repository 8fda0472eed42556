"""Everything that a run leaves behind in a folder."""

from collections.abc import Callable, Iterable
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from osculate.errors import InvalidInput, NotWritten
from osculate.files import write_by, write_text
from osculate.folder import OutputFolder
from osculate.simulation.metrics import Metrics
from osculate.strict_json import strict_json

if TYPE_CHECKING:
    from osculate.simulation import Run, Verdict
    from osculate.study.scenario import Scenario


Tell = Callable[[float], None]
FILM = 20.0  # times the work that another file is


class _File(NamedTuple):
    """One file of a run."""

    path: Path
    write: Callable[[Path, Tell], object]
    effort: float = 1.0


def write_output(
    run: "Run",
    output: Path | None,
    scenario: "Scenario",
    animate: bool = False,
    report: Tell | None = None,
    also: Iterable[Path] = (),
) -> list[Path]:
    """Write ``report.html``, ``metrics.json``, ``run.nc``, ``scenario.json``, PNGs, and an animation.

    The folder is complete or says what is missing (`OutputFolder`). Data come first, then pictures, then
    films: what fails late loses nothing that was written before.

    Args:
        run: The run.
        output: Folder; made if missing. None: only ``also``.
        scenario: What was run, for the title and for ``scenario.json``.
        animate: Also write ``animation.gif``.
        report: Called with the fraction that is written.
        also: Other files of the run, as `Run.save` writes them.

    Returns:
        The files written, the report first.

    Raises:
        InvalidInput: The folder cannot be made or written.
        NotWritten: Some of the files could not be written; the others are there.
    """
    files = _files_of(run, output, scenario, animate) if output else []
    files += [_File(Path(path), partial(_save, run)) for path in also]
    files = [file._replace(effort=FILM) if _is_film(file.path) else file for file in files]
    files.sort(key=lambda file: (file.effort, file.path.suffix in (".html", ".png")))
    failed: dict[str, Exception] = {}
    try:
        names = [file.path.name for file in files if output and _lies_in(file.path, output)]
        with OutputFolder(output, "run", names) if output else nullcontext() as folder:
            written = _write_all(files, folder, report or (lambda fraction: None), failed)
    except InvalidInput:  # no folder, but what belongs elsewhere is written
        rest = [file for file in files if output and not _lies_in(file.path, output)]
        _write_all(rest, None, lambda fraction: None, failed)
        raise
    except NotWritten as error:
        raise NotWritten(error.place, {**error.missing, **failed}) from error
    if failed:
        raise NotWritten("what was asked for", failed) from next(iter(failed.values()))
    return sorted(written, key=lambda path: path.name != "report.html")


def _write_all(
    files: list[_File], folder: OutputFolder | None, tell: Tell, failed: dict[str, Exception]
) -> list[Path]:
    """Write what can be written: into the folder if it belongs there, else each file alone."""
    done, whole, written = 0.0, sum(file.effort for file in files), []
    for path, write, effort in files:
        writer = _told(write, tell, done / whole, effort / whole)
        if folder is not None and _lies_in(path, folder.path):
            folder.write(path.name, writer)
        else:
            try:
                written.append(write_by(writer, path))
            except Exception as error:  # whatever it is, the other files are wanted all the more
                failed[str(path)] = error
        done += effort
        tell(done / whole)
    return [*written, *(folder.written if folder else ())]


def _told(
    write: Callable[[Path, Tell], object], tell: Tell, before: float, share: float
) -> Callable[[Path], object]:
    """A writer whose progress is a share of the whole."""
    return lambda path: write(path, lambda part: tell(before + part * share))


def _files_of(run: "Run", output: Path, scenario: "Scenario", animate: bool) -> list[_File]:
    """The files of the folder."""
    from osculate.study.figures import figure_writers, write_animation
    from osculate.study.report import write_report

    title, description = scenario.name, scenario.description
    files: dict[str, Callable[[Path, Tell], object]] = {
        "scenario.json": lambda path, tell: _write_scenario(scenario, path),
        "metrics.json": lambda path, tell: _write_metrics(run, path),
        "run.nc": partial(_save, run),
        "report.html": lambda path, tell: write_report(run, path, title, description),
    }
    if animate:
        files["animation.gif"] = lambda path, tell: write_animation(run, path, tell)
    for name, write in figure_writers(run).items():
        files[name] = partial(_untold, write)
    return [_File(output / name, write) for name, write in files.items()]


def _untold(write: Callable[[Path], object], path: Path, tell: Tell) -> None:
    write(path)


def _lies_in(path: Path, folder: Path) -> bool:
    return path.parent.resolve() == folder.resolve()


def _is_film(path: Path) -> bool:
    return path.suffix in (".mp4", ".gif")


def _save(run: "Run", path: Path, tell: Tell) -> None:
    from osculate.simulation.recording import write_video

    if _is_film(path):
        write_video(run, path, report=tell)
    else:
        run.save(path)


def write_refusal(verdict: "Verdict", output: Path, scenario: "Scenario") -> Path:
    """Write ``report.html``, ``metrics.json`` and ``scenario.json`` where the robot cannot drive.

    They take the place of an earlier run's files: the folder is complete or says what is missing.

    Returns:
        The report.

    Raises:
        InvalidInput: The folder cannot be made or written.
        NotWritten: Some of the files could not be written; the others are there.
    """
    from osculate.study.report import write_refusal_report

    content = strict_json({"verdict": verdict.as_dict()}, indent=2) + "\n"
    files: dict[str, Callable[[Path], object]] = {
        "scenario.json": partial(_write_scenario, scenario),
        "metrics.json": lambda path: write_text(path, content),
        "report.html": partial(write_refusal_report, verdict, scenario),
    }
    with OutputFolder(output, "run", files) as folder:
        for name, write in files.items():
            folder.write(name, write)
    return output / "report.html"


def _write_metrics(run: "Run", path: Path) -> Path:
    values = run.metrics.as_dict()
    units = {name: unit for name, unit, _ in Metrics.items()}
    content = {"verdict": run.verdict.as_dict(), **values, "units": units}
    return write_text(path, strict_json(content, indent=2) + "\n")


def _write_scenario(scenario: "Scenario", path: Path) -> Path:
    fields = scenario.model_dump(mode="json")
    return write_text(path, strict_json(fields, indent=2) + "\n")
