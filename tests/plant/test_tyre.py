"""Tyres: their force opposes the slip within an ellipse, on the friction of the ground below."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import Patch, Slip, Tricycle
from osculate.plant.tyre import Planar, TyreParameters, friction_at, spots, tyre_force

speeds = st.floats(-5, 5)


@given(speeds, speeds, speeds, st.floats(0, 99), st.floats(0.05, 2), st.floats(0.3, 3))
def test_a_tyre_pulls_against_its_slip_and_within_its_ellipse(along, aside, tread, load, mu, ratio):
    p = TyreParameters(mu, ratio**-2, 12.0, 0.09, spots([]))
    force = tyre_force(Planar(along, aside), tread, load, mu, p)
    assert force.along * (along - tread) + force.aside * aside <= 0.0
    assert np.hypot(force.along, force.aside / ratio) <= mu * load * (1 + 1e-12)
    tiny = tyre_force(Planar(2.0, 1e-6), 2.0, load, mu, p)
    assert tiny.aside == pytest.approx(-12.0 * load * 1e-6 / np.hypot(2.0, 0.3), rel=1e-6)


def test_friction_is_that_of_the_last_patch_below_the_wheel():
    ice = Patch(x=0.0, y=0.0, radius=1.0, friction=0.1)
    sand = Patch(x=0.5, y=0.0, radius=0.2, friction=0.6)
    p = Slip(patches=(ice, sand, ice.model_copy(update={"x": 9.0}))).parameters(Tricycle()).tyre
    assert len(p.patches) == 4
    places = ((0.0, 0.0), (0.5, 0.1), (0.5, 0.3), (0.8, 0.8), (8.5, 0.0))
    assert [friction_at(x, y, p) for x, y in places] == [0.1, 0.6, 0.1, 0.8, 0.1]
