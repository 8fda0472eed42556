"""Finished work on disk: found again by everything that decides its numbers.

A long comparison or search that is interrupted, killed or extended continues where it was. Each piece of
work has a key: a hash of the code that makes numbers, of the versions of what it calls, and of all parts by
their fields. Any number of processes may share a folder; a file that is truncated, foreign or of other work
counts as missing and is replaced.
"""

import hashlib
import platform
import warnings
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import cache
from importlib import metadata
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.curve import CurveFile
from osculate.errors import InvalidInput
from osculate.files import write_bytes
from osculate.kernel.foreign import versions
from osculate.spec import Spec

SHOWS = ("apps", "study")  # rooms that show numbers and do not make them,
MAKES = {f"study/comparison/{name}.py" for name in ("compare", "tune", "kept")}  # but for these
CALLED = ("scipy", "mujoco", "casadi", "cma", "pyclothoids")

SEAL = hashlib.sha256().digest_size  # bytes

Arrays = dict[str, NDArray[Any]]


@dataclass
class Kept:
    """A folder of finished work.

    Attributes:
        folder: Where it is; made when something is kept.
        taken: How many pieces of work were taken over from it.
        made: How many were added to it.
        fails: Whether it could not be written.
    """

    folder: Path
    taken: int = field(default=0, init=False)
    made: int = field(default=0, init=False)
    fails: bool = field(default=False, init=False)

    @classmethod
    def at(cls, place: "Kept | str | Path | None") -> "Kept | None":
        """A folder of finished work, given itself or by its path.

        Raises:
            InvalidInput: Something else.
        """
        if place is None or isinstance(place, cls):
            return place
        if not isinstance(place, (str, Path)):
            raise InvalidInput("keep", place, "must be the path of a folder, a Kept, or None")
        return cls(Path(place))

    def find(self, key: str | None) -> Arrays | None:
        """What was kept under a key, or None."""
        if key is None:
            return None
        try:
            stream = BytesIO(_unsealed(self._file(key).read_bytes()))
            with np.load(stream, allow_pickle=False) as found:  # a pickle runs what it says
                arrays = {name: found[name] for name in found.files}
        except (OSError, ValueError, EOFError, KeyError, RuntimeError, zipfile.BadZipFile):
            return None
        if np.ravel(arrays.pop("key", "")).tolist() != [key, *sorted(arrays)]:
            return None
        self.taken += 1
        return arrays

    def keep(self, key: str | None, arrays: Mapping[str, Any]) -> None:
        """Keep a finished piece of work; where that fails, say so once and go on."""
        if key is None:
            return
        file = self._file(key)
        try:
            content = BytesIO()
            np.savez(content, key=np.array([key, *sorted(arrays)]), **arrays)
            write_bytes(file, _sealed(content.getvalue()), durable=False)
            self.made += 1
        except OSError as error:
            if not self.fails:
                warnings.warn(f"finished work cannot be kept ({error})", stacklevel=2)
            self.fails = True

    def _file(self, key: str) -> Path:
        return self.folder / f"{key[:32]}.npz"


def _sealed(content: bytes) -> bytes:
    """The content of a file, and behind it a hash: a disk that errs is noticed."""
    return content + hashlib.sha256(content).digest()


def _unsealed(sealed: bytes) -> bytes:
    """The content of a file.

    Raises:
        ValueError: It is not what was written.
    """
    content, seal = sealed[:-SEAL], sealed[-SEAL:]
    if hashlib.sha256(content).digest() != seal:
        raise ValueError("damaged")
    return content


def key_of(**parts: Any) -> str | None:
    """The key of a piece of work, from everything that decides its numbers.

    Args:
        **parts: Objects of this package, numbers, strings, arrays, and tuples, lists or mappings of them.

    Returns:
        64 hexadecimal digits; None where a part is of a kind that other processes cannot compare: work of
        classes defined elsewhere is not kept.
    """
    code = code_fingerprint()
    if code is None:
        return None
    try:
        described = repr((code, _versions(), _plain(parts)))
    except _Unknown:
        return None
    return hashlib.sha256(described.encode("utf-8", errors="surrogatepass")).hexdigest()


@cache
def code_fingerprint() -> str | None:
    """A hash of the source of everything that makes numbers; None where there is no source."""
    package = Path(__file__).parents[2]
    digest = hashlib.sha256()
    count = 0
    for path in sorted(package.rglob("*.py")):
        name = path.relative_to(package)
        if name.parts[0] not in SHOWS or name.as_posix() in MAKES:
            digest.update(f"{name.as_posix()} {path.stat().st_size} ".encode())
            digest.update(path.read_bytes())
            count += 1
    return digest.hexdigest() if count else None


@cache
def _versions() -> tuple[object, ...]:
    def version(name: str) -> str:
        try:
            return metadata.version(name)
        except metadata.PackageNotFoundError:
            return ""

    return versions(), platform.machine(), *((name, version(name)) for name in CALLED)


class _Unknown(Exception):
    """Something that other processes cannot compare."""


def _plain(value: Any) -> object:
    """What stands for a part: equal where the numbers that follow are equal."""
    if value is None or isinstance(value, (bool, int, float, str, Enum)):
        return type(value).__name__, repr(value)
    if isinstance(value, Spec):
        return _spec(value)
    if isinstance(value, (np.ndarray, np.generic)):
        return value.dtype.str, value.shape, hashlib.sha256(value.tobytes()).hexdigest()
    if isinstance(value, Mapping):
        return "mapping", [(str(key), _plain(item)) for key, item in value.items()]
    if isinstance(value, (tuple, list)):
        return "sequence", [_plain(item) for item in value]
    raise _Unknown


def _spec(value: Spec) -> object:
    kind = type(value)
    if kind.__module__.partition(".")[0] != "osculate":
        raise _Unknown
    fields = {name: getattr(value, name) for name in kind.model_fields}
    if isinstance(value, CurveFile):  # what the file holds, wherever it lies
        reading = value.reading
        fields |= {"path": "", "curve": reading.curve, "points": reading.points}
        fields["speeds of the file"] = reading.speeds
    return kind.__qualname__, [(name, _plain(item)) for name, item in fields.items()]
