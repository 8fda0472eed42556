"""What in a document may be a path: lists of records, of rows, or columns of numbers."""

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

from osculate.curve.files.found import refuse
from osculate.curve.files.names import FORBIDDEN, PLACE, globe, parse_name, positions

CUT = "..."  # what `ros2 topic echo` prints instead of the rest of a long list
DEEP = 6  # levels of a record
PREFERRED = (
    "path", "poses", "waypoints", "points", "trajectory", "route", "centerline", "center_line",
    "raceline", "coordinates",
)  # fmt: skip
MOTION = frozenset(
    ("orientation", "quaternion", "rotation", "twist", "velocity", "acceleration", "linear", "angular",
     "covariance", "force", "torque", "header", "stamp")
)  # fmt: skip
Path = tuple[str | int, ...]


class Candidate(NamedTuple):
    """Something in a document that may be the path."""

    key: str  # the keys that lead to it, without numbers
    kind: str  # "records", "rows" or "columns"
    data: Any
    empty: bool = False


def candidates(node: Any, key: str, label: str) -> Iterator[Candidate]:
    """Everything in a document that may be a path.

    Args:
        node: Mappings, lists, numbers and texts.
        key: The keys that lead to it.
        label: The file, for messages.

    Raises:
        InvalidInput: A list was cut when it was printed.
    """
    if isinstance(node, Mapping):
        lists = [name for name, value in node.items() if _is_list_of_numbers(value)]
        if _hold_place(tuple(lists)):
            yield Candidate(key, "columns", {name: node[name] for name in lists})
            return
        if _named_records(node):
            yield Candidate(key, "records", list(node.values()))
            return
        for name, value in node.items():
            if MOTION.intersection(parse_name(name).words):
                continue
            yield from candidates(value, f"{key}.{name}" if key else str(name), label)
    elif isinstance(node, list):
        yield from _in_list(node, key, label)


def _named_records(node: Mapping[str, Any]) -> bool:
    """Whether a mapping holds one point a key: ``wp0: {x, y}, wp1: {x, y}``."""
    values = list(node.values())
    if len(values) < 2 or not all(map(is_record, values[:3])):
        return False
    words = [set(parse_name(key).words) for key in node]
    return not any(some & FORBIDDEN or some <= PLACE for some in words)


def _in_list(node: list[Any], key: str, label: str) -> Iterator[Candidate]:
    if CUT in [item for item in node if isinstance(item, str)]:
        raise refuse(
            label, f"the list {key or 'in it'} was cut ({CUT!r}); record it again with "
            "`ros2 topic echo --full-length`",
        )  # fmt: skip
    if not node:
        if key.rpartition(".")[2] in PREFERRED:
            yield Candidate(key, "records", [], empty=True)
    elif is_record(node[0]):
        yield Candidate(key, "records", node)
    elif _is_list_of_numbers(node[0]):
        yield Candidate(key, "rows", node)
    else:
        for item in node:
            if isinstance(item, (Mapping, list)):
                yield from candidates(item, key, label)


def _is_list_of_numbers(value: Any) -> bool:
    return (
        isinstance(value, list) and len(value) > 1 and isinstance(value[0], (int, float, str))
        and any(isinstance(v, (int, float)) and not isinstance(v, bool) for v in value[:3])
    )  # fmt: skip


def is_record(value: Any) -> bool:
    """Whether a mapping has a position in it."""
    if not isinstance(value, Mapping):
        return False
    return _hold_place(tuple(leaves(value)))


@lru_cache(maxsize=1024)
def _hold_place(raw: tuple[str, ...]) -> bool:
    names = [parse_name(name) for name in raw]
    return bool(positions(names) or globe(names))


def leaves(record: Mapping[str, Any], depth: int = DEEP) -> dict[str, Path]:
    """Dotted names of the values in a record and the way to each; ``position: [1, 2]`` is x and y."""
    found: dict[str, Path] = {}
    for key, value in record.items():
        if isinstance(value, Mapping):
            if depth:
                inner = leaves(value, depth - 1)
                found |= {f"{key}.{name}": (key, *way) for name, way in inner.items()}
        elif isinstance(value, list):
            words = parse_name(key).words
            numbers = any(isinstance(v, (int, float)) for v in value)
            if 2 <= len(value) <= 4 and numbers and words and words[-1] in PLACE | {"xy", "xyz"}:
                found |= {f"{key}.{axis}": (key, n) for n, axis in enumerate("xyzw"[: len(value)])}
        else:
            found[key] = (key,)
    return found
