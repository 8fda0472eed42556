"""Drives `Stepper` through wrong measurements and counts what must never happen.

All trackers, with and without estimator and safety layer, on three robots; every episode is a robot of the
tests' own (tests/control/kinematic.py) and a few random spans of wrong readings, reproduced by its seed.

    python benchmarks/fuzz_stepper.py --steps 10000000

Exit code 1 if anything was counted.
"""

import argparse
import itertools
import sys
import traceback
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from control.closed_loop import LAWS, SPEEDS, Case, episode, faults_of

EPISODE = 1200  # steps: long enough for the whole slalom


def fuzz(combination, steps, seed):
    """Count over at least ``steps`` steps of one combination; and the first seeds that failed."""
    case, counts, examples = Case(*combination), Counter(), []
    while counts["steps"] < steps:
        try:
            watch, _ = episode(case, seed, EPISODE)
            wrong = faults_of(watch)
            counts.update(watch.counts)
        except Exception:
            wrong = {"tracebacks": 1, traceback.format_exc(limit=3): 1}
            counts.update({"tracebacks": 1, "steps": EPISODE})
        if wrong:
            examples.append((combination, seed, wrong))
        seed += 1
    return counts, examples


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--steps", type=int, default=10_000_000, help="in all")
    parser.add_argument("--laws", default=",".join(LAWS), help="names, with commas between")
    parser.add_argument("--seed", type=int, default=0, help="of the first episode of each kind")
    parser.add_argument("--processes", type=int, default=2)
    given = parser.parse_args()
    kinds = list(itertools.product(given.laws.split(","), (True, False), (True, False), SPEEDS))
    share = -(-given.steps // len(kinds))
    counts, examples = Counter(), []
    with ProcessPoolExecutor(given.processes) as pool:
        jobs = [pool.submit(fuzz, kind, share, given.seed) for kind in kinds]
        for number, job in enumerate(as_completed(jobs), 1):
            found, failed = job.result()
            counts.update(found)
            examples += failed
            print(f"{number} of {len(jobs)}: {counts['steps']} steps", flush=True)
    for combination, seed, wrong in examples[:50]:
        print(*combination, f"seed {seed}:", wrong)
    for name, count in sorted(counts.items()):
        print(f"{name:24}{count:12d}")
    return 1 if faults_of(counts) or counts["tracebacks"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
