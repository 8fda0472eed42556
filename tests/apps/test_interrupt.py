"""Ctrl-C: an exit code, a sentence, and nothing half-written, whatever the program is doing."""

import os
import pty
import signal
import subprocess
import sys
import time

import pytest

from osculate import OsculateError
from osculate.simulation.recording.video.opengl import offscreen

STUCK = """
import signal, sys, time
from osculate.apps.interrupt import interruptible
from osculate.files import complete_file
signal.signal(signal.SIGINT, signal.default_int_handler)
with interruptible(), complete_file(sys.argv[1]) as path:
    path.write_text("half")
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # as deaf as inside the compiler
    print("ready", flush=True)
    time.sleep(1000.0)
"""
HASTY = STUCK.replace("pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})", "getsignal(2)")
#: Runs a command that hears Ctrl-C, as at a terminal; what a shell starts in the background does not.
HEARING = (
    "import os, signal, sys; signal.signal(2, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])"
)
COMMAND = (sys.executable, "-c", HEARING, sys.executable, "-m", "osculate")


def ended(process, output=""):
    """Interrupt it; what it has printed."""
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    return (out or "") + err + output


@pytest.mark.parametrize("code", [STUCK, HASTY])
def test_a_program_ends_even_if_it_cannot_listen(tmp_path, code):
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "file")],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    process.stdout.readline()
    assert ended(process) == "interrupted: no file is half-written.\n"
    assert [*tmp_path.iterdir()] == []


def test_another_signal_ends_nothing():
    code = STUCK[: STUCK.index("with ")] + (
        "signal.signal(signal.SIGUSR1, lambda *_: None)\n"
        "with interruptible():\n"
        "    signal.raise_signal(signal.SIGUSR1)\n"
        "    time.sleep(2.0 * PATIENCE)\n"
    )
    code = code.replace("import interruptible", "import PATIENCE, interruptible")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_an_error_ends_a_program_as_always():
    code = STUCK[: STUCK.index("with ")] + "with interruptible():\n    1 / 0\n"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ZeroDivisionError" in done.stderr


def test_compiling_is_shown_and_can_be_interrupted(tmp_path):
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [*COMMAND, "run", "--output", str(tmp_path / "out")], stderr=theirs, stdout=subprocess.PIPE,
        env={**os.environ, "OSCULATE_CACHE_DIR": str(tmp_path / "cache"), "TERM": "xterm"},
    )  # fmt: skip
    os.close(theirs)
    seen = b""
    while b"compiling, once for these parts" not in seen:
        seen += os.read(ours, 4096)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    seen = os.read(ours, 100_000)
    os.close(ours)
    process.stdout.close()
    assert b"interrupted: no file is half-written." in seen
    assert seen.rindex(b"\x1b[?25h") >= seen.rfind(b"\x1b[?25l")  # the cursor is there again
    assert {path.name for path in tmp_path.iterdir()} <= {"cache"}


def test_a_film_can_be_interrupted(tmp_path):
    try:
        offscreen(64, 64).free()
    except OsculateError as error:
        pytest.skip(str(error))
    path = tmp_path / "mine.yaml"
    path.write_text("clock: {kind: continuous, duration: 5.0}\n")
    out = tmp_path / "out"
    process = subprocess.Popen(
        [*COMMAND, "run", str(path), "--output", str(out), "--video", str(out / "film.mp4")],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    while process.poll() is None and not [*out.glob(".osculate-*.mp4")]:
        time.sleep(0.01)
    assert "interrupted: no file is half-written.\n" in ended(process)
    names = {path.name for path in out.iterdir()}
    assert {"INCOMPLETE.txt", "run.nc", "metrics.json", "report.html", "overview.png"} <= names
    assert not [name for name in names if "film" in name or name.startswith(".osculate-")]
    assert "Missing: film.mp4 (interrupted)\n" in (out / "INCOMPLETE.txt").read_text()
