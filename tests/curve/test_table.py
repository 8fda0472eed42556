"""The table that kernels read: interpolation error, and curves that cannot be tabulated."""

import numpy as np
import pytest

from osculate import Curve, CurvePoint, Cycloid, InvalidInput
from osculate.curve import tabulate
from osculate.curve.table import curvature_at, point_at
from osculate.kernel import Tables


def test_the_cycloid_is_interpolated_to_a_nanometre():
    curve = Cycloid.over()
    tables = Tables()
    table = tabulate(curve, tables)
    s = np.random.default_rng(0).uniform(0, curve.length, 4000)
    exact = curve.at(s)
    read = CurvePoint(*np.array([point_at(v, table, tables.array) for v in s]).T)
    for name in ("x", "y", "heading", "curvature"):
        assert np.abs(getattr(read, name) - getattr(exact, name)).max() <= 1e-9, name
    assert np.abs(read.curvature_rate - exact.curvature_rate).max() <= 1e-6
    both = curvature_at(3.0, table, tables.array)
    point = point_at(3.0, table, tables.array)
    assert both == (point.curvature, point.curvature_rate)


class Broken(Curve):
    @property
    def length(self):
        return 1.0

    def at(self, arc_length):
        s = np.asarray(arc_length)
        return CurvePoint(s, 0 * s, 0 * s, np.where(s > 0.5, np.nan, 0 * s), 0 * s)


class Empty(Broken):
    @property
    def length(self):
        return 0.0


def test_curves_that_are_not_finite_say_where():
    with pytest.raises(InvalidInput, match=r"s = 0\.5"):
        tabulate(Broken(), Tables())
    with pytest.raises(InvalidInput, match=r"curve\.length = 0\.0"):
        tabulate(Empty(), Tables())
