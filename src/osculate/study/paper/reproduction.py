"""Running all of it and writing it down: claims, figures and a page that holds both."""

import base64
import html
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from osculate.files import write_text
from osculate.folder import OutputFolder
from osculate.strict_json import strict_json
from osculate.study.paper.cases import CASES, rms, run_cases
from osculate.study.paper.claims import HOLDS, Claim, Runs, claims

CAPTIONS = {
    "figure3": "Figure 3: the modified target. Above with plus signs in d₁, below with minus.",
    "figure4": "Figure 4: the static target. Above with plus signs in d₁, below with minus.",
    "figure5": "Figure 5: unstable yaw errors, d₁₁. Above with plus signs, below with minus.",
    "figure6": "Figure 6: the disturbance d₁₂. Above on the law's heading, below on the robot's.",
    "figure7": "Figure 7: steering angle and torques under d₁₂.",
}


@dataclass(frozen=True)
class Reproduction:
    """The paper's experiments and what they say about its statements."""

    runs: Runs
    rows: list[Claim]

    def write(
        self, output: str | Path, report: Callable[[float], None] | None = None
    ) -> list[Path]:
        """Write ``claims.json``, ``figure3.png`` … ``figure7.png`` and ``paper.html``.

        Args:
            output: Folder; made if missing.
            report: Called with the fraction that is written.

        Raises:
            InvalidInput: The folder cannot be made or written.
            NotWritten: Some of the files could not be written; the others are there.
        """
        from osculate.study.paper.figures import write_figures

        claims = strict_json([asdict(row) for row in self.rows], indent=2)
        with OutputFolder(output, "reproduction") as folder:
            folder.write("claims.json", lambda path: write_text(path, claims + "\n"))
            figures = write_figures(self.runs, folder, report)
            folder.write("paper.html", lambda path: write_text(path, self._page(figures)))
        return sorted(folder.written, key=lambda path: path.name != "paper.html")

    def _page(self, figures: list[Path]) -> str:
        claims = "\n".join(_claim_row(row) for row in self.rows)
        cases = "\n".join(
            _row([case.meaning, f"{rms(self.runs[name]):.3g} m", self.runs[name].message])
            for name, case in CASES.items()
        )
        pictures = "\n".join(
            f'<figure><img alt="{html.escape(CAPTIONS[path.stem])}" '
            f'src="data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}">'
            f"<figcaption>{html.escape(CAPTIONS[path.stem])}</figcaption></figure>"
            for path in figures
        )
        return _PAGE.format(claims=claims, cases=cases, pictures=pictures)


def reproduce(report: Callable[[float], None] | None = None) -> Reproduction:
    """Run every experiment of the paper and judge every statement."""
    runs = run_cases(report)
    return Reproduction(runs, claims(runs))


def _claim_row(row: Claim) -> str:
    kind = "good" if row.verdict == HOLDS else "bad" if row.verdict == "does not hold" else "partly"
    cells = [row.statement, row.source, row.expected_text, row.measured_text]
    note = f"<small>{html.escape(row.note)}</small>" if row.note else ""
    return _row(cells, f'<td class="{kind}">{html.escape(row.verdict)}{note}</td>', row.id)


def _row(cells: list[str], last: str = "", anchor: str = "") -> str:
    inner = "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
    return f'<tr id="{anchor}">{inner}{last}</tr>' if anchor else f"<tr>{inner}{last}</tr>"


_PAGE = Path(__file__).with_name("paper.html").read_text(encoding="utf-8")
