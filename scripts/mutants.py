"""Do the tests bite? Changes one thing in the code at a time and asks whether some test fails.

    make mutants                                   # control, target, curve and plant
    .venv/bin/python scripts/mutants.py --room target --count 20

Mutants are drawn at random (``--seed``) from all places of a room: signs, operators, comparisons,
numbers, branches. First the room's own tests run once without any mutant and without compilation; each
says how long it takes and which functions it enters. A mutant then meets, uncompiled, the quick tests
of all files that enter its function, in a process forked from one that has imported everything; what
lives on meets the compiled tests in `COMPILED`. Survivors are printed with their place; those judged to
change nothing that matters stand in ``mutants.txt``, one a line, as printed but without time and line
number and with the reason behind, and do not count. The exit status is 1 where fewer than 85 % of a
room's mutants are killed.
"""

import argparse
import ast
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mutations import count_of, mutated
from quick_tests import Survey, kills, survey

ROOT = Path(__file__).parent.parent
JUDGED = Path(__file__).with_suffix(".txt")
WANTED = 0.85
PATIENCE = 600.0  # s, after which compiled tests run in circles: killed

#: What runs compiled for a mutant that all quick tests let live, most telling first.
COMPILED = {
    "control": (
        "tests/control/tracking/test_tracking.py::test_other_vehicles",
        "tests/control/test_safety.py",
    ),
    "target": ("tests/simulation/test_run.py::test_the_papers_cases",),
    "curve": ("tests/simulation/test_run.py::test_the_papers_cases",),
    "plant": ("tests/simulation/test_run.py::test_the_papers_cases", "tests/plant/test_faults.py"),
}


def survives_compiled(copy: Path, room: str) -> bool:
    """Whether the compiled tests of a room pass in the copy."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(copy / "src"),
        "OSCULATE_CACHE_DIR": str(copy / "machine-code"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    environment.pop("NUMBA_DISABLE_JIT", None)
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    try:
        done = subprocess.run(
            [*command, *COMPILED[room]],
            cwd=copy, env=environment, capture_output=True, timeout=PATIENCE, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def interval(killed: int, tried: int) -> tuple[float, float]:
    """Wilson's 95 % confidence interval of the fraction that is killed."""
    z, rate = 1.96, killed / tried
    middle = rate + z**2 / (2 * tried)
    half = z * math.sqrt(rate * (1 - rate) / tried + (z / (2 * tried)) ** 2)
    return tuple((middle + sign * half) / (1 + z**2 / tried) for sign in (-1, 1))


def try_one(copy: Path, room: str, file: Path, number: int, known: Survey) -> tuple[str, str]:
    """What becomes of one mutant ("judged", "killed", "survived"), and its place and change."""
    source = (ROOT / file).read_text(encoding="utf-8")
    text, lines, change = mutated(source, number)
    judged = JUDGED.read_text(encoding="utf-8").splitlines() if JUDGED.exists() else []
    place = f"{file.as_posix()}:{lines[0]}: {change}"
    if any(line.startswith(f"{file.as_posix()}: {change}") for line in judged):
        return "judged", place
    (copy / file).write_text(text, encoding="utf-8")
    try:
        dead = kills(copy, known.entering(copy / file, lines)) or not survives_compiled(copy, room)
    finally:
        (copy / file).write_text(source, encoding="utf-8")
    return ("killed" if dead else "survived"), place


def try_room(copy: Path, room: str, count: int, seed: int) -> bool:
    """Try mutants of one room; whether enough of them are killed."""
    files = sorted((ROOT / "src" / "osculate" / room).rglob("*.py"))
    places = [
        (file.relative_to(ROOT), number)
        for file in files
        for number in range(count_of(ast.parse(file.read_text(encoding="utf-8"))))
    ]
    chosen = random.Random(seed).sample(places, min(count or len(places), len(places)))
    known = survey(copy, f"tests/{room}")
    if not survives_compiled(copy, room):
        raise SystemExit(f"the tests of {room} fail without any mutant")
    fates = []
    for file, number in chosen:
        begin = time.monotonic()
        fate, place = try_one(copy, room, file, number, known)
        fates.append(fate)
        print(f"{fate:8} {time.monotonic() - begin:5.1f} s  {place}", flush=True)
    killed, tried = fates.count("killed"), len(fates) - fates.count("judged")
    low, high = interval(killed, tried) if tried else (0.0, 1.0)
    print(
        f"{room}: {killed} of {tried} killed (95 %: {low:.0%} to {high:.0%}), drawn from "
        f"{len(places)} places",
        flush=True,
    )
    return killed >= WANTED * tried


def main() -> None:
    """Copy the checkout, then try mutants room by room."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--room", choices=COMPILED, action="append", help="by default all four")
    parser.add_argument("--count", type=int, default=40, help="mutants of a room; 0 tries all")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder).resolve()
        for name in ("src", "tests", "examples", "docs"):
            shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "README.md"):
            shutil.copy(ROOT / name, copy)
        compiled = ROOT / ".pytest_cache" / "osculate"  # of `make test`: saves most compilations
        if compiled.is_dir():
            shutil.copytree(compiled, copy / "machine-code")
        enough = [try_room(copy, r, options.count, options.seed) for r in options.room or COMPILED]
    sys.exit(0 if all(enough) else 1)


if __name__ == "__main__":
    main()
