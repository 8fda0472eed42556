"""Machine code on disk: never that of something else, never a stranger's, and never in the way."""

import os
import re
import signal
import stat
import subprocess
import sys
import tempfile
import textwrap
import warnings
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate.kernel import folder as folders
from osculate.kernel.store import _head, _read, _write

TEMPLATE = '''
    """Template: what a part makes of a number."""
    from osculate.kernel import compiled

    @compiled
    def ask(x):
        return law(x)
'''

LAWS = '''
    """Laws by the dozen."""
    from osculate.kernel import kernel

    def make(gain):
        """A law with its own gain."""
        @kernel
        def law(x):
            return gain * x + 0.0 * slope(x)
        return law

    @kernel
    def slope(x):
        return 3.0 * x
'''

PROGRAM = """
    import sys
    sys.path.insert(0, sys.argv[1])
    from laws import make
    from osculate.kernel import compose
    for gain in sys.argv[2:]:
        ask = compose("template", {"law": make(float(gain))}).ask
        print(ask(1.0), sum(ask.stats.cache_hits.values()))
"""


@pytest.fixture
def place(tmp_path):
    (tmp_path / "template.py").write_text(textwrap.dedent(TEMPLATE))
    (tmp_path / "laws.py").write_text(textwrap.dedent(LAWS))
    return tmp_path


def environment(place, **changes):
    chosen = {"OSCULATE_CACHE_DIR": str(place / "cache"), "PYTHONDONTWRITEBYTECODE": "1", **changes}
    everything = {**os.environ, **chosen}
    return {name: value for name, value in everything.items() if value is not None}


def ask(place, *gains, prelude="", program=PROGRAM, **changes):
    """Answers, how many of them came from the cache, and what was said on the way."""
    done = subprocess.run(
        [sys.executable, "-c", prelude + textwrap.dedent(program), str(place), *map(str, gains)],
        env=environment(place, **changes),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    pairs = [line.split() for line in done.stdout.splitlines()]
    return [float(pair[0]) for pair in pairs], sum(int(pair[1]) for pair in pairs), done.stderr


def stored(place):
    return sorted((place / "cache").glob("*"))


def test_two_gains_of_one_factory_are_two_laws_in_every_process(place):
    assert ask(place, 2.0, 5.0) == ([2.0, 5.0], 0, "")
    assert ask(place, 5.0, 2.0, 7.0) == ([5.0, 2.0, 7.0], 2, "")


def test_only_what_matters_compiles_anew(place):
    ask(place, 2.0)
    for file in ("laws.py", "template.py"):
        text = (place / file).read_text()
        (place / file).write_text(f'"""Other words."""\n# and lines\n{text[text.index(chr(10)) :]}')
    moved = place / "elsewhere"
    moved.mkdir()
    for file in ("laws.py", "template.py"):
        (place / file).rename(moved / file)
    assert ask(moved, 2.0, OSCULATE_CACHE_DIR=str(place / "cache")) == ([2.0], 1, "")
    template = moved / "template.py"
    template.write_text(template.read_text().replace("law(x)", "law(x) + 1.0"))
    assert ask(moved, 2.0, OSCULATE_CACHE_DIR=str(place / "cache")) == ([3.0], 0, "")
    laws = moved / "laws.py"
    laws.write_text(laws.read_text().replace("0.0 * slope", "1.0 * slope"))
    assert ask(moved, 2.0, OSCULATE_CACHE_DIR=str(place / "cache")) == ([6.0], 0, "")
    laws.write_text(laws.read_text().replace("3.0 * x", "4.0 * x"))
    assert ask(moved, 2.0, OSCULATE_CACHE_DIR=str(place / "cache")) == ([7.0], 0, "")


def test_types_of_one_name_are_told_apart(place):
    (place / "laws.py").write_text(
        "from osculate.kernel import kernel\n\n@kernel\ndef law(x):\n    return x.b\n"
    )
    program = """
        import sys
        sys.path.insert(0, sys.argv[1])
        from laws import law
        from osculate.kernel import compose
        from states import State
        ask = compose("template", {"law": law}).ask
        print(ask(State(1.0, 2.0)), sum(ask.stats.cache_hits.values()))
    """
    for fields, answer in (("ab", 2.0), ("ba", 1.0)):
        lines = "".join(f"    {field}: float\n" for field in fields)
        (place / "states.py").write_text(
            f"from typing import NamedTuple\n\nclass State(NamedTuple):\n{lines}"
        )
        assert ask(place, program=program) == ([answer], 0, "")
    assert ask(place, program=program) == ([1.0], 1, "")


def test_a_notebook_is_noticed_too(place):
    notebook = """
        import sys
        sys.path.insert(0, sys.argv[1])
        from osculate.kernel import compose, kernel
        source = "GAIN = {}\\n@kernel\\ndef law(x):\\n    return GAIN * x\\n"
        for cell, gain in enumerate(sys.argv[2:]):
            exec(compile(source.format(gain), f"<cell {cell}>", "exec"))
            ask = compose("template", {"law": law}).ask
            print(ask(1.0), sum(ask.stats.cache_hits.values()))
        GAIN = 9.0
        try:
            compose("template", {"law": law})
        except ValueError as error:
            assert "GAIN" in str(error), error
        else:
            raise SystemExit("a stale law")
    """
    assert ask(place, 2.0, 5.0, program=notebook) == ([2.0, 5.0], 0, "")
    assert ask(place, 5.0, 6.0, program=notebook) == ([5.0, 6.0], 1, "")


@given(payload=st.binary(max_size=200), cut=st.integers(0, 10**6), flip=st.integers(0, 10**6))
def test_a_damaged_file_counts_as_missing(payload, cut, flip):
    with tempfile.TemporaryDirectory() as where:
        file = Path(where).resolve() / "a.code"
        assert _read(file) is None
        _write(file, payload)
        assert _read(file) == payload
        assert stat.S_IMODE(file.stat().st_mode) == 0o600
        whole = file.read_bytes()
        file.write_bytes(whole[: cut % len(whole)])
        assert _read(file) is None
        flipped = bytearray(whole)
        flipped[flip % len(whole)] ^= 1
        file.write_bytes(flipped)
        assert _read(file) is None
        _write(file, payload)
        assert _read(file) == payload


DAMAGES = {
    "truncated": lambda file: file.read_bytes()[:-7],
    "empty": lambda file: b"",
    "foreign": lambda file: b"cos\nsystem\n(S'touch planted'\ntR.",
    "garbage": lambda file: _head(file, b"garbage") + b"garbage",
    "of another": lambda file: next(f for f in file.parent.iterdir() if f != file).read_bytes(),
}


def test_damaged_files_are_repaired(place):
    gains = [float(gain) for gain in range(len(DAMAGES))]
    ask(place, *gains)
    for file, damage in zip(stored(place), DAMAGES.values(), strict=True):
        file.write_bytes(damage(file))
    assert ask(place, *gains) == (gains, 0, "")
    assert ask(place, *gains) == (gains, len(gains), "")


PLANTED = b"cbuiltins\nprint\n(S'planted 1'\ntR."  # prints when unpickled


def test_what_a_stranger_could_have_planted_is_not_loaded(place):
    ask(place, 2.0)
    for file in stored(place):
        file.write_bytes(_head(file, PLANTED) + PLANTED)
    with pytest.raises(ValueError, match="planted"):
        ask(place, 2.0)  # in a folder of our own it is: pickles run
    for file in stored(place):
        file.write_bytes(_head(file, PLANTED) + PLANTED)
    (place / "cache").chmod(0o777)
    answers, hits, said = ask(place, 2.0, 5.0)
    assert (answers, hits) == ([2.0, 5.0], 0)
    assert (
        len(re.findall("RuntimeWarning: .*can be written by others.*OSCULATE_CACHE_DIR", said)) == 1
    )


@pytest.mark.skipif(os.name != "posix", reason="owners and modes")
def test_who_could_write_is_found_out(tmp_path, monkeypatch):
    own = tmp_path / "parent" / "own"
    own.mkdir(parents=True)
    for mode, parent, exposed in [
        (0o700, 0o755, False),
        (0o755, 0o755, False),
        (0o777, 0o755, True),
        (0o702, 0o755, True),
        (0o1777, 0o755, True),
        (0o700, 0o777, True),
        (0o700, 0o1777, False),
    ]:
        own.chmod(mode)
        own.parent.chmod(parent)
        assert bool(folders.is_exposed(own)) == exposed, (oct(mode), oct(parent))
    own.parent.chmod(0o755)
    file = own / "a.code"
    _write(file, b"code")
    assert _read(file) == b"code"
    file.chmod(0o622)
    assert _read(file) is None
    file.chmod(0o600)
    monkeypatch.setattr(os, "geteuid", lambda: 54321)
    assert "another user" in folders.is_exposed(own)
    assert _read(file) is None


@pytest.mark.skipif(os.name != "posix", reason="groups")
def test_a_group_of_oneself_is_no_other(tmp_path, monkeypatch):
    import grp
    import pwd

    tmp_path.chmod(0o770)
    user, number = pwd.getpwuid(os.geteuid()), tmp_path.stat().st_gid
    alone = pwd.struct_passwd((user.pw_name, "", user.pw_uid, number, "", "", ""))
    monkeypatch.setattr(pwd, "getpwuid", lambda _: alone)
    for name, members, exposed in [
        (user.pw_name, [], False),
        (user.pw_name, [user.pw_name], False),
        (user.pw_name, ["mallory"], True),
        ("staff", [], True),
    ]:
        group = grp.struct_group((name, "", number, members))
        monkeypatch.setattr(grp, "getgrgid", lambda _, group=group: group)
        assert bool(folders.is_exposed(tmp_path)) == exposed, (name, members)
    tmp_path.chmod(0o707)
    assert folders.is_exposed(tmp_path)


def test_new_folders_are_private_whatever_the_umask(tmp_path, monkeypatch):
    monkeypatch.setenv("OSCULATE_CACHE_DIR", str(tmp_path / "a" / "b"))
    before = os.umask(0)
    try:
        made = folders.cache_directory()
    finally:
        os.umask(before)
    assert made == tmp_path / "a" / "b"
    assert {stat.S_IMODE(folder.stat().st_mode) for folder in (made, made.parent)} == {0o700}


NOWHERE = {
    "no home": {"HOME": "/dev/null/home"},
    "no place": {"HOME": "/proc/nothing"},
    "a relative one": {"XDG_CACHE_HOME": "relative", "HOME": "/dev/null/home"},
    "a chosen one that cannot be made": {"OSCULATE_CACHE_DIR": "/proc/nothing/cache"},
}


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="Linux")
@pytest.mark.parametrize("case", NOWHERE)
def test_without_a_place_a_private_one_is_used_and_removed(place, case):
    (place / "tmp").mkdir()
    changes = {"OSCULATE_CACHE_DIR": None, "XDG_CACHE_HOME": None, "TMPDIR": str(place / "tmp")}
    program = textwrap.dedent(PROGRAM) + textwrap.dedent("""
        from pathlib import Path
        from osculate.kernel.folder import cache_directory
        made = cache_directory()
        assert made.stat().st_mode & 0o777 == 0o700 and len(list(made.iterdir())) == 2
        assert made.parent == Path(sys.argv[1], "tmp")
    """)
    changes.update(NOWHERE[case])
    answers, hits, said = ask(place, 2.0, 5.0, program=program, **changes)
    assert (answers, hits) == ([2.0, 5.0], 0)
    assert len(re.findall("RuntimeWarning: .*kept in a temporary folder", said)) == 1
    assert not list((place / "tmp").iterdir())


def test_not_even_a_home_in_the_list_of_users(monkeypatch):
    for name in ("OSCULATE_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(Path, "home", lambda: (_ for _ in ()).throw(RuntimeError("no home")))
    folders._directory.cache_clear()
    with pytest.warns(RuntimeWarning, match=r"no home.*temporary folder"):
        made = folders.cache_directory()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert folders.cache_directory() == made
    folders._remove(made, os.getpid() + 1)
    assert made.is_dir()
    folders._remove(made, os.getpid())
    assert not made.exists()
    monkeypatch.setattr(tempfile, "mkdtemp", lambda **_: (_ for _ in ()).throw(OSError("full")))
    folders._directory.cache_clear()
    with pytest.warns(RuntimeWarning, match="compiles anew"):
        assert folders.cache_directory() is None
    folders._directory.cache_clear()


FULL = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"


def test_a_file_that_cannot_be_written_whole_is_not_written(place):
    answers, hits, said = ask(place, 2.0, 5.0, prelude=FULL)
    assert (answers, hits) == ([2.0, 5.0], 0)
    assert len(re.findall("RuntimeWarning: .*cannot be stored", said)) == 1
    assert stored(place) == []


def test_a_full_disk_is_survived(place):
    (place / "cache").mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=20k,mode=700", "none", str(place / "cache")]
    try:
        subprocess.run(mount, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("mounting a small file system needs privileges")
    try:
        answers, _, said = ask(place, 2.0, 5.0)
        assert answers == [2.0, 5.0]
        assert len(re.findall("RuntimeWarning: .*cannot be stored", said)) == 1
        assert not list((place / "cache").glob(".osculate-*"))
        assert ask(place, 2.0, 5.0)[0] == [2.0, 5.0]
    finally:
        subprocess.run(["umount", str(place / "cache")], check=True)


KILLED = {
    "before the name": "import os, pathlib\npathlib.Path.replace = lambda *_: os.kill(os.getpid(), 9)\n",
    "within the file": """
import os, pathlib
def half(self, data):
    with self.open("wb") as stream:
        stream.write(data[: len(data) // 2])
        stream.flush()
        os.kill(os.getpid(), 9)
pathlib.Path.write_bytes = half
""",
}


@pytest.mark.parametrize("moment", KILLED)
def test_six_processes_fill_an_empty_folder_while_one_is_killed(place, moment):
    others = 5 if moment == "within the file" else 0
    tasks = [(KILLED[moment], "9.0"), *[("", "2.0 5.0")] * others]  # nobody else writes its 9.0
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", prelude + textwrap.dedent(PROGRAM), str(place), *gains.split()],
            env=environment(place),
            stdout=subprocess.PIPE,
            text=True,
        )
        for prelude, gains in tasks
    ]
    answers = [process.communicate()[0] for process in processes]
    assert processes[0].returncode == -signal.SIGKILL
    for process, answer in zip(processes[1:], answers[1:], strict=True):
        assert process.returncode == 0
        assert [line.split()[0] for line in answer.splitlines()] == ["2.0", "5.0"]
    left = list((place / "cache").glob(".osculate-*"))
    assert len(left) <= 1 if others else len(left) == 1  # the others clean up already
    assert ask(place, 2.0, 5.0, 7.0)[0] == [2.0, 5.0, 7.0]  # writes, and cleans up
    assert len(stored(place)) == 3
    assert ask(place, 2.0, 5.0)[1:] == (2, "")
