"""Counter-based random numbers: every draw is a pure function of (seed, index, stream).

There is no generator to carry along: a lane, a single run and plain Python draw the same bits, in any
order. The bits come from Philox4x32-10 (Salmon, Moraes, Dror & Shaw 2011, "Parallel random numbers: as
easy as 1, 2, 3"): ten rounds that scramble a counter of four 32-bit words with a key of two. Words are
held in 64-bit integers; the product of two may wrap, but its lower and upper word are masked out right.
"""

from math import sqrt

import numpy as np

from osculate.kernel.decorator import kernel
from osculate.kernel.maths import TWO_PI, WHOLE_BITS, log, sincos

_WORD = 0xFFFFFFFF


@kernel
def philox(c0: int, c1: int, c2: int, c3: int, k0: int, k1: int) -> tuple[int, int, int, int]:
    """Four random words from a counter (c0 … c3) and a key (k0, k1) of 32-bit words."""
    for _ in range(10):  # unrolled before a lane loop is vectorised
        p = c0 * 0xD2511F53
        q = c2 * 0xCD9E8D57
        c0, c1 = (q >> 32 & _WORD) ^ c1 ^ k0, q & _WORD
        c2, c3 = (p >> 32 & _WORD) ^ c3 ^ k1, p & _WORD
        k0 = (k0 + 0x9E3779B9) & _WORD
        k1 = (k1 + 0xBB67AE85) & _WORD
    return c0, c1, c2, c3


@kernel
def uniforms(seed: float, index: float, stream: float) -> tuple[float, float, float, float]:
    """Four independent numbers, uniform on the 2³² midpoints of equal parts of (0, 1).

    ``seed`` and ``index`` are whole numbers in [0, 2⁵³], ``stream`` is one in [0, 2³²).
    """
    key, count = int(seed), int(index)
    a, b, c, d = philox(
        count & _WORD, count >> 32 & _WORD, int(stream) & _WORD, 0, key & _WORD, key >> 32 & _WORD
    )
    return _unit(a), _unit(b), _unit(c), _unit(d)


@kernel
def normals(seed: float, index: float, stream: float) -> tuple[float, float, float, float]:
    """Four independent standard normal numbers (Box–Muller), at most 6.8 in size; see `uniforms`."""
    a, b, c, d = uniforms(seed, index, stream)
    r1, r2 = sqrt(-2.0 * log(a)), sqrt(-2.0 * log(c))
    s1, c1 = sincos(TWO_PI * b)
    s2, c2 = sincos(TWO_PI * d)
    return r1 * c1, r1 * s1, r2 * c2, r2 * s2


@kernel
def _unit(word: int) -> float:
    lifted = np.int64(word + WHOLE_BITS)
    return (float(lifted.view(np.float64)) - (2.0**52 - 0.5)) * 2.0**-32
