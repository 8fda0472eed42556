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
from osculate.control.tracking.nmpc import Nmpc
from osculate.control.tracking.speed_loop import SpeedLoop

AnyTracker = (
    CurvatureTracker | PreviewLqr | FeedforwardLqr | PurePursuit | Kanayama | Stanley | Nmpc
)

#: All compiled trackers by name, with their defaults.
TRACKERS: dict[str, PathTracker] = {
    law.kind: law
    for law in (
        CurvatureTracker(), PreviewLqr(), FeedforwardLqr(), PurePursuit(), Kanayama(), Stanley(),
    )
}  # fmt: skip

__all__ = [
    "TRACKERS",
    "AnyTracker",
    "CurvatureTracker",
    "FeedforwardLqr",
    "Kanayama",
    "Nmpc",
    "PathTracker",
    "PreviewLqr",
    "PurePursuit",
    "Road",
    "SpeedLoop",
    "Stanley",
]
