"""Composition: build a closed loop from parts, once, and keep its machine code for the next process.

A *template* is an ordinary module that uses some names it does not define; it declares them under
``if TYPE_CHECKING:``. `compose` executes the template's code in a new module in which those names are bound
to the chosen parts. All callees are then globals of one module, which is what Numba needs to inline them
and to keep the result.

Numba's own cache does not notice a change in an imported function. Machine code is therefore stored under
a fingerprint of everything that it depends on (`osculate.kernel.fingerprint`, `osculate.kernel.store`).
"""

import sys
from collections.abc import Callable, Mapping
from functools import cache
from importlib.util import find_spec
from threading import Lock
from types import CodeType, ModuleType
from typing import Any, TypeVar

import numba
from numba.core.dispatcher import Dispatcher

from osculate.errors import OsculateError
from osculate.kernel.fingerprint import fingerprint
from osculate.kernel.store import MachineCode

F = TypeVar("F", bound=Callable[..., object])

_composed: dict[str, ModuleType] = {}
_composing = Lock()  # blocks of a batch ask for their engine at the same time


def compiled(function: F) -> F:
    """Compile an entry point of a template: kept on disk, and free of the interpreter's lock."""
    entry: F = numba.njit(nogil=True, error_model="numpy")(function)
    if isinstance(entry, Dispatcher):
        entry._cache = MachineCode(entry.py_func)  # noqa: SLF001 (Numba takes no cache of others)
    return entry


def compose(template: str, parts: Mapping[str, Any]) -> ModuleType:
    """The module that results from binding ``parts`` in ``template``.

    Args:
        template: Dotted name of the template module.
        parts: A function (kernel), named-tuple class or number for every name that it leaves open.

    Returns:
        A module; equal parts give the same module within a process.

    Raises:
        InvalidInput: A part depends on something that cannot be compared between processes, or that has
            changed since the part was compiled.
    """
    code, file = _code(template)
    label = template.rpartition(".")[2]
    key = fingerprint({"template": template, **dict(sorted(parts.items()))}, label)
    name = f"osculate_composed_{label}_{key[:20]}"
    with _composing:
        if name not in _composed:
            module = ModuleType(name, f"{template} with its parts bound")
            module.__file__ = file
            vars(module).update(parts)
            sys.modules[name] = module
            exec(code, vars(module))
            _composed[name] = module
        return _composed[name]


@cache
def _code(template: str) -> tuple[CodeType, str | None]:
    try:
        spec = find_spec(template)
    except ModuleNotFoundError:
        spec = None
    loader: Any = spec and spec.loader
    code = loader.get_code(template) if hasattr(loader, "get_code") else None
    if spec is None or code is None:
        raise OsculateError(f"template {template!r} is not an importable module")
    return code, spec.origin
