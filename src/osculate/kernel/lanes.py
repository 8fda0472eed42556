"""Named tuples in lanes: a block of runs side by side, one array row per leaf.

A block is a 2-D array ``block[leaf, lane]``. `load` gathers one lane into a named tuple, `store`
puts it back. `scratch` makes a block on the stack of the compiled function: the compiler then knows
that nothing else points into it, which is what lets it vectorise a lane loop that also reads tables.
"""

from collections.abc import Iterator
from itertools import count
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types  # type: ignore[attr-defined]
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array
from numpy.typing import NDArray

from osculate.kernel.decorator import compiled_twin
from osculate.kernel.tuples import leaves, map_leaves, rebuild

T = TypeVar("T")
Block = NDArray[np.float64]


def scratch(like: Any, lanes: int) -> Block:
    """An uninitialised block for ``lanes`` tuples shaped as ``like``; ``lanes`` is a constant."""
    return np.empty((sum(1 for _ in leaves(like)), lanes))


def load(like: T, block: Block, lane: int) -> T:
    """The tuple in column ``lane``, shaped as ``like``."""
    return rebuild(like, iter(block[:, lane].tolist()))


def store(value: Any, block: Block, lane: int) -> None:
    """Write the leaves of ``value`` into column ``lane``."""
    for row, leaf in enumerate(leaves(value)):
        block[row, lane] = leaf


def lookup(table: NDArray[np.float64], index: int) -> float:
    """``table[index]`` for an index known to be in range; compiled without any check."""
    return float(table[index])


def _kinds(kind: Any) -> Iterator[Any]:
    if isinstance(kind, types.BaseTuple):
        for part in kind.types:
            yield from _kinds(part)
    else:
        yield kind


def _pointer(context: Any, builder: Any, kind: Any, array: Any, row: int, lane: Any) -> Any:
    struct = context.make_array(kind)(context, builder, array)
    columns = cgutils.unpack_tuple(builder, struct.shape)[1]
    offset = builder.add(builder.mul(ir.Constant(columns.type, row), columns), lane)
    return builder.gep(struct.data, [offset])


@intrinsic(prefer_literal=True)  # type: ignore[untyped-decorator]
def _scratch(typingctx: Any, like: Any, lanes: Any) -> Any:
    if not isinstance(lanes, types.IntegerLiteral):
        return None
    rows, columns = len(list(_kinds(like))), lanes.literal_value
    block = types.Array(types.float64, 2, "C")

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        space = cgutils.alloca_once(builder, ir.ArrayType(ir.DoubleType(), rows * columns))
        size = context.get_constant
        array = context.make_array(block)(context, builder)
        populate_array(
            array,
            data=builder.bitcast(space, array.data.type),
            shape=[size(types.intp, rows), size(types.intp, columns)],
            strides=[size(types.intp, 8 * columns), size(types.intp, 8)],
            itemsize=size(types.intp, 8),
            meminfo=None,
        )
        return array._getvalue()  # noqa: SLF001 (llvmlite's struct proxies have no public way)

    return block(like, lanes), emit


@compiled_twin(scratch)  # type: ignore[untyped-decorator]
def _compiled_scratch(like: Any, lanes: Any) -> Any:
    if not isinstance(lanes, types.IntegerLiteral):
        return None
    constant = lanes.literal_value
    return lambda like, lanes: _scratch(like, constant)


@intrinsic  # type: ignore[untyped-decorator]
def _load(typingctx: Any, like: Any, block: Any, lane: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        shape, array, column = args
        column = context.cast(builder, column, lane, types.intp)
        rows = count()
        return map_leaves(
            context,
            builder,
            like,
            [shape],
            lambda _: builder.load(_pointer(context, builder, block, array, next(rows), column)),
        )

    return like(like, block, lane), emit


@compiled_twin(load)  # type: ignore[untyped-decorator]
def _compiled_load(like: Any, block: Any, lane: Any) -> Any:
    return lambda like, block, lane: _load(like, block, lane)


@intrinsic  # type: ignore[untyped-decorator]
def _store(typingctx: Any, value: Any, block: Any, lane: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        item, array, column = args
        column = context.cast(builder, column, lane, types.intp)
        rows = count()
        map_leaves(
            context,
            builder,
            value,
            [item],
            lambda leaf: (
                builder.store(leaf, _pointer(context, builder, block, array, next(rows), column))
                and leaf
            ),
        )
        return context.get_dummy_value()

    return types.void(value, block, lane), emit


@compiled_twin(store)  # type: ignore[untyped-decorator]
def _compiled_store(value: Any, block: Any, lane: Any) -> Any:
    return lambda value, block, lane: _store(value, block, lane)


@intrinsic  # type: ignore[untyped-decorator]
def _lookup(typingctx: Any, table: Any, index: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        array, position = args
        position = context.cast(builder, position, index, types.intp)
        struct = context.make_array(table)(context, builder, array)
        return builder.load(builder.gep(struct.data, [position]))

    return types.float64(table, index), emit


@compiled_twin(lookup)  # type: ignore[untyped-decorator]
def _compiled_lookup(table: Any, index: Any) -> Any:
    return lambda table, index: _lookup(table, index)
