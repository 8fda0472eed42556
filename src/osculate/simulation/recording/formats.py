"""The kinds of files that a run can be saved as, by their endings."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from osculate.errors import InvalidInput
from osculate.files import check_file
from osculate.simulation.dataset import write_netcdf
from osculate.simulation.recording.mcap import load_mcap, write_mcap
from osculate.simulation.recording.rerun import load_rerun, write_rerun
from osculate.simulation.recording.video import check_video, write_video

if TYPE_CHECKING:
    from osculate.simulation.run import Run

ENDINGS = ".nc, .mcap or .rrd (records), .mp4 or .gif (films)"
WRITERS: dict[str, Callable[["Run", Path], Path]] = {
    ".nc": write_netcdf, ".mcap": write_mcap, ".rrd": write_rerun, ".mp4": write_video,
    ".gif": write_video,
}  # fmt: skip


def writer_for(path: Path) -> Callable[["Run", Path], Path]:
    """What writes a file with this ending.

    Raises:
        InvalidInput: Another ending.
    """
    if path.suffix not in WRITERS:
        raise InvalidInput("path", str(path), f"must end in {ENDINGS}")
    return WRITERS[path.suffix]


def check_save(path: Path) -> None:
    """Make sure, before a run that may take long, that it can be saved here.

    Raises:
        InvalidInput: Another ending, or a place that cannot be written.
        MissingExtra: What writes this format is not installed.
        OsculateError: A film, and OpenGL does not work.
    """
    writer = writer_for(path)
    if writer is write_mcap:
        load_mcap()
    elif writer is write_rerun:
        load_rerun()
    elif writer is write_video:
        check_video(path)
    check_file("path", path)
