"""Arithmetic on nested named tuples and their way into lanes and back."""

from typing import NamedTuple

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate.kernel import (
    axpy,
    finite_sum,
    leaves,
    load,
    lookup,
    names,
    rebuild,
    scratch,
    select,
    store,
)

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
