"""Ctrl-C: the program ends within about a second, whatever it is doing, and leaves nothing half-written.

Python looks at signals between two of its own steps, which the compiler and the encoder of films can
keep it from for long. A thread of its own hears of the signal at once. It lets the program end by itself;
if that takes too long, it removes unfinished files and ends it.
"""

import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from osculate.files import remove_unfinished

EXIT_CODE = 130  # of a program that Ctrl-C has ended
PATIENCE = 0.6  # s, in which it can end by itself


class Interrupted(BaseException):
    """Ctrl-C; no error, and nothing that catches errors catches it."""


@contextmanager
def interruptible(say: Callable[[], None]) -> Iterator[None]:
    """Let Ctrl-C raise `Interrupted` in this ``with`` statement, and end the process if that does not.

    Args:
        say: Tells the user; called by the thread that ends the process.
    """
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:  # a shell has it ignored, or a host has its own
        yield
        return
    ours, theirs = socket.socketpair()
    ended = threading.Event()

    def watch() -> None:
        while ours.recv(1) != b"":
            if not ended.wait(PATIENCE):
                remove_unfinished()
                say()
                os._exit(EXIT_CODE)

    theirs.setblocking(False)
    signal.signal(signal.SIGINT, _interrupt)
    signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        ended.set()
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGINT, before)
        theirs.close()


def _interrupt(number: int, frame: FrameType | None) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # what is cleared up now is not interrupted again
    raise Interrupted
