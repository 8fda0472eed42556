"""A run as MCAP with ROS 2 messages, as a robot would have logged it (REP-103, REP-105).

| topic | message |
|---|---|
| /odom | nav_msgs/Odometry: pose in ``odom``, twist in ``base_link`` |
| /reference | geometry_msgs/TwistStamped: target speed and yaw rate |
| /joint_states | sensor_msgs/JointState: steering angle; torques and speeds of the drive wheels |
| /tf | tf2_msgs/TFMessage: ``map`` → ``odom`` → ``base_link`` |
| /path | nav_msgs/Path: the target curve, once |
| /diagnostics | diagnostic_msgs/DiagnosticArray: verdict, metrics and interventions, once, at the end |
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from osculate.errors import import_extra
from osculate.simulation.metrics import Metrics

if TYPE_CHECKING:
    from osculate.simulation.run import Run

RATE = 100.0  # Hz, of the messages
PATH_POINTS = 1001
TYPES = {
    "/odom": "nav_msgs/msg/Odometry",
    "/reference": "geometry_msgs/msg/TwistStamped",
    "/joint_states": "sensor_msgs/msg/JointState",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/path": "nav_msgs/msg/Path",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}
JOINTS = ("traction_right_wheel_joint", "traction_left_wheel_joint", "steering_joint")
Message = dict[str, Any]


def write_mcap(run: "Run", path: Path) -> Path:
    """Write a run as MCAP (extra ``mcap``).

    Raises:
        MissingExtra: The writer is not installed.
    """
    writer_of, systems = load_mcap()
    store = systems.get_typestore(systems.Stores.ROS2_JAZZY)
    with path.open("wb") as stream:
        writer = writer_of(stream)
        schemas = {
            topic: writer.register_msgdef(kind, store.generate_msgdef(kind, ros_version=2)[0])
            for topic, kind in TYPES.items()
        }

        def send(topic: str, time: float, message: Message) -> None:
            nanoseconds = round(time * 1e9)
            writer.write_message(topic, schemas[topic], message, nanoseconds, nanoseconds)

        send("/path", 0.0, _path(run))
        for n in _kept(run):
            time = float(run.columns["time"][n])
            for topic, message in _messages(run, int(n), time).items():
                send(topic, time, message)
        end = float(run.columns["time"][-1])
        send("/diagnostics", end, _diagnostics(run, end))
        writer.finish()
    return path


def load_mcap() -> tuple[Any, Any]:
    """The writer, and the definitions of messages.

    Raises:
        MissingExtra: They are not installed.
    """
    writer = import_extra("mcap_ros2.writer", "mcap", "mcap-ros2-support").Writer
    return writer, import_extra("rosbags.typesys", "mcap", "rosbags")


def _kept(run: "Run") -> Any:
    """Samples at the message rate, the last one among them."""
    time = run.columns["time"]
    wanted = np.arange(0.0, time[-1] + 1e-9, 1.0 / RATE)
    return np.unique(np.append(np.searchsorted(time, wanted - 1e-9), len(time) - 1))


def _messages(run: "Run", n: int, time: float) -> dict[str, Message]:
    c = {name: float(values[n]) for name, values in run.columns.items()}
    robot = run.setup.robot
    position = {"x": c["x"], "y": c["y"], "z": 0.0}
    turned = _quaternion(c["heading"])
    base = {
        "header": _header(time, "odom"),
        "child_frame_id": "base_link",
        "transform": {"translation": position, "rotation": turned},
    }
    still = {
        "header": _header(time, "map"),
        "child_frame_id": "odom",
        "transform": {"translation": _vector(0.0), "rotation": _quaternion(0.0)},
    }
    side = robot.track_width / 2.0 * c["yaw_rate"]
    right, left = (c["speed"] + side) / robot.wheel_radius, (c["speed"] - side) / robot.wheel_radius
    covariance = [0.0] * 36
    return {
        "/odom": {
            "header": _header(time, "odom"),
            "child_frame_id": "base_link",
            "pose": {
                "pose": {"position": position, "orientation": turned},
                "covariance": covariance,
            },
            "twist": {"twist": _twist(c["speed"], c["yaw_rate"]), "covariance": covariance},
        },
        "/reference": {
            "header": _header(time, "base_link"),
            "twist": _twist(c["target_speed"], c["target_yaw_rate"]),
        },
        "/joint_states": {
            "header": _header(time, ""),
            "name": list(JOINTS),
            "position": [0.0, 0.0, robot.wheel_angle(c["steering_angle"])],
            "velocity": [right, left, 0.0],
            "effort": [c["torque_right"], c["torque_left"], 0.0],
        },
        "/tf": {"transforms": [still, base]},
    }


def _path(run: "Run") -> Message:
    point = run.setup.curve.at(np.linspace(0.0, run.setup.curve.length, PATH_POINTS))
    header = _header(0.0, "map")
    poses = [
        {
            "header": header,
            "pose": {
                "position": {"x": float(x), "y": float(y), "z": 0.0},
                "orientation": _quaternion(float(heading)),
            },
        }
        for x, y, heading in zip(point.x, point.y, point.heading, strict=True)
    ]
    return {"header": header, "poses": poses}


def _known(value: Any) -> bool:
    """Whether there is something to tell: a text, or a finite number."""
    return isinstance(value, str) or (value is not None and bool(np.isfinite(value)))


def _diagnostics(run: "Run", time: float) -> Message:
    values = [
        {"key": f"verdict {name}", "value": str(value)}
        for name, value in run.verdict.as_dict().items()
        if value is not None
    ]
    values += [
        {"key": f"{name} [{unit}]" if unit else name, "value": str(value)}
        for name, unit, _ in Metrics.items()
        if _known(value := getattr(run.metrics, name))
    ]
    status = {
        "level": 0 if run.verdict.reached else 2,
        "name": "osculate: path tracking", "message": str(run.verdict),
        "hardware_id": run.setup.robot.kind, "values": values,
    }  # fmt: skip
    interventions = [
        {
            "level": 1, "name": "osculate: safety", "message": done.reason,
            "hardware_id": run.setup.robot.kind,
            "values": [
                {"key": "begin [s]", "value": str(done.begin)},
                {"key": "end [s]", "value": str(done.end)},
                {"key": "arc length [m]", "value": str(done.place)},
                {"key": "corridor excess [m]", "value": str(done.excess)},
                {"key": "cause", "value": done.cause},
            ],
        }
        for done in run.interventions
    ]  # fmt: skip
    return {"header": _header(time, ""), "status": [status, *interventions]}


def _header(time: float, frame: str) -> Message:
    nanoseconds = round(time * 1e9)
    seconds, rest = divmod(nanoseconds, 1_000_000_000)
    return {"stamp": {"sec": seconds, "nanosec": rest}, "frame_id": frame}


def _quaternion(heading: float) -> Message:
    return {"x": 0.0, "y": 0.0, "z": float(np.sin(heading / 2)), "w": float(np.cos(heading / 2))}


def _vector(x: float, z: float = 0.0) -> Message:
    return {"x": x, "y": 0.0, "z": z}


def _twist(speed: float, yaw_rate: float) -> Message:
    return {"linear": _vector(speed), "angular": _vector(0.0, yaw_rate)}
