"""Composition: the right parts, once per choice, never stale."""

import os
import subprocess
import sys
import textwrap

import pytest

from osculate.errors import OsculateError
from osculate.kernel import compose
from osculate.kernel.folder import cache_directory

TEMPLATE = "osculate.simulation.templates.rk4"

PROGRAM = """
    import sys, numpy as np
    sys.path.insert(0, sys.argv[1])
    from typing import NamedTuple
    import field
    from osculate.kernel import compose
    rk4 = compose("osculate.simulation.templates.rk4", {"rates": field.rates}).rk4
    state = field.State(1.0)
    for n in range(100):
        state = rk4(n * 0.01, 0.01, state, 0.0, 0.0, np.zeros(1))
    print(state.x)
"""

FIELD = """
    from typing import NamedTuple
    from osculate.kernel import kernel
    from slope import slope

    class State(NamedTuple):
        x: float

    @kernel
    def rates(t, state, action, p, tables):
        return State(slope(state.x))
"""


def write(folder, rate):
    (folder / "field.py").write_text(textwrap.dedent(FIELD))
    (folder / "slope.py").write_text(
        f"from osculate.kernel import kernel\n\n@kernel\ndef slope(x):\n    return {rate} * x\n"
    )


def integrate(folder, **environment):
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(PROGRAM), str(folder)],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)


def test_a_change_in_an_imported_function_is_noticed(tmp_path):
    cache = {"OSCULATE_CACHE_DIR": str(tmp_path / "cache")}
    write(tmp_path, 1.0)
    first = integrate(tmp_path, **cache)
    assert first == pytest.approx(2.718281828, abs=1e-8)
    write(tmp_path, -1.0)
    assert integrate(tmp_path, **cache) == pytest.approx(1.0 / 2.718281828, abs=1e-8)


def test_uncompiled_composition_gives_the_same_bits(tmp_path):
    write(tmp_path, -1.0)
    assert integrate(tmp_path) == integrate(tmp_path, NUMBA_DISABLE_JIT="1")


def test_equal_parts_give_the_same_module():
    def one(t, state, action, p, tables):
        return state

    assert compose(TEMPLATE, {"rates": one}) is compose(TEMPLATE, {"rates": one})


def test_an_unknown_template_is_named():
    with pytest.raises(OsculateError, match=r"osculate\.nothing\.here"):
        compose("osculate.nothing.here", {})


def test_the_cache_directory_can_be_chosen(tmp_path, monkeypatch):
    monkeypatch.setenv("OSCULATE_CACHE_DIR", str(tmp_path / "mine"))
    assert cache_directory() == tmp_path / "mine"
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("OSCULATE_CACHE_DIR", str(blocked))
    with pytest.raises(OsculateError, match="OSCULATE_CACHE_DIR"):
        cache_directory()
