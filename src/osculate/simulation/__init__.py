"""Who calls whom, and when: the closed-loop step, single runs and batches."""

from osculate.simulation.batch import Batch, simulate_batch, variable_names
from osculate.simulation.clock import AnyClock, Clock, Continuous, Sampled
from osculate.simulation.loop import InitialState, Setup
from osculate.simulation.metrics import Metrics
from osculate.simulation.run import Run, simulate
from osculate.simulation.verdict import Verdict, VerdictKind

__all__ = [
    "AnyClock",
    "Batch",
    "Clock",
    "Continuous",
    "InitialState",
    "Metrics",
    "Run",
    "Sampled",
    "Setup",
    "Verdict",
    "VerdictKind",
    "simulate",
    "simulate_batch",
    "variable_names",
]
