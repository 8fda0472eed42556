"""How exact and how fast path tracking is: the numbers of the documentation, measured anew.

    .venv/bin/python benchmarks/tracking.py [TRACK.csv ...] [--scale 0.1]

Curves × {0.5, 1, 2} m/s on the actuated plant, 100 Hz, 10 ms delay; errors in mm.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from osculate import (
    Actuated,
    CurvatureTracker,
    CurveFile,
    Cycloid,
    Limits,
    Sampled,
    Stepper,
    compare,
    simulate,
)
from osculate.control.tracking import TRACKERS
from osculate.kernel import compose
from osculate.study.comparison.suite import STARTS, conditions
from osculate.vehicle import Motion

TEXTBOOK = ("pure-pursuit", "stanley", "kanayama", "lqr")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tracks", nargs="*", type=Path, help="track files")
    parser.add_argument("--scale", type=float, default=0.1, help="factor on their coordinates")
    chosen = parser.parse_args()
    nominal()
    robustness()
    for path in chosen.tracks:
        track(path, chosen.scale)
    speed()


def nominal():
    """All controllers on the reported curves."""
    result = compare(TRACKERS, start={"on-path": STARTS["on-path"]})
    ours = result.of("curvature-tracker")
    best = np.min([[c["cross_track_rms"] for c in result.of(n)] for n in TEXTBOOK], axis=0)
    means = {n: np.mean([c["cross_track_rms"] for c in result.of(n)]) for n in TEXTBOOK}
    name = min(means, key=means.get)
    own = np.array([c["cross_track_rms"] for c in ours])
    line("nominal: mean RMS / worst RMS / worst max", *summary(ours))
    print(f"  best textbook law by mean RMS: {name}, {means[name] / own.mean():.1f} times ours")
    print(f"  cells in which ours is the most exact: {(own < best).sum()} of {len(own)}")


def robustness():
    """The tracker from bad starts and on robots it does not know."""
    law = {"curvature-tracker": CurvatureTracker()}
    for start in ("offset", "metre", "across"):
        result = compare(law, start={start: STARTS[start]})
        line(f"start {start}, after 3 m", *summary(result.cells), failures(result.cells))
    for name in ("slow-servo", "late", "payload"):
        result = compare(law, start={"on-path": STARTS["on-path"]}, condition=conditions([name]))
        line(f"robot {name}", *summary(result.cells), failures(result.cells))


def track(path, scale):
    """A track nobody tuned for, at the speed of its own plan."""
    run = simulate(
        CurveFile(path=str(path), scale=scale, tolerance=0.02),
        plant=Actuated(),
        controller=CurvatureTracker(),
        clock=Sampled(period=0.01, delay=0.01, duration=3000.0),
        limits=Limits(speed=3.0),
    )
    m = run.metrics
    line(f"{path.stem} ({m.path_length:.0f} m)", 1e3 * m.cross_track_rms, 1e3 * m.cross_track_max)


def speed():
    """One control step called from Python, and many in lanes."""
    stepper = Stepper(CurvatureTracker(), Cycloid.over())
    motion = Motion(0.0708, 0.4113, 1.3147, 0.5, -0.15, -0.12)
    stepper.step(motion)
    times = np.empty(20000)
    for n in range(len(times)):
        begin = time.perf_counter()
        stepper.step(motion)
        times[n] = time.perf_counter() - begin
    print(f"one step from Python: p50 {1e6 * np.median(times):.2f} µs (goal <= 5)")
    print(f"in lanes: {lanes(stepper, motion):.3g} steps per second on one core (goal >= 1e6)")


def lanes(stepper, motion, width=64, calls=4000):
    """Control steps per second of the same template with ``width`` lanes."""
    engine = stepper._engine
    names = ("decide", "LIKE", "LIKE_PARAMETERS", "LIKE_MEASURED")
    parts = {name: vars(engine)[name] for name in names}
    wide = compose("osculate.control.templates.stepper", {**parts, "LANES": width})
    memory, parameters = (np.repeat(a, width, 1) for a in (stepper._memory, stepper._parameters))
    seen = np.repeat(np.array(motion)[:, None], width, 1)
    command = np.zeros((3, width))
    wide.step_block(memory, parameters, seen, command, stepper.tables)
    begin = time.perf_counter()
    for _ in range(calls):
        wide.step_block(memory, parameters, seen, command, stepper.tables)
    return width * calls / (time.perf_counter() - begin)


def summary(cells):
    rms = 1e3 * np.array([c["cross_track_rms"] for c in cells])
    return rms.mean(), rms.max(), 1e3 * max(c["cross_track_max"] for c in cells)


def failures(cells):
    return f"{sum(c['failed'] for c in cells)} failures of {len(cells)}"


def line(label, *values):
    texts = (value if isinstance(value, str) else f"{value:.4g}" for value in values)
    print(f"{label}: {' / '.join(texts)}")


if __name__ == "__main__":
    main()
