"""Uncompiled tests for `mutants.py`: which functions each enters, how long it takes, and whether one fails.

Tests run in children forked from a process that has imported the packages behind osculate, but not
osculate itself: a child is ready at once, and sees the mutant.
"""

import importlib
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

#: s of CPU; tests that take longer, uncompiled and watched, are left to the compiled ones.
QUICK = 5.0
FORK = multiprocessing.get_context("fork")
GENEROUS = 10.0  # factor over what a test took without a mutant, after which it runs in circles
BEHIND = (
    "numba", "scipy.integrate", "scipy.interpolate", "scipy.optimize", "scipy.linalg", "sympy", "pydantic",
    "shapely", "yaml", "hypothesis", "pytest",
)  # fmt: skip


class QuickTest(NamedTuple):
    """One test that passes uncompiled."""

    name: str
    duration: float  # s
    entered: frozenset[tuple[str, int]]  # file and first line of every function of the package


class Survey(NamedTuple):
    """The quick tests of a room."""

    tests: list[QuickTest]

    def entering(self, file: Path, lines: tuple[int, ...]) -> list[QuickTest]:
        """The tests of all files that run a place: all tests for what runs at import.

        A whole file, since what one of its tests has computed is often kept for the others.
        """
        if len(lines) == 1:
            return self.tests
        place = (str(file), lines[1])
        files = {_file(test) for test in self.tests if place in test.entered}
        return [test for test in self.tests if _file(test) in files]


class Watch:
    """A pytest plugin: watches calls and durations, and stops a test that takes too long.

    Where tests are chosen it runs these alone, the file that takes least time first.
    """

    def __init__(self, source: str, chosen: list[QuickTest] | None = None) -> None:
        self.source, self.trace = source, chosen is None
        self.limits = {test.name: 1.0 + GENEROUS * test.duration for test in chosen or ()}
        self.order = _order(chosen or [])
        self.tests: list[QuickTest] = []
        self.always: set[tuple[str, int]] = set()  # entered while tests were collected

    def _note(self, entered: set[tuple[str, int]]) -> Callable[..., None]:
        def note(frame: FrameType, _event: str, _argument: Any) -> None:
            code = frame.f_code
            if code.co_filename.startswith(self.source):
                entered.add((code.co_filename, code.co_firstlineno))

        return note

    def pytest_sessionstart(self) -> None:  # noqa: D102 (pytest names it)
        if self.trace:
            sys.settrace(self._note(self.always))

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:  # noqa: D102 (pytest names it)
        if not self.trace:
            items[:] = sorted(
                (item for item in items if item.nodeid in self.order),
                key=lambda item: self.order[item.nodeid],
            )

    def pytest_runtest_protocol(self, item: Any, nextitem: Any) -> bool:  # noqa: D102 (pytest names it)
        from _pytest.runner import runtestprotocol

        entered: set[tuple[str, int]] = set()
        if self.trace:
            sys.settrace(self._note(entered))
        signal.signal(signal.SIGPROF, _too_long)
        signal.setitimer(signal.ITIMER_PROF, self.limits.get(item.nodeid, QUICK))
        begin = time.process_time()
        reports = runtestprotocol(item, nextitem=nextitem, log=False)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        for report in reports:
            item.ihook.pytest_runtest_logreport(report=report)
        if all(report.passed for report in reports):
            found = frozenset(entered | self.always)
            self.tests.append(QuickTest(item.nodeid, time.process_time() - begin, found))
        return True


def _order(tests: list[QuickTest]) -> dict[str, tuple[float, str, float]]:
    """What to sort by: the time of the test's file, the file, the time of the test."""
    files: dict[str, float] = {}
    for test in tests:
        files[_file(test)] = files.get(_file(test), 0.0) + test.duration
    return {test.name: (files[_file(test)], _file(test), test.duration) for test in tests}


def _file(test: QuickTest) -> str:
    return test.name.partition("::")[0]


class TooLong(BaseException):
    """Raised in a test after its time; nothing that catches an `Exception` catches it."""


def _too_long(_number: int, _frame: FrameType | None) -> None:
    raise TooLong


def _pytest(copy: Path, arguments: list[str], watch: Watch) -> int:
    import pytest

    os.chdir(copy)
    sys.path.insert(0, str(copy / "src"))
    os.environ["OSCULATE_CACHE_DIR"] = str(copy / "machine-code")
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)
    options = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
    options += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]  # hypothesis is there already
    return int(pytest.main([*options, *arguments], plugins=[watch]))


def _prepare() -> None:
    """Import what is behind osculate, uncompiled; once."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    sys.dont_write_bytecode = True
    for name in BEHIND:
        importlib.import_module(name)


def survey(copy: Path, tests: str) -> Survey:
    """Run the tests of a room once, without a mutant."""
    _prepare()
    receiver, sender = FORK.Pipe(duplex=False)
    child = FORK.Process(target=_survey, args=(copy, tests, sender))
    child.start()
    sender.close()
    found = receiver.recv()
    child.join()
    return Survey(found)


def _survey(copy: Path, tests: str, sender: Any) -> None:
    watch = Watch(str(copy / "src"))
    _pytest(copy, [tests], watch)
    sys.settrace(None)
    sender.send(watch.tests)


def kills(copy: Path, tests: list[QuickTest]) -> bool:
    """Whether one of the tests fails, or runs in circles, in the copy as it is now."""
    if not tests:
        return False
    child = FORK.Process(target=_try, args=(copy, tests))
    child.start()
    child.join(60.0 + GENEROUS * sum(test.duration for test in tests))
    if child.exitcode is None:
        child.kill()
        child.join()
    return child.exitcode != 0


def _try(copy: Path, tests: list[QuickTest]) -> None:
    files = sorted({_file(test) for test in tests})
    os._exit(_pytest(copy, ["-x", *files], Watch(str(copy / "src"), tests)))
