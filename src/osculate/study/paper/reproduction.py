"""Running all of it and writing it down: claims, figures and a page that holds both."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from osculate.files import write_text
from osculate.folder import OutputFolder
from osculate.strict_json import strict_json
from osculate.study.paper.cases import AS_MEANT, CURVE, ROBOT, STEP, Interpretation, run_cases
from osculate.study.paper.claims import Claim, Evidence, claims
from osculate.study.paper.measures import rms
from osculate.study.paper.page import page
from osculate.study.paper.provenance import provenance
from osculate.study.paper.readings import matrix_of_readings, square_sums
from osculate.vehicle import derivation


@dataclass(frozen=True)
class Reproduction:
    """The paper's experiments and what they say about its statements.

    Attributes:
        interpretation: What was chosen where the text leaves something open.
        evidence: Curve, robot, runs and readings.
        halved: √(J_a/N) (m) of every experiment with half the step.
        rows: The statements, judged.
    """

    interpretation: Interpretation
    evidence: Evidence
    halved: dict[str, float]
    rows: list[Claim]

    def write(
        self, output: str | Path, report: Callable[[float], None] | None = None
    ) -> list[Path]:
        """Write ``claims.json``, ``figure1.png`` … ``figure7.png`` and ``paper.html``.

        Args:
            output: Folder; made if missing.
            report: Called with the fraction that is written.

        Raises:
            InvalidInput: The folder cannot be made or written.
            NotWritten: Some of the files could not be written; the others are there.
        """
        from osculate.study.paper.figures import write_figures

        record = self._record()
        with OutputFolder(output, "reproduction") as folder:
            folder.write("claims.json", lambda path: write_text(path, record + "\n"))
            figures = write_figures(self.evidence.runs, folder, report)
            folder.write("paper.html", lambda path: write_text(path, page(self, figures)))
        return sorted(folder.written, key=lambda path: path.name != "paper.html")

    def _record(self) -> str:
        runs = self.evidence.runs
        content = {
            "provenance": provenance(self.interpretation),
            "claims": [asdict(row) for row in self.rows],
            "experiments": [
                {
                    "name": name, "rms": rms(run), "rms_half_step": self.halved[name],
                    "ending": run.verdict.sentence,
                }
                for name, run in runs.items()
            ],
            "readings": [row._asdict() for row in self.evidence.readings],
            "square_sums": [row._asdict() for row in self.evidence.square_sums],
        }  # fmt: skip
        return strict_json(content, indent=2)


def reproduce(
    interpretation: Interpretation = AS_MEANT,
    report: Callable[[float], None] | None = None,
) -> Reproduction:
    """Run every experiment of the paper, with h and h/2, and judge every statement.

    Args:
        interpretation: What the text leaves open: θ̂(0), and what happens after s = l.
        report: Called with the fraction that is done.
    """

    def part(begin: float, end: float) -> Callable[[float], None] | None:
        return (lambda done: report(begin + (end - begin) * done)) if report else None

    runs = run_cases(interpretation, STEP, part(0.0, 0.3))
    finer = run_cases(interpretation, STEP / 2.0, part(0.3, 0.7))
    halved = {name: rms(run) for name, run in finer.items()}
    readings = matrix_of_readings(part(0.7, 0.8))
    sums = square_sums(part(0.8, 0.9))
    evidence = Evidence(CURVE, ROBOT, derivation.derive(), runs, readings, sums)
    rows = claims(evidence)
    if report:
        report(1.0)
    return Reproduction(interpretation, evidence, halved, rows)
