"""False and missing stops of the safety layer, on all robots of the catalogue.

    python benchmarks/false_stops.py            # everything
    python benchmarks/false_stops.py --quick    # two speeds, no batches of faults

A false stop is one where nothing is wrong: ideal, noisy, with a fifth more mass, and with poses that are
corrected by 2 to 5 cm. A missing one is a robot with a fault that leaves its corridor although a stop from
the fault's instant on, with the steering as it is then, would have stayed inside. Exit code 1 if any.
"""

import argparse
import itertools
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from control.closed_loop import corrected
from osculate import (
    CurvatureTracker,
    Late,
    Limits,
    NoSolution,
    Payload,
    Safety,
    Sampled,
    SensorLoss,
    Sensors,
    StuckSteering,
    simulate_batch,
)
from osculate.study.comparison.suite import CURVES
from osculate.target.speed import plan_speed
from osculate.vehicle.catalogue import VEHICLES

SPEEDS = (0.5, 1.0, 1.5, 2.0)
WIDTHS = (0.1, 0.3)
WHEN = 2.0  # s, at which faults begin
CLOCK = Sampled(period=0.01, delay=0.01, duration=60.0)
FAULTS = {
    "stuck steering": StuckSteering(time=WHEN),
    **{f"no {s}": SensorLoss(sensor=s, time=WHEN) for s in ("pose", "wheels", "steering", "gyro")},
    "60 ms late": Late(delay=0.06),
}


def cells(robots, speeds, widths):
    """(robot, curve, speed, half width) of everything that can be driven."""
    for robot, curve in itertools.product(robots, CURVES):
        try:
            plan_speed(CURVES[curve], VEHICLES[robot])
        except NoSolution:
            continue
        yield from itertools.product((robot,), (curve,), speeds, widths)


def drive(work, faults=None, noisy=False, record_every=0):
    """A guarded batch, one run for every cell; ``faults`` makes those of a robot."""
    seen = [Sensors(seed=n) for n in range(len(work))] if noisy else None
    return simulate_batch(
        [CURVES[c] for _, c, _, _ in work],
        [VEHICLES[r] for r, _, _, _ in work],
        limits=[Limits(speed=v) for _, _, v, _ in work],
        safety=[Safety(half_width=w) for _, _, _, w in work],
        controller=CurvatureTracker(),
        faults=[faults(VEHICLES[r]) if faults else () for r, _, _, _ in work],
        clock=CLOCK,
        record_every=record_every,
        **({"sensors": seen} if noisy else {}),
    )


def heavier(robot):
    return (Payload(mass=0.2 * robot.total_mass),)


def false_stops(work):
    """Number of stops, and which, for every condition in which nothing is wrong."""
    conditions = {
        "ideal": {}, "payload": {"faults": heavier}, "noisy": {"noisy": True},
        "noisy, payload": {"faults": heavier, "noisy": True},
    }  # fmt: skip
    total = 0
    for name, condition in conditions.items():
        ended = drive(work, **condition).metrics.ended
        wrong = [(cell, e) for cell, e in zip(work, ended, strict=True) if e != "path end"]
        print(f"{name:18}{len(work):5d} runs {len(wrong):5d} stopped", flush=True)
        for cell, end in wrong:
            print("   ", *cell, end)
        total += len(wrong)
    return total


def corrections(work):
    """The same for poses that are corrected by 2 to 5 cm every two seconds, in the tests' loop."""
    wrong = Counter()
    for n, (cell, estimates) in enumerate(itertools.product(work, (True, False))):
        message = corrected(*cell, estimates=estimates, seed=n)
        if message:
            print("   ", *cell, "estimated" if estimates else "known", message, flush=True)
            wrong[message] += 1
    print(f"{'corrections':18}{2 * len(work):5d} runs {wrong.total():5d} stopped", flush=True)
    return wrong.total()


def would_leave(row, names, cell):
    """Distance (m) from the curve of a stop from a recorded row on, the steering as it is."""
    robot, curve, _, width = cell
    vehicle, path = VEHICLES[robot], CURVES[curve]
    x, y, heading, speed, angle = (
        row[names.index(n)] for n in ("x", "y", "heading", "speed", "steering_angle")
    )
    dec = Safety(half_width=width).stop_deceleration(vehicle)
    lag = 0.0 if vehicle.brake else vehicle.actuators.motor_lag
    way = np.linspace(0.0, speed * (0.02 + lag) + 0.5 * speed**2 / dec, 60)
    turn = way * np.tan(angle) / vehicle.wheelbase
    chord = way * np.sinc(0.5 * turn / np.pi)
    px, py = x + chord * np.cos(heading + 0.5 * turn), y + chord * np.sin(heading + 0.5 * turn)
    point = path.at(np.linspace(0.0, path.length, 4000))
    return max(np.hypot(point.x - a, point.y - b).min() for a, b in zip(px, py, strict=True))


def missing_stops(work):
    """Number of exits where a stop would have stayed inside, for every fault."""
    total = 0
    for name, fault in FAULTS.items():
        batch = drive(work, lambda robot, fault=fault: (fault,), noisy=True, record_every=10)
        names = [v.name for v in batch.variables]
        begin = int(np.searchsorted(batch.time, WHEN))
        exits, avoidable = 0, []
        for cell, far, record in zip(
            work, batch.metrics.cross_track_max, batch.record, strict=True
        ):
            if far > cell[3]:
                exits += 1
                reach = would_leave(record[min(begin, len(record) - 1)], names, cell)
                if reach < cell[3] or name == "60 ms late":
                    avoidable.append((*cell, f"{far:.3f} m, a stop at once {reach:.3f} m"))
        ended = Counter(batch.metrics.ended)
        print(
            f"{name:18}{len(work):5d} runs {exits:5d} exits {len(avoidable):5d} avoidable",
            dict(ended),
            flush=True,
        )
        for cell in avoidable:
            print("   ", *cell)
        total += len(avoidable)
    return total


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args()
    work = list(cells(VEHICLES, SPEEDS[::2] if given.quick else SPEEDS, WIDTHS))
    count = false_stops(work) + corrections(work[:: 4 if given.quick else 1])
    count += 0 if given.quick else missing_stops(work)
    return 1 if count else 0


if __name__ == "__main__":
    raise SystemExit(main())
