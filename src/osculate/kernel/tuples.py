"""Arithmetic on (nested) named tuples of floats, in Python and compiled.

Kernels pass state, memory and parameters as named tuples. The functions here act on all their
leaves at once; the compiled twin emits one instruction per leaf, in the same order and with the
same rounding as the Python one.
"""

from collections.abc import Callable, Iterator
from functools import reduce
from itertools import repeat
from operator import add
from typing import Any, NamedTuple, TypeVar

from llvmlite import ir
from numba.core import types  # type: ignore[attr-defined]
from numba.extending import intrinsic

from osculate.kernel.decorator import compiled_twin

T = TypeVar("T")


class Nothing(NamedTuple):
    """Parameters or memory of a part that needs none."""

    zero: float = 0.0


def _make(kind: Any, items: list[Any]) -> Any:
    return kind._make(items) if hasattr(kind, "_make") else kind(items)


def leaves(value: Any) -> Iterator[Any]:
    """The floats of a nested tuple, depth first: the order in which lanes store them."""
    if isinstance(value, tuple):
        for item in value:
            yield from leaves(item)
    else:
        yield value


def names(value: Any, prefix: str = "") -> Iterator[str]:
    """Dotted field names of the leaves of a nested named tuple, in the order of `leaves`."""
    if isinstance(value, tuple):
        fields = getattr(value, "_fields", [str(n) for n in range(len(value))])
        for field, item in zip(fields, value, strict=True):
            yield from names(item, f"{prefix}.{field}" if prefix else field)
    else:
        yield prefix


def rebuild(like: T, values: Iterator[Any]) -> T:
    """A tuple shaped as ``like`` whose leaves are taken from ``values`` in order."""
    if isinstance(like, tuple):
        return _make(type(like), [rebuild(item, values) for item in like])
    return next(values)  # type: ignore[no-any-return]


def zeros(like: T) -> T:
    """A tuple shaped as ``like`` full of zeros."""
    return rebuild(like, repeat(0.0))


def axpy(scale: float, x: T, y: T) -> T:
    """``scale * x + y`` on every leaf."""
    if isinstance(y, tuple):
        return _make(type(y), [axpy(scale, a, b) for a, b in zip(x, y, strict=True)])  # type: ignore
    return scale * x + y  # type: ignore


def select(condition: bool, x: T, y: T) -> T:
    """``x`` where the condition holds, else ``y``, without a branch."""
    return x if condition else y


def finite_sum(value: Any) -> float:
    """Zero times the sum of all leaves: 0.0 when all are finite (and their sum is), else NaN."""
    total = 0.0
    for leaf in leaves(value):
        total = total + leaf
    return total * 0.0


def dot(x: Any, y: Any) -> float:
    """Sum of the products of all leaves of two tuples of the same shape, added in order."""
    pairs = zip(leaves(x), leaves(y), strict=True)
    return reduce(add, (a * b for a, b in pairs))  # `sum` adds with another rounding


def transpose(rows: T) -> T:
    """The square matrix whose rows are the columns of ``rows``, n tuples of n floats; types stay."""
    columns = zip(*rows, strict=True)  # type: ignore
    turned = [_make(type(row), column) for row, column in zip(rows, columns, strict=True)]  # type: ignore
    return _make(type(rows), turned)


def map_leaves(
    context: Any, builder: Any, kind: Any, items: list[Any], combine: Callable[..., Any]
) -> Any:
    """Emit ``combine`` for every leaf of the LLVM aggregates ``items`` of numba type ``kind``."""
    if isinstance(kind, types.BaseTuple):
        parts = [
            map_leaves(
                context, builder, part, [builder.extract_value(i, n) for i in items], combine
            )
            for n, part in enumerate(kind.types)
        ]
        return context.make_tuple(builder, kind, parts)
    return combine(*items)


@intrinsic  # type: ignore[untyped-decorator]
def _axpy(typingctx: Any, scale: Any, x: Any, y: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        factor, left, right = args
        factor = context.cast(builder, factor, scale, types.float64)
        return map_leaves(
            context,
            builder,
            y,
            [left, right],
            lambda a, b: builder.fadd(builder.fmul(factor, a), b),
        )

    return y(scale, x, y), emit


@compiled_twin(axpy)  # type: ignore[untyped-decorator]
def _compiled_axpy(scale: Any, x: Any, y: Any) -> Any:
    return lambda scale, x, y: _axpy(scale, x, y)


@intrinsic  # type: ignore[untyped-decorator]
def _select(typingctx: Any, condition: Any, x: Any, y: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        flag, left, right = args
        flag = context.cast(builder, flag, condition, types.boolean)
        if flag.type != ir.IntType(1):
            flag = builder.trunc(flag, ir.IntType(1))
        return map_leaves(
            context, builder, y, [left, right], lambda a, b: builder.select(flag, a, b)
        )

    return y(condition, y, y), emit


@compiled_twin(select)  # type: ignore[untyped-decorator]
def _compiled_select(condition: Any, x: Any, y: Any) -> Any:
    return lambda condition, x, y: _select(condition, x, y)


@intrinsic  # type: ignore[untyped-decorator]
def _finite_sum(typingctx: Any, value: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        total = [ir.Constant(ir.DoubleType(), 0.0)]
        zero = total[0]

        def add(leaf: Any) -> Any:
            total[0] = builder.fadd(total[0], leaf)
            return leaf

        map_leaves(context, builder, value, [args[0]], add)
        return builder.fmul(total[0], zero)

    return types.float64(value), emit


@compiled_twin(finite_sum)  # type: ignore[untyped-decorator]
def _compiled_finite_sum(value: Any) -> Any:
    return lambda value: _finite_sum(value)


def _flat(context: Any, builder: Any, kind: Any, item: Any) -> list[Any]:
    found: list[Any] = []

    def keep(leaf: Any) -> Any:
        found.append(leaf)
        return leaf

    map_leaves(context, builder, kind, [item], keep)
    return found


@intrinsic  # type: ignore[untyped-decorator]
def _dot(typingctx: Any, x: Any, y: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        left, right = (_flat(context, builder, k, i) for k, i in zip((x, y), args, strict=True))
        pairs = zip(left, right, strict=True)
        return reduce(builder.fadd, [builder.fmul(a, b) for a, b in pairs])

    return types.float64(x, y), emit


@compiled_twin(dot)  # type: ignore[untyped-decorator]
def _compiled_dot(x: Any, y: Any) -> Any:
    return lambda x, y: _dot(x, y)


@intrinsic  # type: ignore[untyped-decorator]
def _transpose(typingctx: Any, rows: Any) -> Any:
    if any(len(row) != len(rows) for row in rows.types):
        return None

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        turned = [
            context.make_tuple(
                builder, row, [builder.extract_value(args[0], [c, r]) for c in range(len(rows))]
            )
            for r, row in enumerate(rows.types)
        ]
        return context.make_tuple(builder, rows, turned)

    return rows(rows), emit


@compiled_twin(transpose)  # type: ignore[untyped-decorator]
def _compiled_transpose(rows: Any) -> Any:
    return lambda rows: _transpose(rows)
