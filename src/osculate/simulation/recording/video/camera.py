"""The camera of a film: behind the robot and to its left, above, looking ahead; its moves are smooth."""

from typing import Any, NamedTuple

import numpy as np

from osculate.simulation.recording.video.stage import Frame

ASIDE, DOWN = 32.0, 25.0  # degrees: to the right of the robot's heading, below the horizon
DISTANCE, AHEAD, TOWARDS = 6.6, 0.7, 0.9  # lengths of the robot
CALM_TURN, CALM_MOVE = 1.2, 0.25  # s, standard deviations of the smoothing


class Shot(NamedTuple):
    """Where the camera looks."""

    x: float  # m, of the point in the middle of the picture
    y: float  # m
    azimuth: float  # rad, the direction of view


def shots(frames: list[Frame], rate: float, length: float) -> list[Shot]:
    """One shot for each frame; what comes is known, so that nothing lags behind.

    Args:
        frames: The film.
        rate: Frames per second.
        length: Of the robot (m).
    """
    from scipy.ndimage import gaussian_filter1d

    x, y, heading = np.array([(f.x, f.y, f.heading) for f in frames]).T
    azimuth = gaussian_filter1d(heading, CALM_TURN * rate, mode="nearest") - np.radians(ASIDE)
    ahead = length * (AHEAD * np.exp(1j * heading) + TOWARDS * np.exp(1j * azimuth))
    middle = gaussian_filter1d(x + ahead.real, CALM_MOVE * rate, mode="nearest")
    centre = gaussian_filter1d(y + ahead.imag, CALM_MOVE * rate, mode="nearest")
    return [Shot(*map(float, row)) for row in zip(middle, centre, azimuth, strict=True)]


def aim(camera: Any, shot: Shot, length: float) -> None:
    """Set a ``mujoco.MjvCamera`` for a robot of some length (m)."""
    camera.lookat[:] = shot.x, shot.y, 0.2 * length
    camera.azimuth, camera.elevation = np.degrees(shot.azimuth), -DOWN
    camera.distance = DISTANCE * length
