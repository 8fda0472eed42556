"""Formulas in p: read without ever running them, evaluated with their exact derivatives.

A formula becomes a short programme in postfix order. It is run on truncated Taylor series (value and
up to three derivatives, arrays over p), so that a derivative costs what a value costs and nothing is
ever expanded: ``9**9**9`` is a number that is not finite, not a number of 400 million digits.
"""

import ast
import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.curve.interval import Interval, enclose
from osculate.errors import InvalidInput

Array = NDArray[np.float64]
Function = Callable[[Any], Any]
Series = list[Any]  # Taylor coefficients f⁽ᵏ⁾ / k!, numbers or arrays over p

LONGEST = 2000  # characters
CHUNK = 1 << 14  # parameters at a time, for the memory's sake
CONSTANTS = {"pi": math.pi, "E": math.e}


def _power(exponent: float) -> tuple[Function, ...]:
    """Of uᶜ; the derivatives of a polynomial vanish beyond its degree."""
    factors = np.cumprod([1.0, exponent, exponent - 1.0, exponent - 2.0])

    def derivative(k: int) -> Function:
        if factors[k] == 0.0:
            return np.zeros_like
        return lambda u: factors[k] * np.power(u, exponent - k)

    return tuple(derivative(k) for k in range(4))


def _sech2(u: Any) -> Any:
    return 1.0 / np.cosh(u) ** 2


def _lorentz(u: Any) -> Any:
    return 1.0 / (1.0 + u * u)


def _sec2(u: Any) -> Any:
    return 1.0 + np.tan(u) ** 2


#: Name -> the function and its first three derivatives.
FUNCTIONS: dict[str, tuple[Function, ...]] = {
    "sin": (np.sin, np.cos, lambda u: -np.sin(u), lambda u: -np.cos(u)),
    "cos": (np.cos, lambda u: -np.sin(u), lambda u: -np.cos(u), np.sin),
    "tan": (
        np.tan,
        _sec2,
        lambda u: 2.0 * np.tan(u) * _sec2(u),
        lambda u: 2.0 * _sec2(u) * (3.0 * _sec2(u) - 2.0),
    ),
    "exp": (np.exp,) * 4,
    "log": (np.log, *_power(-1.0)[:3]),
    "sqrt": _power(0.5),
    "sinh": (np.sinh, np.cosh, np.sinh, np.cosh),
    "cosh": (np.cosh, np.sinh, np.cosh, np.sinh),
    "tanh": (
        np.tanh,
        _sech2,
        lambda u: -2.0 * np.tanh(u) * _sech2(u),
        lambda u: 2.0 * _sech2(u) * (2.0 - 3.0 * _sech2(u)),
    ),
    "atan": (
        np.arctan,
        _lorentz,
        lambda u: -2.0 * u * _lorentz(u) ** 2,
        lambda u: (6.0 * u * u - 2.0) * _lorentz(u) ** 3,
    ),
}
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
VALID = (
    "must be a formula in p with + - * / ** and "
    f"{', '.join(sorted([*FUNCTIONS, *CONSTANTS]))}"
)  # fmt: skip


class Formula:
    """A formula in p with its first three derivatives.

    Args:
        name: Of the field that holds it, for errors.
        text: The formula; ``^`` is read as ``**``.

    Raises:
        InvalidInput: It is not arithmetic on p, numbers and the known functions.
    """

    def __init__(self, name: str, text: str) -> None:
        self._programme = _compile(name, text)

    def __call__(self, p: Array, order: int) -> Array:
        """The derivative of an order 0…3 at the parameters, shape (n,)."""
        values = np.empty(len(p))
        with np.errstate(all="ignore"):
            for n in range(0, len(p), CHUNK):
                series = self._series(p[n : n + CHUNK], order)
                values[n : n + CHUNK] = series[order] * math.factorial(order)
        return values

    def enclose(self, start: Array, end: Array) -> Interval:
        """Bounds of the first derivative between two parameters, shape (n,) each."""
        with np.errstate(all="ignore"):
            low, high = enclose(self._programme, start, end)
        return np.broadcast_to(low, start.shape), np.broadcast_to(high, start.shape)

    def _series(self, p: Array, order: int) -> Series:
        stack: list[Series] = []
        for kind, value in self._programme:
            if kind == "p":
                stack.append([p, 1.0, 0.0, 0.0][: order + 1])
            elif kind == "number":
                stack.append([np.float64(value), 0.0, 0.0, 0.0][: order + 1])
            elif kind == "call":
                stack.append(_compose(FUNCTIONS[value], stack.pop()))
            elif kind == "-u":
                stack.append([-part for part in stack.pop()])
            else:
                right, left = stack.pop(), stack.pop()
                stack.append(_combine(kind, left, right))
        return stack[0]


def _compose(outer: tuple[Function, ...], u: Series) -> Series:
    """The series of f(u) from f and its derivatives (Faà di Bruno); for u = p most of it vanishes."""
    f = [derivative(u[0]) for derivative in outer[: len(u)]]
    if all(np.ndim(part) == 0 and part == 0.0 for part in u[2:]):
        return [part * u[1] ** k / math.factorial(k) if k else part for k, part in enumerate(f)]
    second = f[1] * u[2] + f[2] * u[1] ** 2 / 2.0
    series = [f[0], f[1] * u[1], second]
    if len(u) > 3:
        series.append(f[1] * u[3] + f[2] * u[1] * u[2] + f[3] * u[1] ** 3 / 6.0)
    return series


def _combine(kind: str, left: Series, right: Series) -> Series:
    if kind == "+":
        return [a + b for a, b in zip(left, right, strict=True)]
    if kind == "-":
        return [a - b for a, b in zip(left, right, strict=True)]
    if kind == "*":
        return [sum(left[j] * right[k - j] for j in range(k + 1)) for k in range(len(left))]
    if kind == "/":
        return _combine("*", left, _compose(_power(-1.0), right))
    if np.ndim(right[0]) == 0:  # an exponent without p
        return _compose(_power(float(right[0])), left)
    logarithm = _compose(FUNCTIONS["log"], left)  # uᵛ = exp(v log u)
    exponent = _combine("*", right, logarithm)
    return _compose(FUNCTIONS["exp"], exponent)


def _compile(name: str, text: str) -> list[tuple[str, Any]]:
    """The postfix programme of a formula."""
    tree = _parse(name, text)
    programme: list[tuple[str, Any]] = []
    waiting: list[Any] = [tree.body]  # nodes to visit, and instructions to put out after them
    while waiting:
        node = waiting.pop()
        if isinstance(node, tuple):
            programme.append(node)
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            programme.append(("number", _number(node.value)))  # type: ignore[arg-type]
        elif isinstance(node, ast.Name) and node.id in CONSTANTS:
            programme.append(("number", CONSTANTS[node.id]))
        elif isinstance(node, ast.Name) and node.id == "p":
            programme.append(("p", None))
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            waiting += [("-u", None), node.operand]
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd):
            waiting.append(node.operand)
        elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            waiting += [(OPERATORS[type(node.op)], None), node.right, node.left]
        elif isinstance(node, ast.Call) and _is_known(node):
            waiting += [("call", node.func.id), node.args[0]]  # type: ignore[attr-defined]
        else:
            raise InvalidInput(name, _short(text), VALID)
    return programme


def _is_known(node: ast.Call) -> bool:
    named = isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS
    plain = len(node.args) == 1 and not node.keywords
    return named and plain and not isinstance(node.args[0], ast.Starred)


def _number(value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _parse(name: str, text: str) -> ast.Expression:
    if len(text) > LONGEST:
        raise InvalidInput(
            name, _short(text), f"must be at most {LONGEST} characters; it has {len(text)}"
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text.strip().replace("^", "**"), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InvalidInput(name, _short(text), VALID) from None


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}..."
