"""What to command: one file per law."""

from osculate.control.contract import Controller, ControlPart, Errors, Start
from osculate.control.curvature import CurvatureLaw, SlidingMode, YawRegulator

__all__ = [
    "ControlPart",
    "Controller",
    "CurvatureLaw",
    "Errors",
    "SlidingMode",
    "Start",
    "YawRegulator",
]
