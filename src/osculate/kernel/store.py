"""Machine code on disk: found again by a fingerprint, in a folder that only its owner can write.

Machine code is loaded by unpickling, which runs whatever a file says; `osculate.kernel.folder` sees to it
that no other user can put a file there. Files carry a checksum: one that is truncated, foreign or
renamed counts as missing and is replaced. A file appears under its name complete or not at all, so
that any number of processes can fill the folder and be killed.
"""

import contextlib
import hashlib
import os
import pickle
import warnings
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.core.sigutils import normalize_signature
from numba.core.types import BaseTuple

from osculate.files import write_bytes
from osculate.kernel.fingerprint import pin
from osculate.kernel.folder import cache_directory, others_write
from osculate.kernel.foreign import versions

MAGIC = b"osculate machine code 1\n"
HEAD = len(MAGIC) + hashlib.sha256().digest_size


class MachineCode(NullCache):  # type: ignore[misc]
    """Where Numba looks for the machine code of one function, and leaves it."""

    def __init__(self, function: FunctionType) -> None:
        self.function = function
        self.file: Path | None = None  # for the types that Numba has asked for last

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The stored machine code for the argument types ``sig``, or None.

        Raises:
            InvalidInput: The function depends on something that cannot be compared between processes.
        """
        target_context.refresh()
        content = pin(self.function)
        folder = cache_directory()
        if folder is None:
            return None
        types = [_described(kind) for kind in normalize_signature(sig)[0]]
        key = (content, versions(), types, target_context.codegen().magic_tuple())
        digest = hashlib.sha256(repr(key).encode()).hexdigest()
        self.file = folder / f"{self.function.__name__}-{digest[:32]}.code"
        payload = _read(self.file)
        if payload:
            with contextlib.suppress(Exception):  # whatever is wrong with it, compiling repairs it
                result = CompileResult._rebuild(target_context, *pickle.loads(payload))  # noqa: SLF001
                if result.signature.args == normalize_signature(sig)[0]:
                    return result
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Store what was compiled for ``sig``, if another process can use it."""
        fixed = not data.lifted and not data.library.has_dynamic_globals
        if self.file and fixed and pickle.loads(dumps(data.signature)) == data.signature:
            _write(self.file, dumps(data._reduce()))  # noqa: SLF001


def _described(kind: Any) -> tuple[object, ...]:
    """An argument's type; the name of a named tuple does not say which field is where."""
    fields = getattr(kind, "fields", ())
    inner = [_described(part) for part in kind] if isinstance(kind, BaseTuple) else []
    return str(kind), str(getattr(kind, "instance_class", "")), fields, inner


def _read(file: Path) -> bytes | None:
    """The payload of ``file``, or None where there is none that we have written completely."""
    try:
        with file.open("rb") as stream:
            status = os.fstat(stream.fileno())
            if hasattr(os, "geteuid") and (status.st_uid != os.geteuid() or others_write(status)):
                return None
            content = stream.read()
    except OSError:
        return None
    payload = content[HEAD:]
    return payload if content == _head(file, payload) + payload else None


def _write(file: Path, payload: bytes) -> None:
    try:
        write_bytes(file, _head(file, payload) + payload, durable=False, private=True)
    except OSError as error:
        _say(f"machine code cannot be stored ({error}); the next process compiles again")


def _head(file: Path, payload: bytes) -> bytes:
    return MAGIC + hashlib.sha256(file.name.encode() + payload).digest()


@cache
def _say(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=2)
