"""Fingerprints: a hash of everything that the machine code of a kernel depends on.

A fingerprint covers bytecode, constants, defaults, closures, arrays by content, module attributes and,
through all callees, the same of them; overloads and intrinsics behind Python functions; the fields and
defaults of named tuples; the versions of Python, NumPy, Numba and llvmlite. It covers no file names, line
numbers and docstrings. What cannot be compared between two processes is refused.

Numba freezes what a kernel reads when it compiles it. `pin` notes the fingerprints at that moment; a
kernel whose surroundings have changed since is refused as well, for its machine code is that of before.
"""

import hashlib
from collections.abc import Iterator, Mapping
from enum import Enum
from types import CodeType, FunctionType, ModuleType
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic

from osculate.errors import InvalidInput
from osculate.kernel.bytecode import Anatomy, Read, dissect
from osculate.kernel.foreign import findable, is_foreign, named, overloads_of

ATOMS = {bool, int, float, complex, str, bytes, type(None), type(Ellipsis)}

Content = tuple[object, ...]

_anatomies: WeakKeyDictionary[FunctionType, tuple[CodeType, str, Anatomy]] = WeakKeyDictionary()
_pinned: WeakKeyDictionary[FunctionType, dict[str, Content]] = WeakKeyDictionary()
_fixed: dict[int, tuple[Any, Content]] = {}  # classes and foreign things, which do not change


def fingerprint(value: Any, name: str) -> str:
    """The fingerprint of ``value``, 64 hexadecimal digits.

    Args:
        value: A kernel, function, named tuple or its class, number, string, array, or a tuple, list,
            set or mapping of such.
        name: What to call it in an error.

    Raises:
        InvalidInput: It depends on something that cannot be compared between processes, or on something
            that has changed since it was compiled.
    """
    return _hash(_Walk(pins=False).of(value, name))


def pin(function: FunctionType) -> str:
    """The fingerprint of a function that is compiled now, noted with those of all its callees.

    Raises:
        InvalidInput: As `fingerprint`.
    """
    return _hash(_Walk(pins=True).of(function, function.__qualname__))


class _Walk:
    """One walk through everything that can be reached; a function met again is not walked again.

    A function is described by a hash, everything else by a tuple of plain values, nested where it is.
    """

    def __init__(self, *, pins: bool) -> None:
        self.pins = pins
        self.known: dict[int, str] = {}
        self.open: list[int] = []  # functions on the way from the start to here
        self.circular: set[int] = set()  # those that call each other

    def of(self, value: Any, name: str) -> Content:
        """What stands for ``value``, called ``name``: equal where the machine code is equal."""
        if type(value) in ATOMS:
            return type(value).__name__, repr(value)
        if isinstance(value, (tuple, list)):
            return self.of(type(value), name), *[self.of(item, name) for item in value]
        if isinstance(value, Dispatcher):
            return self._dispatcher(value, name)
        if overloads := overloads_of(value):
            return "overloads", *[self.of(item, name) for item in overloads]
        if id(value) in _fixed:
            return _fixed[id(value)][1]
        if isinstance(value, _Intrinsic):
            return "intrinsic", self.of(value._defn, name), value._prefer_literal  # noqa: SLF001
        if isinstance(value, FunctionType) and not is_foreign(value.__module__):
            return ("function", self._function(value))
        if isinstance(value, type) and not findable(value):
            _fixed[id(value)] = value, self._class(value, name)
            return _fixed[id(value)][1]
        return self._data(value, name)

    def _data(self, value: Any, name: str) -> Content:
        if isinstance(value, (np.generic, np.ndarray)):
            return _array(value, name)
        if isinstance(value, Enum):
            return "enum", self.of(type(value), name), value.name
        if isinstance(value, (set, frozenset)):
            return "set", *sorted((self.of(item, name) for item in value), key=repr)
        if isinstance(value, Mapping):
            return "mapping", *[self.of(item, f"{name}.{item[0]}") for item in value.items()]
        stands_for = named(value)
        if stands_for is None:
            raise _refusal(name, value)
        _fixed[id(value)] = value, stands_for
        return _fixed[id(value)][1]

    def _dispatcher(self, value: Any, name: str) -> Content:
        if value._cache.cache_path:  # noqa: SLF001 (Numba has no public way to ask)
            valid = "is cached by Numba, which does not notice changes in its callees; use @kernel"
            raise InvalidInput(name, value, valid)
        options = self.of(value.targetoptions, name), self.of(value.locals, name)
        return ("kernel", self._function(value.py_func), *options)

    def _class(self, value: type, name: str) -> Content:
        title = (value.__module__, value.__qualname__)
        if issubclass(value, BaseException):
            return "exception", *title
        if issubclass(value, Enum):
            members = [(key, self.of(item.value, name)) for key, item in value.__members__.items()]
            return "enumeration", *title, *members
        if issubclass(value, tuple) and hasattr(value, "_fields"):
            defaults = self.of(dict(value._field_defaults), name)  # type: ignore[attr-defined]
            return "named tuple", *title, value._fields, defaults
        raise _refusal(name, value)

    def _function(self, function: FunctionType) -> str:
        if id(function) in self.known:
            return self.known[id(function)]
        _, essence, anatomy = _anatomy(function)
        if id(function) in self.open:
            circle = self.open[self.open.index(id(function)) :]
            self.circular.update(circle if len(circle) > 1 else ())
            return essence
        self.open.append(id(function))
        parts: dict[str, Content] = {
            "its code": (essence,),
            **dict(self._dependencies(function, anatomy)),
        }
        self.open.pop()
        digest = _hash(parts)
        if id(function) not in self.circular:  # else it depends on where the walk came from
            self._compare(function, parts)
            self.known[id(function)] = digest
        return digest

    def _dependencies(
        self, function: FunctionType, anatomy: Anatomy
    ) -> Iterator[tuple[str, Content]]:
        name = function.__qualname__
        for module in anatomy.imports:
            if not is_foreign(module):
                raise InvalidInput(f"{name}.{module}", module, "must be imported outside it")
        yield "its defaults", self.of((function.__defaults__, function.__kwdefaults__), name)
        for free, cell in zip(
            function.__code__.co_freevars, function.__closure__ or (), strict=True
        ):
            yield free, self.of(cell.cell_contents, f"{name}.{free}")
        for read in anatomy.reads:
            if read[0] in function.__globals__:
                path = ".".join(read)
                yield path, self._read(function.__globals__[read[0]], read, f"{name}.{path}")

    def _read(self, value: Any, read: Read, name: str) -> Content:
        """What ``a.b.c`` stands for: modules are followed, other values are taken with all they hold."""
        module = None
        for attribute in read[1:]:
            if not isinstance(value, ModuleType):
                break
            if not hasattr(value, attribute):
                return ("missing",)
            module, value = value.__name__, getattr(value, attribute)
        if module and is_foreign(module) and not overloads_of(value):
            return "foreign", module, *read
        return self.of(value, name)

    def _compare(self, function: FunctionType, parts: dict[str, Content]) -> None:
        before = _pinned.get(function)
        changed = before and [
            key for key in {**before, **parts} if before.get(key) != parts.get(key)
        ]
        if changed:
            valid = (
                f"was compiled before {', '.join(changed)} changed, and its machine code is the old one; "
                "define it again, or make what changes a parameter"
            )
            raise InvalidInput(function.__qualname__, function, valid)
        if self.pins and before is None:
            _pinned[function] = parts


def _hash(content: object) -> str:
    return hashlib.sha256(repr(content).encode()).hexdigest()


def _anatomy(function: FunctionType) -> tuple[CodeType, str, Anatomy]:
    found = _anatomies.get(function)
    if found is None or found[0] is not function.__code__:
        walk = _Walk(pins=False)
        anatomy = dissect(function.__code__, lambda value: walk.of(value, function.__qualname__))
        found = (function.__code__, _hash(anatomy.essence), anatomy)
        _anatomies[function] = found
    return found


def _array(value: Any, name: str) -> Content:
    if value.dtype.hasobject:
        raise _refusal(name, value)
    flags = value.flags
    order = (flags.c_contiguous, flags.f_contiguous)
    dtype = np.lib.format.dtype_to_descr(value.dtype)
    data = hashlib.sha256(value.tobytes()).hexdigest()
    return "array", type(value).__name__, dtype, value.shape, order, data


def _refusal(name: str, value: Any) -> InvalidInput:
    valid = (
        "is read by a kernel, but cannot be compared with what another process reads; make it a number, "
        "string, tuple, array or kernel, or hand it over as a parameter"
    )
    return InvalidInput(name, value, valid)
