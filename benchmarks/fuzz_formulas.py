"""Formula curves against random and broken formulas: no traceback, no hang, no silent wrong answer.

    python benchmarks/fuzz_formulas.py [count] [seed]

An accepted curve is compared with what Python itself makes of the formulas: positions, and lengths of
ever finer polylines. A refused one must be refused in one line by one of the package's errors.
"""

import math
import random
import sys
import time
from collections import Counter
from typing import NamedTuple

import numpy as np

from osculate import Parametric
from osculate.errors import OsculateError

SLOWEST = 5.0  # s of the processor
UNARY = ("sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "atan")
NUMPY = {name: getattr(np, name) for name in UNARY if name != "atan"}
NAMES = {**NUMPY, "atan": np.arctan, "pi": math.pi, "E": math.e, "__builtins__": {}}
BROKEN = "()*/+-^.,0123456789pEeij xyπ'\"\\#@%&|~<>=!?:;[]{}_\n\0\t"
SEEDS = (
    "9**9**9", "p**9**9", "((((p))))", "1j*p", "(-1)**p", "p if p else 1", "lambda: p", "f(p)", "p.real",
    "[p]", "p; p", "2p", "sin p", "sin(p, p)", "sin()", "sin(*p)", "1e999", "0x10", "1_000", "True*p",
    "p p",    "__import__('os')", "p**p", "1/(p-0.37123)", "atan(1e6*(p-0.37))", "tanh(1e7*(p-0.7))",
    "exp(-(1e6*(p-0.37))**2)", "sin(3000*p)", "sqrt(p-0.5)", "(p**2)**0.5", "p**1.5", "log(p)", "tan(9*p)",
    "-" * 400 + "p", "(" * 150 + "p" + ")" * 150, "+".join(["p"] * 900), "sin(" * 90 + "p" + ")" * 90,
)  # fmt: skip


class Outcome(NamedTuple):
    """What became of one pair of formulas."""

    kind: str  # accepted, refused, or a failure: traceback, hang, wrong
    told: str


def formula(rng: random.Random, depth: int = 4) -> str:
    """A random formula, most of them sensible."""
    if depth == 0 or rng.random() < 0.25:
        return rng.choice(("p", "p", "p", f"{rng.uniform(-3, 3):.3g}", "pi", "E", "2", "0"))
    kind = rng.random()
    if kind < 0.35:
        return f"{rng.choice(UNARY)}({formula(rng, depth - 1)})"
    if kind < 0.45:
        return f"({formula(rng, depth - 1)})**{rng.choice(('2', '3', '0.5', '-1', '1.5', 'p'))}"
    if kind < 0.5:
        return f"-({formula(rng, depth - 1)})"
    if kind < 0.6:
        return f"{10 ** rng.uniform(0, 6):.3g}*({formula(rng, depth - 1)})"
    operator = rng.choice("+-*/")
    return f"({formula(rng, depth - 1)}) {operator} ({formula(rng, depth - 1)})"


def broken(rng: random.Random, text: str) -> str:
    """A formula with a few characters changed."""
    letters = list(text)
    for _ in range(rng.randint(1, 4)):
        place = rng.randint(0, len(letters))
        letters[place : place + rng.randint(0, 2)] = rng.choice(BROKEN)
    return "".join(letters)


def pair(rng: random.Random) -> tuple[str, str]:
    """Formulas for x and y."""
    texts = [rng.choice(SEEDS) if rng.random() < 0.1 else formula(rng) for _ in range(2)]
    if rng.random() < 0.3:
        texts[rng.randint(0, 1)] = broken(rng, rng.choice(texts))
    if rng.random() < 0.3:
        texts[0] = "p"
    return texts[0], texts[1]


def examine(x: str, y: str) -> Outcome:
    """Build a curve and judge it."""
    begin = time.process_time()
    try:
        curve = Parametric(x=x, y=y, end=1.3)
        length = curve.length
    except OsculateError as error:
        lines = str(error).split("\n")  # one for each field
        fine = len(lines) == 1 or all(line.startswith("Parametric.") for line in lines)
        outcome = Outcome("refused" if fine and len(lines) < 3 else "wrong", str(error))
    except Exception as error:
        outcome = Outcome("traceback", repr(error))
    else:
        outcome = judge(curve, x, y, length)
    slow = time.process_time() - begin > SLOWEST
    return Outcome("hang", outcome.told) if slow else outcome


def judge(curve: Parametric, x: str, y: str, length: float) -> Outcome:
    """Compare an accepted curve with plain evaluation of its formulas."""
    edges = curve._arc._p
    scale = float(np.abs(positions(x, y, edges)).max())
    fine = [polyline(x, y, refined(edges, n)) for n in (8, 16)]
    expected = fine[1] + (fine[1] - fine[0]) / 3.0  # a polyline errs by its step squared
    allowed = 1e-6 * length + 1e-11 * scale * len(edges)
    if not abs(length - expected) <= allowed:
        return Outcome("wrong", f"length {length:.9g}, polylines say {expected:.9g}")
    plain = polyline(x, y, np.linspace(0.0, 1.3, 20011))
    if plain > length + allowed:
        return Outcome("wrong", f"length {length:.9g}, even samples are {plain:.9g} apart")
    s = np.linspace(0.0, length, 101)
    point, p = curve.at(s), curve._arc.parameter(s)
    far = np.abs(np.stack([point.x, point.y]) - positions(x, y, p)).max()
    if not far <= 1e-9 * max(scale, 1.0):
        return Outcome("wrong", f"position off by {far:.3g}")
    again = np.array([polyline(x, y, refined(np.append(edges[edges < q], q), 16)) for q in p[::25]])
    if not np.abs(again - s[::25]).max() <= 2.0 * allowed + 1e-5 * length / len(edges):
        return Outcome("wrong", "arc length does not belong to the parameter")
    return Outcome("accepted", f"{length:.6g} m")


def positions(x: str, y: str, p: np.ndarray) -> np.ndarray:
    """What Python makes of the formulas, shape (2, n)."""
    with np.errstate(all="ignore"):
        values = [eval(text.strip().replace("^", "**"), {**NAMES, "p": p}) for text in (x, y)]
    return np.stack([np.broadcast_to(np.asarray(value, dtype=float), p.shape) for value in values])


def polyline(x: str, y: str, p: np.ndarray) -> float:
    """Length of the polyline through the positions at parameters."""
    return float(np.hypot(*np.diff(positions(x, y, p), axis=1)).sum())


def refined(edges: np.ndarray, parts: int) -> np.ndarray:
    """Every interval cut into equal parts."""
    fraction = np.arange(parts) / parts
    inner = edges[:-1, None] + fraction * np.diff(edges)[:, None]
    return np.append(inner.ravel(), edges[-1])


def main(count: int = 10_000, seed: int = 1) -> int:
    """Examine many pairs; the number of failures."""
    rng = random.Random(seed)
    tally: Counter[str] = Counter()
    for _ in range(count):
        x, y = pair(rng)
        outcome = examine(x, y)
        tally[outcome.kind] += 1
        if outcome.kind not in ("accepted", "refused"):
            print(f"{outcome.kind}: x = {x!r}, y = {y!r}: {outcome.told}")
    print(f"formulas: {dict(tally)}")
    return sum(tally[kind] for kind in ("traceback", "hang", "wrong"))


if __name__ == "__main__":
    sys.exit(1 if main(*map(int, sys.argv[1:])) else 0)
