"""An output folder: complete, or it says that it is not; nothing old beside new."""

import json
import random
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from osculate import InvalidInput, NotWritten
from osculate.folder import MARK, RECORD, OutputFolder

WRITER = """
import sys
from osculate.folder import OutputFolder
print("ready", flush=True)
version, rounds = int(sys.argv[2]), int(sys.argv[3])
while rounds:
    rounds -= 1
    with OutputFolder(sys.argv[1], "run") as folder:
        for n in range(4 + version % 2):
            folder.write(f"{n}.txt", lambda path: path.write_text(str(version) * 2000))
    version += 1
"""


def write(folder, *names, kind="run", content="content", **special):
    """Write files of one content each, or as a function of ``special`` writes them."""
    with OutputFolder(folder, kind) as output:
        for name in names:
            usual = partial(Path.write_text, data=content)
            output.write(name, special.get(name, usual))


def contents(folder):
    return {path.name for path in folder.iterdir()} - {RECORD}


def program(*arguments):
    return subprocess.Popen(
        [sys.executable, "-c", WRITER, *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def assert_complete(folder):
    """Everything there is of one version."""
    texts = {path.name: path.read_text() for path in folder.glob("[0-9].txt")}
    (text,) = set(texts.values())
    version = int(text[: len(text) // 2000])
    assert text == str(version) * 2000
    assert set(texts) == {f"{n}.txt" for n in range(4 + version % 2)}


def test_nothing_old_stays_beside_new_and_nothing_of_others_goes(tmp_path):
    (tmp_path / "mine.txt").write_text("")
    write(tmp_path, "a", "b")
    write(tmp_path, "page", kind="comparison")
    write(tmp_path, "b", "c")
    assert contents(tmp_path) == {"mine.txt", "b", "c", "page"}
    (tmp_path / "a").write_text("now it is the user's")
    write(tmp_path, "c")
    assert contents(tmp_path) == {"mine.txt", "a", "c", "page"}


def test_a_folder_stays_incomplete_until_every_kind_of_output_is_complete(tmp_path):
    def fail(path):
        raise OSError("no more room")

    for kind in ("comparison", "reproduction"):
        with pytest.raises(NotWritten):
            write(tmp_path, "page", kind=kind, page=fail)
    write(tmp_path, "a")
    text = (tmp_path / MARK).read_text()
    assert "an earlier comparison, reproduction" in text
    write(tmp_path, "page", kind="comparison")
    assert "an earlier reproduction are" in (tmp_path / MARK).read_text()
    write(tmp_path, "page", kind="reproduction")
    assert contents(tmp_path) == {"a", "page"}


def test_the_first_new_file_is_there_before_the_old_ones_go(tmp_path):
    write(tmp_path, "scenario", "b")
    with OutputFolder(tmp_path, "run") as folder:
        assert (tmp_path / "scenario").read_text() == "content"
        folder.write("scenario", lambda path: path.write_text("new"))
        assert contents(tmp_path) == {"scenario", MARK}


def test_what_cannot_be_written_is_named_and_the_rest_is_there(tmp_path):
    def fail(path):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(NotWritten, match=r"film is missing \(.*No space left") as error:
        write(tmp_path, "data", "film", "page", film=fail)
    assert set(error.value.missing) == {"film"}
    assert contents(tmp_path) == {"data", "page", MARK}
    assert "Missing: film ([Errno 28] No space left on device)" in (tmp_path / MARK).read_text()
    write(tmp_path, "data")
    assert contents(tmp_path) == {"data"}


def test_an_interrupted_folder_says_so(tmp_path):
    def interrupt(path):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write(tmp_path, "data", "film", film=interrupt)
    assert contents(tmp_path) == {"data", MARK}
    assert "Missing: film (interrupted)\nFinished: data.\n" in (tmp_path / MARK).read_text()


@pytest.mark.parametrize("record", ['{"run": ["../outside", "/", ""]}', '{"run": 3}', "[", "\xff"])
def test_a_damaged_record_removes_nothing(tmp_path, record):
    (tmp_path / "outside").write_text("")
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / RECORD).write_bytes(record.encode("latin-1"))
    write(folder, "new")
    assert (tmp_path / "outside").exists()
    assert contents(folder) == {"new"}
    assert json.loads((folder / RECORD).read_text()) == {"run": ["new"]}


def test_the_mark_says_what_is_to_come(tmp_path):
    with OutputFolder(tmp_path, "run", ["data", "film"]) as folder:
        assert "Files: data, film.\n" in (tmp_path / MARK).read_text()
        folder.write("data", Path.touch)
        folder.write("film", Path.touch)


def test_a_killed_writer_leaves_a_folder_that_says_so(tmp_path):
    marked = 0
    for attempt in range(6):
        writer = program(tmp_path, 10 * attempt, -1)
        writer.stdout.readline()
        time.sleep(random.uniform(0.0, 0.05))
        writer.send_signal(signal.SIGKILL)
        writer.communicate()
        if (tmp_path / MARK).exists():
            marked += 1
            continue
        if contents(tmp_path):
            assert_complete(tmp_path)
    assert marked
    done = program(tmp_path, 1, 1)
    done.communicate()
    assert_complete(tmp_path)
    assert contents(tmp_path) == {"0.txt", "1.txt", "2.txt", "3.txt", "4.txt"}


def test_two_processes_take_turns(tmp_path):
    writers = [program(tmp_path, 10 * n, 6) for n in (1, 2)]
    for writer in writers:
        assert "Traceback" not in writer.communicate()[1]
        assert writer.returncode == 0
    assert MARK not in contents(tmp_path)
    assert_complete(tmp_path)


def test_a_full_disk_leaves_whole_files_and_says_what_is_missing(small_disk):
    out = small_disk.path / "out"
    write(out, "old", content="o" * 1000)
    small_disk.fill(left=300_000)
    sizes = {"1": 200_000, "2": 400_000, "0": 0}
    writers = {name: partial(Path.write_bytes, data=bytes(size)) for name, size in sizes.items()}
    with pytest.raises(NotWritten, match=r"2 is missing .*No space left"):
        write(out, *sizes, **writers)
    assert contents(out) == {"0", "1", MARK}
    assert (out / "1").stat().st_size == 200_000
    (small_disk.path / "other data").unlink()
    small_disk.fill()
    with pytest.raises((InvalidInput, NotWritten), match="No space left"):
        write(out, "new")
    assert "not complete" in (out / MARK).read_text()
    assert "new" not in contents(out)


def test_who_has_waited_marks_the_folder_again(tmp_path):
    code = (
        "import sys, pathlib\nfrom osculate.folder import MARK, OutputFolder\n"
        "with OutputFolder(sys.argv[1], 'run'):\n    print(pathlib.Path(sys.argv[1], MARK).exists())\n"
    )
    with OutputFolder(tmp_path, "run"):
        other = subprocess.Popen(
            [sys.executable, "-c", code, str(tmp_path)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert "is being written by another process" in other.stderr.readline()
    assert other.communicate()[0] == "True\n"
    assert MARK not in contents(tmp_path)


def test_what_another_kind_has_written_meanwhile_is_not_removed(tmp_path):
    """The last to write a name owns it."""
    write(tmp_path, "a.png", "b.png", kind="run", content="run")
    write(tmp_path, "a.png", "c.png", kind="comparison", content="comparison")
    write(tmp_path, "b.png", kind="run", content="run")
    assert contents(tmp_path) == {"a.png", "b.png", "c.png"}
    assert (tmp_path / "a.png").read_text() == "comparison"
    write(tmp_path, "c.png", kind="comparison")
    assert contents(tmp_path) == {"b.png", "c.png"}
