"""What to command: one file per law."""

from osculate.control.contract import Controller, ControlPart, Errors, Start
from osculate.control.curvature import CurvatureLaw, SlidingMode, YawRegulator
from osculate.control.estimation.ekf import Ekf
from osculate.control.safety import Safety
from osculate.control.stepper import Stepper
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
)

__all__ = [
    "ControlPart",
    "Controller",
    "CurvatureLaw",
    "CurvatureTracker",
    "Ekf",
    "Errors",
    "FeedforwardLqr",
    "Kanayama",
    "Nmpc",
    "PathTracker",
    "PreviewLqr",
    "PurePursuit",
    "Safety",
    "SlidingMode",
    "SpeedLoop",
    "Stanley",
    "Start",
    "Stepper",
    "YawRegulator",
]
