"""Intervals that hold all values of a function between two arguments: what samples may have missed.

An interval is a pair of arrays (low, high). Bounds may be too wide, never too narrow but for rounding;
what cannot be bounded (a pole, a root of a negative number) is (−∞, ∞).
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Interval = tuple[Any, Any]
HALF_PI = 0.5 * np.pi


def add(a: Interval, b: Interval) -> Interval:
    """All a + b."""
    return _sound(a[0] + b[0], a[1] + b[1])


def negative(a: Interval) -> Interval:
    """All −a."""
    return -a[1], -a[0]


def multiply(a: Interval, b: Interval) -> Interval:
    """All a · b."""
    corners = [np.where((x == 0.0) | (y == 0.0), 0.0, x * y) for x in a for y in b]
    return _sound(np.minimum.reduce(corners), np.maximum.reduce(corners))


def reciprocal(a: Interval) -> Interval:
    """All 1 / a; unbounded where a may be 0."""
    over = (a[0] <= 0.0) & (a[1] >= 0.0)
    return _sound(np.where(over, -np.inf, 1.0 / a[1]), np.where(over, np.inf, 1.0 / a[0]))


def power(a: Interval, exponent: float) -> Interval:
    """All aᶜ for a number c."""
    if exponent < 0.0:
        return reciprocal(power(a, -exponent))
    low, high = np.power(a[0], exponent), np.power(a[1], exponent)
    if exponent % 2.0 == 0.0:
        over = (a[0] <= 0.0) & (a[1] >= 0.0) & (exponent > 0.0)
        return _sound(np.where(over, 0.0, np.minimum(low, high)), np.maximum(low, high))
    return _sound(low, high)


def _sound(low: Any, high: Any) -> Interval:
    """Unbounded where a bound is no number."""
    lost = np.isnan(low) | np.isnan(high)
    return np.where(lost, -np.inf, low), np.where(lost, np.inf, high)


def _rising(function: Callable[[Any], Any]) -> Callable[[Interval], Interval]:
    return lambda a: _sound(function(a[0]), function(a[1]))


def _even(function: Callable[[Any], Any]) -> Callable[[Interval], Interval]:
    """Of an even function that rises from 0 on."""

    def bounds(a: Interval) -> Interval:
        over = (a[0] <= 0.0) & (a[1] >= 0.0)
        sizes = np.abs(a[0]), np.abs(a[1])
        return _sound(
            function(np.where(over, 0.0, np.minimum(*sizes))), function(np.maximum(*sizes))
        )

    return bounds


def _passes(a: Interval, place: float, period: float) -> Any:
    """Whether place + n · period lies in the interval for some whole n."""
    return np.ceil((a[0] - place) / period) * period + place <= a[1]


def _sin(a: Interval) -> Interval:
    low, high = np.sin(a[0]), np.sin(a[1])
    return _sound(
        np.where(_passes(a, -HALF_PI, 4.0 * HALF_PI), -1.0, np.minimum(low, high)),
        np.where(_passes(a, HALF_PI, 4.0 * HALF_PI), 1.0, np.maximum(low, high)),
    )


def _cos(a: Interval) -> Interval:
    return _sin((a[0] + HALF_PI, a[1] + HALF_PI))


def _tan(a: Interval) -> Interval:
    pole = _passes(a, HALF_PI, np.pi)
    return _sound(np.where(pole, -np.inf, np.tan(a[0])), np.where(pole, np.inf, np.tan(a[1])))


def _plus_one(a: Interval) -> Interval:
    return 1.0 + a[0], 1.0 + a[1]


_cosh = _even(np.cosh)
_square = _even(np.square)
_log, _sqrt, _exp = _rising(np.log), _rising(np.sqrt), _rising(np.exp)
_sinh, _tanh, _atan = _rising(np.sinh), _rising(np.tanh), _rising(np.arctan)

#: Name -> (interval of the function, interval of its derivative).
FUNCTIONS: dict[str, tuple[Callable[[Interval], Interval], Callable[[Interval], Interval]]] = {
    "sin": (_sin, _cos),
    "cos": (_cos, lambda a: negative(_sin(a))),
    "tan": (_tan, lambda a: _plus_one(_square(_tan(a)))),
    "exp": (_exp, _exp),
    "log": (_log, reciprocal),
    "sqrt": (_sqrt, lambda a: multiply((0.5, 0.5), reciprocal(_sqrt(a)))),
    "sinh": (_sinh, _cosh),
    "cosh": (_cosh, _sinh),
    "tanh": (_tanh, lambda a: reciprocal(_square(_cosh(a)))),
    "atan": (_atan, lambda a: reciprocal(_plus_one(_square(a)))),
}


def enclose(
    programme: list[tuple[str, Any]], start: NDArray[np.float64], end: NDArray[np.float64]
) -> Interval:
    """What the first derivative of a formula's programme lies in, p from start to end, shape (n,)."""
    one, zero = (np.float64(1.0),) * 2, (np.float64(0.0),) * 2
    stack: list[tuple[Interval, Interval]] = []  # of value and derivative
    for kind, value in programme:
        if kind == "p":
            stack.append(((start, end), one))
        elif kind == "number":
            stack.append(((np.float64(value),) * 2, zero))
        elif kind == "call":
            outer, slope = FUNCTIONS[value]
            u, du = stack.pop()
            stack.append((outer(u), multiply(slope(u), du)))
        elif kind == "-u":
            u, du = stack.pop()
            stack.append((negative(u), negative(du)))
        else:
            right, left = stack.pop(), stack.pop()
            stack.append(_operation(kind, left, right))
    return stack[0][1]


def _operation(
    kind: str, left: tuple[Interval, Interval], right: tuple[Interval, Interval]
) -> tuple[Interval, Interval]:
    (u, du), (v, dv) = left, right
    if kind == "+":
        return add(u, v), add(du, dv)
    if kind == "-":
        return add(u, negative(v)), add(du, negative(dv))
    if kind == "*":
        product = add(multiply(du, v), multiply(u, dv))
        return multiply(u, v), product
    if kind == "/":
        inverse = reciprocal(v)
        slope = negative(multiply(dv, power(inverse, 2.0)))
        return _operation("*", left, (inverse, slope))
    if np.ndim(v[0]) == 0:  # an exponent without p
        slope = multiply((v[0], v[0]), power(u, float(v[0]) - 1.0))
        return power(u, float(v[0])), multiply(slope, du)
    outer, log_slope = FUNCTIONS["log"]
    logarithm = outer(u), multiply(log_slope(u), du)
    exponent, rate = _operation("*", right, logarithm)
    value = FUNCTIONS["exp"][0](exponent)
    return value, multiply(value, rate)
