"""JSON and YAML as plain data, strictly: no number that programs read differently, everything bounded.

YAML's plain scalars become a float only if they are a decimal number; ``010``, ``1:30``, ``0x1F``,
``1_000`` and ``yes`` stay text, which is no coordinate. Keys stay text. libyaml's parser is used where
it is there.
"""

import json
import re
from collections.abc import Callable, Iterator
from typing import Any

from osculate.curve.files.found import refuse
from osculate.curve.files.numbers import strict

DEEPEST = 40  # nested mappings and lists
EXPANDED = 20_000_000  # values, aliases written out
_NOTHING = ("", "~", "null", "Null", "NULL")
_NUMBERS = ("tag:yaml.org,2002:float", "tag:yaml.org,2002:int")
_ELSEWHERE = re.compile(
    r"[+-]?(0[0-7_]+|[1-9][0-9_]*(:[0-5]?\d)+(\.\d*)?|0[xb][\da-fA-F_]+|\d+_[\d_]*)"
)
_EVERY = 20_000  # events between two reports of progress


def load_json(text: str, label: str) -> list[Any]:
    """The documents in a JSON text; there may be several, one after the other (JSON lines).

    Raises:
        InvalidInput: Not JSON, a key twice, NaN, nested too deeply; says in which line.
    """
    decoder = json.JSONDecoder(object_pairs_hook=_pairs, parse_constant=_constant)
    documents, at = [], 0
    try:
        while at < len(text):
            if text[at].isspace():
                at += 1
                continue
            document, at = decoder.raw_decode(text, at)
            documents.append(document)
    except json.JSONDecodeError as error:
        raise refuse(label, f"is not valid JSON: {error.msg}", f"line {error.lineno}") from None
    except RecursionError:
        raise refuse(label, f"is nested more than {DEEPEST} deep") from None
    except ValueError as error:  # of the hooks, and of whole numbers with thousands of digits
        raise refuse(label, f"is not valid JSON: {error}") from None
    _check_depth(documents, label)
    return documents


def _pairs(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) != len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"the key {twice!r} is there twice in one mapping")
    return mapping


def _constant(name: str) -> float:
    raise ValueError(f"{name} is no number, must be finite")


def _check_depth(data: list[Any], label: str) -> None:
    level: list[Any] = data
    for _ in range(DEEPEST):
        level = [
            child
            for node in level
            if isinstance(node, (dict, list))
            for child in (node.values() if isinstance(node, dict) else node)
            if isinstance(child, (dict, list))
        ]
        if not level:
            return
    raise refuse(label, f"is nested more than {DEEPEST} deep")


def load_yaml(
    text: str, label: str, on_progress: Callable[[float], None], *, decimal: bool = False
) -> list[Any]:
    """The documents in a YAML text that are not empty.

    Args:
        text: YAML 1.1.
        label: The file, for messages.
        on_progress: Told the fraction done.
        decimal: Refuse ``010``, ``1:30``, ``0x1F`` and ``1_000`` wherever they stand without quotes.

    Raises:
        InvalidInput: Not YAML, a key twice, an alias to what is not there yet, too deep or too large
            when aliases are written out; says in which line.
    """
    import yaml

    loader: Any = getattr(yaml, "CLoader", yaml.Loader)
    try:
        return _Builder(label, max(len(text), 1), on_progress, decimal).build(
            yaml.parse(text, Loader=loader)
        )
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f"line {mark.line + 1}" if mark else ""
        raise refuse(label, f"is not valid YAML: {error.problem or error.context}", where) from None
    except yaml.YAMLError as error:
        raise refuse(label, f"is not valid YAML: {error}") from None


class _Builder:
    """Plain data from YAML's events: one list of open mappings and lists, no recursion."""

    def __init__(
        self, label: str, size: int, on_progress: Callable[[float], None], decimal: bool
    ) -> None:
        self.decimal = decimal
        self.label, self.size, self.on_progress = label, size, on_progress
        self.open: list[Any] = []  # mappings and lists that are not finished
        self.keys: list[str | None] = []  # the key that waits for its value, in each of them
        self.counts: list[int] = []  # values in each, aliases written out
        self.names: list[str | None] = []  # the anchor of each
        self.anchors: dict[str | None, tuple[Any, int]] = {}
        self.documents: list[Any] = []

    def build(self, events: Iterator[Any]) -> list[Any]:
        """All documents."""
        handlers: dict[str, Callable[[Any], None]] = {
            "ScalarEvent": self._scalar,
            "MappingStartEvent": lambda event: self._start({}, event),
            "SequenceStartEvent": lambda event: self._start([], event),
            "MappingEndEvent": self._end,
            "SequenceEndEvent": self._end,
            "AliasEvent": self._alias,
            "DocumentStartEvent": lambda event: self.anchors.clear(),
        }
        for n, event in enumerate(events):
            handler = handlers.get(event.__class__.__name__)
            if handler:
                handler(event)
            if n % _EVERY == 0:
                self.on_progress(event.start_mark.index / self.size)
        return [document for document in self.documents if document is not None]

    def _error(self, event: Any, message: str) -> Exception:
        return refuse(self.label, message, f"line {event.start_mark.line + 1}")

    def _scalar(self, event: Any) -> None:
        value: Any = event.value
        parent: Any = self.open[-1] if self.open else None
        mapping = isinstance(parent, dict)
        if mapping and self.keys[-1] is None:
            if value in parent or value == "<<":
                raise self._wrong_key(event)
            self.keys[-1] = value
            return
        if event.implicit[0] or event.tag in _NUMBERS:
            value = None if value in _NOTHING else strict(value)
            if self.decimal and isinstance(value, str) and _ELSEWHERE.fullmatch(value):
                raise self._error(
                    event, f"{value} is not the same number everywhere; write it plainly"
                )
        if event.anchor or parent is None:
            self.anchors[event.anchor] = (value, 1)
            self._put(value, 1, event)
        elif mapping:
            parent[self.keys[-1]] = value
            self.keys[-1] = None
            self.counts[-1] += 1
        else:
            parent.append(value)
            self.counts[-1] += 1

    def _wrong_key(self, event: Any) -> Exception:
        if event.value == "<<":
            return self._error(event, "merged mappings (<<) are not read; write the fields out")
        return self._error(event, f"the key {event.value!r} is there twice in one mapping")

    def _start(self, container: Any, event: Any) -> None:
        if self.open and self.keys[-1] is None and isinstance(self.open[-1], dict):
            raise self._error(event, "a key must be a text, not a list or a mapping")
        if len(self.open) >= DEEPEST:
            raise self._error(event, f"is nested more than {DEEPEST} deep")
        self.open.append(container)
        self.keys.append(None)
        self.counts.append(1)
        self.names.append(event.anchor)

    def _end(self, event: Any) -> None:
        container, count, name = self.open.pop(), self.counts.pop(), self.names.pop()
        self.keys.pop()
        if name:
            self.anchors[name] = (container, count)
        self._put(container, count, event)

    def _alias(self, event: Any) -> None:
        if event.anchor not in self.anchors:
            raise self._error(event, f"the alias *{event.anchor} has no finished anchor before it")
        if self.open and self.keys[-1] is None and isinstance(self.open[-1], dict):
            raise self._error(event, "a key must be a text, not an alias")
        self._put(*self.anchors[event.anchor], event)

    def _put(self, value: Any, count: int, event: Any) -> None:
        if not self.open:
            self.documents.append(value)
            return
        self.counts[-1] += count
        if self.counts[-1] > EXPANDED:
            raise self._error(event, "its aliases written out are too large")
        if isinstance(self.open[-1], list):
            self.open[-1].append(value)
        else:
            self.open[-1][self.keys[-1]] = value
            self.keys[-1] = None
