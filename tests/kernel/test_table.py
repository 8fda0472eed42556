"""Uniform tables: exactness, order of convergence, and what happens outside."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate.kernel import Tables, read


def sine_table(cells, tables=None):
    tables = tables or Tables()
    x = np.linspace(1.0, 3.0, cells + 1)
    return tables, tables.add(np.stack([np.sin(x), np.cos(x)], axis=1), 1.0, 2.0 / cells)


@given(st.floats(1.0, 3.0))
def test_cubics_are_reproduced(x):
    tables = Tables()
    nodes = np.linspace(1.0, 3.0, 5)
    rows = np.stack([nodes**3 - nodes, 3 * nodes**2 - 1], axis=1)
    grid = tables.add(rows, 1.0, 0.5)
    value, slope = read(x, grid, tables.array)
    assert value == pytest.approx(x**3 - x, abs=1e-12)
    assert slope == pytest.approx(3 * x**2 - 1, abs=1e-11)


def test_the_error_falls_with_the_fourth_power():
    x = np.linspace(1.001, 2.999, 777)
    errors = []
    for cells in (8, 16, 32):
        tables, grid = sine_table(cells)
        errors.append(max(abs(read(v, grid, tables.array)[0] - np.sin(v)) for v in x))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 3.8).all()


def test_several_tables_share_one_array():
    tables = Tables()
    tables.add(np.full((7, 3), 9.0), 0.0, 1.0)
    tables, grid = sine_table(64, tables)
    assert read(2.0, grid, tables.array)[0] == pytest.approx(np.sin(2.0), abs=1e-8)


@pytest.mark.parametrize("x", [-np.inf, -5.0, 1.0, 3.0, 3.001, 1e9, np.inf, np.nan])
def test_no_argument_leaves_the_table(x):
    tables, grid = sine_table(16)
    value, _ = read(x, grid, tables.array)
    assert np.isfinite(value)
    if x <= 1.0:
        assert value == np.sin(1.0)
    if x in (3.0, 3.001):
        assert value == pytest.approx(np.sin(x), abs=1e-5)
