"""Descriptions: changed copies are as valid as new ones, and carry nothing of the old one along."""

import copy
import json
import pickle
import sys
from functools import cached_property

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import osculate
from osculate import (
    Chain,
    Composite,
    CurvatureTracker,
    CurveFile,
    Cycloid,
    InvalidInput,
    Laps,
    Line,
    Nurbs,
    Parametric,
    Pose,
    Scenario,
    Spline,
    Tricycle,
)
from osculate.errors import InvalidScenario
from osculate.plant import Actuated, Reduced
from osculate.spec import Spec

POINTS = ((0.0, 0.0), (1.5, 0.5), (3.0, 0.0), (4.5, -0.5), (6.0, 0.0))


def one_of_each():
    """An instance of every public class that needs no argument, and a curve of most kinds."""
    for name in osculate.__all__:
        kind = getattr(osculate, name)
        if isinstance(kind, type) and issubclass(kind, Spec):
            try:
                yield kind()
            except (InvalidInput, InvalidScenario, TypeError):  # needs arguments
                continue
    loop = Spline(points=((0, 0), (4, -1), (6, 2), (2, 4)), loop=True)
    yield from (
        Cycloid.over(distance=8.0, height=3.0),
        Chain.corner(turn=1.5, radius=0.8, ramp=0.4, straight=2.0),
        Spline(points=POINTS),
        Spline(points=POINTS, tolerance=0.1),
        loop,
        Laps(track=loop, count=2),
        Composite(pieces=(Line(distance=1.0), Line(start=Pose(x=1.0), distance=2.0))),
        Parametric(x="3*p", y="sin(p)"),
        Nurbs(degree=2, knots=(0, 0, 0, 1, 1, 1), points=((0, 0), (1, 0), (2, 1))),
    )


EACH = {f"{type(spec).__name__}-{n}": spec for n, spec in enumerate(one_of_each())}


def touched(spec):
    """The spec after everything that it computes once has been computed."""
    for kind in type(spec).__mro__:
        for name, value in vars(kind).items():
            if isinstance(value, cached_property):
                getattr(spec, name)
    return spec


COPIES = {
    "but": lambda spec, **changes: spec.but(**changes),
    "model_copy": lambda spec, **changes: spec.model_copy(update=changes),
    "deep": lambda spec, **changes: spec.model_copy(update=changes, deep=True),
}
if sys.version_info >= (3, 13):
    COPIES["copy.replace"] = copy.replace


@pytest.mark.parametrize("spec", EACH.values(), ids=EACH)
@pytest.mark.parametrize("make", COPIES.values(), ids=COPIES)
def test_a_copy_is_equal_and_has_computed_nothing(make, spec):
    given = {name: getattr(spec, name) for name in spec.model_fields_set}
    made = make(touched(spec))
    assert made == spec
    assert type(made) is type(spec)
    assert set(vars(made)) == set(vars(type(spec)(**given)))
    assert made.model_fields_set == spec.model_fields_set


@pytest.mark.parametrize("make", COPIES.values(), ids=COPIES)
@given(mass=st.floats(0.1, 100), radius=st.floats(0.05, 0.5))
def test_what_is_computed_follows_the_new_values(make, mass, radius):
    copied = make(touched(Tricycle(track_width=1.1)), body_mass=mass, wheel_radius=radius)
    new = Tricycle(track_width=1.1, body_mass=mass, wheel_radius=radius)
    assert copied == new
    for name in ("total_mass", "turn_inertia", "yaw_gain"):
        assert getattr(copied, name) == getattr(new, name)
    curve = touched(Spline(points=POINTS))
    moved = tuple((mass * x, y) for x, y in POINTS)
    assert make(curve, points=moved).length == Spline(points=moved).length


@pytest.mark.parametrize("make", COPIES.values(), ids=COPIES)
@given(
    changes=st.dictionaries(st.sampled_from(["body_mass", "wheelbase", "mass"]), st.floats(-1, 1))
)
def test_a_copy_is_refused_where_a_new_one_is(make, changes):
    def outcome(build):
        try:
            return build()
        except (InvalidInput, InvalidScenario) as error:
            return str(error)

    assert outcome(lambda: make(Tricycle(), **changes)) == outcome(lambda: Tricycle(**changes))


def test_equality_and_hash_are_those_of_the_fields():
    ring = ((0, 0), (4, -1), (6, 2), (2, 4))
    one, two, other = (touched(Spline(points=ring, loop=loop)) for loop in (False, False, True))
    assert one == two
    assert hash(one) == hash(two)
    assert one != other
    assert one != POINTS
    assert Reduced() != Actuated()


@pytest.mark.parametrize("spec", EACH.values(), ids=EACH)
def test_true_is_no_number(spec):
    given = {name: getattr(spec, name) for name in spec.model_fields_set}
    for name, field in type(spec).model_fields.items():
        if field.annotation in (float, int, float | None, int | None):
            with pytest.raises(InvalidInput, match=f"{name} = True: is no number"):
                type(spec)(**{**given, name: True})


def test_true_is_no_number_in_lists_and_files_either():
    with pytest.raises(InvalidInput, match=r"points.*truth value"):
        Spline(points=[(0.0, 0.0), (1.0, True)])
    with pytest.raises(InvalidInput, match=r"limits\.speed = True"):
        Scenario.parse({"limits": {"speed": True}})
    assert CurveFile(path="a.csv", loop=True, speeds=True).loop is True


def test_fields_that_were_never_given_follow_their_defaults():
    tracked = Scenario().but(controller=CurvatureTracker())
    assert tracked == Scenario(controller=CurvatureTracker())
    assert isinstance(tracked.plant, Actuated)
    given_plant = Scenario(plant=Reduced()).but(controller=CurvatureTracker())
    assert isinstance(given_plant.plant, Reduced)


def test_a_deep_copy_shares_nothing_that_was_given():
    curve = Spline(points=POINTS)
    lap = Composite(pieces=(Line(distance=1.0),))
    assert lap.model_copy().pieces[0] is lap.pieces[0]
    assert lap.model_copy(deep=True).pieces[0] is not lap.pieces[0]
    assert curve.model_copy(deep=True) == curve


@pytest.mark.parametrize("spec", EACH.values(), ids=EACH)
def test_everything_pickles_without_what_it_has_computed(spec):
    fresh = pickle.loads(pickle.dumps(touched(spec)))
    assert fresh == spec
    assert type(fresh) is type(spec)
    assert all(name in type(spec).model_fields for name in vars(fresh))
    if hasattr(spec, "at"):
        s = np.linspace(0.0, spec.length, 50)
        for here, there in zip(spec.at(s), fresh.at(s), strict=True):
            assert np.array_equal(here, there)


def test_a_curve_from_a_file_is_pickled_as_it_was_read(tmp_path):
    file = tmp_path / "way.json"
    file.write_text(
        json.dumps({"poses": [{"pose": {"position": {"x": x, "y": y}}} for x, y in POINTS]})
    )
    curve = CurveFile(path=str(file))
    length = curve.length
    sent = pickle.dumps(curve)
    assert pickle.loads(pickle.dumps(CurveFile(path=str(file)))).length == length
    file.unlink()
    fresh = pickle.loads(sent)
    assert fresh.length == length
    assert fresh.reading.rows() == curve.reading.rows()
    with pytest.raises(InvalidInput, match="way"):
        curve.but(scale=2.0).length  # noqa: B018 (reads the file)
