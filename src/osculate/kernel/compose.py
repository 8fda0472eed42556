"""Composition: build a closed loop from parts, once, and keep its machine code for the next process.

A *template* is an ordinary module of this package that uses some names it does not define; it
declares them under ``if TYPE_CHECKING:``. `compose` executes the template's source in a new module
in which those names are bound to the chosen parts. All callees are then globals of one module, which
is what Numba needs to inline them and to cache the result on disk.

Numba's own cache does not notice a change in an imported function. The composed module is therefore
stored under a hash of the source files of everything that its parts reach, and of the constants.
"""

import hashlib
import inspect
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from threading import Lock
from types import CodeType, FunctionType, ModuleType
from typing import Any, TypeVar

import numba

from osculate.errors import OsculateError

F = TypeVar("F", bound=Callable[..., object])

_FOREIGN = {*sys.stdlib_module_names, "numba", "numpy", "llvmlite"} - {"__main__"}

_composed: dict[str, ModuleType] = {}
_composing = Lock()  # blocks of a batch ask for their engine at the same time


def compiled(function: F) -> F:
    """Compile an entry point of a template: cached on disk, and free of the interpreter's lock."""
    entry: F = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return entry


def compose(template: str, parts: Mapping[str, Any]) -> ModuleType:
    """The module that results from binding ``parts`` in ``template``.

    Args:
        template: Dotted name of the template module.
        parts: A function (kernel), named-tuple class or number for every name that it leaves open.

    Returns:
        A module; equal sources and parts give the same module within a process.
    """
    source = _source(template)
    key = _fingerprint(source, parts)
    with _composing:
        if key not in _composed:
            _composed[key] = _execute(template, source, key, parts)
        return _composed[key]


def cache_directory() -> Path:
    """Where composed modules and their machine code are kept.

    ``OSCULATE_CACHE_DIR`` if set, else ``osculate`` in the user's cache directory, else (when that
    cannot be written) in the directory for temporary files.
    """
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "osculate"
    chosen = os.environ.get("OSCULATE_CACHE_DIR")
    for candidate in [Path(chosen)] if chosen else [user, Path(tempfile.gettempdir()) / "osculate"]:
        try:
            candidate.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(candidate, os.W_OK):
            return candidate
    raise OsculateError("no writable cache directory; set OSCULATE_CACHE_DIR to one")


def _execute(template: str, source: str, key: str, parts: Mapping[str, Any]) -> ModuleType:
    name = f"osculate_composed_{template.rpartition('.')[2]}_{key}"
    path = cache_directory() / f"{name}.py"
    if not path.exists():  # rewriting it would make Numba discard the machine code
        temporary = path.with_suffix(f".{os.getpid()}.tmp")
        temporary.write_text(source, encoding="utf-8")
        temporary.replace(path)
    module = ModuleType(name, f"{template} with its parts bound")
    module.__file__ = str(path)
    vars(module).update(parts)
    sys.modules[name] = module
    exec(compile(source, str(path), "exec"), vars(module))
    return module


@cache
def _source(template: str) -> str:
    try:
        spec = find_spec(template)
    except ModuleNotFoundError:
        spec = None
    if spec is None or spec.origin is None:
        raise OsculateError(f"template {template!r} is not an importable module")
    return Path(spec.origin).read_text(encoding="utf-8")


def _fingerprint(source: str, parts: Mapping[str, Any]) -> str:
    files: dict[str, str] = {}
    constants: list[str] = [numba.__version__]
    seen: set[int] = set()
    for name in sorted(parts):
        constants.append(name)
        _reach(parts[name], files, constants, seen)
    digest = hashlib.sha256(source.encode())
    for text in [*constants, *(f"{name}:{files[name]}" for name in sorted(files))]:
        digest.update(text.encode())
    return digest.hexdigest()[:20]


def _reach(value: Any, files: dict[str, str], constants: list[str], seen: set[int]) -> None:
    """Collect the source files and constants that ``value`` depends on, through all callees."""
    function = getattr(value, "py_func", value)
    if isinstance(function, (FunctionType, type)):
        if id(function) in seen:
            return
        seen.add(id(function))
        if function.__module__.partition(".")[0] in _FOREIGN:
            return
        constants.append(function.__qualname__)
        _add_file(function, files)
        if isinstance(function, FunctionType):
            for name in _global_names(function.__code__):
                if name in function.__globals__:
                    _reach(function.__globals__[name], files, constants, seen)
    elif isinstance(value, (int, float, bool, str, tuple)):
        constants.append(repr(value))


def _add_file(value: Any, files: dict[str, str]) -> None:
    try:
        path = inspect.getsourcefile(value)
    except TypeError:  # built into the interpreter
        return
    if path and path not in files and Path(path).exists():
        files[path] = hashlib.sha256(Path(path).read_bytes()).hexdigest()


def _global_names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _global_names(constant)
