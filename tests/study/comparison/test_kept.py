"""Finished work is kept: found again when everything that decides its numbers is equal, and only then."""

import json
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import (
    CurveFile,
    InvalidInput,
    Limits,
    MissingExtra,
    Nmpc,
    PurePursuit,
    Sampled,
    Spline,
    Tricycle,
    compare,
    tune,
    vehicle_named,
)
from osculate.control.tracking.baselines import PurePursuit as Base
from osculate.simulation import Verdict, VerdictKind
from osculate.study.comparison import kept as keeping
from osculate.study.comparison.compare import Trace, _packed, _unpacked
from osculate.study.comparison.kept import Kept, key_of
from osculate.study.comparison.suite import conditions, curves, starts, training_curves

WORK = {
    "controllers": {"pure-pursuit": PurePursuit(), "second": PurePursuit(lookahead=0.5)},
    "on": curves(["corner"]),
    "start": starts(["on-path", "offset"]),
    "speeds": (1.0,),
}


def same(a, b):
    """Whether two comparisons are equal, bit for bit."""
    return (
        repr(a.cells) == repr(b.cells)
        and list(a.traces) == list(b.traces)
        and all(
            np.array_equal(x, y)
            for key in a.traces
            for x, y in zip(a.traces[key], b.traces[key], strict=True)
        )
    )


@pytest.fixture(scope="module")
def whole():
    return compare(**WORK)


def test_what_is_kept_is_taken_over_bit_for_bit(whole, tmp_path):
    first, again = Kept(tmp_path), Kept(tmp_path)
    assert same(compare(**WORK, keep=first), whole)
    assert (first.taken, first.made) == (0, 4)
    for file in sorted(tmp_path.iterdir())[1:2]:  # as if killed on the way
        file.unlink()
    assert same(compare(**WORK, keep=again), whole)
    assert (again.taken, again.made) == (3, 1)
    more = Kept(tmp_path)
    work = {**WORK, "controllers": {"renamed": PurePursuit(), "third": PurePursuit(lookahead=0.6)}}
    compare(**work, keep=more)
    assert (more.taken, more.made) == (2, 2)


@given(
    st.sampled_from([VerdictKind.HIT, VerdictKind.REACHED, VerdictKind.DIVERGED]),
    st.none() | st.floats(),
    st.none() | st.integers(1, 9),
    st.sampled_from(["", "slid", "é − ∞"]),
)
def test_a_kept_run_has_its_metrics_and_its_verdict(kind, number, obstacle, words):
    verdict = Verdict(
        kind, f"went: {words}", number, x=1 / 3, time=number, reason=words, obstacle=obstacle
    )
    metrics = {"cross_track_rms": number, "energy": np.float64(0.1), "ended": np.str_("path end")}
    kept = Kept(Path(tempfile.mkdtemp()))
    kept.keep(KEY, _packed((metrics, verdict, Trace(*np.eye(4)))))
    values, found, trace = _unpacked(kept.find(KEY))
    shutil.rmtree(kept.folder)
    assert repr(found) == repr(verdict)  # NaN is as it was
    assert found.kind is kind
    assert repr(values.get("cross_track_rms")) == repr(number)
    assert (values["energy"], values["ended"]) == (0.1, "path end")
    assert np.array_equal(trace, np.eye(4))


KEY = "0123456789abcdef" * 4


def test_damaged_files_count_as_missing(tmp_path):
    kept = Kept(tmp_path)
    kept.keep(KEY, {"costs": np.arange(3.0)})
    (file,) = tmp_path.iterdir()
    content = file.read_bytes()
    assert np.array_equal(kept.find(KEY)["costs"], np.arange(3.0))
    flipped = (
        content[:n] + bytes([content[n] ^ bit]) + content[n + 1 :]
        for n in (0, 150, 400, *range(content.index(b"PK\1\2"), len(content)))  # and the directory
        for bit in (1, 64)
    )
    cut = (content[:n] for n in range(0, len(content), 13))
    for damaged in (*cut, *flipped, b"PK\3\4 foreign", b"[1, 2]"):
        file.write_bytes(damaged)
        found = kept.find(KEY)
        assert found is None or np.array_equal(found["costs"], np.arange(3.0))
    kept.keep(KEY, {"costs": np.arange(3.0)})
    file.rename(tmp_path / f"{'1' * 32}.npz")  # of other work
    assert kept.find("1" * 64) is None


def test_other_code_takes_nothing_over(monkeypatch):
    before = key_of(law=PurePursuit())
    monkeypatch.setattr(keeping, "code_fingerprint", lambda: "another")
    assert key_of(law=PurePursuit()) != before
    monkeypatch.undo()
    assert key_of(law=PurePursuit()) == before
    monkeypatch.setattr(keeping, "_versions", lambda: "another")
    assert key_of(law=PurePursuit()) != before
    monkeypatch.setattr(keeping, "code_fingerprint", lambda: None)
    assert key_of(law=PurePursuit()) is None


def test_the_fingerprint_sees_the_code_that_makes_numbers(tmp_path, monkeypatch):
    package = tmp_path / "osculate"
    for name in ("plant/slip.py", "study/comparison/compare.py", "study/report.py", "apps/cli.py"):
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text("a = 1\n")
    monkeypatch.setattr(keeping, "__file__", str(package / "study" / "comparison" / "kept.py"))
    fingerprint = keeping.code_fingerprint.__wrapped__
    before = fingerprint()
    (package / "study/report.py").write_text("a = 2\n")
    (package / "apps/cli.py").write_text("a = 2\n")
    assert fingerprint() == before
    seen = {before}
    for name in ("plant/slip.py", "study/comparison/compare.py"):
        (package / name).write_text("a = 2\n")
        seen.add(fingerprint())
    (package / "plant/slip.py").rename(package / "plant/other.py")
    assert len({*seen, fingerprint()}) == 4


@given(
    st.sampled_from(["lookahead", "speed", "mass", "curve", "duration"]),
    st.floats(1.0, 2.0),
    st.floats(1.0, 2.0),
)
def test_keys_differ_exactly_where_a_part_differs(what, a, b):
    def key(value):
        numbers = dict.fromkeys(("lookahead", "speed", "mass", "curve", "duration"), 1.5)
        numbers[what] = value
        return key_of(
            law=PurePursuit(lookahead=numbers["lookahead"]),
            limits=Limits(speed=numbers["speed"]),
            robot=Tricycle(body_mass=numbers["mass"]),
            curve=Spline(points=((0, 0), (2, numbers["curve"]), (4, 0))),
            clock=Sampled(period=0.01, delay=0.01, duration=numbers["duration"]),
        )

    assert key(a) is not None
    assert (key(a) == key(b)) == (a == b)


def test_a_file_is_known_by_what_it_holds(tmp_path):
    for name, middle in (("a.csv", 0.3), ("b.csv", 0.3), ("c.csv", 0.31)):
        (tmp_path / name).write_text(f"x,y\n0,0\n2,{middle}\n4,0\n6,-0.2\n", encoding="utf-8")
    a, b, c = (key_of(curve=CurveFile(path=str(tmp_path / f"{n}.csv"))) for n in "abc")
    assert a == b != c
    assert a != key_of(curve=CurveFile(path=str(tmp_path / "a.csv"), scale=1.1))


def test_classes_from_elsewhere_are_not_kept(tmp_path):
    class Mine(Base):
        kind: Literal["mine"] = "mine"

    assert key_of(law=Mine()) is None
    kept = Kept(tmp_path / "new")
    kept.keep(None, {"costs": np.zeros(1)})
    assert kept.find(None) is None
    assert not kept.folder.exists()


def test_extras_are_asked_for_before_anything_runs(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    laws = {"pure-pursuit": PurePursuit(), "nmpc": Nmpc()}
    with pytest.raises(MissingExtra, match=r"osculate\[mpc\]"):
        compare(**{**WORK, "controllers": laws}, keep=tmp_path / "cells")
    kinds = conditions(["ideal", "mujoco"])
    with pytest.raises(MissingExtra, match=r"osculate\[mujoco\]"):
        compare(**WORK, condition=kinds, keep=tmp_path / "cells")
    assert not (tmp_path / "cells").exists()


def test_a_killed_comparison_goes_on_from_where_it_was(tmp_path):
    command = [
        sys.executable, "-m", "osculate", "compare", "--controllers", "lqr,pure-pursuit",
        "--curves", "corner", "--speeds", "1", "--starts", "on-path", "--output", str(tmp_path / "out"),
    ]  # fmt: skip
    cells = tmp_path / "out" / "cells"
    killed = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while killed.poll() is None and len([*cells.glob("[!.]*")]) < 1:
        time.sleep(0.005)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    there = len([*cells.glob("[!.]*")])
    assert not (tmp_path / "out" / "comparison.json").exists() or there == 2
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert f"Taken over: {there} of 2 cells, kept in: {cells}" in done.stdout.replace("\n", "")
    assert len(json.loads((tmp_path / "out" / "comparison.json").read_text())) == 2
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        ".osculate.json", "cells", "comparison.html", "comparison.json", "comparison.parquet",
        "comparison-corner.png",
    }  # fmt: skip
    assert len([*cells.iterdir()]) == 2


def test_a_search_goes_on_from_where_it_was(tmp_path):
    pytest.importorskip("cma")
    search = {
        "on": {"hairpin": training_curves()["hairpin"]}, "speeds": (1.0,),
        "starts": (starts(["on-path"])["on-path"],), "population": 4, "robot": vehicle_named("tugger"),
    }  # fmt: skip
    whole = tune(PurePursuit(), **search, generations=2)
    tune(PurePursuit(), **search, generations=1, keep=tmp_path)
    again = Kept(tmp_path)
    assert tune(PurePursuit(), **search, generations=2, keep=again) == whole
    assert (again.taken, again.made) == (2, 1)
    other = Kept(tmp_path)
    tune(PurePursuit(), **search, generations=1, seed=2, keep=other)
    assert (other.taken, other.made) == (1, 1)  # the start is that of any seed


def test_a_full_disk_is_said_once_and_the_work_goes_on(small_disk):
    small_disk.fill()
    kept = Kept(small_disk.path)
    with pytest.warns(UserWarning, match=r"cannot be kept .*No space left") as said:
        _ = [kept.keep(digit * 64, {"costs": np.zeros(1000)}) for digit in "12"]
    assert len(said) == 1
    assert (kept.made, kept.find("1" * 64)) == (0, None)


def test_files_of_one_name_are_two_curves(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        for name in ("track.csv", "slalom.csv"):
            (tmp_path / folder / name).write_text("0,0\n1,0\n2,0\n")
    files = [str(tmp_path / name) for name in ("a/track.csv", "b/track.csv", "a/slalom.csv")]
    assert [*curves(["slalom", *files])] == ["slalom", "track", *files[1:]]
    with pytest.raises(InvalidInput, match="is given twice"):
        curves([*files, files[0]])


@settings(max_examples=300, deadline=None)
@given(place=st.floats(0.0, 1.0, exclude_max=True), flip=st.integers(0, 255), cut=st.booleans())
def test_a_damaged_file_counts_as_missing(tmp_path_factory, place, flip, cut):
    kept = Kept(tmp_path_factory.getbasetemp() / "damaged")
    key = key_of(a=1)
    arrays = {"x": np.linspace(0.0, 1.0, 5), "t": np.array("abc")}
    kept.keep(key, arrays)
    (file,) = kept.folder.iterdir()
    content = bytearray(file.read_bytes())
    spot = int(place * len(content))
    content[spot] ^= flip
    file.write_bytes(content[:spot] if cut else content)
    found = kept.find(key)
    if flip or cut:
        assert found is None
    else:
        assert all(np.array_equal(found[name], arrays[name]) for name in arrays)
