"""Fingerprints: equal where machine code would be equal, different where anything it depends on differs."""

import ctypes
import enum
import math
import os
import subprocess
import sys
import textwrap
import threading
from types import ModuleType
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba.extending import intrinsic, overload

from osculate.errors import InvalidInput
from osculate.kernel import axpy, kernel, load
from osculate.kernel import fingerprint as fingerprints
from osculate.kernel.fingerprint import fingerprint, pin

NUMBERS = st.one_of(
    st.integers(-9, 9), st.booleans(), st.sampled_from([0.0, -0.0, math.nan, math.inf]), st.floats()
)


def define(source, file="<memory>", **scope):
    """The function ``f`` of a source text that lies in no file."""
    scope = {"kernel": kernel, "np": np, "numba": numba, "__name__": "invented", **scope}
    exec(compile(textwrap.dedent(source), file, "exec"), scope)
    return scope["f"]


def mark(value):
    return fingerprint(value, "part")


def tuple_with(value):
    class Pair(NamedTuple):
        x: float
        y: float = value

    return Pair


def enumeration(value):
    return enum.Enum("Gain", {"HIGH": value})


def module_with(value):
    module = ModuleType("settings")
    module.inner = ModuleType("settings.inner")
    module.inner.GAIN = value
    return module


def overloaded(value, **options):
    def plain(x):
        return x

    overload(plain, jit_options=options)(define("def f(x):\n    return lambda x: G * x", G=value))
    return plain


def intrinsic_with(value):
    return intrinsic(define("def f(context, x):\n    return x(x), lambda *a: G", G=value))


FACTORY = (
    "def make(g):\n    @kernel\n    def f(x):\n        return g * x\n    return f\nf = make(G)"
)

#: where a number can hide from a look at source files
PLACES = {
    "literal": lambda g: define(f"@kernel\ndef f(x, nan=0, inf=1):\n    return ({g!r}, x)"),
    "global": lambda g: define("@kernel\ndef f(x):\n    return G * x", G=g),
    "closure": lambda g: define(FACTORY, G=g),
    "default": lambda g: define("@kernel\ndef f(x, g=G):\n    return g * x", G=g),
    "keyword default": lambda g: define("def f(x, *, g=G):\n    return g * x", G=g),
    "module attribute": lambda g: define(
        "def f(x):\n    return m.inner.GAIN * x", m=module_with(g)
    ),
    "array": lambda g: define("@kernel\ndef f(x):\n    return G[1] * x", G=np.array([1, g])),
    "tuple": lambda g: define("@kernel\ndef f(x):\n    return G[0][1] * x", G=((1.0, g), 2.0)),
    "callee": lambda g: define("@kernel\ndef f(x):\n    return h(x)", h=define(FACTORY, G=g)),
    "nested function": lambda g: define(
        "def f(x):\n    def inner():\n        return G * x\n    return inner()", G=g
    ),
    "default of a field": lambda g: define("def f(x):\n    return T(x).y", T=tuple_with(g)),
    "enumeration": lambda g: define("def f(x):\n    return E.HIGH", E=enumeration(g)),
    "member": lambda g: define("def f(x):\n    return E", E=enumeration(g).HIGH),
    "overload": lambda g: define("@kernel\ndef f(x):\n    return h(x)", h=overloaded(g)),
    "intrinsic": lambda g: define("@kernel\ndef f(x):\n    return h(x)", h=intrinsic_with(g)),
    "one of many globals": lambda g: define(
        "def f(x):\n    return (" + ",".join(f"G{n}" for n in range(300)) + ")",
        **{f"G{n}": g if n == 299 else 0 for n in range(300)},
    ),
    "frozen set": lambda g: define(f"def f(x, nan=0, inf=1):\n    return x in {{{g!r}, 5}}"),
}


def same(a, b, place):
    if place in ("array",):  # arrays have one type for all their numbers
        a, b = np.array([1, a]), np.array([1, b])
        return a.dtype == b.dtype and a.tobytes() == b.tobytes()
    return type(a) is type(b) and repr(a) == repr(b)


@pytest.mark.parametrize("place", PLACES)
@given(a=NUMBERS, b=NUMBERS)
def test_a_number_is_seen_wherever_it_hides(place, a, b):
    make = PLACES[place]
    assert (mark(make(a)) == mark(make(b))) == same(a, b, place)


BODY = """
{above}
@kernel
def f(x, gain=2.0):
    {docstring}
    def inner(y):
        {inner}
        return y if y in (1.0, None) else 3.0 * y
    {comment}
    {local} = gain * x
    return None if {local} is None else inner({local})
"""


@given(
    text=st.text("abc é\n", max_size=20),
    documented=st.booleans(),
    lines=st.integers(0, 4),
    local=st.sampled_from(["a", "b", "long_name"]),
    file=st.sampled_from(["<cell 1>", "/one/place.py", "/another/place.py"]),
)
def test_texts_names_of_locals_lines_and_folders_do_not_matter(
    text, documented, lines, local, file
):
    plain = define(BODY.format(above="", docstring="", inner="", comment="", local="a"))
    document = repr(text) if documented else ""
    source = BODY.format(
        above="\n" * lines,
        docstring=document,
        inner=document,
        comment="# " + text.replace("\n", " "),
        local=local,
    )
    assert mark(define(source, file)) == mark(plain)


def test_options_of_the_compiler_and_types_of_arrays_are_seen():
    source = "@numba.njit(fastmath={})\ndef f(x):\n    return x"
    assert mark(define(source.format(True))) != mark(define(source.format(False)))
    assert mark(overloaded(1.0)) != mark(overloaded(1.0, fastmath=True))
    read = "@kernel\ndef f(x):\n    return G[0, 0]"
    square = np.arange(4.0).reshape(2, 2)
    flat, whole = np.zeros(4), np.zeros(4, dtype=np.int64)  # all of the same bytes
    variants = [
        flat,
        whole,
        flat.reshape(2, 2),
        flat.reshape(4, 1),
        square,
        np.asfortranarray(square),
    ]
    assert len({mark(define(read, G=v)) for v in variants}) == len(variants)


@given(names=st.lists(st.sampled_from("abc"), min_size=1, max_size=3, unique=True))
def test_the_fields_of_a_tuple_are_seen(names):
    first = NamedTuple("T", [(name, float) for name in names])
    second = NamedTuple("T", [(name, float) for name in reversed(names)])
    assert (mark(first) == mark(second)) == (len(names) == 1)
    assert mark(first(*range(len(names)))) != mark(tuple(range(len(names))))


def test_the_signature_is_seen():
    sources = ("def f(a, b): return a", "def f(b, a): return b", "def f(a, *b): return a")
    assert len({mark(define(source)) for source in sources}) == 3
    assert mark(define("def f(a): return a.low")) != mark(define("def f(a): return a.high"))
    guarded = define(
        "def f(a):\n    try:\n        return a()\n    except ValueError:\n        return 0"
    )
    before = mark(guarded)
    guarded.__code__ = guarded.__code__.replace(co_exceptiontable=b"")  # as reloading does
    assert mark(guarded) != before


def test_compiled_twins_of_the_package_are_reached(monkeypatch):
    monkeypatch.setattr(fingerprints, "_pinned", WeakKeyDictionary())  # nothing is compiled yet
    before = mark(define("@kernel\ndef f(x):\n    return h(2.0, x, x)", h=axpy))
    twins = sys.modules[axpy.__module__]
    changed = define("def f(context, builder, kind, items, combine):\n    return items[0]")
    monkeypatch.setattr(twins, "map_leaves", changed)
    assert mark(define("@kernel\ndef f(x):\n    return h(2.0, x, x)", h=axpy)) != before
    assert mark(define("@kernel\ndef f(x):\n    return h(2.0, x, x)", h=load)) != before


CIRCLE = """
    @kernel
    def f(x, n):
        return x if n == 0 else g(x, n - 1)

    @kernel
    def g(x, n):
        return {gain} * f(x, n) + h(x, n)

    @kernel
    def h(x, n):
        return g(x, n - 1) if n > 0 else h(x, n + 1)
"""


def test_kernels_that_call_each_other_in_a_circle_are_told_apart():
    one, same_one, two = (define(CIRCLE.format(gain=gain)) for gain in (1.0, 1.0, 2.0))
    assert mark(one) == mark(same_one) != mark(two)
    others = [f.py_func.__globals__["h"] for f in (one, two)]
    assert mark(others[0]) != mark(others[1])
    pin(
        one.py_func
    )  # compiled now; a walk that starts elsewhere in the circle finds nothing changed
    assert mark(others[0]) != mark(others[1])


@pytest.mark.parametrize(
    "thing",
    [
        threading.Lock(),
        ctypes.CDLL(None).abs if os.name == "posix" else object(),
        np.array([object()]),
        ModuleType("settings"),
        type("Plain", (), {}),
        np.frompyfunc(lambda x: x, 1, 1),
        math.sin.__call__,
    ],
    ids=lambda thing: type(thing).__name__,
)
def test_what_cannot_be_compared_is_refused(thing):
    for source in ("def f(x):\n    return G", "def f(x):\n    return (lambda: G.shape)"):
        read = define(f"@kernel\n{source}", G=thing)
        if isinstance(thing, ModuleType) and "shape" in source:
            thing.shape = threading.Lock()
        with pytest.raises(InvalidInput, match=r"f\.G.*parameter"):
            mark(read)


def test_imports_inside_a_kernel_are_refused_unless_versions_stand_for_them():
    assert mark(define("def f(x):\n    import math\n    return math.sin(x)"))
    with pytest.raises(InvalidInput, match="outside"):
        mark(define("def f(x):\n    import conftest\n    return conftest.G"))
    with pytest.raises(InvalidInput, match="outside"):
        mark(define("def f(x):\n    def g():\n        import conftest\n    return g"))


def test_a_kernel_that_numba_caches_is_refused(tmp_path):
    (tmp_path / "cached.py").write_text(
        "import numba\n\n@numba.njit(cache=True)\ndef f(x):\n    return x\n"
    )
    f = define((tmp_path / "cached.py").read_text(), str(tmp_path / "cached.py"))
    with pytest.raises(InvalidInput, match="use @kernel"):
        mark(f)


def test_a_compiled_kernel_whose_surroundings_change_is_refused():
    f = define("@kernel\ndef f(x):\n    return G * h(x)", G=2.0, h=define(FACTORY, G=1.0))
    caller = define("@kernel\ndef f(x):\n    return g(x)", g=f)
    before = mark(caller)
    scope = f.py_func.__globals__
    scope["G"] = 3.0  # nothing is compiled yet
    assert mark(caller) != before
    assert f(1.0) == 3.0
    for name, value in (("G", 4.0), ("h", define(FACTORY, G=9.0))):
        kept, scope[name] = scope[name], value
        with pytest.raises(InvalidInput, match=f"f = .*compiled before {name} changed"):
            mark(caller)
        scope[name] = kept
    scope["h"] = define(FACTORY, G=1.0)  # the same, defined again
    assert mark(caller)


def test_a_user_module_with_a_name_of_python_is_read(tmp_path):
    program = """
        import sys
        sys.path.insert(0, sys.argv[1])
        import profile
        from osculate.kernel.fingerprint import fingerprint
        print(fingerprint(profile.f, "f"))
    """
    marks = []
    for gain in (1.0, 2.0):
        (tmp_path / "profile.py").write_text(f"def f(x):\n    return {gain} * x\n")
        command = [sys.executable, "-B", "-c", textwrap.dedent(program), str(tmp_path)]
        marks.append(subprocess.run(command, capture_output=True, check=True).stdout)
    assert marks[0] != marks[1]


def test_every_process_finds_the_same_fingerprint():
    program = """
        import sys
        from osculate.kernel import kernel
        def f(x):
            return x in {"a", "b", "c", "d"} or sys.version
        from osculate.kernel.fingerprint import fingerprint
        print(fingerprint(kernel(f), "f"))
    """
    marks = set()
    for seed in ("1", "2"):
        done = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(program)],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            check=True,
        )
        marks.add(done.stdout)
    assert len(marks) == 1
