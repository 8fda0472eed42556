"""Files that appear complete or not at all: whatever the writer does, whenever it is killed."""

import contextlib
import os
import random
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from osculate import InvalidInput
from osculate.files import (
    check_file,
    check_folder,
    complete_file,
    remove_abandoned,
    remove_unfinished,
    write_bytes,
    write_text,
)

WRITER = """
import sys
from pathlib import Path
from osculate.files import write_by
def write(version, path):
    with path.open("wb") as stream:
        for _ in range(64):
            stream.write(bytes([version]) * 4096)
print("ready", flush=True)
version = int(sys.argv[2])
while True:
    write_by(lambda path: write(version % 256, path), sys.argv[1])
    version += 1
"""


def program(code, *arguments):
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, arguments)], stdout=subprocess.PIPE, text=True
    )


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=50)
@given(old=st.none() | st.binary(), new=st.binary(), fails_at=st.none() | st.integers(0, 20))
def test_a_name_stands_for_the_old_content_or_for_the_new_one(tmp_path, old, new, fails_at):
    target = tmp_path / "file.bin"
    target.unlink(missing_ok=True)
    if old is not None:
        target.write_bytes(old)
    fails = fails_at is not None and fails_at < len(new)
    with contextlib.suppress(RuntimeError), complete_file(target) as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".bin"
        temporary.write_bytes(new[:fails_at] if fails else new)
        if fails:
            raise RuntimeError
    assert (target.read_bytes() if target.exists() else None) == (old if fails else new)
    assert set(tmp_path.iterdir()) <= {target}


def test_a_kill_leaves_a_whole_file_and_the_next_writer_clears_up(tmp_path):
    target = tmp_path / "file.bin"
    killed = 0
    for attempt in range(6):
        writer = program(WRITER, target, 20 * attempt)
        writer.stdout.readline()
        time.sleep(random.uniform(0.0, 0.03))
        writer.send_signal(signal.SIGKILL)
        writer.communicate()
        killed += len([*tmp_path.glob(".osculate-*")])
        if target.exists():
            content = target.read_bytes()
            assert len(content) == 64 * 4096
            assert len(set(content)) == 1
    write_bytes(target, b"new")
    assert [*tmp_path.iterdir()] == [target]
    assert target.read_bytes() == b"new"


def test_the_unfinished_file_of_a_living_process_stays(tmp_path):
    holds = "import sys\nfrom osculate.files import complete_file\n" + (
        "with complete_file(sys.argv[1]) as path:\n print(path.name, flush=True)\n sys.stdin.read()\n"
        " path.write_text('done')\n"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", holds, str(tmp_path / "slow")], text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    name = other.stdout.readline().strip()
    dead = tmp_path / f".osculate-{'0' * 16}.gif"
    dead.write_text("half")
    (tmp_path / ".osculate-notes").write_text("not ours")
    with complete_file(tmp_path / "quick") as mine:
        remove_abandoned(tmp_path)
        assert mine.exists()
    assert {path.name for path in tmp_path.iterdir()} == {name, "quick", ".osculate-notes"}
    other.communicate()
    assert (tmp_path / "slow").read_text() == "done"
    assert other.returncode == 0


def test_unfinished_files_of_this_process_can_be_removed_at_once(tmp_path):
    with pytest.raises(FileNotFoundError), complete_file(tmp_path / "file"):
        remove_unfinished()
    assert [*tmp_path.iterdir()] == []


def test_modes_and_links_are_kept(tmp_path):
    old = os.umask(0o027)
    try:
        assert stat.S_IMODE(write_text(tmp_path / "new", "").stat().st_mode) == 0o640
    finally:
        os.umask(old)
    (tmp_path / "new").chmod(0o604)
    (tmp_path / "link").symlink_to("new")
    write_text(tmp_path / "link", "content")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "new").read_text() == "content"
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o604
    with complete_file(tmp_path / "secret", private=True):
        pass
    assert stat.S_IMODE((tmp_path / "secret").stat().st_mode) == 0o600


def test_what_is_no_character_is_written_as_an_escape(tmp_path):
    assert write_text(tmp_path / "file", "ü\ud800").read_bytes() == b"\xc3\xbc\\ud800"


@pytest.mark.parametrize("durable", [True, False])
def test_a_file_is_on_the_disk_before_its_name_and_the_name_before_the_end(
    tmp_path, monkeypatch, durable
):
    done = []
    sync, rename = os.fsync, Path.replace
    places = {tmp_path.stat().st_ino: "folder"}

    def note_sync(descriptor):
        done.append(places.get(os.fstat(descriptor).st_ino, "file"))
        sync(descriptor)

    def note_rename(path, target):
        done.append("name")
        return rename(path, target)

    monkeypatch.setattr(os, "fsync", note_sync)
    monkeypatch.setattr(Path, "replace", note_rename)
    write_bytes(tmp_path / "file", b"content", durable=durable)
    assert done == (["file", "name", "folder"] if durable else ["name"])


def test_pipes_and_folders_are_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for name in ("pipe", "."):
        with pytest.raises(OSError, match=r"is a device or pipe|[Dd]irectory"):
            write_bytes(tmp_path / name, b"")
        with pytest.raises(InvalidInput, match="must be writable"):
            check_file("path", tmp_path / name)
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


@pytest.mark.parametrize("name", ["n" * 256, "a/" + "n" * 256 + "/b", "null\0character"])
def test_places_that_do_not_exist_are_refused_before_the_work(tmp_path, name):
    with pytest.raises(InvalidInput, match=r"path = .*must be writable"):
        check_file("path", tmp_path / name)


def test_a_place_is_tried_and_nothing_is_left(tmp_path):
    check_folder("output", tmp_path / "deep" / "down")
    check_file("path", tmp_path / "deep" / "file.nc")
    assert [*tmp_path.iterdir()] == []
    (tmp_path / "file").write_text("")
    with pytest.raises(InvalidInput, match=r"output = .*must be a writable folder"):
        check_folder("output", tmp_path / "file" / "below")


def test_a_folder_without_room_is_refused_before_the_work(small_disk):
    small_disk.fill()
    for check in (check_folder, check_file):
        with pytest.raises(InvalidInput, match="No space left"):
            check("output", small_disk.path / "out")
