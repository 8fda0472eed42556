"""Many noisy closed loops with estimator: how long they take, and how exact they are.

    .venv/bin/python benchmarks/noise.py --runs 100000

A lemniscate at 1 m/s for 20 s, sensors with a seed of their own in every run, payload, worn wheels and a
steering offset that no law knows.
"""

import argparse
import math
import time

import numpy as np

from osculate import (
    CurvatureTracker,
    InitialState,
    Laps,
    Limits,
    Payload,
    Sampled,
    Sensors,
    SteeringOffset,
    WheelWear,
    simulate_batch,
)
from osculate.study.comparison.suite import CURVES

SECONDS = 20.0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10_000)
    runs = parser.parse_args().runs
    drive(64)  # compile
    begin = time.perf_counter()
    metrics = drive(runs).metrics
    seconds = time.perf_counter() - begin
    rms = 1e3 * metrics.cross_track_rms
    largest = 1e3 * metrics.cross_track_max
    print(f"{runs} runs of {SECONDS:g} s in {seconds:.1f} s: {seconds / runs * 1e3:.2f} ms a run")
    print(f"100000 runs at this rate: {seconds / runs * 1e5 / 60:.1f} minutes (goal <= 60)")
    print(f"cross-track RMS: mean {rms.mean():.3f} mm, 99 % below {np.quantile(rms, 0.99):.3f} mm")
    print(f"cross-track max: mean {largest.mean():.2f} mm, largest {largest.max():.2f} mm")
    ended, counts = np.unique(metrics.ended, return_counts=True)
    print("ended by:", ", ".join(f"{e} {c}" for e, c in zip(ended, counts, strict=True)))


def drive(runs):
    return simulate_batch(
        Laps(track=CURVES["lemniscate"], count=2),
        controller=CurvatureTracker(),
        limits=Limits(speed=1.0),
        sensors=Sensors(),
        faults=(Payload(mass=4.5), WheelWear(loss=0.02), SteeringOffset(angle=math.radians(1.0))),
        initial=InitialState(settled=3.0),
        clock=Sampled(period=0.01, delay=0.01, duration=SECONDS),
        vary={"sensors.seed": np.arange(runs, dtype=float)},
    )


if __name__ == "__main__":
    main()
