"""The NURBS of VDA 5050, with the norm's defaults: degree 1, knots uniform and clamped, weights 1."""

from collections.abc import Mapping
from typing import Any

from osculate.curve.files.found import refuse
from osculate.curve.files.numbers import number
from osculate.curve.nurbs import Nurbs
from osculate.errors import InvalidInput

LONG = 200  # characters of a message: longer ones repeat all points


def nurbs(trajectory: Mapping[str, Any], label: str, scale: float) -> Nurbs:
    """The NURBS of a trajectory, with the norm's defaults.

    Raises:
        InvalidInput: A value that is no number, a degree that is not whole, or what `Nurbs` refuses.
    """
    control = trajectory.get("controlPoints")
    if not isinstance(control, list) or len(control) < 2:
        raise refuse(label, "its trajectory needs at least two controlPoints")
    if not isinstance(trajectory.get("knotVector", []), (list, type(None))):
        raise refuse(label, "its knotVector must be a list of numbers")
    try:
        points, weights = zip(*(_control(point, n) for n, point in enumerate(control)), strict=True)
        degree = _degree(trajectory.get("degree"), len(points))
        knots = _knots(trajectory.get("knotVector"), len(points), degree)
    except ValueError as error:
        raise refuse(label, f"its trajectory cannot be read: {error}") from None
    scaled = tuple((scale * x, scale * y) for x, y in points)
    try:
        return Nurbs(degree=degree, knots=tuple(knots), points=scaled, weights=weights)
    except ValueError as error:
        said = str(error)
        if len(said) > LONG and isinstance(error, InvalidInput):
            said = f"{error.field} {error.valid}"
        raise refuse(label, f"its trajectory: {said}") from None


def _knots(given: Any, count: int, degree: int) -> list[float]:
    if given is None or given == []:
        return clamped(count, degree)
    knots = []
    for n, knot in enumerate(given):
        try:
            knots.append(number(knot))
        except ValueError as error:
            raise ValueError(f"knot {n} {error}") from None
    return knots


def _control(point: Any, n: int) -> tuple[tuple[float, float], float]:
    if not isinstance(point, Mapping) or "x" not in point or "y" not in point:
        raise ValueError(f"control point {n} needs x and y")
    values = []
    for key in ("x", "y", "weight"):
        try:
            values.append(number(point.get(key, 1.0)))
        except ValueError as error:
            raise ValueError(f"{key} of control point {n} {error}") from None
    return (values[0], values[1]), values[2]


def _degree(given: Any, count: int) -> int:
    try:
        degree = 1.0 if given is None else number(given)
    except ValueError as error:
        raise ValueError(f"its degree {error}") from None
    if degree != int(degree):
        raise ValueError(f"its degree is {degree:g}, must be a whole number")
    if not 1 <= degree < count:
        raise ValueError(f"its degree is {degree:g}, must be from 1 to {count - 1} (points − 1)")
    return int(degree)


def clamped(count: int, degree: int) -> list[float]:
    """Uniform knots that are clamped at both ends, for ``count`` control points."""
    spans = count - degree
    return [0.0] * degree + [n / spans for n in range(spans + 1)] + [1.0] * degree
