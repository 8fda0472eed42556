"""MCAP recordings of ROS 2: the last nav_msgs/Path of a topic, or the way that a pose took.

Needs the extra ``mcap``. What a chunk unpacks to is bounded before it is unpacked.
"""

from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from osculate.curve.files.found import Found, Wishes, refuse
from osculate.errors import InvalidInput, MissingExtra

LARGEST_CHUNK = 256 * 2**20  # bytes, unpacked
MOST = 2_000_000  # messages of one topic
KINDS: dict[str, Callable[[Any], Any]] = {  # the surest first; a message to its Point
    "nav_msgs/msg/Path": lambda m: m,
    "nav_msgs/msg/Odometry": lambda m: m.pose.pose.position,
    "geometry_msgs/msg/PoseWithCovarianceStamped": lambda m: m.pose.pose.position,
    "geometry_msgs/msg/PoseStamped": lambda m: m.pose.position,
    "geometry_msgs/msg/PointStamped": lambda m: m.point,
}


class Topic(NamedTuple):
    """A topic that may hold the path."""

    name: str
    kind: str
    messages: list[tuple[int, bytes]]  # time of logging (ns) and content


def read_mcap(path: Path, wishes: Wishes) -> Found:
    """The path in a recording.

    Raises:
        InvalidInput: Damaged, too large when unpacked, or without a topic that holds a path (lists them).
        MissingExtra: The reader is not installed.
    """
    label = str(path)
    try:
        stream: Any = import_module("mcap.stream_reader")
        systems: Any = import_module("rosbags.typesys")
    except ImportError:
        raise MissingExtra("mcap", "mcap-ros2-support") from None
    try:
        topics, others = _topics(path, stream, label)
    except InvalidInput:
        raise
    except Exception as error:  # mcap, struct, lz4 and zstandard each raise errors of their own
        why = str(error) or type(error).__name__
        raise refuse(label, f"is a damaged MCAP file, cut off perhaps ({why})") from None
    topic, warnings = _choose(topics, others, label, wishes)
    store = systems.get_typestore(systems.Stores.ROS2_JAZZY)
    try:
        return _found(topic, store, label, warnings, wishes)
    except InvalidInput:
        raise
    except Exception as error:  # rosbags raises what struct and NumPy raise
        message = f"a message of {topic.name} cannot be read as {topic.kind} ({error})"
        raise refuse(label, message) from None


def _topics(path: Path, stream: Any, label: str) -> tuple[list[Topic], list[str]]:
    """Topics of the kinds that are read, and the others in words."""
    schemas: dict[int, str] = {}
    channels: dict[int, Topic | None] = {}
    others: list[str] = []
    with path.open("rb") as file:
        for record in _records(file, stream, label):
            kind = type(record).__name__
            if kind == "Schema":
                schemas[record.id] = record.name
            elif kind == "Channel" and record.id not in channels:
                name = schemas.get(record.schema_id, "unknown")
                able = name in KINDS and record.message_encoding == "cdr"
                channels[record.id] = Topic(record.topic, name, []) if able else None
                if not able:
                    others.append(f"{record.topic} ({name}, {record.message_encoding})")
            elif kind == "Message":
                topic = channels.get(record.channel_id)
                if topic is None:
                    continue
                if len(topic.messages) >= MOST:
                    raise refuse(label, f"holds more than {MOST} messages of {topic.name}")
                topic.messages.append((record.log_time, record.data))
    return [topic for topic in channels.values() if topic and topic.messages], others


def _records(file: Any, stream: Any, label: str) -> Iterator[Any]:
    reader = stream.StreamReader(
        file, emit_chunks=True, validate_crcs=True, record_size_limit=LARGEST_CHUNK
    )
    for record in reader.records:
        if type(record).__name__ == "Chunk":
            _check_size(record, label)
            yield from stream.breakup_chunk(record, validate_crc=True)
        else:
            yield record


def _check_size(chunk: Any, label: str) -> None:
    """What a chunk says that it unpacks to, and what its compressed frame says."""
    size = chunk.uncompressed_size
    if chunk.compression == "zstd":
        size = max(size, import_module("zstandard").frame_content_size(chunk.data))
    elif chunk.compression == "lz4":
        unpacker = import_module("lz4.frame").LZ4FrameDecompressor()
        size = max(size, len(unpacker.decompress(chunk.data, max_length=LARGEST_CHUNK + 1)))
    if size > LARGEST_CHUNK:
        raise refuse(label, f"has a chunk of {size / 2**20:.0f} MiB, unpacked; up to 256 are read")


def _choose(
    topics: list[Topic], others: list[str], label: str, wishes: Wishes
) -> tuple[Topic, tuple[str, ...]]:
    listed = ", ".join(f"{topic.name} ({topic.kind})" for topic in topics)
    if not topics:
        there = ", ".join(others[:8]) or "no topics"
        raise refuse(label, f"holds no path or pose of ROS 2 (cdr), but {there}")
    if wishes.take:
        named = [topic for topic in topics if topic.name == wishes.take]
        if not named:
            raise refuse(label, f"has no topic {wishes.take!r} with a path; it has {listed}")
        return named[0], ()
    best = min(topics, key=lambda topic: list(KINDS).index(topic.kind))
    same = [topic.name for topic in topics if topic.kind == best.kind and topic.name != best.name]
    said = f"{best.name} is read; {', '.join(same)} hold {best.kind} too (--take TOPIC)"
    return best, (said,) if same else ()


def _found(
    topic: Topic, store: Any, label: str, warnings: tuple[str, ...], wishes: Wishes
) -> Found:
    rows: tuple[tuple[str, str], ...] = (("topic", topic.name), ("message", topic.kind))
    messages = sorted(topic.messages, key=lambda message: message[0])
    if topic.kind == "nav_msgs/msg/Path":
        paths = [store.deserialize_cdr(data, topic.kind).poses for _, data in messages]
        full = [poses for poses in paths if len(poses)]
        if not full:
            raise refuse(label, f"every message of {topic.name} is an empty path")
        if len(full) > 1:
            said = (
                f"{len(full)} messages hold a path; the last one is read ({len(full[-1])} points)"
            )
            warnings = (*warnings, said)
        places = [pose.pose.position for pose in full[-1]]
        points = np.array([(p.x, p.y) for p in places])
        return _finite(Found("MCAP", points, None, rows, warnings=warnings), label)
    pick, speeds = KINDS[topic.kind], []
    points = np.empty((len(messages), 2))
    for n, (_, data) in enumerate(messages):
        message = store.deserialize_cdr(data, topic.kind)
        place = pick(message)
        points[n] = place.x, place.y
        if topic.kind == "nav_msgs/msg/Odometry":
            speeds.append(message.twist.twist.linear.x)
        if n % 1000 == 0:
            wishes.on_progress(n / len(messages))
    given = np.array(speeds) if speeds else None
    name = "twist.twist.linear.x" if speeds else ""
    return _finite(
        Found(
            "MCAP",
            points,
            None,
            rows,
            "m",
            None,
            given,
            name,
            range(len(points)),
            "message",
            warnings,
        ),
        label,
    )


def _finite(found: Found, label: str) -> Found:
    assert found.points is not None
    bad = ~np.isfinite(found.points).all(axis=1)
    if bad.any():
        raise refuse(label, "must be finite", found.where(int(bad.argmax())))
    return found
