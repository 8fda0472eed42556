"""Controllers compared on the same work, and tuned on other work."""

from osculate.study.comparison.compare import Comparison, compare
from osculate.study.comparison.significance import PairedComparison, paired_comparisons
from osculate.study.comparison.suite import (
    CONDITIONS,
    REALITY,
    STOPS,
    Condition,
    curves,
    starts,
    training_curves,
)
from osculate.study.comparison.tune import Tuning, quick_search, tune
from osculate.study.comparison.tuned import TUNED, trackers_for

__all__ = [
    "CONDITIONS",
    "REALITY",
    "STOPS",
    "TUNED",
    "Comparison",
    "Condition",
    "PairedComparison",
    "Tuning",
    "compare",
    "curves",
    "paired_comparisons",
    "quick_search",
    "starts",
    "trackers_for",
    "training_curves",
    "tune",
]
