"""The targets: the projected family and its limits, and that drifts are derivatives."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import (
    Cycloid,
    Dynamical,
    InvalidInput,
    Modified,
    Natural,
    Parametric,
    Projected,
    Static,
    Tricycle,
)
from osculate.curve import tabulate
from osculate.kernel import Tables
from osculate.target import TargetMemory
from osculate.target.profile import Pace
from osculate.vehicle import Motion

pytestmark = pytest.mark.core

CURVE = Cycloid.over()
WAVE = Parametric(x="p", y="sin(p)", end=6.0)

speeds = st.floats(0.05, 3)
places = st.floats(1.0, 20.0)


def reference(target, curve, s, v, omega, pace):
    tables = Tables()
    table = tabulate(curve, tables)
    part = target.part(curve, table, Tricycle(), tables)
    motion = Motion(0.0, 0.0, 0.0, v, omega, 0.0)
    return part.refer(motion, pace, TargetMemory(s, 0.0), part.parameters, table, tables.array)


@given(places, speeds)
def test_slaved_speeds_lie_on_the_curvature_line_when_the_robot_does(s, v):
    k = float(CURVE.at(s).curvature)
    pace = Pace(0.0, v, 0.0)
    for target in (Dynamical(), Projected()):
        ref = reference(target, CURVE, s, v, k * v, pace)
        assert ref.speed == pytest.approx(v)
        assert ref.yaw_rate == pytest.approx(k * v)


@given(places, speeds, st.floats(-2, 2), speeds)
def test_the_projected_family_has_the_others_as_its_limits(s, v, omega, v_p):
    pace = Pace(0.0, v_p, 0.1)
    zero = reference(Projected(metric_length=0.0), CURVE, s, v, omega, pace)
    assert zero == pytest.approx(reference(Dynamical(), CURVE, s, v, omega, pace))
    far = reference(Projected(metric_length=1e7), CURVE, s, v, omega, pace)
    k = float(CURVE.at(s).curvature)
    assert far.speed == pytest.approx(omega / k, rel=1e-6, abs=1e-9)
    assert far.yaw_rate == pytest.approx(k * v_p, rel=1e-6)


@given(st.floats(0.0, 7.0), st.floats(0.0, 100.0))
def test_slaving_never_feeds_back_more_than_a_quarter(s, length):
    ref = reference(Projected(metric_length=length), WAVE, s, 1.0, 0.3, Pace(0.0, 1.0, 0.0))
    assert 0.0 <= ref.speed_slaving * ref.yaw_slaving <= 0.25 + 1e-12


@pytest.mark.parametrize(
    "target", [Dynamical(), Modified(), Projected(), Projected(metric_length=2.0)]
)
def test_target_rates_are_derivatives_along_the_motion(target):
    """Move the robot a little: the targets change by drift and slaving."""
    s, v, omega, dv, domega = 6.0, 1.3, -0.4, 0.7, -0.9
    h = 1e-6

    def at(t):
        motion_v, motion_w = v + dv * t, omega + domega * t
        where = s + v * t + 0.5 * dv * t * t
        return reference(target, CURVE, where, motion_v, motion_w, Pace(0.0, 1.1 + 0.2 * t, 0.2))

    here, before, after = at(0.0), at(-h), at(h)
    speed_rate = here.speed_drift + here.speed_slaving * domega
    yaw_rate = here.yaw_drift + here.yaw_slaving * dv
    assert (after.speed - before.speed) / (2 * h) == pytest.approx(speed_rate, abs=1e-6)
    assert (after.yaw_rate - before.yaw_rate) / (2 * h) == pytest.approx(yaw_rate, abs=1e-6)


def test_the_modified_rate_is_the_papers_eq_37():
    s, v, omega = 5.0, 1.2, -0.37
    ref = reference(Modified(), CURVE, s, v, omega, Pace(0.0, -0.3, 0.0))
    k = float(CURVE.at(s).curvature)
    paper = k * (4 * CURVE.radius * math.cos(CURVE.truncation / 2) - s) * v * omega
    assert ref.speed_drift == pytest.approx(paper, abs=1e-9)
    assert ref.speed_slaving == pytest.approx(1 / k)


def test_the_static_target_knows_its_yaw_acceleration():
    tables = Tables()
    table = tabulate(CURVE, tables)
    natural = Static(profile=Natural()).part(CURVE, table, Tricycle(), tables)
    assert np.abs(natural.known_yaw.accelerations).max() < 1e-8  # θ̂̇ = −1/2 throughout


@pytest.mark.parametrize(("curve", "place"), [(WAVE, "0 m"), (Parametric(x="p", y="0*p"), "0 m")])
def test_the_modified_target_refuses_straights_and_says_what_to_use(curve, place):
    with pytest.raises(InvalidInput, match=r"at s = .* m; use the projected target"):
        reference(Modified(), curve, 1.0, 1.0, 0.0, Pace(0.0, 1.0, 0.0))


@given(st.floats(0.0, 7.0))
def test_the_projected_target_is_finite_on_inflections(s):
    ref = reference(Projected(), WAVE, s, 1.0, 0.5, Pace(0.0, 1.0, 0.1))
    assert np.isfinite(list(ref)).all()
