"""Things of Python, NumPy and Numba, for which their versions stand, and what others add to them."""

import sys
import sysconfig
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core.typing.templates import builtin_registry

_overloads: dict[int, list[Any]] = {}
_registered = 0  # globals of Numba's registry that `_overloads` knows


def versions() -> tuple[object, ...]:
    """What the machine code of every kernel depends on: interpreter, libraries, compiler options."""
    modules = [(module.__name__, module.__version__) for module in (numba, np, llvmlite)]
    names = ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT")
    options = [(name, getattr(numba.config, name, None)) for name in names]
    return sys.implementation.cache_tag, tuple(sys.version_info), tuple(modules), tuple(options)


def overloads_of(value: Any) -> list[Any]:
    """The compiled implementations of a Python function that are not Numba's own."""
    global _registered
    known = builtin_registry.globals
    for key, kind in known[_registered:]:
        for template in getattr(kind, "templates", ()):
            implementation = getattr(template, "_overload_func", None)
            if implementation and not is_foreign(implementation.__module__):
                _overloads.setdefault(id(key), []).append((implementation, template._jit_options))  # noqa: SLF001
    _registered = len(known)
    return _overloads.get(id(value), [])


def named(value: Any) -> tuple[str, ...] | None:
    """The name that stands for a module, function, class or type of Python, NumPy or Numba, or None."""
    if isinstance(value, ModuleType) and is_foreign(value.__name__):
        return "module", value.__name__
    if isinstance(value, (numba.types.Type, np.dtype)):
        return type(value).__name__, str(value)
    return ("foreign", value.__module__, _title(value)) if findable(value) else None


def _title(value: Any) -> str:
    return str(getattr(value, "__qualname__", None) or getattr(value, "__name__", ""))


def findable(value: Any) -> bool:
    """Whether a thing of Python, NumPy or Numba can be found again under its name."""
    module = getattr(value, "__module__", None)
    if not isinstance(module, str) or not is_foreign(module):
        return False
    found: Any = sys.modules.get(module)
    for part in _title(value).split("."):
        found = getattr(found, part, None)
    return found is value


@cache
def is_foreign(module: str | None) -> bool:
    """Whether a module belongs to Python, NumPy or Numba."""
    top = str(module).partition(".")[0]
    if top in ("numba", "numpy", "llvmlite"):
        return True
    if top not in sys.stdlib_module_names:
        return False
    file = getattr(sys.modules.get(top), "__file__", None)
    if file is None:
        return True
    library = Path(sysconfig.get_path("stdlib"))  # a user's module may have the same name
    return Path(file).is_relative_to(library) and not Path(file).is_relative_to(
        library / "site-packages"
    )
