"""Every format on a disk that is full, or for a file that may not grow: whole files or none."""

import pytest

from osculate import (
    Continuous,
    Cycloid,
    InvalidInput,
    NotWritten,
    OsculateError,
    Scenario,
    simulate,
)
from osculate.folder import MARK, RECORD
from osculate.simulation.recording.video import write_video
from osculate.simulation.recording.video.opengl import offscreen
from osculate.study import figures
from osculate.study.figures import write_animation, write_figures
from osculate.study.output import write_output
from osculate.study.report import write_report


@pytest.fixture(scope="module")
def run():
    return simulate(Cycloid.over(), clock=Continuous(duration=0.5))


def film(run, path):
    pytest.importorskip("av")
    try:
        offscreen(64, 64).free()
    except OsculateError as error:
        pytest.skip(str(error))
    write_video(run, path, size=(64, 64), fps=10)


def save(extra):
    def write(run, path):
        pytest.importorskip(extra)
        run.save(path)

    return write


WRITERS = {
    "run.nc": save("scipy"),
    "run.mcap": save("mcap_ros2"),
    "run.rrd": save("rerun"),
    "film.mp4": film,
    "film.gif": film,
    "animation.gif": write_animation,
    "report.html": lambda run, path: write_report(run, path, "title"),
    "overview.png": lambda run, path: write_figures(run, path.parent),
}


@pytest.mark.parametrize("left", [0, 3000])
@pytest.mark.parametrize("name", WRITERS)
def test_a_full_disk_leaves_the_old_file_or_none(run, small_disk, monkeypatch, name, left):
    monkeypatch.setattr(figures, "FRAMES", 3)
    target = small_disk.path / name
    small_disk.fill(left)
    with pytest.raises((InvalidInput, OSError), match=r"No space left|\[Errno 28\]"):
        WRITERS[name](run, target)
    assert {path.name for path in small_disk.path.iterdir()} == {"other data"}
    (small_disk.path / "other data").unlink()
    target.write_text("old")
    small_disk.fill(left)
    with pytest.raises((InvalidInput, OSError), match=r"No space left|\[Errno 28\]"):
        WRITERS[name](run, target)
    assert target.read_text() == "old"


def test_a_run_on_a_disk_that_gets_full_keeps_what_was_finished(run, small_disk):
    out = small_disk.path / "out"
    small_disk.fill(left=600_000)  # the data, and not the report
    with pytest.raises(NotWritten, match=r"report.html is missing \(.*No space left"):
        write_output(run, out, Scenario(), also=[small_disk.path / "other.nc"])
    names = {path.name for path in out.iterdir()} - {RECORD}
    assert {"scenario.json", "metrics.json", "run.nc", MARK} <= names
    assert "report.html" not in names
    assert Scenario.load(out / "scenario.json") == Scenario()
    assert "Missing: report.html" in (out / MARK).read_text()
    assert (small_disk.path / "other.nc").stat().st_size == (out / "run.nc").stat().st_size
