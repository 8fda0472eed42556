"""A run in MuJoCo's viewer, in real time and over and over until the window is closed."""

import os
import sys
import time
from importlib import import_module
from typing import TYPE_CHECKING, Any
from warnings import catch_warnings

from osculate.errors import InvalidInput, MissingExtra
from osculate.simulation.recording.video.camera import aim, shots
from osculate.simulation.recording.video.stage import Stage, moments

if TYPE_CHECKING:
    from osculate.simulation.run import Run

RATE = 50.0  # Hz
FAR = 60.0  # lengths of the robot
NEEDS_DISPLAY = "needs a display, and there is none; write a film with --video FILE"


def require_display() -> None:
    """Make sure that a window can be opened.

    Raises:
        InvalidInput: There is no display.
    """
    if sys.platform == "linux" and not {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ):
        raise InvalidInput("view", True, NEEDS_DISPLAY)


def view(run: "Run") -> None:
    """Replay a run in MuJoCo's viewer until its window is closed.

    Raises:
        InvalidInput: There is no display.
        MissingExtra: MuJoCo is not installed.
    """
    require_display()
    try:
        launch: Any = import_module("mujoco.viewer").launch_passive
    except ImportError:
        raise MissingExtra("video", "mujoco") from None
    with catch_warnings(action="ignore"):
        opens = import_module("glfw").init()
    if not opens:  # the viewer itself would wait for ever
        raise InvalidInput("view", True, NEEDS_DISPLAY)
    stage, frames = Stage(run, (640, 480)), moments(run, RATE)
    visual = stage.model.vis.map
    visual.zfar, visual.shadowclip = FAR, 0.5 * FAR  # there is no fog here
    stage.show(frames[0])
    with launch(stage.model, stage.data, show_left_ui=False, show_right_ui=False) as window:
        with window.lock():
            aim(window.cam, shots(frames, RATE, stage.length)[0], stage.length)
            stage.follow(window.cam)
            stage.lay(window.user_scn)
        begin = time.monotonic()
        while window.is_running():
            passed = int((time.monotonic() - begin) * RATE)
            with window.lock():
                frame = frames[passed % len(frames)]
                stage.show(frame)
                window.user_scn.ngeom = int(stage.station(frame))
            window.sync()
            time.sleep(max(0.0, begin + (passed + 1) / RATE - time.monotonic()))
