"""The page of a reproduction: one file that holds everything, readable without a network."""

import base64
import html
from pathlib import Path
from typing import TYPE_CHECKING

from osculate.study.paper.cases import CASES
from osculate.study.paper.claims import FAILS, HOLDS, Claim
from osculate.study.paper.errata import ERRATA
from osculate.study.paper.measures import rms
from osculate.study.paper.provenance import provenance
from osculate.study.paper.readings import ORIGIN_WORDS, SIGN_WORDS, Reading, SquareSum

if TYPE_CHECKING:
    from osculate.study.paper.reproduction import Reproduction

CAPTIONS = {
    "figure1": "Figure 1: the robot. The speed of P lies along the front wheel; across OP it is aθ̇.",
    "figure2": "Figure 2: the task. The text says neither where it starts nor how wide the obstacle is.",
    "figure3": "Figure 3: the modified target. Above with plus signs in d₁, below with minus.",
    "figure4": "Figure 4: the static target. Above with plus signs in d₁, below with minus.",
    "figure5": "Figure 5: unstable yaw errors, d₁₁. Above with plus signs, below with minus.",
    "figure6": "Figure 6: the disturbance d₁₂. Above on the law's heading, below on the robot's.",
    "figure7": "Figure 7: steering angle and torques under d₁₂. The spike of φ at t = 0: the robot stands, "
    "d₁₂ pushes its yaw rate by cos 0 = 1 rad/s² at once, and φ = arctan(aθ̇/v) is large until v has grown.",
}


def page(made: "Reproduction", figures: list[Path]) -> str:
    """The page as HTML; the figures are written into it."""
    evidence = made.evidence
    cases = "\n".join(
        _row(
            [
                CASES[name].meaning,
                f"{rms(run):.3g} m",
                f"{made.halved[name]:.3g} m",
                run.verdict.sentence,
            ]
        )
        for name, run in evidence.runs.items()
    )
    return _PAGE.format(
        claims="\n".join(_claim_row(row) for row in made.rows),
        cases=cases,
        readings="\n".join(_reading_row(row) for row in evidence.readings),
        sums="\n".join(_sum_row(row) for row in evidence.square_sums),
        errata="\n".join(
            f'<li id="erratum-{n}">{html.escape(text)}</li>' for n, text in enumerate(ERRATA, 1)
        ),
        made="\n".join(_row([k, str(v)]) for k, v in provenance(made.interpretation).items()),
        pictures="\n".join(_picture(path) for path in figures),
    )


def _picture(path: Path) -> str:
    caption = html.escape(CAPTIONS[path.stem])
    data = base64.b64encode(path.read_bytes()).decode()
    return (
        f'<figure><img alt="{caption}" src="data:image/png;base64,{data}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _claim_row(row: Claim) -> str:
    kind = {HOLDS: "good", FAILS: "bad"}.get(row.judgement, "partly")
    note = html.escape(row.note)
    if row.erratum is not None:
        note += f' <a href="#erratum-{row.erratum}">Erratum {row.erratum}</a>'
    small = f"<small>{note.strip()}</small>" if note.strip() else ""
    cells = [row.statement, row.source, row.expected_text, row.measured_text, row.criterion]
    return _row(cells, f'<td class="{kind}">{html.escape(row.judgement)}{small}</td>', row.id)


def _reading_row(row: Reading) -> str:
    lost = "never" if row.lost is None else f"{row.lost:.3f} s"
    cells = [
        f"Figure {row.figure}", SIGN_WORDS[row.sign], ORIGIN_WORDS[row.origin],
        f"{row.speed_error:.3g}", f"{row.growth:.3g} 1/s", f"{row.off:.3g} m", lost,
        "yes" if row.premise else "no", "yes" if row.conclusion else "no",
    ]  # fmt: skip
    kind = "good" if row.agrees else "bad"
    return _row(cells, f'<td class="{kind}">{"agrees" if row.agrees else "does not agree"}</td>')


def _sum_row(row: SquareSum) -> str:
    return _row([
        ORIGIN_WORDS[row.origin], {"stop": "stops", "continue": "goes on to 20 s"}[row.after_end],
        row.constants, f"{row.end:.3f} s", f"{row.on_path:.4g} m²", f"{row.whole:.4g} m²",
        f"{row.whole_halved:.4g} m²", f"{1e3 * (row.whole / row.samples) ** 0.5:.3g} mm",
    ])  # fmt: skip


def _row(cells: list[str], last: str = "", anchor: str = "") -> str:
    inner = "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
    return f'<tr id="{anchor}">{inner}{last}</tr>' if anchor else f"<tr>{inner}{last}</tr>"


_PAGE = Path(__file__).with_name("paper.html").read_text(encoding="utf-8")
