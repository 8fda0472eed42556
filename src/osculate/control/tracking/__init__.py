"""Laws that know the pose: the curvature tracker, and what people use today to compare it with."""

from osculate.control.tracking.baselines import (
    FeedforwardLqr,
    Kanayama,
    PreviewLqr,
    PurePursuit,
    Stanley,
)
from osculate.control.tracking.contract import PathTracker, Road
from osculate.control.tracking.curvature_tracker import CurvatureTracker
from osculate.control.tracking.speed_loop import SpeedLoop

__all__ = [
    "CurvatureTracker",
    "FeedforwardLqr",
    "Kanayama",
    "PathTracker",
    "PreviewLqr",
    "PurePursuit",
    "Road",
    "SpeedLoop",
    "Stanley",
]
