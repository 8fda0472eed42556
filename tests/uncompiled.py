"""Run a piece of Python without compilation and return what it prints."""

import os
import subprocess
import sys
import textwrap


def run_uncompiled(code: str) -> str:
    """Standard output of ``code`` in a new process in which every kernel is plain Python."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", textwrap.dedent(code)],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
