"""Profiles: they cover what they promise, and their three numbers belong together."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import Cycloid, Exponential, InvalidInput, Natural, Parametric, SampledProfile
from osculate.kernel import Tables

pytestmark = pytest.mark.core

CURVE = Cycloid.over()


def evaluated(profile, times, whole=CURVE.length):
    tables = Tables()
    part = profile.part(whole, CURVE, tables)
    return part, [part.pace(t, part.parameters, tables.array) for t in times]


PROFILES = [
    Exponential(),
    Exponential(decay=2.0, amplitude=-3.0),
    Natural(rate=1.0),
    SampledProfile.of(lambda t: 2.0 - math.cos(t), 5.0),
]


@pytest.mark.parametrize("profile", PROFILES)
def test_rate_and_acceleration_are_the_derivatives(profile):
    h = 1e-4
    times = np.linspace(0.1, 4.0, 41)
    _, here = evaluated(profile, times)
    _, before = evaluated(profile, times - h)
    _, after = evaluated(profile, times + h)
    for p, q, r in zip(before, here, after, strict=True):
        assert (r.progress - p.progress) / (2 * h) == pytest.approx(q.rate, abs=1e-5)
        assert (r.rate - p.rate) / (2 * h) == pytest.approx(q.acceleration, abs=1e-5)


@pytest.mark.parametrize("profile", PROFILES)
def test_the_array_form_is_the_kernel(profile):
    times = np.linspace(0.0, 6.0, 61)
    part, points = evaluated(profile, times)
    arrays = part.sample(times)
    for name in ("progress", "rate", "acceleration"):
        kernel = [getattr(p, name) for p in points]
        assert getattr(arrays, name) == pytest.approx(kernel, abs=1e-6), name


@given(st.floats(0.1, 5), st.floats(-10, 30))
def test_the_exponential_profile_covers_its_amplitude(decay, amplitude):
    _, (start, end) = evaluated(Exponential(decay=decay, amplitude=amplitude), [0.0, 60 / decay])
    assert (start.progress, start.rate) == (0.0, 0.0)
    assert end.progress == pytest.approx(amplitude, abs=1e-12)
    assert abs(end.rate) < 1e-20


def test_the_natural_profile_is_the_papers_static_speed():
    part, points = evaluated(Natural(), [0.0, 1.0, 2.0])
    for t, p in zip([0.0, 1.0, 2.0], points, strict=True):
        half = (t + CURVE.truncation) / 2
        assert p.rate == pytest.approx(2 * CURVE.radius * math.sin(half), abs=1e-10)
    assert part.horizon == pytest.approx(2 * math.pi - 2 * CURVE.truncation)


def test_a_sampled_profile_stands_still_in_acceleration_after_its_end():
    _, (end, later) = evaluated(SampledProfile(times=(0, 1, 2), rates=(0, 1, 0)), [2.0, 9.0])
    assert later.progress == pytest.approx(end.progress)
    assert later.acceleration == 0.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Exponential(decay=0), "Exponential.decay"),
        (lambda: SampledProfile(times=(0, 2, 1), rates=(0, 1, 2)), "increasing times"),
        (lambda: SampledProfile(times=(0, 1), rates=(0,)), "one finite rate for every time"),
        (lambda: SampledProfile.of(lambda t: t, -1.0), "duration = -1.0"),
        (
            lambda: Natural().part(1.0, Parametric(x="p", y="p"), Tables()),
            "use exponential or sampled",
        ),
    ],
)
def test_bad_profiles_are_explained(make, message):
    with pytest.raises(InvalidInput, match=message):
        make()
