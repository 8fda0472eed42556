"""JSON that every program reads: no NaN, no infinity, from one place."""

import json
import math
from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import osculate
from osculate.strict_json import strict_json

SCALARS = st.none() | st.booleans() | st.integers() | st.text() | st.floats()
VALUES = st.recursive(
    SCALARS | st.lists(st.floats()).map(np.array) | st.floats().map(np.float64),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner, inner),
)


def refuse(name):
    raise AssertionError(f"{name} is no JSON")


def same(value, back):
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, dict):
        return value.keys() == back.keys() and all(same(v, back[k]) for k, v in value.items())
    if isinstance(value, (list, tuple)):
        return len(value) == len(back) and all(map(same, value, back))
    if isinstance(value, float) and not math.isfinite(value):
        return back is None
    return value == back and type(value) is type(back)


@given(VALUES)
def test_what_is_written_is_json_and_comes_back_but_for_what_is_not_finite(value):
    assert same(value, json.loads(strict_json(value), parse_constant=refuse))


def test_nothing_else_in_the_package_writes_json():
    for path in Path(osculate.__file__).parent.rglob("*.py"):
        if path.name != "strict_json.py":
            assert "json.dump" not in path.read_text(encoding="utf-8"), path
