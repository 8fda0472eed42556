"""The closed loops of a batch: all in the same tables, brought to the same shape, or told apart by part.

The machine code of a batch is compiled for the kernels and the shape of its first run. Parts with other
kernels are refused. Tuples of other lengths (commands on their way, places an estimator remembers, poses on
their way, pushes, patches) are filled up with entries that do nothing, so that a lane keeps the bits of the
single run.
"""

from collections.abc import Iterable
from dataclasses import replace
from functools import reduce
from typing import Any

from osculate.errors import InvalidInput, OsculateError
from osculate.kernel import Nothing, Tables
from osculate.plant import World
from osculate.plant.faults import WELL
from osculate.plant.weather import STILL, Blow, blow_all, impair
from osculate.simulation.loop import Loop, Setup, close_loop
from osculate.spec import Spec

STATE = ("initial", "mind", "thought", "parameters")  # of a loop, what has a shape
IDLE = {Blow: STILL}  # entries that do nothing; of other kinds the last one may be there twice


def close_alike(setups: Iterable[Setup]) -> list[Loop]:
    """Closed loops of one kind and one shape, which share their tables.

    Raises:
        InvalidInput: One that needs other machine code than the first; names the part.
    """
    tables = Tables()
    loops: list[Loop] = []
    for n, setup in enumerate(setups):
        loop = close_loop(setup, tables)
        if loop.decide is not None:
            message = "decides in Python; use simulate, one run at a time"
            raise InvalidInput("controller", setup.controller, message)
        if loops:
            _require_alike(n, loops[0], loop)
        loops.append(loop)
    if any(_calm(loop) != _calm(loops[0]) for loop in loops):
        loops = [_stirred(loop) for loop in loops]
    whole = tables.array
    if len(loops) > 1:
        widest = {name: reduce(_wider, (getattr(k, name) for k in loops)) for name in STATE}
        loops = [
            replace(k, **{name: _filled(getattr(k, name), like) for name, like in widest.items()})
            for k in loops
        ]
    return [replace(loop, tables=whole) for loop in loops]


def _calm(loop: Loop) -> bool:
    """Whether nothing can push the robot."""
    return isinstance(loop.thought, Nothing) or isinstance(loop.thought.blows, Nothing)


def _stirred(loop: Loop) -> Loop:
    """The same for a world in which other robots are pushed, or have actuators that fail."""
    if not _calm(loop):
        return loop
    blows = World(loop.setup.plant).padded_blows
    thought = loop.thought._replace(blows=blows, impairment=WELL)
    return replace(loop, bindings={**loop.bindings, **STIRRED}, thought=thought)


STIRRED = {"blow": blow_all, "impair": impair}


def _kind(loop: Loop) -> Any:
    """What two runs of a batch must have in common."""
    kernels = {name: part for name, part in loop.bindings.items() if name not in STIRRED}
    shaped = [loop.initial, loop.parameters, loop.mind]
    if not isinstance(loop.thought, Nothing):
        shaped += [loop.thought.plant, loop.thought.sensors, loop.thought.control]
    return kernels, [_types(value) for value in shaped]


def _types(value: Any) -> Any:
    """The types in a nested tuple; all entries of a plain tuple are of one type."""
    if not isinstance(value, tuple):
        return float
    entries = value if hasattr(value, "_fields") else value[:1]
    return type(value), *map(_types, entries)


def _require_alike(n: int, first: Loop, loop: Loop) -> None:
    if loop.setup.clock != first.setup.clock:
        clock, field = first.setup.clock, f"clock (run {n})"
        raise InvalidInput(field, loop.setup.clock, f"must be that of run 0, {clock!r}")
    if _kind(loop) == _kind(first):
        return
    name = _culprit(first, loop.setup)
    ours, theirs = (getattr(setup, name) for setup in (first.setup, loop.setup))
    raise InvalidInput(
        f"{name} (run {n})", theirs, f"needs other machine code than that of run 0, {_named(ours)}; "
        "the runs of a batch must have the same kinds of parts: run it in a batch of its own",
    )  # fmt: skip


def _culprit(first: Loop, other: Setup) -> str:
    """The part of another setup that alone makes other machine code of the first one."""
    given = first.setup._asdict()
    differing = [name for name in Setup._fields if getattr(other, name) != given[name]]
    for name in differing:
        try:
            changed = close_loop(first.setup._replace(**{name: getattr(other, name)}))
        except OsculateError:  # it does not fit the other parts
            return name
        if _kind(changed) != _kind(first):
            return name
    return differing[0]


def _named(part: Any) -> str:
    if isinstance(part, Spec) and hasattr(part, "kind"):
        return f"kind {part.kind!r}"
    return repr(part)


def _wider(a: Any, b: Any) -> Any:
    """A nested tuple as wide as the wider of two of one kind, in every part."""
    if type(a) is tuple:
        return a if len(a) >= len(b) else b
    return type(a)(*map(_wider, a, b)) if isinstance(a, tuple) else a


def _filled(value: Any, like: Any) -> Any:
    """A nested tuple, its tuples of entries filled up to the lengths of another's."""
    if type(value) is tuple:
        entry = IDLE.get(type(value[-1]), value[-1])
        return value + (entry,) * (len(like) - len(value))
    return type(value)(*map(_filled, value, like)) if isinstance(value, tuple) else value
