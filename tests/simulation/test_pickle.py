"""Runs and batches can be kept and sent: all of them, computed or not, and without machine code."""

import pickle

import numpy as np
import pytest

from osculate import CurvatureTracker, Cycloid, Spline, simulate, simulate_batch

CURVE = Spline(points=((0, 0), (1.5, 0.5), (3, 0), (4.5, -0.5), (6, 0)))
RESULTS = {
    "paper": lambda: simulate(Cycloid.over()),
    "tracker": lambda: simulate(CURVE, controller=CurvatureTracker()),
    "batch": lambda: simulate_batch([Cycloid.over(), Cycloid.over(height=4.0)], record_every=10),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_comes_back_whole(name):
    result = RESULTS[name]()
    sent = pickle.dumps(result)
    assert b"osculate_composed" not in sent
    before = pickle.loads(sent)
    result.data  # noqa: B018 (computed once, kept)
    after = pickle.loads(pickle.dumps(result))
    for back in (before, after):
        assert back.setup == result.setup
        assert back.data.identical(result.data)
        assert repr(back.metrics) == repr(result.metrics)
    if name != "batch":
        assert after.verdict.sentence == result.verdict.sentence
        assert np.array_equal(after.clearance, result.clearance)
        assert after.interventions == result.interventions
        assert repr(after.plan) == repr(result.plan)
