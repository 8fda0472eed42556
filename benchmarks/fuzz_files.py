"""Damaged files by the ten thousand: no traceback, no hang, no silent wrong answer.

    .venv/bin/python benchmarks/fuzz_files.py [--inputs 10000] [--first 0] [csv json yaml]

The same inputs as in the tests (tests/fuzzing/files.py), which take the first few hundred of each.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from fuzzing.files import KINDS, campaign


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--inputs", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    failed = False
    for kind in arguments.kinds:
        begin = time.monotonic()
        seeds = range(arguments.first, arguments.first + arguments.inputs)
        with tempfile.TemporaryDirectory() as folder:
            counts, bad = campaign(kind, seeds, Path(folder))
        print(f"{kind}: {dict(counts)} in {time.monotonic() - begin:.0f} s", flush=True)
        for found in bad[:10]:
            print(f"  seed {found.seed}: {found.kind}: {found.message[:200]}")
        failed = failed or bool(bad)
    sys.exit(failed)


if __name__ == "__main__":
    main()
