"""The joints of a recording turn as the wheels of the robot do."""

import numpy as np
import pytest

from osculate import Continuous, Cycloid, Sampled, simulate, vehicle_named
from osculate.control.tracking import CurvatureTracker
from osculate.study.comparison.suite import CURVES

pytest.importorskip("mcap_ros2")
pytest.importorskip("rosbags")


def joint_states(path):
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return [m for _, _, _, m in reader.iter_decoded_messages(topics=["/joint_states"])]


@pytest.mark.parametrize("name", ["paper", "tugger", "forklift"])
def test_wheels_roll_and_the_outer_one_is_faster(name, tmp_path):
    """v = r (right + left) / 2 and ω = r (right − left) / d, whatever the messages name first."""
    robot = vehicle_named(name)
    parts = {"robot": robot, "clock": Continuous(duration=2.0)}
    if name != "paper":
        parts |= {"controller": CurvatureTracker(), "clock": Sampled(duration=2.0, delay=0.01)}
    run = simulate(Cycloid.over() if name == "paper" else CURVES["slalom"], **parts)
    messages = joint_states(run.save(tmp_path / "run.mcap"))
    at = np.searchsorted(run.columns["time"], np.arange(len(messages)) / 100.0 - 1e-9)
    side = {key: messages[0].name.index(f"traction_{key}_wheel_joint") for key in ("left", "right")}
    velocity = {key: np.array([m.velocity[n] for m in messages]) for key, n in side.items()}
    effort = {key: np.array([m.effort[n] for m in messages]) for key, n in side.items()}
    r, d = robot.wheel_radius, robot.track_width
    speed, turn = run.columns["speed"][at], run.columns["yaw_rate"][at]
    assert r * (velocity["right"] + velocity["left"]) / 2 == pytest.approx(speed, abs=1e-12)
    assert r * (velocity["right"] - velocity["left"]) / d == pytest.approx(turn, abs=1e-12)
    assert np.abs(turn).max() > 0.01
    for key in side:
        assert effort[key] == pytest.approx(run.columns[f"torque_{key}"][at], abs=0.0)
