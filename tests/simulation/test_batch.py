"""Batches: a lane is the single run and the uncompiled function, bit for bit, and is vectorised."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest

from osculate import (
    Continuous,
    CurvatureLaw,
    Cycloid,
    Disturbance,
    InvalidInput,
    Metrics,
    Modified,
    Projected,
    Sampled,
    SlidingMode,
    Tricycle,
    YawRegulator,
    simulate,
    simulate_batch,
    variable_names,
)
from uncompiled import run_uncompiled

CURVE = Cycloid.over()
SHORT = Continuous(duration=0.3)
RUNS = 70  # a full block and a part of one
GENTLE = CurvatureLaw(
    yaw=YawRegulator(rate_weight=1e-3, heading_weight=1e-2), speed=SlidingMode(gain=10)
)


def robots(count=RUNS):
    return [Tricycle(body_mass=mass) for mass in np.linspace(2.0, 5.0, count)]


@pytest.mark.parametrize(
    "parts",
    [
        {"target": Modified(), "clock": SHORT, "disturbance": Disturbance.external()},
        {
            "target": Projected(),
            "clock": Sampled(period=0.01, delay=0.015, duration=0.3),
            "controller": GENTLE,
        },
    ],
    ids=["continuous", "sampled"],
)
def test_a_lane_is_the_single_run_bit_for_bit(parts):
    batch = simulate_batch(CURVE, robots(), record_every=1, **parts)
    for n in (0, 1, 41, 63, 64, 69):
        run = simulate(CURVE, robots()[n], **parts)
        for column, variable in enumerate(run.columns):
            lane = batch.record[n, :, column]
            assert (lane == run.columns[variable][: len(lane)]).all(), variable
        for name, value in run.metrics.as_dict().items():
            if value is not None:
                assert getattr(batch.metrics, name)[n] == value, name


UNCOMPILED = """
    import json
    from osculate import *
    robots = [Tricycle(body_mass=m) for m in (2.0, 3.5)]
    parts = dict(clock=Continuous(duration=0.05), disturbance=Disturbance.external())
    batch = simulate_batch(Cycloid.over(), robots, record_every=1, **parts)
    run = simulate(Cycloid.over(), robots[1], **parts)
    print(json.dumps([batch.record[1].tolist(), run.columns["x"].tolist()]))
"""


def test_a_lane_is_the_uncompiled_function_bit_for_bit():
    plain, x = json.loads(run_uncompiled(UNCOMPILED))
    fleet = [Tricycle(body_mass=m) for m in (2.0, 3.5)]
    batch = simulate_batch(
        CURVE,
        fleet,
        record_every=1,
        clock=Continuous(duration=0.05),
        disturbance=Disturbance.external(),
    )
    assert (batch.record[1] == np.array(plain)).all()
    assert list(batch.data.x.values[1]) == x[: len(batch.time)]


ASSEMBLY = """
    from osculate import *
    from osculate.simulation.blocks import run_block
    from osculate.simulation.loop import Setup, close_loop
    from osculate.simulation.columns import LANES, Columns
    loop = close_loop(Setup(Cycloid.over(), clock=Continuous(duration=0.01)))
    columns = Columns([loop], {}, LANES)
    run_block(loop, columns.block(0))
    (text,) = loop.engine(LANES).run_block.inspect_asm().values()
    print(text)
"""


def test_the_lane_loop_is_vectorised(tmp_path):
    """In a fresh cache: machine code that was loaded from disk cannot be inspected."""
    import os
    import platform
    import textwrap

    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(ASSEMBLY)],
        capture_output=True,
        text=True,
        env={**os.environ, "OSCULATE_CACHE_DIR": str(tmp_path)},
        check=True,
    )
    if platform.machine() in ("x86_64", "AMD64"):
        packed = r"\bv?(mul|add|sub|div|fmadd\d*|fmsub\d*)pd\b"
        scalar = r"\bv?(mul|add|sub|div|fmadd\d*|fmsub\d*)sd\b"
    else:
        packed = r"\bf(mul|add|sub|div|mla|mls)(\.2d|\s+v\d+\.2d)"
        scalar = r"\bf(mul|add|sub|div)\s+d\d"
    count = {name: len(re.findall(p, done.stdout)) for name, p in (("p", packed), ("s", scalar))}
    assert count["p"] > 1000
    assert count["p"] > 5 * count["s"]  # what depends on time alone is computed once, as a scalar


def test_numbers_are_varied_by_name():
    heading = np.linspace(-0.2, 0.2, 5)
    masses = Tricycle(body_mass=3.0)
    names = variable_names(CURVE, masses)
    assert "initial.plant.heading" in names
    assert "control.speed_gain" in names
    begin = float(CURVE.at(0.0).heading)
    batch = simulate_batch(
        CURVE, vary={"initial.plant.heading": begin + heading}, clock=SHORT, record_every=100
    )
    assert batch.record.shape[:2] == (5, 3)
    assert batch.data.heading_error.values[:, 0] == pytest.approx(heading, abs=1e-9)
    assert batch.metrics.heading_error_max == pytest.approx(np.abs(heading), abs=1e-3)


def test_lanes_end_on_their_own():
    """A fast and a slow run in one block: each stops at its own path end."""
    batch = simulate_batch(
        CURVE, vary={"pace.amplitude": [-3.0, -2.9, -2.0]}, clock=Continuous(duration=12.0)
    )
    assert batch.metrics.ended.tolist() == ["path end", "path end", "time"]
    assert batch.metrics.duration[0] == pytest.approx(7.2446, abs=1e-3)
    assert batch.metrics.duration[2] == pytest.approx(12.0)
    single = simulate(CURVE, clock=Continuous(duration=12.0), target=printed())
    assert single.metrics.duration == batch.metrics.duration[0]
    assert single.metrics.cross_track_rms == batch.metrics.cross_track_rms[0]


def printed():
    from osculate import Exponential

    return Modified(profile=Exponential(amplitude=-3.0))


def test_threads_do_not_change_results():
    parts = {"vary": {"control.speed_gain": np.linspace(100, 700, 200)}, "clock": SHORT}
    one = simulate_batch(CURVE, threads=1, **parts)
    two = simulate_batch(CURVE, threads=2, **parts)
    for name, _, _ in Metrics.items():
        first, second = getattr(one.metrics, name), getattr(two.metrics, name)
        assert first is second is None or (first == second).all(), name


def test_curves_of_different_length_share_a_batch():
    curves = [Cycloid.over(height=height) for height in (3.0, 5.0)]
    batch = simulate_batch(curves, clock=Continuous(duration=20.0))
    assert batch.metrics.path_length == pytest.approx([c.length for c in curves])
    assert batch.metrics.cross_track_rms.max() < 1e-8


def test_progress_and_labels():
    seen = []
    batch = simulate_batch(CURVE, runs=130, clock=SHORT, report=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert batch.data.sizes == {"run": 130}
    assert batch.data.cross_track_rms.attrs["units"] == "m"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "runs = None: must be given when nothing varies"),
        ({"runs": 0}, "runs = 0: must be at least 1"),
        ({"vary": {"mass": [1.0, 2.0]}}, r"vary\['mass'\] = 'mass': unknown; valid: .*control"),
        ({"runs": 3, "vary": {"delay": [0.0, 0.0]}}, "must have the length of"),
        ({"vary": {"delay": [[0.0]]}}, "must be one number for every run"),
        (
            {"target": [Modified(), Projected()]},
            r"target \(run 1\) = Projected.*: needs other machine",
        ),
    ],
)
def test_bad_batches_are_explained(arguments, message):
    with pytest.raises(InvalidInput, match=message):
        simulate_batch(CURVE, **arguments)
