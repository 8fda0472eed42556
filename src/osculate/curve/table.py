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
MOST_BEYOND = 1 << 16  # cells beyond each end; a far shorter curve gets coarser ones
MOST_TURN = 1.0  # rad, within one cell
MOST_CELLS = 10_000_000  # of one table: 560 MB


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
        InvalidInput: The curve has no length, needs more cells than fit, or is not finite somewhere
            (says where).
    """
    length = curve.length
    if not (math.isfinite(length) and length > 0):
        raise InvalidInput("curve.length", length, "must be a positive, finite length (m)")
    step, extra, cells = _layout(length, cells, margin)
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
    _require_drivable(s, rows, step)
    return CurveTable(tables.add(rows, -extra * step, step), length)


def _layout(length: float, cells: int, margin: float) -> tuple[float, int, int]:
    """Step of the rows (m), cells beyond each end, cells on the curve itself."""
    if cells > MOST_CELLS:
        raise InvalidInput(
            "curve.length", length, f"would need {cells / 1e6:.3g} M cells, at most "
            f"{MOST_CELLS / 1e6:g} M fit: drive it in parts, or fewer laps",
        )  # fmt: skip
    step = length / cells
    if margin > MOST_BEYOND * step:
        cells = math.ceil(length * MOST_BEYOND / margin)
        step = length / cells
    extra = math.ceil(margin / step)
    return step, extra, cells


def _require_drivable(s: NDArray[Any], rows: NDArray[np.float64], step: float) -> None:
    """Refuse a table that is not finite, or whose cells turn too far."""
    bad = ~np.isfinite(rows).all(axis=1)
    if bad.any():
        where = float(s[bad.argmax()])
        raise InvalidInput("curve", f"not finite at s = {where:.6g} m", "must be smooth and finite")
    turns = np.abs(np.diff(rows[:, 4]))
    if turns.max() > MOST_TURN:
        where = float(s[turns.argmax()])
        raise InvalidInput(
            "curve", f"turns by {turns.max():.3g} rad within {step:.3g} m near s = {where:.6g} m",
            f"must turn by at most {MOST_TURN:g} rad within a cell: it is too fine to be driven",
        )  # fmt: skip


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
