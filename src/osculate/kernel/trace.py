"""Kernels as plain Python: run on symbols, so that a formula can be proved about the code itself."""

from types import FunctionType
from typing import Any


def plain(function: Any) -> Any:
    """The uncompiled twin of a kernel, which calls the uncompiled twins of all its helpers.

    It accepts whatever supports arithmetic: floats, NumPy arrays, SymPy expressions.
    """
    python = getattr(function, "py_func", function)
    scope = dict(python.__globals__)
    for name in python.__code__.co_names:
        callee = scope.get(name)
        if hasattr(callee, "py_func"):
            scope[name] = plain(callee)
    return FunctionType(python.__code__, scope, python.__name__, python.__defaults__)
