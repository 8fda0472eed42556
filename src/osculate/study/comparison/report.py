"""The comparison as a page: ranking, all cells, one figure per curve."""

import base64
import html
import math
import re
from collections.abc import Iterable
from functools import partial
from itertools import chain, count
from pathlib import Path
from typing import Any

import numpy as np

from osculate.files import write_text
from osculate.folder import OutputFolder
from osculate.simulation import VerdictKind
from osculate.simulation.plot import new_figure, unmarked
from osculate.study.comparison.compare import Comparison
from osculate.study.comparison.significance import condition_table, paired_comparisons, summary

OURS = "curvature-tracker"
MEANING = (
    "Mean RMS of the cross-track error in mm over the runs that arrived. + means significantly more than "
    f"{OURS}, − less, = what cannot be told apart (paired, 95 % confidence). All controllers have the same "
    "speed loop, estimator and random numbers."
)
LONGEST_NAME = 60  # characters of the name of a figure's file
COLOURS = ("#1f5fa8", "#d9730d", "#2e8b57", "#b3261e", "#7b4fa3", "#5b6470", "#b08900", "#0f8a8a")


def write_figures(comparison: Comparison, folder: OutputFolder) -> list[Path]:
    """One PNG per curve: the curve, and the error of all controllers over arc length.

    No curve's name makes a name that a run or a reproduction in the same folder has.
    """
    names = _file_names(comparison.curves)
    paths = [
        folder.write(f"comparison-{names[name]}.png", partial(_write_figure, comparison, name))
        for name in comparison.curves
    ]
    return [path for path in paths if path is not None]


def _file_names(curves: Iterable[str]) -> dict[str, str]:
    """A file name for every curve: without what has a meaning in paths, and each only once."""
    names: dict[str, str] = {}
    for curve in curves:
        plain = re.sub(r"[^\w.+-]", "_", curve)[:LONGEST_NAME].strip(".") or "curve"
        used = {name.lower() for name in names.values()}
        candidates = chain([plain], (f"{plain}-{n}" for n in count(2)))
        names[curve] = next(name for name in candidates if name.lower() not in used)
    return names


def _write_figure(comparison: Comparison, name: str, path: Path) -> None:
    curve = comparison.curves[name]
    keys = [key for key in comparison.traces if key[1] == name]
    _, start, kind = keys[0][2:]
    speeds = sorted({key[2] for key in keys}, key=float)
    speed = speeds[len(speeds) // 2]
    figure, axes = new_figure(11.0, 3.8, [["path", "error", "error"]])
    point = curve.at(np.linspace(0.0, curve.length, 801))
    axes["path"].plot(point.x, point.y, color="#5b6470", linewidth=3.0, alpha=0.4)
    lines = {}
    for colour, law in zip(COLOURS, comparison.controllers, strict=False):
        trace = comparison.traces[(law, name, speed, start, kind)]
        axes["path"].plot(trace.x, trace.y, color=colour, linewidth=0.9)
        error = np.maximum(1e3 * np.abs(trace.cross_track), 1e-5)
        (lines[law],) = axes["error"].semilogy(trace.arc_length, error, color=colour, linewidth=1.1)
    title = f"{unmarked(name)}, up to {speed} m/s"
    axes["path"].set_aspect("equal", adjustable="datalim")
    axes["path"].set(xlabel="x (m)", ylabel="y (m)", title=title)
    axes["error"].set(
        xlabel="arc length (m)",
        ylabel="|cross-track error| (mm)",
        title=unmarked(f"start {start}, {kind}"),
    )
    axes["error"].legend(
        lines.values(), map(unmarked, lines),
        loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize="small",
    )  # fmt: skip
    figure.subplots_adjust(right=0.84, wspace=0.3)
    figure.savefig(path)


def ranking_table(comparison: Comparison) -> list[list[str]]:
    """Rows of the ranking, the header first."""
    rows = [
        ["controller", "mean RMS (mm)", "worst max (mm)", "failures", "× the first", "better in"]
    ]
    for place, s in enumerate(comparison.ranking()):
        rows.append(
            [
                s.controller,
                _known(1e3 * s.cross_track_rms, ".4g"),
                _known(1e3 * s.cross_track_max, ".4g"),
                str(s.failures),
                "1" if place == 0 else _known(s.ratio, ".3g"),
                "–" if place == 0 else f"{s.wins} of {s.cells} cells",
            ]
        )
    return rows


def cell_table(comparison: Comparison) -> list[list[str]]:
    """Rows of all cells, the header first."""
    rows = [
        [
            "controller", "curve", "speed (m/s)", "start", "plant", "seed", "RMS (mm)", "max (mm)",
            "heading RMS (°)", "time (s)", "steering (rad)", "torque ripple (N m)", "work (J)", "verdict",
        ]
    ]  # fmt: skip
    return rows + [_cell_row(cell) for cell in comparison.cells]


def _cell_row(c: dict[str, Any]) -> list[str]:
    return [
        c["controller"], c["curve"], f"{c['speed']:g}", c["start"], c["plant"], str(c["seed"]),
        _known(1e3 * c["cross_track_rms"], ".4g"), _known(1e3 * c["cross_track_max"], ".4g"),
        _known(np.degrees(c["heading_error_rms"]), ".3g"), f"{c['duration']:.2f}",
        f"{c['steering_travel']:.2f}", f"{c['torque_travel']:.1f}", f"{c['energy']:.0f}",
        verdict_text(c),
    ]  # fmt: skip


def _known(value: float, form: str) -> str:
    """A number, or a dash for one that is not known."""
    return "–" if math.isnan(value) else format(value, form)


def verdict_text(cell: dict[str, Any]) -> str:
    """The verdict on a cell: the kind, and unless it reached the end a sign, when and where."""
    if cell["verdict"] == VerdictKind.REACHED:
        return str(cell["verdict"])
    place, time = cell["verdict_place"], cell["verdict_time"]
    return f"✗ {cell['verdict']} at {time:.2f} s, {place:.2f} m"


def write_page(comparison: Comparison, path: Path, figures: list[Path]) -> Path:
    """Write the self-contained page."""
    pictures = "\n".join(
        f'<img alt="{html.escape(f.stem)}" src="data:image/png;base64,'
        f'{base64.b64encode(f.read_bytes()).decode()}">'
        for f in figures
    )
    page = _PAGE.format(
        kind="good" if comparison.reached else "bad",
        verdict=html.escape(f"{'✓' if comparison.reached else '✗'} {comparison.verdict}."),
        ranking=_table(ranking_table(comparison)),
        significance=_significance(comparison),
        cells=_table(cell_table(comparison)),
        pictures=pictures,
    )
    return write_text(path, page)


def _significance(comparison: Comparison) -> str:
    """The tracker of this package against the others, condition by condition."""
    kinds = {cell["plant"] for cell in comparison.cells}
    if OURS not in comparison.controllers or len(comparison.controllers) < 2 or len(kinds) < 2:
        return ""
    found = paired_comparisons(comparison, OURS)
    items = "".join(f"<li>{html.escape(pair.sentence)}</li>" for pair in found)
    return (
        f"<h2>Under every condition</h2><p>{html.escape(MEANING)}</p>"
        f'<div class="wide">{_table(condition_table(comparison, OURS))}</div>'
        f"<p>{html.escape(summary(found))}</p><ul>{items}</ul>"
    )


def _table(rows: list[list[str]]) -> str:
    head, *body = rows
    return f"<table>{_row(head, 'th')}{''.join(_row(row, 'td') for row in body)}</table>"


def _row(cells: list[str], tag: str) -> str:
    written = (f"<{tag}{_kind(cell)}>{html.escape(cell)}</{tag}>" for cell in cells)
    return f"<tr>{''.join(written)}</tr>"


def _kind(cell: str) -> str:
    return ' class="bad"' if cell.startswith("✗") else ""


_PAGE = Path(__file__).with_name("comparison.html").read_text(encoding="utf-8")
