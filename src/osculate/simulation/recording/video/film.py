"""A run as a film: the stage, a camera that follows, words, and an encoder."""

from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from osculate.errors import InvalidInput, import_extra
from osculate.files import complete_file
from osculate.simulation.recording.video.camera import aim, shots
from osculate.simulation.recording.video.caption import Caption
from osculate.simulation.recording.video.opengl import Screen, load_mujoco, offscreen
from osculate.simulation.recording.video.stage import Frame, Stage, moments

if TYPE_CHECKING:
    from osculate.simulation.run import Run

Picture = NDArray[np.uint8]
Report = Callable[[float], None]
FINER = 1.25  # drawn larger and shrunk: smooth edges, also of shadows, for less than multisampling


def write_video(
    run: "Run",
    path: str | Path,
    size: tuple[int, int] | None = None,
    fps: int | None = None,
    report: Report | None = None,
) -> Path:
    """Film a run of any plant in real time (extra ``video``); needs OpenGL, but no display.

    Args:
        run: The run.
        path: ``.mp4`` (H.264) or ``.gif``.
        size: Width and height in pixels, both even; by default (1280, 720), of a GIF (640, 360).
        fps: Pictures per second; by default 30, of a GIF 20.
        report: Called with the fraction of the film that is done.

    Returns:
        The file.

    Raises:
        InvalidInput: Another ending, a wrong size or rate, or a file that cannot be written.
        MissingExtra: MuJoCo or the encoder is not installed.
        OsculateError: OpenGL does not work; says what to install.
    """
    target = check_video(path)
    small = target.suffix == ".gif"
    size, fps = size or ((640, 360) if small else (1280, 720)), fps or (20 if small else 30)
    if min(size) < 64 or size[0] % 2 or size[1] % 2:
        raise InvalidInput("size", size, "must be even numbers of pixels, 64 or more")
    if not 1 <= fps <= 100:
        raise InvalidInput("fps", fps, "must be from 1 to 100 pictures per second")
    drawn = (round(FINER * size[0]), round(FINER * size[1]))
    stage, frames = Stage(run, drawn), moments(run, fps)
    try:
        with complete_file(target) as temporary, Screen(stage.model, drawn) as screen:
            pictures = _pictures(stage, screen, frames, fps, Caption(size, run.verdict))
            WRITERS[target.suffix](
                _counted(pictures, len(frames), report), temporary, fps, len(frames)
            )
    except OSError as error:
        raise InvalidInput("path", str(path), f"must be writable ({error})") from None
    return target


def check_video(path: str | Path) -> Path:
    """The path of a film, if its ending is known and all that makes films is there.

    Raises:
        InvalidInput: Another ending.
        MissingExtra: MuJoCo or the encoder is not installed.
        OsculateError: OpenGL does not work; says what to install.
    """
    target = Path(path)
    if target.suffix not in WRITERS:
        raise InvalidInput("path", str(path), f"must end in {' or '.join(WRITERS)}")
    if target.suffix == ".mp4":
        import_extra("av", "video", "av")
    load_mujoco()
    offscreen(64, 64).free()
    return target


def _pictures(
    stage: Stage, screen: Screen, frames: list[Frame], fps: int, caption: Caption
) -> Iterator[Picture]:
    from PIL import Image

    camera = stage.camera()
    for frame, shot in zip(frames, shots(frames, fps, stage.length), strict=True):
        stage.show(frame)
        aim(camera, shot, stage.length)
        drawn = Image.fromarray(screen.picture(stage.data, camera, stage.trace))
        yield caption.on(np.asarray(drawn.resize(caption.size, Image.Resampling.BILINEAR)), frame)


def _counted(pictures: Iterator[Picture], count: int, report: Report | None) -> Iterator[Picture]:
    for n, picture in enumerate(pictures):
        yield picture
        if report:
            report((n + 1) / count)


def _write_mp4(pictures: Iterator[Picture], path: Path, fps: int, count: int) -> None:
    av = import_extra("av", "video", "av")
    first = next(pictures)
    with av.open(str(path), "w", options={"movflags": "faststart"}) as film:
        stream = film.add_stream("libx264", rate=fps, options={"crf": "20", "preset": "veryfast"})
        stream.pix_fmt = "yuv420p"
        stream.height, stream.width = first.shape[:2]
        for picture in chain([first], pictures):
            film.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        film.mux(stream.encode(None))


def _write_gif(pictures: Iterator[Picture], path: Path, fps: int, count: int) -> None:
    """All pictures in the colours of the first one; a GIF counts time in steps of 10 ms."""
    from PIL import Image

    first = Image.fromarray(next(pictures)).quantize(255)
    rest = (Image.fromarray(p).quantize(palette=first, dither=Image.Dither.NONE) for p in pictures)
    stamps = 10 * np.round(np.arange(count + 1) * 100.0 / fps).astype(int)
    first.save(path, save_all=True, append_images=rest, duration=np.diff(stamps).tolist(), loop=0)


WRITERS: dict[str, Callable[[Iterator[Picture], Path, int, int], None]] = {
    ".mp4": _write_mp4,
    ".gif": _write_gif,
}
