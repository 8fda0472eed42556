"""Where to go: one file per kind of curve behind one contract, and the table that kernels read."""

from typing import Annotated

from pydantic import Field

from osculate.curve.contract import Curve, CurvePoint
from osculate.curve.cycloid import Cycloid
from osculate.curve.parametric import Parametric
from osculate.curve.table import CurveTable, tabulate

AnyCurve = Annotated[Cycloid | Parametric, Field(discriminator="kind")]

__all__ = ["AnyCurve", "Curve", "CurvePoint", "CurveTable", "Cycloid", "Parametric", "tabulate"]
