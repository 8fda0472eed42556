"""Damaged files: right, refused or warned of; never a traceback, a hang, or a silent wrong answer."""

import pytest

from fuzzing.files import KINDS, campaign

INPUTS = {"csv": 1200, "json": 1200, "yaml": 500}


@pytest.mark.parametrize("kind", KINDS)
def test_damaged_files_are_read_right_or_refused_or_warned_of(tmp_path, kind):
    counts, bad = campaign(kind, range(INPUTS[kind]), tmp_path)
    assert not bad, [(found.kind, found.seed, found.message[:300]) for found in bad[:3]]
    assert counts["right"] > 0.25 * INPUTS[kind]  # those that were left whole, and more
    assert counts["refused"] > 0.2 * INPUTS[kind]
