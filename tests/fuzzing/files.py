"""Known paths written in many ways and then damaged: what is read must be right, or refused, or warned of.

An input is made from a seed. A reader of its own (Python's csv, json, yaml and the knowledge of the form)
says what the damaged file still means; an answer without a word that differs from it and from the path
that was written is a silent wrong answer.
"""

import csv
import json
import math
import random
import re
import time
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from osculate.curve.files import read_file
from osculate.errors import OsculateError

SLOW = 5.0  # s
NOISE = "0123456789.,;:-+eE \t\n\"'#%[]{}()&*!|>?@`~^$xyNaninfTrue\0\x85é€𝟙"
Points = list[tuple[float, float]]


class Written(NamedTuple):
    """A file and what it says."""

    text: str
    suffix: str
    points: Points
    meaning: Callable[[str], Points]  # reads a damaged text as its form says; raises if it cannot
    separator: str = "\n"  # around what can be moved, doubled or dropped


class Outcome(NamedTuple):
    """What became of one input."""

    kind: str  # right, refused, warned, wrong, crash, slow
    seed: int
    message: str
    text: str


def path(rng: random.Random) -> Points:
    """A path that is none of the shapes a reader may mistake for a list of numbers."""
    count, turn = rng.randint(9, 40), rng.uniform(-0.25, 0.25)
    x, y, heading = rng.uniform(-20, 20), rng.uniform(-20, 20), rng.uniform(-3, 3)
    step, points = rng.choice([0.05, 0.3, 1.0, 2.5]), []
    for _ in range(count):
        points.append((round(x, 4), round(y, 4)))
        heading += turn + rng.uniform(-0.05, 0.05)
        x, y = x + step * math.cos(heading), y + step * math.sin(heading)
    return points


# tables ----------------------------------------------------------------------------------------


def table(rng: random.Random) -> Written:
    """A table with a header: any delimiter, order, further columns, quotes, comments."""
    points = path(rng)
    names = rng.choice(
        [("x", "y"), ("x_m", "y_m"), ("pos_x", "pos_y"), ("pose.position.x", "pose.position.y"),
         ("Easting", "Northing"), ("X [m]", "Y [m]"), ("tx", "ty"), ("x_ref", "y_ref")]
    )  # fmt: skip
    columns: dict[str, list[str]] = {
        names[0]: [repr(x) for x, _ in points], names[1]: [repr(y) for _, y in points]
    }  # fmt: skip
    more = {
        "time": [f"{1.7e9 + 0.1 * n:.3f}" for n in range(len(points))],
        "index": [str(n) for n in range(len(points))],
        "name": [f"wp{n}" for n in range(len(points))],
        "z": ["0.0"] * len(points),
        "kappa": [f"{rng.uniform(-1, 1):.3f}" for _ in points],
    }
    for name in rng.sample(sorted(more), rng.randint(0, 4)):
        columns[name] = more[name]
    order = rng.sample(sorted(columns), len(columns))
    spaced = any(" " in name for name in order)
    delimiter = rng.choice([",", ";", "\t", "|", ", "] + [" "] * (not spaced))
    quoted = '"' if rng.random() < 0.2 and delimiter != ", " else ""
    mark = "# " if rng.random() < 0.3 and not quoted else ""
    lines = [mark + delimiter.join(f"{quoted}{name}{quoted}" for name in order)]
    lines += [delimiter.join(columns[name][n] for name in order) for n in range(len(points))]
    if rng.random() < 0.3:
        lines.insert(rng.randint(1, len(lines)), "# a comment, after the header")
    end = rng.choice(["\n", "\r\n"])
    places = order.index(names[0]), order.index(names[1])

    def meaning(text: str) -> Points:
        bare = delimiter.strip(" ") or " "
        lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        kept = [line.strip(" ") for line in lines if line.strip() and line[0] not in "#%"]
        if not any(name in line for name in names for line in lines):
            rows = [[c for c in line.split(bare) if not _has_letters(c)] for line in kept]
            return [(float(row[0]), float(row[1])) for row in rows]  # the header is gone
        if any(name in kept[0] for name in names):
            header, kept = (
                [c.strip() for c in next(csv.reader([kept[0]], delimiter=bare))],
                kept[1:],
            )
        else:
            header = [c.strip() for c in lines[0][1:].strip().split(bare)]
        bases = [header[n].split("[")[0].strip() for n in places if n < len(header)]
        if len(header) != len(order) or bases != [name.split("[")[0].strip() for name in names]:
            raise ValueError("another header")
        rows = [next(csv.reader([line], delimiter=bare)) for line in kept]
        if any(len(row) != len(order) for row in rows):
            raise ValueError("another width")
        return [(float(row[places[0]]), float(row[places[1]])) for row in rows]

    return Written(end.join(lines) + end, rng.choice([".csv", ".txt"]), points, meaning)


def _has_letters(cell: str) -> bool:
    return any(c.isalpha() for c in cell)


# documents -------------------------------------------------------------------------------------


def _records(points: Points, form: str) -> Any:
    if form == "pairs":
        return [[x, y] for x, y in points]
    if form == "mappings":
        return {"waypoints": [{"x": x, "y": y} for x, y in points]}
    if form == "keyed pairs":
        return {"name": "route", "points": [[x, y] for x, y in points]}
    if form == "columns":
        return {"X": [x for x, _ in points], "Y": [y for _, y in points], "width": 1.2}
    head = {"stamp": {"sec": 1, "nanosec": 0}, "frame_id": "map"}
    turned = {"x": 0.0, "y": 0.0, "z": 0.6, "w": 0.8}
    poses = [
        {"header": head, "pose": {"position": {"x": x, "y": y, "z": 0.0}, "orientation": turned}}
        for x, y in points
    ]
    if form == "path":
        return {"header": head, "poses": poses}
    return poses


def _meaning(data: Any, form: str) -> Points:
    if form == "columns":
        pairs = list(zip(data["X"], data["Y"], strict=True))
    elif form in ("pairs", "keyed pairs"):
        pairs = [(p[0], p[1]) for p in (data if form == "pairs" else _only_list(data))]
    elif form == "mappings":
        pairs = [(p["x"], p["y"]) for p in _only_list(data)]
    else:
        poses = [p["pose"]["position"] for p in (data["poses"] if form == "path" else data)]
        pairs = [(p["x"], p["y"]) for p in poses]
    pairs = [tuple(map(_yaml_number, pair)) for pair in pairs]
    if any(type(v) not in (int, float) or not math.isfinite(v) for pair in pairs for v in pair):
        raise ValueError("no numbers")
    return [(float(x), float(y)) for x, y in pairs]


def _yaml_number(value: Any) -> Any:
    """``-.5`` and ``1e5`` are numbers in YAML 1.2 and texts in PyYAML."""
    plain = isinstance(value, str) and re.fullmatch(
        r"[+-]?(([1-9]\d*|0)\.?\d*|\.\d+)([eE][+-]?\d+)?", value
    )
    return float(value) if plain and not re.match(r"[+-]?0\d", value) else value


def _only_list(data: dict[str, Any]) -> list[Any]:
    """The list of a mapping, whatever its key has become."""
    (found,) = [value for value in data.values() if isinstance(value, list)]
    return found


FORMS = ("pairs", "mappings", "keyed pairs", "columns", "path", "poses")


def json_document(rng: random.Random) -> Written:
    """JSON: lists, mappings, columns, ROS messages."""
    points, form = path(rng), rng.choice(FORMS)
    text = json.dumps(_records(points, form), indent=rng.choice([None, 1]))

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        if len(dict(pairs)) < len(pairs):
            raise ValueError("a key twice")
        return dict(pairs)

    def meaning(text: str) -> Points:
        decoder, documents = json.JSONDecoder(object_pairs_hook=once), []
        rest = text.strip()
        while rest:
            document, end = decoder.raw_decode(rest)
            documents.append(_meaning(document, form))
            rest = rest[end:].strip()
        return documents[-1]

    return Written(text, ".json", points, meaning, rng.choice(["\n", ", ", "},"]))


def yaml_document(rng: random.Random) -> Written:
    """YAML: the same, and one ROS message a document."""
    points, form = path(rng), rng.choice((*FORMS, "dump"))
    data = _records(points, "poses" if form == "dump" else form)
    flow = rng.choice([None, False])

    def written(part: Any) -> str:
        text: str = yaml.dump(part, Dumper=_Plain, default_flow_style=flow)
        return text

    text = "---\n".join(written(part) for part in data) if form == "dump" else written(data)

    def meaning(text: str) -> Points:
        documents = [d for d in yaml.load_all(text, Loader=yaml.CSafeLoader) if d is not None]
        return _meaning(documents if form == "dump" else documents[0], form)

    return Written(text, ".yaml", points, meaning)


class _Plain(yaml.SafeDumper):
    """Without anchors."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


KINDS = {"csv": table, "json": json_document, "yaml": yaml_document}


# damage ----------------------------------------------------------------------------------------


def damaged(rng: random.Random, written: Written) -> str:
    """The text with one to three faults in it."""
    text = written.text
    for _ in range(rng.randint(1, 3)):
        lines = text.split(written.separator)
        at, place = rng.randrange(len(lines)), rng.randrange(max(len(text), 1))
        fault = rng.randrange(8)
        if fault == 0:
            text = text[:place] + rng.choice(NOISE) + text[place + 1 :]
        elif fault == 1:
            text = text[:place] + rng.choice(NOISE) + text[place:]
        elif fault == 2:
            text = text[:place] + text[place + rng.randint(1, 4) :]
        elif fault == 3:
            text = text[:place]
        elif fault == 4:
            text = written.separator.join(lines[:at] + lines[at + 1 :])
        elif fault == 5:
            text = written.separator.join([*lines[:at], lines[at], *lines[at:]])
        elif fault == 6:
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
            text = written.separator.join(lines)
        else:
            word = rng.choice(
                ["true", "nan", "010", "1:30", "...", "~", "&a", "*a", "[", "1e999", '""']
            )
            text = text[:place] + word + text[place + rng.randint(0, 3) :]
    return text


def outcome(kind: str, seed: int, folder: Path) -> Outcome:
    """Write the input of a seed, read it, and judge; every fourth input is left whole."""
    rng = random.Random(f"{kind} {seed}")
    written = KINDS[kind](rng)
    whole = seed % 4 == 0
    text = written.text if whole else damaged(rng, written)
    file = folder / f"input{written.suffix}"
    encoding = rng.choice(["utf-8", "utf-8-sig", "utf-16", "utf-8"])
    file.write_bytes(text.encode(encoding, errors="replace"))
    begin = time.monotonic()
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            points = read_file(file).found.points
    except OsculateError as error:
        verdict = "wrong" if whole else "refused"
        return Outcome(verdict, seed, str(error), text)
    except Exception as error:
        return Outcome("crash", seed, f"{type(error).__name__}: {error}", text)
    if time.monotonic() - begin > SLOW:
        return Outcome("slow", seed, "", text)
    if _same(points, written.points):
        return Outcome("right", seed, "", text)
    if said:
        return Outcome("warned", seed, str(said[0].message), text)
    try:
        meant = written.meaning(text)
    except Exception as error:  # the form's own reader gives up in its own ways
        return Outcome("wrong", seed, f"its meaning is lost ({error}), read {points}", text)
    return Outcome("right" if _same(points, meant) else "wrong", seed, f"read {points}", text)


def _same(points: Any, expected: Points) -> bool:
    return points is not None and np.array_equal(points, np.array(expected))


def campaign(kind: str, seeds: range, folder: Path) -> tuple[Counter[str], list[Outcome]]:
    """How often what happened, and everything that must not."""
    outcomes = [outcome(kind, seed, folder) for seed in seeds]
    bad = [o for o in outcomes if o.kind in ("wrong", "crash", "slow")]
    return Counter(o.kind for o in outcomes), bad


# trees -----------------------------------------------------------------------------------------

JUNK = (
    None, True, -1, 0, 1e308, 1e-320, 2.5, "x", "...", "", "n0", [], {}, [[]], [1], [1, 2], [1, 2, 3],
    {"x": 1}, {"x": 1, "y": 2}, 10**30, [None], [{}], {"type": "LineString"},
)  # fmt: skip


def mutated(rng: random.Random, tree: Any) -> Any:
    """A document in which one to three values are replaced by something else, deleted or doubled."""
    tree = json.loads(json.dumps(tree))
    for _ in range(rng.randint(1, 3)):
        places = list(_places(tree))
        if not places:
            return rng.choice(JUNK)
        parent, key = rng.choice(places)
        fate = rng.random()
        if fate < 0.6:
            parent[key] = json.loads(json.dumps(rng.choice(JUNK)))
        elif fate < 0.8:
            del parent[key]
        elif isinstance(parent, list):
            parent.insert(key, parent[key])
        else:
            parent[rng.choice(["x", "edges", "poses", "a"])] = parent[key]
    return tree


def _places(node: Any, depth: int = 12) -> Any:
    items = (
        node.items()
        if isinstance(node, dict)
        else enumerate(node)
        if isinstance(node, list)
        else ()
    )
    for key, value in list(items)[:8] if depth else ():
        yield node, key
        yield from _places(value, depth - 1)


def survives(file: Path) -> bool:
    """Read a file, or be told why not; anything else is an error of the reader's."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            read_file(file)
        except OsculateError:
            return False
    return True
