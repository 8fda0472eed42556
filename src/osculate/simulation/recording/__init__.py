"""Runs as files of other tools: MCAP with ROS 2 messages, Rerun recordings, films."""

from osculate.simulation.recording.mcap import write_mcap
from osculate.simulation.recording.rerun import write_rerun
from osculate.simulation.recording.video import write_video

__all__ = ["write_mcap", "write_rerun", "write_video"]
