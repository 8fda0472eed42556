"""Fixtures shared by all tests."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).parent.parent

# composed loops are compiled once per checkout, and shared by all test processes
os.environ.setdefault("OSCULATE_CACHE_DIR", str(ROOT / ".pytest_cache" / "osculate"))

settings.register_profile("osculate", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("osculate")


@pytest.fixture
def shared_data() -> Path:
    """Tracks and maps from elsewhere; tests that use them are skipped where they are missing."""
    folder = ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("no shared data beside this checkout")
    return folder


class SmallDisk:
    """A file system of two megabytes."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def fill(self, left: int = 0) -> None:
        """Fill it up to so many bytes."""
        status = os.statvfs(self.path)
        room = status.f_bavail * status.f_frsize - left
        (self.path / "other data").write_bytes(bytes(max(room, 0)))


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[SmallDisk]:
    """A disk to fill; tests that use it are skipped where nothing may be mounted."""
    place = tmp_path / "disk"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=2m", "none", str(place)]
    mount = shutil.which("mount")
    if not mount or subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("no file system can be mounted here")
    yield SmallDisk(place)
    subprocess.run(["umount", "--lazy", str(place)], check=True)
