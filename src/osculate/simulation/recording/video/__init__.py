"""Runs of any plant as films, and in MuJoCo's viewer: the record moves a model that is only looked at."""

from osculate.simulation.recording.video.film import check_video, write_video
from osculate.simulation.recording.video.viewer import require_display, view

__all__ = ["check_video", "require_display", "view", "write_video"]
