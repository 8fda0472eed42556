"""Running all of it and writing it down: claims, figures and a page that holds both."""

import base64
import html
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from osculate.errors import InvalidInput
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
        """
        from osculate.study.paper.figures import write_figures

        folder = Path(output)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            record = folder / "claims.json"
            content = strict_json([asdict(row) for row in self.rows], indent=2)
            record.write_text(content + "\n", encoding="utf-8")
            figures = write_figures(self.runs, folder, report)
            page = folder / "paper.html"
            page.write_text(self._page(figures), encoding="utf-8")
        except OSError as error:
            message = f"must be a writable folder ({error})"
            raise InvalidInput("output", str(folder), message) from None
        return [page, record, *figures]

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
