"""Ctrl-C: the program ends within about a second, whatever it is doing, and leaves nothing half-written.

Python looks at signals between two of its own steps, which the compiler and the encoder of films can
keep it from for long. A thread of its own hears of the signal at once. It lets the program end by itself;
if that takes too long, it removes unfinished files and ends it.
"""

import atexit
import contextlib
import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from osculate.files import remove_unfinished

EXIT_CODE = 130  # of a program that Ctrl-C has ended
PATIENCE = 0.5  # s, in which it can end by itself


class Interrupted(BaseException):
    """Ctrl-C; no error, and nothing that catches errors catches it."""


#: What is said after Ctrl-C: a sentence that ends with a full stop.
farewell = ["no file is half-written."]


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C end the process in this ``with`` statement: by `Interrupted`, or else without."""
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:  # a shell has it ignored, or a host has its own
        yield
        return
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    ended = threading.Event()
    signal.signal(signal.SIGINT, _interrupt)
    signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    watcher = threading.Thread(target=_watch, args=(ours, ended), daemon=True)
    watcher.start()
    try:
        yield
    except Interrupted:
        ended.set()
        _say()
        atexit._run_exitfuncs()  # noqa: SLF001 (there is no public name)
        with contextlib.suppress(OSError):
            sys.stdout.flush()
        os._exit(EXIT_CODE)  # taking the interpreter apart takes longer than everything else
    finally:
        ended.set()
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGINT, before)
        theirs.close()  # which ends the thread
        watcher.join()


def _interrupt(number: int, frame: FrameType | None) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # what is cleared up now is not interrupted again
    raise Interrupted


def _say() -> None:
    """Tell the user, below the streams, which another thread may hold."""
    clear = "\x1b[?25h\r\x1b[K" if os.isatty(2) else ""  # a cursor that was hidden, on a clear line
    with contextlib.suppress(OSError):
        os.write(2, f"{clear}interrupted: {farewell[-1]}\n".encode())


def _watch(signals: socket.socket, ended: threading.Event) -> None:
    with signals:
        while number := signals.recv(1):  # of every signal that Python handles
            if number[0] == signal.SIGINT and not ended.wait(PATIENCE):
                remove_unfinished()
                _say()
                os._exit(EXIT_CODE)
