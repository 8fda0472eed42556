"""What the names of columns and fields mean: position, place on the globe, speed, and their units.

A name such as ``/odom.pose.position.x_mm`` has parents (odom, pose, position), words (x) and a unit (mm).
The last part decides, the parents can only forbid: ``orientation.x`` is no position.
"""

import re
from collections.abc import Sequence
from typing import NamedTuple

LENGTHS = {
    "m": 1.0, "meter": 1.0, "meters": 1.0, "metre": 1.0, "metres": 1.0, "mm": 1e-3, "cm": 1e-2,
    "dm": 0.1, "km": 1e3, "um": 1e-6, "µm": 1e-6, "ft": 0.3048, "feet": 0.3048, "inch": 0.0254,
    "millimeters": 1e-3, "millimetres": 1e-3, "centimeters": 1e-2, "centimetres": 1e-2,
}  # fmt: skip
SPEEDS = {
    "mps": 1.0, "m/s": 1.0, "m_s": 1.0, "m_per_s": 1.0, "ms-1": 1.0, "mmps": 1e-3, "mm/s": 1e-3,
    "cmps": 1e-2, "cm/s": 1e-2, "kmh": 1 / 3.6, "km/h": 1 / 3.6, "km_h": 1 / 3.6, "kph": 1 / 3.6,
    "kmph": 1 / 3.6, "mph": 0.44704, "knots": 0.514444,
}  # fmt: skip
ANGLES = {"deg": 1.0, "degree": 1.0, "degrees": 1.0, "°": 1.0, "rad": 57.29577951308232}
OTHERS = {"s", "ms", "us", "ns", "sec", "1/m", "m/s^2", "m/s²", "mps2", "radpm", "-", "1", "rad/s"}
PIXELS = {"px", "pixel", "pixels", "pix"}
MOST = 64  # names that are tried as x or y: more say nothing
UNITS = {*LENGTHS, *SPEEDS, *ANGLES, *OTHERS}

PLACE = {
    "link", "frame", "lane", "road", "line", "gnss", "rtk", "slam", "ekf", "mocap", "vicon", "sim",
    "filtered", "fused", "mean", "mid", "middle", "r", "rs",
    "pos", "position", "positions", "p", "t", "c", "ref", "reference", "center", "centre",
    "centerline", "coord", "coordinate", "coordinates", "map", "utm", "world", "local",
    "global", "odom", "odometry", "path", "point", "points", "waypoint", "waypoints", "wp",
    "pose", "target", "desired", "des", "robot", "vehicle", "car", "ego", "raceline",
    "racetraj", "track", "trajectory", "traj", "translation", "trans", "loc", "location", "act",
    "actual", "meas", "measured", "est", "estimated", "gt", "true", "node", "field", "msg",
    "data", "opt", "smooth", "route", "base", "rear", "axle", "value", "gps", "enu",
}  # fmt: skip
FORBIDDEN = {
    "orientation", "quaternion", "quat", "rotation", "rot", "linear", "angular", "twist",
    "velocity", "vel", "acceleration", "accel", "acc", "force", "torque", "covariance", "cov",
    "std", "sigma", "var", "variance", "error", "err", "normal", "normvec", "tangent",
    "direction", "dir", "size", "offset", "gyro", "imu", "header", "stamp", "left", "right",
    "inner", "outer", "bound", "boundary", "wheel", "color",
}  # fmt: skip
_NEAR = "|".join(sorted(PLACE - {"r", "rs"}, key=len, reverse=True))
_MERGED = re.compile(rf"(?:({_NEAR})([xy])|([xy])(s|{_NEAR}))")
_SPEED_WORDS = {"v", "vx", "speed", "velocity", "vel", "mps", "kmh", "kph"}
_SPEED_MORE = {
    "ref", "reference", "target", "desired", "des", "max", "limit", "profile", "x", "cmd", "long",
    "longitudinal", "forward", "linear", "planned", "opt", "vehicle", "car", "robot", "ego",
}  # fmt: skip
EAST = {"easting": "x", "east": "x", "e": "x", "northing": "y", "north": "y", "n": "y"}
GLOBE = {
    "lat": "lat", "latitude": "lat", "lon": "lon", "lng": "lon", "long": "lon", "longitude": "lon",
}  # fmt: skip


class Name(NamedTuple):
    """A name taken apart."""

    raw: str
    parents: tuple[str, ...]
    words: tuple[str, ...]
    unit: str  # lower case, or empty


class Axis(NamedTuple):
    """A name that says x or y, and what it shares with its partner."""

    axis: str  # "x" or "y"
    family: tuple[object, ...]  # equal for both of a pair
    rank: int  # the smaller, the surer


class Roles(NamedTuple):
    """Which columns are what; numbers from 0."""

    x: int  # or longitude
    y: int  # or latitude
    geographic: bool = False
    speed: int | None = None


def parse_name(raw: str) -> Name:
    """Take a name apart: quotes, comment marks, parents, words, unit."""
    text = raw.strip().strip("\"'`").strip().lstrip("#%").strip()
    unit = ""
    bracket = re.search(r"\s*[\[(<{]\s*(?:in\s+)?([^\])>}]*?)\s*[\])>}]\s*$", text)
    if bracket and bracket.start() and not bracket[1].isdigit():
        unit, text = bracket[1].lower(), text[: bracket.start()]
        unit = "inch" if unit in ("in", '"') else unit
    text = re.sub(r"(?<=[a-z])(?=[XY](?:$|[^a-z]))|(?<=[a-z]{2})(?=[A-Z])", "_", text)
    text = re.sub(r"(?<=\b[xy])(?=[A-Z][a-z])", "_", text)
    parts = [part for part in re.split(r"[./:|]+", text.lower()) if part.strip()]
    words = [w for w in re.split(r"[\s_,-]+", parts[-1]) if w] if parts else []
    for length in (3, 2, 1):
        tail = "_".join(words[-length:])
        if not unit and len(words) > length and (tail in UNITS or tail in PIXELS):
            unit, words = tail, words[:-length]
    if len(words) > 1 and unit and words[-1] == "in":
        words = words[:-1]
    parents = tuple(w for part in parts[:-1] for w in re.split(r"[\s_,-]+", part) if w)
    return Name(raw, parents, tuple(words), unit)


def axis_of(name: Name) -> Axis | None:
    """Whether a name says x or y of a position."""
    if FORBIDDEN & {*name.parents, *name.words}:
        return None
    found = [(n, *_letter(word)) for n, word in enumerate(name.words) if _letter(word)[0]]
    if len(found) != 1:
        return None
    place, axis, rest = found[0]
    others = [word for n, word in enumerate(name.words) if n != place]
    if not PLACE.issuperset(others):
        return None
    plain = not others and not rest
    known = bool(name.parents) and name.parents[-1] in PLACE
    rank = (0 if not name.parents else 1 if known else 2) if plain else 3
    return Axis(axis, (name.parents, place, *others, rest), rank)


def _letter(word: str) -> tuple[str, str]:
    """``x`` or ``y`` and what else is in the word; empty if it is neither."""
    if word in ("x", "y"):
        return word, ""
    if word in EAST:
        return EAST[word], "e" if len(word) == 1 else "east"
    merged = _MERGED.fullmatch(word)
    if not merged:
        return "", ""
    return (merged[2], merged[1]) if merged[2] else (merged[3], f"-{merged[4]}")


def positions(names: Sequence[Name]) -> list[tuple[int, int]]:
    """Pairs (x, y) of the surest kind that is there; more than one means that nobody can tell."""
    axes = [(n, axis) for n, axis in enumerate(map(axis_of, names)) if axis][:MOST]
    pairs = [
        (a.rank, n, m)
        for n, a in axes
        for m, b in axes
        if a.axis == "x" and b.axis == "y" and a.family == b.family
    ]
    best = min((rank for rank, *_ in pairs), default=0)
    chosen = [(n, m) for rank, n, m in pairs if rank == best]
    if len(chosen) > 1:
        chosen = [(n, m) for n, m in chosen if names[n].unit == names[m].unit] or chosen
    if len(chosen) > 1:
        chosen = [(n, m) for n, m in chosen if not pixels(names, n)] or chosen
    return chosen


def pixels(names: Sequence[Name], column: int) -> bool:
    """Whether a column counts pixels."""
    return names[column].unit in PIXELS


def globe(names: Sequence[Name]) -> list[tuple[int, int]]:
    """Pairs (longitude, latitude)."""
    which = {
        axis: [n for n, name in enumerate(names) if axis in {GLOBE.get(w) for w in name.words}][
            :MOST
        ]
        for axis in ("lon", "lat")
    }
    return [
        (n, m)
        for n in which["lon"]
        for m in which["lat"]
        if names[n].parents == names[m].parents and len(names[n].words) == len(names[m].words)
    ]


def speed_of(names: Sequence[Name]) -> int | None:
    """The first column that says how fast."""
    for n, name in enumerate(names):
        words = set(name.words)
        linear = words == {"x"} and name.parents[-1:] == ("linear",)
        if name.unit in SPEEDS and not words:
            return n
        if linear or (words & _SPEED_WORDS and words <= _SPEED_WORDS | _SPEED_MORE):
            return n
    return None
