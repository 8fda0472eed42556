"""Uniform tables with exact slopes: how kernels read curves, profiles and previews.

All tables of a run live one behind the other in one 1-D array, ``tables``; a `Grid` says where one of
them starts and how it is spaced. Between two rows a value follows the cubic that matches value and
slope at both (Hermite), so a table with step h errs by h⁴/384 max|f⁗|. Before its start a table holds the
first value; after its end the last cell's cubic is continued, at most `MARGIN` cells far.
"""

from collections.abc import Callable, Hashable
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from osculate.kernel.decorator import kernel
from osculate.kernel.lanes import lookup

T = TypeVar("T")

MARGIN = 2.0  # cells that a table may be read beyond its end


class Grid(NamedTuple):
    """Where a uniform table lies and how its argument is spaced."""

    offset: float  # index of the first number in ``tables``
    start: float  # argument of the first row
    step: float  # distance of the rows in the argument
    density: float  # rows per unit of the argument, 1 / step
    last: float  # index of the last cell (rows - 2)


class Tables:
    """Collects the tables of a run into the one array that its kernels read."""

    def __init__(self) -> None:
        self._parts: list[NDArray[np.float64]] = []
        self._size = 0
        self._made: dict[Hashable, Any] = {}
        self._array: NDArray[np.float64] | None = None

    def add(self, rows: ArrayLike, start: float, step: float) -> Grid:
        """Append a table of shape (rows, columns), rows ``step`` apart from argument ``start``."""
        part = np.ascontiguousarray(rows, dtype=np.float64)
        grid = Grid(float(self._size), start, step, 1.0 / step, float(part.shape[0] - 2))
        self._parts.append(part.ravel())
        self._size += part.size
        self._array = None
        return grid

    def once(self, key: Hashable, make: Callable[[], T]) -> T:
        """What ``make`` returns, made once for every key: runs that share tables share these."""
        if key not in self._made:
            self._made[key] = make()
        value: T = self._made[key]
        return value

    @property
    def array(self) -> NDArray[np.float64]:
        """All tables, shape (n,)."""
        if self._array is None:
            self._array = np.concatenate([*self._parts, np.zeros(1)])
        return self._array


@kernel
def locate(x: float, grid: Grid, columns: int) -> Any:
    """Index in ``tables`` of the row at or before ``x``, and the fraction of the cell beyond it.

    The branch around the division stays a branch until the lane loop is vectorised. It must: without
    it LLVM keeps whatever an address depends on scalar on processors without a fast gather, and in
    a closed loop that is everything. A NaN takes the other way, so that no index leaves the table.
    """
    u = 0.0
    cell = np.int32(0)
    if x > grid.start:
        u = (x - grid.start) * grid.density
        cell = np.int32(u if u < grid.last else grid.last)
    fraction = u - float(cell)
    fraction = fraction if fraction < 1.0 + MARGIN else 1.0 + MARGIN
    return np.int32(grid.offset) + cell * np.int32(columns), fraction


@kernel
def hermite(
    f: float, grid: Grid, value0: float, slope0: float, value1: float, slope1: float
) -> Any:
    """The cubic through value and slope at both ends of a cell, and its slope, at fraction ``f``."""
    rise = value1 - value0
    first = slope0 * grid.step
    last = slope1 * grid.step
    b = 3.0 * rise - 2.0 * first - last
    c = first + last - 2.0 * rise
    value = value0 + f * (first + f * (b + f * c))
    slope = (first + f * (2.0 * b + f * (3.0 * c))) * grid.density
    return value, slope


@kernel
def read(x: float, grid: Grid, tables: NDArray[np.float64]) -> Any:
    """Value and slope at ``x`` of a table with the columns (value, slope)."""
    row, f = locate(x, grid, 2)
    return hermite(
        f,
        grid,
        lookup(tables, row),
        lookup(tables, row + 1),
        lookup(tables, row + 2),
        lookup(tables, row + 3),
    )
