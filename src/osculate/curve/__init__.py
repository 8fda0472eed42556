"""Where to go: one file per kind of curve behind one contract, and the table that kernels read."""

from typing import Annotated, Any

from pydantic import Field

from osculate.curve.composite import Composite, Laps, Part
from osculate.curve.contract import Curve, CurvePoint
from osculate.curve.cycloid import Cycloid
from osculate.curve.files import CurveFile, Reading, read_curve, read_file
from osculate.curve.nurbs import Nurbs
from osculate.curve.parametric import Parametric
from osculate.curve.segments import Arc, Chain, Clothoid, Line, Segment
from osculate.curve.spirals import Pose
from osculate.curve.spline import Spline
from osculate.curve.table import CurveTable, tabulate
from osculate.spec import Spec

AnyCurve = Annotated[
    Cycloid
    | Parametric
    | Line
    | Arc
    | Clothoid
    | Chain
    | Spline
    | Nurbs
    | CurveFile
    | Composite
    | Laps
    | Part,
    Field(discriminator="kind"),
]


class _Holder(Spec):
    curve: AnyCurve


def parse_curve(data: Any) -> Curve:
    """The curve that plain data such as a YAML file holds describe; ``kind`` says which one."""
    return _Holder(curve=data).curve


__all__ = [
    "AnyCurve",
    "Arc",
    "Chain",
    "Clothoid",
    "Composite",
    "Curve",
    "CurveFile",
    "CurvePoint",
    "CurveTable",
    "Cycloid",
    "Laps",
    "Line",
    "Nurbs",
    "Parametric",
    "Part",
    "Pose",
    "Reading",
    "Segment",
    "Spline",
    "parse_curve",
    "read_curve",
    "read_file",
    "tabulate",
]
