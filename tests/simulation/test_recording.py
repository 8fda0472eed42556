"""Runs as MCAP and Rerun files, opened by the readers that others use."""

import numpy as np
import pytest

from osculate import Continuous, Cycloid, InvalidInput, MissingExtra, Scene, Wall, simulate

pytestmark = pytest.mark.core

pytest.importorskip("mcap_ros2")
pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def run():
    scene = Scene(obstacles=(Wall(),))
    return simulate(Cycloid.over(), clock=Continuous(duration=2.0), scene=scene)


@pytest.fixture(scope="module")
def bag(run, tmp_path_factory):
    return run.save(tmp_path_factory.mktemp("bag") / "run.mcap")


def test_mcap_is_read_by_the_mcap_library(run, bag):
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    messages = {}
    with bag.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            messages.setdefault(channel.topic, []).append(message)
    assert {name: len(found) for name, found in messages.items()} == {
        "/odom": 201, "/reference": 201, "/joint_states": 201, "/tf": 201, "/path": 1, "/diagnostics": 1,
    }  # fmt: skip
    odometry = messages["/odom"][100]
    assert odometry.header.stamp.sec == 1
    assert odometry.header.frame_id == "odom"
    n = 1000
    assert odometry.pose.pose.position.x == run.columns["x"][n]
    assert odometry.twist.twist.angular.z == run.columns["yaw_rate"][n]
    turned = odometry.pose.pose.orientation
    assert 2 * np.arctan2(turned.z, turned.w) == pytest.approx(run.columns["heading"][n])
    joints = messages["/joint_states"][100]
    assert joints.name[2] == "steering_joint"
    assert joints.effort[0] == run.columns["torque_right"][n]
    assert len(messages["/path"][0].poses) == 1001
    keys = {value.key for value in messages["/diagnostics"][0].status[0].values}
    assert "cross_track_rms [m]" in keys


def test_mcap_is_read_by_rosbags(run, bag):
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        kinds = {connection.topic: connection.msgtype for connection in reader.connections}
        assert kinds["/tf"] == "tf2_msgs/msg/TFMessage"
        connections = [c for c in reader.connections if c.topic == "/odom"]
        times = []
        for connection, stamp, raw in reader.messages(connections=connections):
            times.append(stamp)
            message = reader.deserialize(raw, connection.msgtype)
        assert message.pose.pose.position.y == run.columns["y"][-1]
        assert np.diff(times) == pytest.approx(1e7)


def test_rerun_recordings_hold_map_and_series(run, tmp_path):
    pytest.importorskip("rerun")
    path = run.save(tmp_path / "deep" / "run.rrd")
    content = path.read_bytes()
    assert content.startswith(b"RRF")
    for entity in (b"map/obstacles", b"map/target", b"map/robot", b"series/cross_track_error"):
        assert entity in content


def test_other_endings_and_missing_extras_are_explained(run, tmp_path, monkeypatch):
    import sys

    with pytest.raises(InvalidInput, match=r"must end in \.nc, \.mcap or \.rrd"):
        run.save(tmp_path / "run.bag")
    monkeypatch.setitem(sys.modules, "mcap_ros2.writer", None)
    with pytest.raises(MissingExtra, match=r"pip install 'osculate\[mcap\]'"):
        run.save(tmp_path / "run.mcap")
