"""Every number and statement of the paper, measured: statement, source, expected, measured, judgement."""

from osculate.study.paper.claims.claim import FAILS, HOLDS, Claim, Evidence
from osculate.study.paper.claims.control import control_claims
from osculate.study.paper.claims.curve import curve_claims
from osculate.study.paper.claims.figures import figure_claims
from osculate.study.paper.claims.model import model_claims
from osculate.study.paper.claims.targets import target_claims

__all__ = ["FAILS", "HOLDS", "Claim", "Evidence", "claims"]


def claims(evidence: Evidence) -> list[Claim]:
    """All claims, from the finished runs of `osculate.study.paper.cases` and their readings."""
    parts = (curve_claims, model_claims, control_claims, target_claims, figure_claims)
    return [claim for part in parts for claim in part(evidence)]
