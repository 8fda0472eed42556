"""Every argument of a function that users call is checked: the wrong kind is answered by its name."""

import inspect
import math

import pytest

from osculate import (
    CurvatureTracker,
    Cycloid,
    InitialState,
    InvalidInput,
    Limits,
    Line,
    PurePursuit,
    Sampled,
    Sensors,
    Stepper,
    compare,
    simulate,
    simulate_batch,
    tune,
    variable_names,
)
from osculate.simulation.loop import Setup
from osculate.study.comparison.suite import CONDITIONS

LINE = Line(distance=2)
CALLS = {
    simulate: {"curve": LINE, "controller": CurvatureTracker()},
    simulate_batch: {"curve": LINE, "controller": CurvatureTracker(), "runs": 2},
    variable_names: {"curve": LINE, "controller": CurvatureTracker()},
    Stepper: {"law": CurvatureTracker(), "curve": LINE},
    compare: {"controllers": {"a": PurePursuit()}, "on": {"line": LINE}, "speeds": (1.0,)},
    tune: {"controller": PurePursuit(), "on": {"line": LINE}, "speeds": (1.0,)},
}


def arguments(function):
    """Names of all arguments, those of ``**parts`` written out."""
    known = inspect.signature(function).parameters
    parts = any(p.kind is p.VAR_KEYWORD for p in known.values())
    return [
        *(name for name, p in known.items() if p.kind is not p.VAR_KEYWORD),
        *(name for name in (Setup._fields if parts else ()) if name not in known),
    ]


@pytest.mark.parametrize(
    ("function", "argument"),
    [(f, a) for f in CALLS for a in arguments(f)],
    ids=lambda x: getattr(x, "__name__", x),
)
@pytest.mark.parametrize(
    "wrong", [object(), "nonsense", -7, math.nan], ids=lambda x: type(x).__name__
)
def test_an_argument_of_the_wrong_kind_is_refused_by_its_name(function, argument, wrong):
    if function is tune:
        pytest.importorskip("cma")
    if argument == "keep" and isinstance(wrong, str):
        wrong = b"no path"  # any text is one
    with pytest.raises(InvalidInput) as caught:
        function(**{**CALLS[function], argument: wrong})
    assert caught.value.field.startswith(argument)


@pytest.mark.parametrize(
    ("function", "argument", "empty"),
    [
        *((compare, name, {}) for name in ("controllers", "on", "start", "condition")),
        (compare, "speeds", ()),
        (tune, "on", {}),
        (tune, "speeds", []),
        (tune, "starts", []),
        (simulate_batch, "runs", 0),
    ],
)
def test_nothing_to_do_is_refused_and_not_replaced_by_the_default(function, argument, empty):
    with pytest.raises(InvalidInput, match=rf"^{argument} = .*at least"):
        function(**{**CALLS[function], argument: empty})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"draws": 2}, "draws = 2: nothing is random under these conditions"),
        ({"limits": Limits(speed=1.0)}, "limits.speed = 1.0: give speeds="),
        ({"controllers": {"a": None}}, r"controllers\['a'\] = None: must be a PathTracker"),
        ({"start": {"here": Sensors()}}, r"start\['here'\] = .*must be a InitialState"),
    ],
)
def test_what_would_have_no_effect_on_a_comparison_is_refused(changes, message):
    with pytest.raises(InvalidInput, match=message):
        compare(**{**CALLS[compare], **changes})


@pytest.mark.parametrize("progress", [-1.0, 2.1, math.nan, math.inf])
def test_a_stepper_starts_on_its_curve(progress):
    with pytest.raises(InvalidInput, match="progress"):
        Stepper(CurvatureTracker(), LINE, progress=progress)


@pytest.mark.parametrize("law", ["safety", "estimator", "sensors"])
def test_what_sees_and_guards_is_for_path_trackers(law):
    from osculate import Ekf, Safety

    parts = {"safety": Safety(), "estimator": Ekf(), "sensors": Sensors()}
    clock = Sampled(period=1e-3, duration=0.1)
    with pytest.raises(InvalidInput, match=f"{law} = .*needs a path tracker as controller"):
        simulate(Cycloid(), clock=clock, **{law: parts[law]})


def test_a_duration_that_is_given_is_kept():
    clock = Sampled(period=0.01, delay=0.01, duration=0.5)
    start = {"here": InitialState()}
    (cell,) = compare(**CALLS[compare], start=start, clock=clock).cells
    assert (cell["ended"], cell["duration"]) == ("time", 0.5)


def test_draws_are_of_what_is_random():
    """Conditions without random numbers run once, those with them as often as asked for."""
    chosen = {name: CONDITIONS[name] for name in ("ideal", "noisy")}
    clock = Sampled(period=0.01, delay=0.01, duration=0.3)
    start = {"here": InitialState()}
    cells = compare(**CALLS[compare], start=start, condition=chosen, draws=2, clock=clock).cells
    assert [(c["plant"], c["seed"]) for c in cells] == [("ideal", 1), ("noisy", 1), ("noisy", 2)]
    first, second = (c["cross_track_rms"] for c in cells[1:])
    assert first != second
