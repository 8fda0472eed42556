"""Controllers compared on the same work, and tuned on other work."""

from osculate.study.comparison.compare import Comparison, compare
from osculate.study.comparison.suite import CONDITIONS, Condition, curves, starts, training_curves
from osculate.study.comparison.tune import Tuning, tune

__all__ = [
    "CONDITIONS",
    "Comparison",
    "Condition",
    "Tuning",
    "compare",
    "curves",
    "starts",
    "training_curves",
    "tune",
]
