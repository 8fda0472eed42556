"""How calm the steering is and how exact the tracking, over the horizon of the servo's inverse.

A slow servo (8 rad/s), decisions every 20 ms behind the estimator, poses at 50 Hz with 1 cm and 0.5°.
"""

import numpy as np

from osculate import (
    Actuators,
    CurvatureTracker,
    InitialState,
    Limits,
    Sampled,
    Sensors,
    Tricycle,
    simulate_batch,
)
from osculate.study.comparison.suite import CURVES

SERVO = 8.0  # rad/s
PERIOD = 0.02  # s
SETTLED = 2.0  # s, after which changes of the command count


def measure(horizon: float | None) -> tuple[float, float, float]:
    """RMS and largest change of the command (degrees), and mean RMS of the cross-track error (mm)."""
    cells = [(c, v) for c in CURVES for v in (0.5, 1.0)]
    clock = Sampled(period=PERIOD, delay=PERIOD, duration=60.0)
    batch = simulate_batch(
        [CURVES[c] for c, _ in cells],
        Tricycle(actuators=Actuators(steering_frequency=SERVO)),
        limits=[Limits(speed=v) for _, v in cells],
        sensors=[Sensors(seed=n + 1) for n in range(len(cells))],
        controller=CurvatureTracker(horizon=horizon),
        initial=InitialState(settled=3.0),
        clock=clock,
        record_every=clock.substeps,
    )
    column = [v.name for v in batch.variables].index("commanded_steering_angle")
    begin = round(SETTLED / PERIOD)
    changes = np.concatenate(
        [
            np.diff(record[begin : int(end / PERIOD), column])
            for record, end in zip(batch.record, batch.metrics.duration, strict=True)
        ]
    )
    step = np.degrees(changes)
    exact = 1e3 * float(batch.metrics.cross_track_rms.mean())
    return float(np.sqrt((step**2).mean())), float(np.abs(step).max()), exact


def main() -> None:
    """Print the table of the documentation."""
    print("| ω h | change of the command, RMS (°) | largest (°) | cross-track RMS (mm) |")
    print("|---:|---:|---:|---:|")
    for stretch in (0.4, 0.5, 0.6, 0.8, 1.0, 1.3, None):
        name = "chosen" if stretch is None else f"{stretch:g}"
        rms, largest, exact = measure(None if stretch is None else stretch / SERVO)
        print(f"| {name} | {rms:.2f} | {largest:.2f} | {exact:.3f} |", flush=True)


if __name__ == "__main__":
    main()
