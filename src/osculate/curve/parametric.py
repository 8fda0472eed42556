"""Any smooth curve (x(p), y(p)): given as formulas, or as Python functions."""

import ast
from collections.abc import Callable
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray
from pydantic import model_validator
from pydantic.json_schema import SkipJsonSchema

from osculate.curve.arclength import ArcLength, Derivative
from osculate.curve.contract import Curve, CurvePoint
from osculate.errors import InvalidInput, NoSolution
from osculate.spec import quantity

Array = NDArray[np.float64]

DEGREE = 20  # of the Chebyshev polynomials that stand in for Python functions
TOLERANCE = 1e-13  # relative size of the last coefficients of a resolved function
MOST_PIECES = 1024

FUNCTIONS = {"sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "atan"}
CONSTANTS = {"pi", "E"}
ALLOWED = (
    ast.Expression,
    ast.BinOp,
    ast.UnaryOp,
    ast.Call,
    ast.operator,
    ast.unaryop,
    ast.expr_context,
)


class Parametric(Curve):
    """A curve (x(p), y(p)) for p from ``start`` to ``end``.

    Formulas are strings in ``p`` (``"3 * cos(p)"``, anything SymPy reads); their derivatives are
    exact. Python functions of one float are replaced by piecewise Chebyshev polynomials that agree to
    rounding, whose derivatives are then exact.

    Raises:
        InvalidInput: A formula that cannot be read, or a curve that stops (r' = 0).
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

    @cached_property
    def _arc(self) -> ArcLength:
        x, y = (self._component(name) for name in ("x", "y"))
        breaks = np.union1d(x.breaks, y.breaks)

        def derivative(p: Array, order: int) -> Array:
            return np.stack([x(p, order), y(p, order)], axis=-1)

        return ArcLength(derivative, breaks)

    def _component(self, name: str) -> Any:
        given = getattr(self, name)
        if isinstance(given, str):
            return _Formula(name, given, self.start, self.end)
        return _resolve(name, given, self.start, self.end)

    @property
    def length(self) -> float:
        """See `Curve.length`."""
        return self._arc.length

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """See `Curve.at`."""
        return self._arc.at(arc_length)


class _Formula:
    """A formula in p and its derivatives, by SymPy."""

    def __init__(self, name: str, text: str, start: float, end: float) -> None:
        import sympy

        self.breaks = np.array([start, end])
        _require_formula(name, text)
        p = sympy.Symbol("p", real=True)
        formula = sympy.sympify(text, locals={"p": p})
        self._functions = [sympy.lambdify(p, formula.diff(p, n), "numpy") for n in range(4)]

    def __call__(self, p: Array, order: int) -> Array:
        return np.broadcast_to(np.asarray(self._functions[order](p), dtype=float), p.shape)


def _require_formula(name: str, text: str) -> None:
    """Accept nothing but arithmetic on p, numbers and known functions: formulas come from files."""
    valid = f"must be a formula in p with + - * / ** and {', '.join(sorted(FUNCTIONS | CONSTANTS))}"
    try:
        tree = ast.parse(text, mode="eval")
    except (SyntaxError, ValueError):
        raise InvalidInput(name, text, valid) from None
    called = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            known = FUNCTIONS if id(node) in called else CONSTANTS | {"p"}
            if node.id in known:
                continue
        elif isinstance(node, ast.Constant):
            if type(node.value) in (int, float):
                continue
        elif isinstance(node, ALLOWED):
            continue
        raise InvalidInput(name, text, valid)


class _Pieces:
    """Piecewise Chebyshev polynomials and their derivatives."""

    def __init__(self, breaks: Array, coefficients: Array) -> None:
        self.breaks = breaks
        half = 0.5 * np.diff(breaks)
        self._orders: list[Any] = [coefficients]
        for _ in range(3):
            self._orders.append(chebyshev.chebder(self._orders[-1], axis=1) / half[:, None])

    def __call__(self, p: Array, order: int) -> Array:
        piece = np.clip(np.searchsorted(self.breaks, p, side="right") - 1, 0, len(self.breaks) - 2)
        a, b = self.breaks[piece], self.breaks[piece + 1]
        local = (2.0 * p - a - b) / (b - a)
        values: Array = chebyshev.chebval(local, self._orders[order][piece].T, tensor=False)
        return values


def _resolve(name: str, function: Callable[[float], float], start: float, end: float) -> _Pieces:
    """Cut [start, end] into ever more pieces until every piece's polynomial has converged."""
    nodes = chebyshev.chebpts1(DEGREE + 1)
    transform = np.linalg.inv(chebyshev.chebvander(nodes, DEGREE))
    pieces = 4
    while pieces <= MOST_PIECES:
        breaks = np.linspace(start, end, pieces + 1)
        middle, half = 0.5 * (breaks[1:] + breaks[:-1]), 0.5 * np.diff(breaks)
        values = _sample(name, function, middle[:, None] + half[:, None] * nodes)
        coefficients = values @ transform.T
        tail = np.abs(coefficients[:, -3:]).max()
        if tail <= TOLERANCE * max(np.abs(values).max(), 1e-300):
            return _Pieces(breaks, coefficients)
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


__all__ = ["Derivative", "Parametric"]
