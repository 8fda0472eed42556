"""Curves from files: one module a format, one record of what was understood, one front door."""

from osculate.curve.files.curve_file import CurveFile, read_curve
from osculate.curve.files.reading import Reading, read_file

__all__ = ["CurveFile", "Reading", "read_curve", "read_file"]
