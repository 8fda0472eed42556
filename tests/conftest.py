"""Fixtures shared by all tests."""

import os
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
