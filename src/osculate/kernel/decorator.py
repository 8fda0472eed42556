"""The one decorator of every compiled scalar function."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba.extending import overload

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
    return compiled


def compiled_twin(function: Callable[..., Any]) -> Any:
    """Decorate the compiled implementation of a Python function that kernels may call."""
    return overload(function, jit_options=FLAGS, strict=False, prefer_literal=True)
