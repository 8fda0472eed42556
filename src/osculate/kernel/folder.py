"""The folder of the machine code: the user's own, or a private one for this process alone."""

import atexit
import os
import shutil
import stat
import tempfile
import warnings
from functools import cache
from pathlib import Path

from osculate.errors import InvalidInput

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
CURE = "set OSCULATE_CACHE_DIR to a folder of your own that nobody else can write"


def cache_directory() -> Path | None:
    """Where machine code is kept.

    ``OSCULATE_CACHE_DIR`` if set, else ``osculate`` in the user's cache directory. Where that cannot be
    made or others could write it, a new private folder that is removed when this process ends (a warning
    says so, once); None if there is no place even for that.

    Raises:
        InvalidInput: ``OSCULATE_CACHE_DIR`` names something that is no folder.
    """
    variables = ("OSCULATE_CACHE_DIR", "XDG_CACHE_HOME", "HOME")
    return _directory(*(os.environ.get(name) for name in variables))


@cache
def _directory(chosen: str | None, base: str | None, home: str | None) -> Path | None:
    try:
        folder = _make(Path(chosen) if chosen else _usual(base))
        fault = is_exposed(folder)
    except (FileExistsError, NotADirectoryError):
        if chosen:
            valid = "must be a folder, or the name of a new one"
            raise InvalidInput("OSCULATE_CACHE_DIR", chosen, valid) from None
        fault = "the user's cache directory is no folder"
    except (OSError, RuntimeError) as error:  # the latter: no home
        fault = f"machine code cannot be kept ({error})"
    return _private(fault) if fault else folder


def _usual(base: str | None) -> Path:
    caches = Path(base) if base and Path(base).is_absolute() else Path.home() / ".cache"
    return caches / "osculate"


def _make(folder: Path) -> Path:
    folder = folder.absolute().resolve()  # a link that is changed later changes nothing
    for place in reversed(folder.parents):
        if not place.exists():
            place.mkdir(mode=0o700, exist_ok=True)
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder


def is_exposed(folder: Path) -> str:
    """Who else could put files into ``folder``, or replace it; empty where nobody could."""
    if not hasattr(os, "geteuid"):  # Windows: access lists of the user's profile
        return ""
    for place in (folder, *folder.parents):
        status = place.stat()
        if status.st_uid not in (os.geteuid(), *([] if place == folder else [0])):
            return f"{place} belongs to another user"
        sticky = place != folder and status.st_mode & stat.S_ISVTX  # others cannot replace entries
        if others_write(status) and not sticky:
            return f"{place} can be written by others"
    return ""


def others_write(status: os.stat_result) -> bool:
    """Whether somebody other than owner and root may write what ``status`` describes."""
    mode = status.st_mode & OTHERS_WRITE
    return bool(mode) and not (mode == stat.S_IWGRP and _is_own_group(status.st_gid))


def _is_own_group(number: int) -> bool:
    """Whether a group is the user's private one, which many systems give every user."""
    import grp  # not on Windows
    import pwd

    try:
        user, group = pwd.getpwuid(os.geteuid()), grp.getgrgid(number)
    except KeyError:
        return False
    alone = set(group.gr_mem) <= {user.pw_name}
    return alone and group.gr_name == user.pw_name and user.pw_gid == number


def _private(fault: str) -> Path | None:
    try:
        folder = Path(tempfile.mkdtemp(prefix="osculate-"))  # mode 0700
    except OSError:
        _say(f"{fault}; every process compiles anew; {CURE}")
        return None
    atexit.register(_remove, folder, os.getpid())
    _say(f"{fault}; machine code is kept in a temporary folder until this process ends; {CURE}")
    return folder


def _remove(folder: Path, process: int) -> None:
    if os.getpid() == process:  # not in a fork of it
        shutil.rmtree(folder, ignore_errors=True)


def _say(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=2)
