"""The confidence interval behind "better" and "worse" is Student's."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import ttest_1samp

from osculate.study.comparison.compare import Comparison
from osculate.study.comparison.significance import CONFIDENCE, paired_comparisons

LOGS = st.lists(st.floats(-2.0, 2.0), min_size=2, max_size=6).filter(lambda x: np.std(x) > 1e-3)


def cell(controller, curve, rms):
    return {
        "controller": controller, "curve": curve, "speed": 1.0, "start": "on-path", "plant": "ideal",
        "seed": 1, "cross_track_rms": rms, "cross_track_max": rms, "failed": False, "arrived": True,
        "ended": "path end",
    }  # fmt: skip


@given(logs=LOGS)
def test_few_pairs_get_the_interval_of_scipy(logs):
    cells = [cell("ours", str(n), 1e-3) for n in range(len(logs))]
    cells += [cell("theirs", str(n), 1e-3 * math.exp(x)) for n, x in enumerate(logs)]
    (found,) = paired_comparisons(Comparison(cells, {}, {}), "ours")
    expected = ttest_1samp(logs, 0.0).confidence_interval(CONFIDENCE)
    assert math.log(found.low) == pytest.approx(expected.low, abs=1e-9)
    assert math.log(found.high) == pytest.approx(expected.high, abs=1e-9)
    assert math.log(found.ratio) == pytest.approx(np.mean(logs), abs=1e-9)
