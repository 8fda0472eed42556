"""Random numbers: published vectors, distribution, independence, and the same bits everywhere."""

import json
import platform
import re

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from osculate.kernel import normals, uniforms
from osculate.kernel.random import philox
from uncompiled import run_uncompiled

WORD = 0xFFFFFFFF
COUNT = 25_000
whole = st.integers(0, 2**53)
words = st.integers(0, WORD)


@numba.njit(error_model="numpy")
def block(draw, seed, first, stream, out):
    for n in range(out.shape[1]):
        out[0, n], out[1, n], out[2, n], out[3, n] = draw(seed, first + n, stream)


def table(draw, seed=1.0, first=0.0, stream=0.0, count=COUNT):
    out = np.empty((4, count))
    block(draw, seed, first, stream, out)
    return out


@pytest.mark.parametrize(
    ("counter", "key", "expected"),
    [
        ("00000000 00000000 00000000 00000000", "00000000 00000000",
         "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
        ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff",
         "408f276d 41c83b0e a20bc7c6 6d5451fd"),
        ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0",
         "d16cfe09 94fdcceb 5001e420 24126ea1"),
    ],
)  # fmt: skip
def test_philox_gives_the_known_answers_of_random123(counter, key, expected):
    arguments = [int(word, 16) for word in f"{counter} {key}".split()]
    for function in (philox, philox.py_func):
        assert " ".join(f"{word:08x}" for word in function(*arguments)) == expected


@given(st.tuples(words, words, words, words, words, words))
def test_wrapped_products_lose_nothing(arguments):
    assert philox(*arguments) == philox.py_func(*arguments)


@given(whole, whole, words)
def test_seed_and_index_count_with_all_their_bits(seed, index, stream):
    drawn = philox(index & WORD, index >> 32, stream, 0, seed & WORD, seed >> 32)
    u = uniforms(float(seed), float(index), float(stream))
    assert u == tuple((word + 0.5) / 2**32 for word in drawn)
    assert all(0.0 < part < 1.0 for part in u)


@pytest.mark.parametrize(("draw", "law"), [(uniforms, "uniform"), (normals, "norm")])
def test_the_distribution_is_the_promised_one(draw, law):
    x = table(draw).ravel()
    assert stats.kstest(x, law).pvalue > 0.01
    assert all(stats.kstest(part, law).pvalue > 0.01 for part in table(draw, seed=2.0))


def test_moments_of_normals():
    x = table(normals).ravel()
    spread = 4.0 / np.sqrt(x.size)
    assert abs(x.mean()) < spread
    assert abs(x.var() - 1.0) < spread * np.sqrt(2.0)
    assert abs(stats.skew(x)) < spread * np.sqrt(6.0)
    assert abs(stats.kurtosis(x)) < spread * np.sqrt(24.0)
    assert np.abs(x).max() < 6.8


def test_neighbours_are_independent():
    """Draws of one call, and of calls with the next index, seed, stream, or the two swapped."""
    x = np.concatenate(
        [
            table(normals, 7.0, 100.0, 3.0),
            table(normals, 7.0, 101.0, 3.0),
            table(normals, 8.0, 100.0, 3.0),
            table(normals, 7.0, 100.0, 4.0),
            table(normals, 7.0 + 2.0**32, 100.0, 3.0),
            table(normals, 7.0, 100.0 + 2.0**32, 3.0),
            table(normals, 3.0, 100.0, 7.0),
        ]
    )
    for values in (x, x * x):
        correlations = np.corrcoef(values)[np.triu_indices(len(x), 1)]
        assert np.abs(correlations).max() < 4.5 / np.sqrt(COUNT)


def test_uncompiled_numbers_are_the_same_bits():
    code = """
        import json
        from osculate.kernel import normals, uniforms
        numbers = [0.0, 1.0, 2.0**31, 2.0**32 - 1, 2.0**32, 2.0**53 - 1, 2.0**53]
        points = [(s, i, t) for s in numbers for i in numbers for t in numbers[:4]]
        print(json.dumps([points, [[v.hex() for f in (uniforms, normals) for v in f(*p)]
                                   for p in points]]))
    """
    points, there = json.loads(run_uncompiled(code))
    assert there == [[v.hex() for f in (uniforms, normals) for v in f(*p)] for p in points]


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="reads x86 assembly")
def test_a_loop_over_lanes_is_vectorised():
    @numba.njit(error_model="numpy")
    def lanes(seed, index, out):
        for n in range(64):
            out[0, n], out[1, n], out[2, n], out[3, n] = normals(seed[n], index[n], 5.0)

    seed, index = np.arange(64.0) * 2.0**47, np.arange(64.0) ** 8
    out = np.empty((4, 64))
    lanes(seed, index, out)
    singly = [normals(s, n, 5.0) for s, n in zip(seed, index, strict=True)]
    assert out.T.tolist() == [list(row) for row in singly]
    assembly = "\n".join(lanes.inspect_asm().values())
    assert len(re.findall(r"\bv?pmuludq\b", assembly)) >= 19
    assert re.search(r"\bv?mulpd\b", assembly)
