"""The words on a film: the verdict comes first, in its colour, whole, at every size."""

import numpy as np
import pytest

from osculate import Verdict, VerdictKind
from osculate.simulation.recording.video.caption import Caption, wrapped
from osculate.simulation.recording.video.stage import Frame

pytest.importorskip("PIL")
FRAME = Frame(*[0.0] * 10)
SENTENCE = (
    "hit obstacle 1 (disc) at t = 1.663 s, 0.971 m on the path, 121 mm deep; it then "
    + "drove " * 20
)


@pytest.mark.parametrize("size", [(64, 64), (320, 180), (1280, 720)])
def test_the_banner_is_green_only_if_the_end_was_reached(size):
    blank = np.full((size[1], size[0], 3), 255, dtype=np.uint8)
    for kind in (VerdictKind.REACHED, VerdictKind.HIT, VerdictKind.LATE):
        drawn = Caption(size, Verdict(kind, SENTENCE)).on(blank, FRAME)
        assert drawn.shape == blank.shape
        top = drawn[: size[1] // 3].astype(int)
        red, green = (top[..., 0] - top[..., 1]).max(), (top[..., 1] - top[..., 0]).max()
        assert (green > red) == (kind is VerdictKind.REACHED)
        assert max(red, green) > 40


def test_a_text_is_broken_between_words_and_nothing_is_lost():
    lines = wrapped(SENTENCE, lambda text: len(text) <= 40)
    assert all(len(line) <= 40 for line in lines)
    assert " ".join(lines).split() == SENTENCE.split()
    assert wrapped("a" * 50 + " b", lambda text: len(text) <= 40) == ["a" * 50, "b"]
