"""The one decorator of every compiled scalar function."""

from collections.abc import Callable
from contextlib import suppress
from types import FunctionType
from typing import Any, TypeVar

import numba
from numba.core.caching import NullCache
from numba.core.dispatcher import Dispatcher
from numba.extending import overload

from osculate.errors import InvalidInput
from osculate.kernel.fingerprint import pin

#: Compiler flags shared by every kernel and every intrinsic. Inlining is forced at the LLVM level,
#: so that a whole closed loop becomes one straight piece of code that can be vectorised; division
#: follows IEEE rules; there is no fastmath, so a lane, a single run and plain Python agree.
FLAGS = {"forceinline": True, "error_model": "numpy"}

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile a pure scalar function on floats and named tuples of floats.

    The uncompiled function stays available as ``.py_func``; with ``NUMBA_DISABLE_JIT=1`` the
    decorator returns the function itself and the whole package runs as plain Python.
    """
    compiled: F = numba.njit(**FLAGS)(function)
    if isinstance(compiled, Dispatcher):
        compiled._cache = _Pins(compiled.py_func)  # noqa: SLF001 (Numba's only hook before compiling)
    return compiled


class _Pins(NullCache):  # type: ignore[misc]
    """Stores nothing, but notes what a kernel depends on when it is compiled."""

    def __init__(self, function: FunctionType) -> None:
        self.function = function

    def load_overload(self, sig: Any, target_context: Any) -> None:
        """Called by Numba before it compiles for the signature ``sig``."""
        with suppress(InvalidInput):  # composing the kernel will refuse it
            pin(self.function)


def compiled_twin(function: Callable[..., Any]) -> Any:
    """Decorate the compiled implementation of a Python function that kernels may call."""
    return overload(function, jit_options=FLAGS, strict=False, prefer_literal=True)
