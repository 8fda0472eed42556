"""Any smooth curve (x(p), y(p)): given as formulas, or as Python functions."""

from collections.abc import Callable
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator, model_validator
from pydantic.json_schema import SkipJsonSchema

from osculate.curve.arclength import ArcLength
from osculate.curve.formula import Formula
from osculate.curve.pieces import Pieces, nodes_of
from osculate.curve.sampled import Sampled
from osculate.errors import InvalidInput, NoSolution
from osculate.spec import quantity

Array = NDArray[np.float64]

DEGREE = 20  # of the Chebyshev polynomials that stand in for Python functions
TOLERANCE = 1e-13  # relative size of the last coefficients of a resolved function
MOST_PIECES = 1024


class Parametric(Sampled):
    """A curve (x(p), y(p)) for p from ``start`` to ``end``.

    Formulas are strings in ``p``: ``"3 * cos(p)"``, with + - * / ** and the functions listed in
    `osculate.curve.formula`; their derivatives are exact. Python functions of one float are replaced by
    piecewise Chebyshev polynomials that agree to rounding, whose derivatives are then exact.

    Raises:
        InvalidInput: A formula that cannot be read, a curve that stops, turns back, jumps or has a pole
            (says where), a loop whose end does not continue into its start.
        NoSolution: A function too rough to be resolved: it must be smooth.
    """

    kind: Literal["parametric"] = "parametric"
    x: str | SkipJsonSchema[Callable[[float], float]] = quantity(
        "m", "x(p), a formula in p or a function"
    )
    y: str | SkipJsonSchema[Callable[[float], float]] = quantity(
        "m", "y(p), a formula in p or a function"
    )
    start: float = quantity("1", "first parameter", default=0.0)
    end: float = quantity("1", "last parameter", default=1.0)
    loop: bool = quantity("1", "whether its end continues into its start", default=False)

    @property
    def closed(self) -> bool:
        """See `Curve.closed`."""
        return self.loop

    @model_validator(mode="after")
    def _forward(self) -> "Parametric":
        if not self.end > self.start:
            raise InvalidInput("end", self.end, f"must be greater than start = {self.start:g}")
        return self

    @field_validator("x", "y")
    @classmethod
    def _readable(cls, given: Any) -> Any:
        if isinstance(given, str):
            Formula("", given)
        return given

    @cached_property
    def _arc(self) -> ArcLength:
        x, y = (self._component(name) for name in ("x", "y"))
        inner = [part.breaks for part in (x, y) if isinstance(part, Pieces)]
        breaks = np.unique(np.concatenate([[self.start, self.end], *inner]))

        def derivative(p: Array, order: int) -> Array:
            return np.stack([x(p, order), y(p, order)], axis=-1)

        def enclosure(start: Array, end: Array) -> tuple[Array, Array]:
            bounds = [part.enclose(start, end) for part in (x, y)]
            low, high = zip(*bounds, strict=True)
            return np.stack(low, axis=-1), np.stack(high, axis=-1)

        formulas = isinstance(x, Formula) and isinstance(y, Formula)
        arc = ArcLength(derivative, breaks, enclosure=enclosure if formulas else None)
        if self.loop:
            self._require_closed(arc)
        return arc

    @staticmethod
    def _require_closed(arc: ArcLength) -> None:
        ends = arc.at(np.array([0.0, arc.length]))
        x, y, heading, curvature, _ = (float(np.diff(column)[0]) for column in ends)
        turn = abs(heading - 2.0 * np.pi * round(heading / (2.0 * np.pi)))
        jumps = (
            (np.hypot(x, y), 1e-6 * arc.length, f"ends {np.hypot(x, y):.4g} m from its start"),
            (turn, 1e-6, f"has a corner of {np.degrees(turn):.4g}° where it closes"),
            (
                abs(curvature),
                1e-4,
                f"has a jump of curvature of {curvature:.4g} 1/m where it closes",
            ),
        )
        for jump, most, what in jumps:
            if jump > most:
                raise InvalidInput("loop", True, f"the curve {what}; must continue into its start")

    def _component(self, name: str) -> Any:
        given = getattr(self, name)
        if isinstance(given, str):
            return Formula(name, given)
        return _resolve(name, given, self.start, self.end)


def _resolve(name: str, function: Callable[[float], float], start: float, end: float) -> Pieces:
    """Cut [start, end] into ever more pieces until every piece's polynomial has converged."""
    pieces = 4
    while pieces <= MOST_PIECES:
        breaks = np.linspace(start, end, pieces + 1)
        nodes, transform = nodes_of(breaks, DEGREE)
        values = _sample(name, function, nodes)
        coefficients = values @ transform.T
        tail = np.abs(coefficients[:, -3:]).max()
        if tail <= TOLERANCE * max(np.abs(values).max(), 1e-300):
            return Pieces(breaks, coefficients)
        pieces *= 2
    raise NoSolution(
        f"{name}(p) is too rough: {MOST_PIECES} polynomials of degree {DEGREE} do not resolve it; "
        "it must be smooth (give kinks as a composite of pieces)"
    )


def _sample(name: str, function: Callable[[float], float], p: Array) -> Array:
    values = np.array([[float(function(float(q))) for q in row] for row in p])
    if not np.isfinite(values).all():
        where = float(p[~np.isfinite(values)][0])
        raise InvalidInput(name, f"not finite at p = {where:.6g}", "must be finite everywhere")
    return values
