"""A curve as its kernels see it: tabulated once over arc length, read by cubic interpolation."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve, CurvePoint
from osculate.errors import InvalidInput
from osculate.kernel import Grid, Tables, hermite, kernel, locate, lookup

COLUMNS = 7  # x, y, cos θ, sin θ, θ, κ, dκ/ds
CELLS = 4096  # default resolution


class CurveTable(NamedTuple):
    """A tabulated curve: the parameters of `curvature_at` and `point_at`."""

    grid: Grid
    length: float  # m


class Curvature(NamedTuple):
    """Curvature of a curve at one arc length."""

    curvature: float  # 1/m
    curvature_rate: float  # 1/m², dκ/ds


def tabulate(curve: Curve, tables: Tables, cells: int = CELLS, margin: float = 0.0) -> CurveTable:
    """Append the table of ``curve`` to ``tables``.

    Args:
        curve: What to tabulate.
        tables: Where to.
        cells: Resolution, on the curve itself.
        margin: How far (m) the table goes on beyond both ends: along the osculating circle there, or
            around the lap of a closed curve.

    Raises:
        InvalidInput: The curve has no length, or is not finite somewhere (says where).
    """
    length = curve.length
    if not (math.isfinite(length) and length > 0):
        raise InvalidInput("curve.length", length, "must be a positive, finite length (m)")
    step = length / cells
    extra = math.ceil(margin / step)
    s = np.arange(-extra, cells + extra + 1) * step
    s[extra + cells] = length
    point = _extended(curve, s)
    rows = np.stack(
        [
            point.x,
            point.y,
            np.cos(point.heading),
            np.sin(point.heading),
            point.heading,
            point.curvature,
            point.curvature_rate,
        ],
        axis=1,
    )
    bad = ~np.isfinite(rows).all(axis=1)
    if bad.any():
        where = float(s[bad.argmax()])
        raise InvalidInput("curve", f"not finite at s = {where:.6g} m", "must be smooth and finite")
    return CurveTable(tables.add(rows, -extra * step, step), length)


def _extended(curve: Curve, s: NDArray[Any]) -> CurvePoint:
    """The curve at arc lengths (m) that may lie beyond its ends."""
    if curve.closed:
        lap = np.floor(s / curve.length) * ((s < 0.0) | (s > curve.length))
        point = curve.at(s - lap * curve.length)
        return point._replace(heading=point.heading + lap * curve.total_turn)
    end = curve.at(np.clip(s, 0.0, curve.length))
    over = s - np.clip(s, 0.0, curve.length)
    turn = end.curvature * over
    chord = over * np.sinc(turn / (2.0 * np.pi))  # of the osculating circle
    direction = end.heading + 0.5 * turn
    return CurvePoint(
        x=end.x + chord * np.cos(direction),
        y=end.y + chord * np.sin(direction),
        heading=end.heading + turn,
        curvature=end.curvature,
        curvature_rate=np.where(over == 0.0, end.curvature_rate, 0.0),
    )


@kernel
def curvature_at(s: float, curve: CurveTable, tables: NDArray[np.float64]) -> Curvature:
    """Curvature and its slope at arc length ``s`` (m)."""
    row, f = locate(s, curve.grid, COLUMNS)
    value, slope = _column(row, f, curve.grid, 5, 6, tables)
    return Curvature(value, slope)


@kernel
def point_at(s: float, curve: CurveTable, tables: NDArray[np.float64]) -> CurvePoint:
    """The whole `CurvePoint` at arc length ``s`` (m)."""
    row, f = locate(s, curve.grid, COLUMNS)
    x, _ = _column(row, f, curve.grid, 0, 2, tables)
    y, _ = _column(row, f, curve.grid, 1, 3, tables)
    heading, _ = _column(row, f, curve.grid, 4, 5, tables)
    curvature, curvature_rate = _column(row, f, curve.grid, 5, 6, tables)
    return CurvePoint(x, y, heading, curvature, curvature_rate)


@kernel
def _column(
    row: int, f: float, grid: Grid, value: int, slope: int, tables: NDArray[np.float64]
) -> Any:
    return hermite(
        f,
        grid,
        lookup(tables, row + value),
        lookup(tables, row + slope),
        lookup(tables, row + COLUMNS + value),
        lookup(tables, row + COLUMNS + slope),
    )
