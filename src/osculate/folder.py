"""A folder of files that belong together: complete, or it says that it is not."""

import contextlib
import json
import os
import time
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from types import TracebackType
from typing import Self

from osculate.errors import InvalidInput, NotWritten
from osculate.files import is_still, lock_file, write_by, write_text
from osculate.strict_json import strict_json

MARK = "INCOMPLETE.txt"
RECORD = ".osculate.json"  # the files of every kind of output in the folder
BEGUN = "not finished"  # in the record: the kinds of output of which something is missing


class OutputFolder:
    """A folder while it is written, in a ``with`` statement.

    From the first file to the last one it holds ``INCOMPLETE.txt``, which says what is missing; it stays
    while an earlier output of another kind is not complete. Files that an earlier output of the same kind
    has left are removed, whatever else is there stays. One process writes at a time, others wait. A file
    that cannot be written does not keep others from it.

    Args:
        path: The folder; made if missing.
        kind: What is written, such as ``run``; different kinds may share a folder.
        expected: Names of the files that are going to be written, as far as they are known.

    Raises:
        InvalidInput: The folder cannot be made or written.
        NotWritten: At the end of the statement: some files are missing; says which ones and why.
    """

    def __init__(self, path: str | Path, kind: str, expected: Iterable[str] = ()) -> None:
        self.path, self.kind, self.expected = Path(path), kind, list(expected)
        self.written: list[Path] = []
        self._failed: dict[str, Exception] = {}
        self._old: set[str] = set()
        self._others: set[str] = set()  # kinds of output that an earlier process has not finished
        self._lock = -1

    def __enter__(self) -> Self:
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock = self._claim()
            self._mark()
            found = self._recorded()
            self._old, self._others = set(found.get(self.kind, ())), set(found.get(BEGUN, ()))
            self._others.discard(self.kind)
        except OSError as error:
            if self._lock >= 0:
                os.close(self._lock)
            message = f"must be a writable folder ({error})"
            raise InvalidInput("output", str(self.path), message) from None
        return self

    def write(self, name: str, writer: Callable[[Path], object]) -> Path | None:
        """Let ``writer`` write one file to the path it is given; its own path, or None if it failed."""
        target = self.path / name
        self.expected += [name] if name not in self.expected else []
        try:
            names = {*self._old, *(path.name for path in self.written), name}
            begun = {*self._others, self.kind}
            self._record(names, begun)  # before the file: if this process is killed, the next knows
            write_by(writer, target)
            self.written.append(target)
            self._remove_old()
        except Exception as error:  # whatever it is, the other files are wanted all the more
            self._failed[name] = error
            return None
        return target

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        try:
            if error is None and not self._failed:
                with contextlib.suppress(OSError):  # a full disk; it then names too many
                    self._record({path.name for path in self.written}, self._others)
                if self._others:
                    self._say_who_has_not_finished()
                else:
                    (self.path / MARK).unlink(missing_ok=True)
                return
            self._say_what_is_missing(kind)
        finally:
            os.close(self._lock)
        if error is None:
            first = next(iter(self._failed.values()))
            raise NotWritten(str(self.path), self._failed) from first

    def _claim(self) -> int:
        """Create the mark and lock it, after whoever writes the folder now."""
        mark = self.path / MARK
        while True:
            lock = os.open(mark, os.O_CREAT | os.O_RDWR, 0o666)
            if not lock_file(lock, wait=False):
                warnings.warn(f"{self.path} is being written by another process", stacklevel=4)
                lock_file(lock, wait=True)
            if is_still(lock, mark):
                return lock
            os.close(lock)

    def _mark(self) -> None:
        when = time.strftime("%Y-%m-%d %H:%M:%S")
        text = (
            f"This folder is not complete: since {when} a {self.kind} is being written into it.\n"
            "If nothing is at work here any more, run the command again.\n"
        )
        self._write_mark(text + (f"Files: {', '.join(self.expected)}.\n" if self.expected else ""))

    def _write_mark(self, text: str) -> None:
        content = text.encode("utf-8", errors="backslashreplace")
        os.pwrite(self._lock, content, 0)
        os.ftruncate(self._lock, len(content))

    def _remove_old(self) -> None:
        """Once there is something new, what was there before goes."""
        for name in self._old:
            here = name and Path(name).name == name  # else somebody has changed the record
            if here and (self.path / name).is_file() and self.path / name not in self.written:
                (self.path / name).unlink()
        self._old.clear()

    def _recorded(self) -> dict[str, list[str]]:
        try:
            found = json.loads((self.path / RECORD).read_text(encoding="utf-8"))
            return {str(kind): [str(name) for name in names] for kind, names in found.items()}
        except (FileNotFoundError, ValueError, AttributeError, TypeError):
            return {}

    def _record(self, names: set[str], begun: set[str]) -> None:
        known = self._recorded()
        known.pop(BEGUN, None)
        others = {kind: [n for n in own if n not in names] for kind, own in known.items()}
        found = {**others, self.kind: sorted(names), **({BEGUN: sorted(begun)} if begun else {})}
        write_text(self.path / RECORD, strict_json(found, indent=1) + "\n", durable=False)

    def _say_who_has_not_finished(self) -> None:
        kinds = ", ".join(sorted(self._others))
        with contextlib.suppress(OSError):  # a full disk; then the first text stays
            self._write_mark(
                f"This folder is not complete: files of an earlier {kinds} are missing.\n"
                f"What was written last, the {self.kind}, is complete.\n"
            )

    def _say_what_is_missing(self, kind: type[BaseException] | None) -> None:
        done = [path.name for path in self.written]
        early = "interrupted" if kind and not issubclass(kind, Exception) else "not written"
        missing = [name for name in self.expected if name not in done]
        lines = [
            "This folder is not complete.",
            *(f"Missing: {name} ({self._failed.get(name, early)})" for name in missing),
            f"Finished: {', '.join(done) or 'nothing'}.",
        ]
        with contextlib.suppress(OSError):  # a full disk; then the first text stays
            self._write_mark("\n".join(lines) + "\n")
