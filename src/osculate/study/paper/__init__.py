"""The paper, executable: its experiments, its figures, and a verdict on each of its statements."""

from osculate.study.paper.cases import CASES, Case, run_cases
from osculate.study.paper.claims import Claim, claims
from osculate.study.paper.reproduction import Reproduction, reproduce

__all__ = ["CASES", "Case", "Claim", "Reproduction", "claims", "reproduce", "run_cases"]
