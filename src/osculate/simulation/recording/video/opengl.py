"""OpenGL without a window: pictures of a MuJoCo scene where there is no display."""

import ctypes
import os
import sys
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.errors import MissingExtra, OsculateError

LIBRARIES = {"egl": "libEGL.so.1", "osmesa": "libOSMesa.so.8"}
PACKAGES = "apt-get install libegl1 libgl1 libgl1-mesa-dri"
GEOMS = 1000  # in one picture, at most


class Screen:
    """Where a model is drawn; close it after use, or use it in a ``with`` statement."""

    def __init__(self, model: Any, size: tuple[int, int]) -> None:
        self._mujoco = load_mujoco()
        self._model, (width, height) = model, size
        self._opengl = offscreen(width, height)
        try:
            font = self._mujoco.mjtFontScale.mjFONTSCALE_100
            self._context = self._mujoco.MjrContext(model, font)
        except self._mujoco.FatalError as error:
            raise no_opengl(error) from error
        self._mujoco.mjr_setBuffer(self._mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = self._mujoco.MjvScene(model, maxgeom=GEOMS)
        self._scene.flags[self._mujoco.mjtRndFlag.mjRND_FOG] = True
        self._option, self._rect = self._mujoco.MjvOption(), self._mujoco.MjrRect(0, 0, *size)
        self._pixels = np.empty((height, width, 3), np.uint8)

    def __enter__(self) -> "Screen":
        return self

    def __exit__(self, *_: object) -> None:
        self._context.free()
        self._opengl.free()

    def picture(self, data: Any, camera: Any, changed: int = -1) -> NDArray[np.uint8]:
        """What a ``mujoco.MjvCamera`` sees, shape (height, width, 3), after a mesh has changed."""
        if changed >= 0:
            self._mujoco.mjr_uploadMesh(self._model, self._context, changed)
        everything = self._mujoco.mjtCatBit.mjCAT_ALL
        # the floor has no end: MuJoCo moves it under the camera, so that comes first
        self._mujoco.mjv_updateCamera(self._model, data, camera, self._scene)
        self._mujoco.mjv_updateScene(
            self._model, data, self._option, None, camera, everything, self._scene
        )
        self._mujoco.mjr_render(self._rect, self._scene, self._context)
        self._mujoco.mjr_readPixels(self._pixels, None, self._rect, self._context)
        return self._pixels[::-1]  # OpenGL counts rows from below


def load_mujoco() -> Any:
    """The module, which loads an OpenGL library when ``MUJOCO_GL`` names one.

    Raises:
        MissingExtra: MuJoCo is not installed.
        OsculateError: What the variable names does not work.
    """
    try:
        return import_module("mujoco")
    except ImportError:
        raise MissingExtra("video", "mujoco") from None
    except Exception as error:  # PyOpenGL's and others
        raise no_opengl(error) from error


def no_opengl(error: Exception) -> OsculateError:
    """What to do about an error of some OpenGL library."""
    chosen = os.environ.get("MUJOCO_GL")
    where = f" with MUJOCO_GL={chosen}" if chosen else ""
    return OsculateError(
        f"a film needs OpenGL, which does not work here{where} ({error}); on Debian and Ubuntu it "
        f"comes with: {PACKAGES}"
    )


def offscreen(width: int, height: int) -> Any:
    """An OpenGL context without a window, already current.

    MuJoCo chooses one when it is first imported, and without ``MUJOCO_GL`` takes GLFW, which needs a
    display. Here that variable decides as well; without it, on Linux, the first library that is there.

    Raises:
        OsculateError: No library, or no device that it can draw with; says what to install.
    """
    name = os.environ.get("MUJOCO_GL", "").lower().strip()
    try:
        name = name or _found()
        module = import_module(f"mujoco.{name}" if name in (*LIBRARIES, "glfw") else "mujoco")
        context = module.GLContext(width, height)
        context.make_current()
    except Exception as error:  # each library has errors of its own
        raise no_opengl(error) from error
    return context


def _found() -> str:
    if sys.platform != "linux":
        return "default"
    for name, library in LIBRARIES.items():
        try:
            ctypes.CDLL(library)
        except OSError:
            continue
        return name
    if "DISPLAY" in os.environ:
        return "glfw"
    raise OSError(f"there is neither {' nor '.join(LIBRARIES.values())}")
