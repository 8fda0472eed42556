"""The paper, executable: its experiments, its figures, and a judgement on each of its statements."""

from osculate.study.paper.cases import CASES, Case, Interpretation, run_cases
from osculate.study.paper.claims import Claim, Evidence, claims
from osculate.study.paper.readings import matrix_of_readings, square_sums
from osculate.study.paper.reproduction import Reproduction, reproduce

__all__ = [
    "CASES",
    "Case",
    "Claim",
    "Evidence",
    "Interpretation",
    "Reproduction",
    "claims",
    "matrix_of_readings",
    "reproduce",
    "run_cases",
    "square_sums",
]
