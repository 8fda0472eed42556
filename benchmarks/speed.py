"""How fast the engine is, as ratios against C and SciPy measured in the same run.

The work: the paper's continuous closed loop, 20 s at h = 1 ms by RK4 (20,000 steps). Usage:

    make bench            # or: .venv/bin/python benchmarks/speed.py [--json FILE]

Needs a C compiler (cc); every result of the C programs is compared with the package's before its time
counts.
"""

import argparse
import ctypes
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numba
import numpy as np
from scipy.integrate import solve_ivp

from osculate import Cycloid
from osculate.kernel import compose, load, names, store
from osculate.scene import Scene
from osculate.simulation.batch import LANES, simulate_batch
from osculate.simulation.blocks import run_block, single_block
from osculate.simulation.loop import TEMPLATES, Loop, Setup, close_loop, size
from osculate.simulation.run import run_loop

HERE = Path(__file__).parent
BATCH = 512
REPEATS = 7
DOUBLES = np.ctypeslib.ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, help="also write the results here")
    chosen = parser.parse_args()
    loop = close_loop(Setup(Cycloid.over()))
    results = {"machine": f"{platform.machine()}, {os.cpu_count()} processors"}
    results |= engine_speed(loop)
    results |= scipy_speed(loop, results["single run with record [ms]"])
    results |= start_up()
    width = max(map(len, results))
    for name, value in results.items():
        print(f"{name:<{width}}  {value if isinstance(value, str) else f'{value:.3g}'}")
    if chosen.json:
        chosen.json.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


def engine_speed(loop: Loop):
    """Times of one 20 s run in ms, alternating between all contestants so that they share the weather."""
    parameters, initial = column(loop.parameters), state_column(loop)
    with tempfile.TemporaryDirectory() as folder:
        scalar = library(Path(folder), loop, "scalar", "-O3")
        native = library(Path(folder), loop, "scalar", "-O3", "-march=native")
        vector = library(Path(folder), loop, "vector", "-O3", "-march=native")
        steps, h, tables = loop.setup.clock.steps, loop.setup.clock.step, loop.tables
        many = np.repeat(parameters[:, None], BATCH, 1)

        def one(program, recorded):
            state, tally = initial.copy(), np.zeros(19)
            program.run.restype = ctypes.c_int
            record = np.empty((steps, 25)) if recorded else np.empty((0, 25))
            pointer = record.ctypes.data_as(ctypes.c_void_p) if recorded else None
            program.run(
                *map(as_pointer, (state, tally, parameters, tables)),
                ctypes.c_int(steps), ctypes.c_double(h), pointer,
            )  # fmt: skip
            return state, record

        def block(program):
            state, tally = np.repeat(initial[:, None], BATCH, 1), np.zeros((19, BATCH))
            program.run_many(
                *map(as_pointer, (state, tally, many, tables)),
                ctypes.c_int(steps), ctypes.c_double(h), ctypes.c_int(BATCH),
            )  # fmt: skip
            return state

        check(loop, *one(scalar, True), block(vector)[:, 3])
        alone = single_block(loop)
        simulate_batch(loop.setup.curve, runs=BATCH, threads=2)
        best = fastest(
            {
                "c": lambda: one(scalar, True),
                "c native": lambda: one(native, True),
                "c without record": lambda: one(scalar, False),
                "single": lambda: run_block(loop, alone, every=1),
                "complete": lambda: run_loop(loop, Scene()),
                "vector c": lambda: block(vector),
                "batch": lambda: simulate_batch(loop.setup.curve, runs=BATCH, threads=1),
                "two": lambda: simulate_batch(loop.setup.curve, runs=BATCH, threads=2),
            }
        )
    ms = {name: 1e3 * seconds for name, seconds in best.items()}
    for name in ("vector c", "batch", "two"):
        ms[name] /= BATCH
    return {
        "scalar C -O3, one run with record [ms]": ms["c"],
        "scalar C -O3 -march=native, one run with record [ms]": ms["c native"],
        "scalar C -O3, one run [ms]": ms["c without record"],
        "hand-vectorised C, per run [ms]": ms["vector c"],
        "single run with record [ms]": ms["single"],
        "the same with metrics and labels [ms]": ms["complete"],
        f"batch of {BATCH} on one core, per run [ms]": ms["batch"],
        f"batch of {BATCH} on two cores, per run [ms]": ms["two"],
        "single / scalar C (goal <= 1.3)": ms["single"] / ms["c"],
        "scalar C / batch (goal >= 4)": ms["c without record"] / ms["batch"],
        "batch / vector C (goal <= 1.25)": ms["batch"] / ms["vector c"],
        "one thread / two threads (goal >= 1.8)": ms["batch"] / ms["two"],
    }


def check(loop: Loop, scalar, record, vector):
    """Both C programs do the package's work: equal ends and records, up to rounding."""
    columns = run_loop(loop, Scene()).columns
    end = [columns[name][-1] for name in ("x", "y", "heading", "speed", "yaw_rate")]
    for state in (scalar, vector):
        assert np.abs(state[:5] - end).max() < 1e-7, (state[:5], end)
    for number, name in ((1, "x"), (16, "torque_left"), (23, "cross_track_error")):
        worst = np.abs(record[:-1, number] - columns[name][: len(record) - 1]).max()
        assert worst < 1e-3 if name == "torque_left" else worst < 1e-7, (name, worst)


def scipy_speed(loop: Loop, single_ms: float):
    """solve_ivp on the same compiled kernel, 2 s of the run, with steps no longer than h."""
    dynamics = compose(f"{TEMPLATES}.continuous", loop.bindings)
    rates, like, parameters = dynamics.rates, loop.initial.state, loop.parameters

    @numba.njit
    def flat(t, block, tables):
        out = np.empty_like(block)
        store(rates(t, load(like, block, 0), 0.0, parameters, tables), out, 0)
        return out

    block = np.empty((size(like), 1))
    store(like, block, 0)
    flat(0.0, block, loop.tables)
    seconds, clock = 2.0, loop.setup.clock

    def solve():
        solve_ivp(
            lambda t, y: flat(t, y.reshape(-1, 1), loop.tables).ravel(),
            (0.0, seconds), block.ravel(), max_step=clock.step, rtol=1e-6, atol=1e-9,
        )  # fmt: skip

    ms = 1e3 * fastest({"solve_ivp": solve}, repeats=1)["solve_ivp"] * clock.duration / seconds
    return {
        "solve_ivp with the same kernel, 20 s [ms]": ms,
        "solve_ivp / single (goal >= 200)": ms / single_ms,
    }


def start_up():
    """Whole commands in new processes: first with an empty cache, then again; and the bare import."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "OSCULATE_CACHE_DIR": folder}
        run = [sys.executable, "-m", "osculate", "run"]
        cold = timed(run, environment)
        warm = min(timed(run, environment) for _ in range(3))
    nothing = min(timed([sys.executable, "-c", "pass"]) for _ in range(3))
    bare = min(timed([sys.executable, "-c", "import osculate"]) for _ in range(3))
    return {
        "first osculate run, compiling [s] (goal <= 20)": cold,
        "second osculate run [s] (goal <= 2)": warm,
        "import osculate [s] (goal <= 0.3)": bare - nothing,
    }


def fastest(contestants, repeats=REPEATS):
    """Best time (s) of each, in turns."""
    best = dict.fromkeys(contestants, np.inf)
    for _ in range(repeats):
        for name, call in contestants.items():
            start = time.perf_counter()
            call()
            best[name] = min(best[name], time.perf_counter() - start)
    return best


def timed(command, environment=None):
    start = time.perf_counter()
    subprocess.run(command, env=environment, check=True, capture_output=True)
    return time.perf_counter() - start


def library(folder: Path, loop: Loop, program: str, *flags: str):
    """Compile one of the C programs for the layout that this loop's parameters have."""
    fields = [name.replace(".", "_") for name in names(loop.parameters)]
    lines = [f"#define P_{name} {number}" for number, name in enumerate(fields)]
    (folder / "layout.h").write_text(
        "\n".join([*lines, f"#define PARAMETERS_COUNT {len(fields)}", ""]), encoding="utf-8"
    )
    target = folder / f"{program}{'-'.join(flags)}.so"
    source = HERE / "reference" / f"{program}.c"
    command = ["cc", *flags, "-std=gnu11", "-shared", "-fPIC", "-I", str(folder), str(source)]
    subprocess.run([*command, "-o", str(target), "-lm"], check=True)
    return ctypes.CDLL(str(target))


def as_pointer(array):
    return array.ctypes.data_as(ctypes.c_void_p)


def column(value):
    from osculate.kernel import leaves

    return np.array(list(leaves(value)))


def state_column(loop: Loop):
    """The nine states of the C programs."""
    from osculate.kernel import leaves

    return np.array(list(leaves(loop.initial.state)))


if __name__ == "__main__":
    assert LANES > 1
    main()
