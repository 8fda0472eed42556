"""What to command: one file per law."""

from osculate.control.contract import Controller, ControlPart, Errors, Start
from osculate.control.curvature import CurvatureLaw, SlidingMode, YawRegulator
from osculate.control.tracking import (
    CurvatureTracker,
    FeedforwardLqr,
    Kanayama,
    Nmpc,
    PathTracker,
    PreviewLqr,
    PurePursuit,
    SpeedLoop,
    Stanley,
    Stepper,
)

__all__ = [
    "ControlPart",
    "Controller",
    "CurvatureLaw",
    "CurvatureTracker",
    "Errors",
    "FeedforwardLqr",
    "Kanayama",
    "Nmpc",
    "PathTracker",
    "PreviewLqr",
    "PurePursuit",
    "SlidingMode",
    "SpeedLoop",
    "Stanley",
    "Start",
    "Stepper",
    "YawRegulator",
]
