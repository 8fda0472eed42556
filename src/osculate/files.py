"""Files that appear under their names complete, or not at all.

A file is written under a temporary name in its own folder, flushed to the disk and renamed. Whatever
happens on the way (an error, a full disk, a kill), its name stands for the old content or for the new one.
A writer holds a lock on its temporary file; one without a lock belongs to a process that was killed, and
the next writer removes it.
"""

import contextlib
import errno
import os
import re
import secrets
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from osculate.errors import InvalidInput

TEMPORARY = re.compile(r"\.osculate-[0-9a-f]{16}(\.\w+)?")
PROBE = 4096  # bytes that are written to see whether there is room

_unfinished: set[Path] = set()  # temporary files of this process


@contextmanager
def complete_file(
    path: str | Path, *, durable: bool = True, private: bool = False
) -> Iterator[Path]:
    """Where to write what is to appear as ``path``: the body of the ``with`` statement writes it there.

    The temporary name has the same ending. A link is followed, the mode of a file that is replaced is kept.
    If the body raises, nothing has changed.

    Args:
        path: The file; its folder is made if missing.
        durable: Whether it must also survive a power failure, which takes milliseconds.
        private: Whether nobody else may read it.

    Raises:
        OSError: It cannot be written.
    """
    target = Path(os.path.realpath(path))
    _require_regular(target)
    target.parent.mkdir(parents=True, exist_ok=True)
    remove_abandoned(target.parent)
    temporary, lock = _claim(target, 0o600 if private else 0o666)
    _unfinished.add(temporary)
    try:
        yield temporary
        if not private and target.exists():
            temporary.chmod(stat.S_IMODE(target.stat().st_mode))
        if durable:
            _flush(temporary)
        temporary.replace(target)
        if durable:
            _flush(target.parent)
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        _unfinished.discard(temporary)
        os.close(lock)


def write_bytes(
    path: str | Path, content: bytes, *, durable: bool = True, private: bool = False
) -> Path:
    """Write a file, complete or not at all; see `complete_file`.

    Raises:
        OSError: It cannot be written.
    """
    with complete_file(path, durable=durable, private=private) as temporary:
        temporary.write_bytes(content)
    return Path(path)


def write_text(path: str | Path, text: str, *, durable: bool = True) -> Path:
    """Write a text as UTF-8, complete or not at all; what is no character is written as an escape.

    Raises:
        OSError: It cannot be written.
    """
    return write_bytes(path, text.encode("utf-8", errors="backslashreplace"), durable=durable)


def write_by(writer: Callable[[Path], object], path: str | Path) -> Path:
    """Let ``writer`` write a file to the path it is given, so that it appears complete or not at all.

    Raises:
        OSError: It cannot be written.
    """
    with complete_file(path) as temporary:
        writer(temporary)
    return Path(path)


def is_file(path: Path) -> bool:
    """Whether there is such a file; no error for what can be no path."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that is too long, a null character
        return False


def check_folder(field: str, path: Path) -> None:
    """Make sure, before long work, that a folder is there or can be made, and has room.

    Raises:
        InvalidInput: The field ``field`` has to name another folder.
    """
    try:
        _probe(path)
    except OSError as error:
        raise InvalidInput(field, str(path), f"must be a writable folder ({error})") from None


def check_file(field: str, path: Path) -> None:
    """Make sure, before long work, that a file can be written.

    Raises:
        InvalidInput: The field ``field`` has to name another file.
    """
    try:
        target = Path(os.path.realpath(path))
        _require_regular(target)
        _probe(target.parent)
        _require_name(target.parent, target.name)
    except (OSError, ValueError) as error:  # the latter: a null character
        raise InvalidInput(field, str(path), f"must be writable ({error})") from None


def remove_unfinished() -> None:
    """Remove the temporary files of this process, which is about to be ended at once."""
    for temporary in tuple(_unfinished):
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def remove_abandoned(folder: Path) -> None:
    """Remove the temporary files that killed processes have left in a folder."""
    for name in os.listdir(folder):  # noqa: PTH208 (one system call, no objects: folders may be large)
        if TEMPORARY.fullmatch(name):
            with contextlib.suppress(OSError):  # gone already, or another user's
                _remove_if_abandoned(folder / name)


def lock_file(descriptor: int, *, wait: bool) -> bool:
    """Lock an open file against other processes until it is closed; False if another one has it.

    Where locks do not exist, every process is told that it has it.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return True


def is_still(descriptor: int, path: Path) -> bool:
    """Whether a path still names the open file, which nobody has removed or replaced meanwhile."""
    try:
        named = path.lstat()
    except FileNotFoundError:
        return False
    opened = os.fstat(descriptor)
    return (named.st_dev, named.st_ino) == (opened.st_dev, opened.st_ino)


def _claim(target: Path, mode: int) -> tuple[Path, int]:
    """A new temporary file beside ``target``, and the open file that locks it."""
    ending = target.suffix if re.fullmatch(r"\.\w{1,16}", target.suffix) else ""
    while True:
        temporary = target.with_name(f".osculate-{secrets.token_hex(8)}{ending}")
        descriptor = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_RDWR, mode)
        if lock_file(descriptor, wait=True) and is_still(descriptor, temporary):
            return temporary, descriptor
        os.close(descriptor)  # another process took it for abandoned before it was locked


def _remove_if_abandoned(temporary: Path) -> None:
    try:
        import fcntl
    except ImportError:  # Windows refuses to remove what is open
        temporary.unlink()
        return
    descriptor = os.open(temporary, os.O_RDONLY | os.O_NOFOLLOW)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        temporary.unlink()
    finally:
        os.close(descriptor)


def _flush(path: Path) -> None:
    """Have the disk hold what was written to a file or folder."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # some systems cannot, for folders
            raise
    finally:
        os.close(descriptor)


def _require_regular(target: Path) -> None:
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(target))
    if target.exists() and not target.is_file():
        raise OSError(errno.EINVAL, "is a device or pipe", str(target))


def _require_name(folder: Path, name: str) -> None:
    """Whether the file system takes the name; a missing folder would hide that it does not."""
    with contextlib.suppress(FileNotFoundError):
        (folder / name).lstat()


def _probe(folder: Path) -> None:
    """Write a little into the nearest folder there is, and take it away again."""
    place, missing = Path(os.path.realpath(folder)), []
    while not place.exists():
        missing.append(place.name)
        place = place.parent
    for name in missing:
        _require_name(place, name)
    if not place.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(place))
    temporary, lock = _claim(place / "probe", 0o600)
    try:
        os.write(lock, bytes(PROBE))
        os.fsync(lock)
    finally:
        temporary.unlink(missing_ok=True)
        os.close(lock)
