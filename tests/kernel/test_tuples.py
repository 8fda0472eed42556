"""Arithmetic on nested named tuples and their way into lanes and back."""

from typing import NamedTuple

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate.kernel import (
    axpy,
    dot,
    finite_sum,
    leaves,
    load,
    lookup,
    names,
    rebuild,
    scratch,
    select,
    store,
    transpose,
)
from uncompiled import run_uncompiled

numbers = st.floats(-1e9, 1e9)


class Inner(NamedTuple):
    a: float
    b: float


class Outer(NamedTuple):
    inner: Inner
    pair: tuple[Inner, Inner]
    c: float


LIKE = Outer(Inner(0.0, 0.0), (Inner(0.0, 0.0), Inner(0.0, 0.0)), 0.0)
outers = st.lists(numbers, min_size=7, max_size=7).map(lambda v: rebuild(LIKE, iter(v)))


@numba.njit
def compiled_axpy(scale, x, y):
    return axpy(scale, x, y)


@numba.njit
def compiled_select(condition, x, y):
    return select(condition, x, y)


@numba.njit
def compiled_finite(x):
    return finite_sum(x)


def test_names_and_leaves_go_together():
    assert list(names(LIKE)) == [
        "inner.a",
        "inner.b",
        "pair.0.a",
        "pair.0.b",
        "pair.1.a",
        "pair.1.b",
        "c",
    ]
    value = rebuild(LIKE, iter(map(float, range(7))))
    assert list(leaves(value)) == list(range(7))
    assert isinstance(value.pair[1], Inner)


@given(numbers, outers, outers)
def test_compiled_axpy_rounds_like_python(scale, x, y):
    expected = axpy(scale, x, y)
    assert compiled_axpy(scale, x, y) == expected
    assert list(leaves(expected)) == [
        scale * a + b for a, b in zip(leaves(x), leaves(y), strict=True)
    ]


@given(st.booleans(), outers, outers)
def test_select_takes_one_side(condition, x, y):
    assert compiled_select(condition, x, y) == (x if condition else y) == select(condition, x, y)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("leaf", range(7))
def test_finite_sum_notices_any_leaf(bad, leaf):
    good = rebuild(LIKE, iter(map(float, range(7))))
    assert finite_sum(good) == compiled_finite(good) == 0.0
    values = [1.0] * 7
    values[leaf] = bad
    assert np.isnan(finite_sum(rebuild(LIKE, iter(values))))
    assert np.isnan(compiled_finite(rebuild(LIKE, iter(values))))


@numba.njit
def compiled_dot(x, y):
    return dot(x, y)


@numba.njit
def compiled_transpose(rows):
    return transpose(rows)


@given(outers, outers)
def test_compiled_dot_rounds_like_python(x, y):
    products = [a * b for a, b in zip(leaves(x), leaves(y), strict=True)]
    expected = products[0]
    for product in products[1:]:
        expected += product
    assert compiled_dot(x, y) == dot(x, y) == expected
    assert dot(x, y) == dot(y, x)
    scale = sum(map(abs, products))
    assert dot(x, y) == pytest.approx(np.dot([*leaves(x)], [*leaves(y)]), abs=1e-15 * scale)


@given(outers)
def test_dot_begins_with_the_first_product(x):
    signed = rebuild(LIKE, iter([-0.0] * 7))
    ones = rebuild(LIKE, iter([1.0] * 7))
    assert str(dot(signed, ones)) == str(compiled_dot(signed, ones)) == "-0.0"
    assert dot(x, x) >= 0.0


@pytest.mark.parametrize("function", [dot, compiled_dot])
def test_dot_takes_tuples_of_one_shape_only(function):
    for x, y in [((1.0, 2.0), (1.0,)), ((1.0,), (1.0, 2.0))]:
        with pytest.raises(ValueError, match="argument 2 is"):
            function(x, y)


class Row(NamedTuple):
    x: float
    y: float
    z: float


class Square(NamedTuple):
    x: Row
    y: Row
    z: tuple[float, float, float]


squares = st.lists(numbers, min_size=9, max_size=9).map(
    lambda v: Square(Row(*v[:3]), Row(*v[3:6]), tuple(v[6:]))
)
unnamed = squares.map(lambda m: tuple(map(tuple, m)))


@given(squares | unnamed)
def test_transpose_swaps_rows_and_columns_and_keeps_the_types(rows):
    expected = np.array(rows).T.tolist()
    for turned in (transpose(rows), compiled_transpose(rows)):
        assert np.array(turned).tolist() == expected
        assert type(turned) is type(rows)
        assert [type(row) for row in turned] == [type(row) for row in rows]
    assert transpose(transpose(rows)) == compiled_transpose(compiled_transpose(rows)) == rows


@given(squares)
def test_rows_of_one_named_type_transpose_too(rows):
    same = Square(rows.x, rows.y, Row(*rows.z))
    turned = compiled_transpose(same)
    assert turned == transpose(same)
    assert isinstance(turned, Square)
    assert all(isinstance(row, Row) for row in turned)


def test_only_square_matrices_are_transposed():
    with pytest.raises(ValueError, match="argument 2 is"):
        transpose(((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)))
    with pytest.raises(numba.core.errors.TypingError):
        compiled_transpose(((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)))


def test_uncompiled_dot_and_transpose_give_the_same_bits():
    code = """
        from osculate.kernel import dot, transpose
        rows = ((0.1, 0.2), (0.3, 0.7))
        print(dot(rows, transpose(rows)).hex(), transpose(rows))
    """
    rows = ((0.1, 0.2), (0.3, 0.7))
    turned = compiled_transpose(rows)
    assert run_uncompiled(code).strip() == f"{compiled_dot(rows, turned).hex()} {turned}"


def through_lanes(like, block):
    own = scratch(like, 4)
    for lane in range(4):
        store(load(like, block, lane), own, lane)
    for lane in range(4):
        store(axpy(2.0, load(like, own, lane), load(like, own, 3 - lane)), block, lane)


def test_lanes_keep_their_values_apart():
    block = np.arange(28.0).reshape(7, 4)
    expected = 2.0 * block + block[:, ::-1]
    python, compiled = block.copy(), block.copy()
    through_lanes(LIKE, python)
    numba.njit(through_lanes)(LIKE, compiled)
    assert (python == expected).all()
    assert (compiled == expected).all()


def test_lookup_reads_the_table():
    table = np.arange(5.0)
    assert numba.njit(lambda t, n: lookup(t, n))(table, np.int32(3)) == lookup(table, 3) == 3.0
