"""False and missing stops of the safety layer, on all robots of the catalogue.

    python benchmarks/false_stops.py            # everything
    python benchmarks/false_stops.py --quick    # two speeds

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
RECORD = 20  # steps between two rows of a record
LATE = "60 ms late"
CLOCK = Sampled(period=0.01, delay=0.01, duration=60.0)
FAULTS = {
    "stuck steering": StuckSteering(time=WHEN),
    **{f"no {s}": SensorLoss(sensor=s, time=WHEN) for s in ("pose", "wheels", "steering", "gyro")},
    LATE: Late(delay=0.06),
}


def cells(robots, speeds, widths):
    """(robot, curve, speed, half width) of everything that can be driven."""
    for robot, curve in itertools.product(robots, CURVES):
        try:
            plan_speed(CURVES[curve], VEHICLES[robot])
        except NoSolution:
            continue
        yield from itertools.product((robot,), (curve,), speeds, widths)


def drive(work, conditions, noisy):
    """A guarded batch of every cell under every condition, and its runs' (condition, cell)."""
    runs = list(itertools.product(conditions, work))
    cells = [cell for _, cell in runs]
    sensors = {"sensors": [Sensors(seed=n) for n in range(len(runs))]} if noisy else {}
    batch = simulate_batch(
        [CURVES[c] for _, c, _, _ in cells],
        [VEHICLES[r] for r, _, _, _ in cells],
        limits=[Limits(speed=v) for _, _, v, _ in cells],
        safety=[Safety(half_width=w) for _, _, _, w in cells],
        controller=CurvatureTracker(),
        faults=[conditions[name](VEHICLES[cell[0]]) for name, cell in runs],
        clock=CLOCK,
        record_every=RECORD,
        **sensors,
    )
    return batch, runs


def nothing(robot):
    return ()


def heavier(robot):
    return (Payload(mass=0.2 * robot.total_mass),)


def report_false(batch, runs, names):
    """Number of stops where nothing is wrong; prints which."""
    total = 0
    for name in names:
        mine = [(c, e) for (n, c), e in zip(runs, batch.metrics.ended, strict=True) if n == name]
        wrong = [(cell, end) for cell, end in mine if end != "path end"]
        print(f"{name:18}{len(mine):5d} runs {len(wrong):5d} stopped", flush=True)
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


def report_missing(batch, runs, name):
    """Number of exits with a fault where a stop would have stayed inside; prints which."""
    variables = [v.name for v in batch.variables]
    begin = int(np.searchsorted(batch.time, 0.0 if name == LATE else WHEN))
    ended, exits, avoidable = Counter(), 0, []
    for n, (fault, cell) in enumerate(runs):
        if fault != name:
            continue
        ended[str(batch.metrics.ended[n])] += 1
        far = float(batch.metrics.cross_track_max[n])
        if far > cell[3]:
            exits += 1
            reach = would_leave(batch.record[n, begin], variables, cell)
            if reach < cell[3]:
                avoidable.append((*cell, f"{far:.3f} m; a stop at once: {reach:.3f} m"))
    print(f"{name:18}{exits:5d} exits {len(avoidable):5d} avoidable", dict(ended), flush=True)
    for cell in avoidable:
        print("   ", *cell)
    return len(avoidable)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--quick", action="store_true", help="two speeds only")
    parser.add_argument("--robots", default=",".join(VEHICLES), help="names, with commas between")
    given = parser.parse_args()
    work = list(cells(given.robots.split(","), SPEEDS[1:3] if given.quick else SPEEDS, WIDTHS))
    batch, runs = drive(work, {"ideal": nothing, "payload": heavier}, noisy=False)
    count = report_false(batch, runs, ("ideal", "payload"))
    seen = {"noisy": nothing, "noisy, payload": heavier}
    stops = {name: lambda robot, fault=fault: (fault,) for name, fault in FAULTS.items()}
    batch, runs = drive(work, seen | stops, noisy=True)
    count += report_false(batch, runs, seen)
    count += sum(report_missing(batch, runs, name) for name in FAULTS)
    count += corrections(work)
    return 1 if count else 0


if __name__ == "__main__":
    raise SystemExit(main())
