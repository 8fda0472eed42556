"""What a run shows: scenarios, figures, reports, and the paper's claims."""

from osculate.study.scenario import Scenario, built_in

__all__ = ["Scenario", "built_in"]
