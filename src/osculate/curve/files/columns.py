"""Which columns of a table are x and y: by their names, or without names by what they hold."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from osculate.curve.files import names as nm
from osculate.curve.files.alternatives import (
    better_pair,
    column_of,
    flat,
    heading_fits,
    pair_doubt,
    say,
)
from osculate.curve.files.found import Array, Choice, refuse
from osculate.curve.files.names import Name, parse_name

EPOCH = 1e8  # s; numbers above it that only grow are times
SHOWN = 12  # names in a message


class Columns(NamedTuple):
    """The columns that hold the path; numbers from 0."""

    x: int
    y: int
    factor_x: float = 1.0  # to metres (or degrees)
    factor_y: float = 1.0
    geographic: bool = False  # x is the longitude, y the latitude
    speed: int | None = None
    speed_factor: float = 1.0  # to m/s
    units: str = "m"
    warnings: tuple[str, ...] = ()


def by_name(header: Sequence[str], wish: Choice | None, label: str, scale: float = 1.0) -> Columns:
    """The columns of a table with a header; never falls back to their order.

    Raises:
        InvalidInput: No x and y among the names, several of them, or pixels (lists the names).
    """
    names = [parse_name(raw) for raw in header]
    if wish is not None:
        pairs, geographic = [wished(wish, len(header), label, header)], False
        geographic = pairs[0] in nm.globe(names)
    else:
        pairs, geographic = nm.positions(names), False
        if not pairs:
            pairs, geographic = nm.globe(names), True
    if len(pairs) != 1:
        raise refuse(label, _no_pair(names, pairs))
    x, y = pairs[0]
    speed = nm.speed_of(names)
    speed = None if speed in (x, y) else speed
    if nm.pixels(names, x) and scale == 1.0:
        raise refuse(label, f"{header[x].strip()} counts pixels; give the metres of one as scale")
    units = nm.ANGLES if geographic else nm.LENGTHS
    said = sorted({names[n].unit for n in (x, y)} - {""})
    return Columns(
        x, y, units.get(names[x].unit, 1.0), units.get(names[y].unit, 1.0), geographic, speed,
        nm.SPEEDS.get(names[speed].unit, 1.0) if speed is not None else 1.0,
        " and ".join(said) if said else "degrees" if geographic else "m (the names give none)",
        _unit_warnings(names, (x, y), geographic),
    )  # fmt: skip


def _unit_warnings(
    names: Sequence[Name], pair: tuple[int, int], geographic: bool
) -> tuple[str, ...]:
    known = nm.ANGLES if geographic else nm.LENGTHS
    strange = [names[n].raw.strip() for n in pair if names[n].unit and names[n].unit not in known]
    return (f"the unit of {' and '.join(strange)} is taken as metres",) if strange else ()


def _no_pair(names: Sequence[Name], pairs: Sequence[tuple[int, int]]) -> str:
    listed = ", ".join(n.raw.strip(" \"'#%") or "(empty)" for n in names[:SHOWN])
    if len(names) > SHOWN:
        listed += f" and {len(names) - SHOWN} more"
    if pairs:
        offers = " or ".join(f"--columns {x + 1},{y + 1}" for x, y in pairs[:4])
        return f"several columns may be x and y among {listed}; say {offers}"
    there = {axis.axis: n + 1 for n, axis in enumerate(map(nm.axis_of, names)) if axis}
    if len(there) == 1:
        found, n = there.popitem()
        missing, offer = ("y", f"{n},{n + 1}") if found == "x" else ("x", f"{max(n - 1, 1)},{n}")
        return f"{found} is there, {missing} is not, among {listed}; say which, such as --columns {offer}"
    return f"the header names {listed} and no x and y; if it is a path, say which, such as --columns 1,2"


def wished(
    wish: Choice, count: int, label: str, header: Sequence[str] | None = None
) -> tuple[int, int]:
    """The columns the user named or counted, from 0.

    Raises:
        InvalidInput: No such column, or the same twice.
    """
    bare = [raw.strip(" \"'#%\t") for raw in header or ()]
    found = []
    for entry in wish:
        if isinstance(entry, str) and entry in bare:
            found.append(bare.index(entry))
        elif isinstance(entry, int) and 1 <= entry <= count:
            found.append(entry - 1)
        else:
            valid = f"1 to {count}" + (
                f", or a name among {', '.join(bare[:SHOWN])}" if bare else ""
            )
            raise refuse(label, f"has no column {entry!r}; --columns takes {valid}")
    if found[0] == found[1]:
        raise refuse(label, f"--columns {wish[0]},{wish[1]} is the same column twice")
    return found[0], found[1]


def by_content(numbers: Sequence[Array | None], label: str) -> Columns:
    """The columns of a table without a header: the first two of numbers, unless they look wrong.

    Args:
        numbers: The columns, each of shape (n,), or None where it holds text.
        label: The file, for messages.

    Raises:
        InvalidInput: Fewer than two columns of numbers, the first one counts, is a time or is constant,
            or others fit a path better.
    """
    able = [n for n, column in enumerate(numbers) if column is not None]
    if len(able) < 2:
        raise refuse(label, "has no two columns of numbers: it is no path")
    x, y = able[0], able[1]
    if len(able) == 2 or len(column_of(numbers, x)) < 3:
        if _is_time(column_of(numbers, x)) and len(able) == 2:
            raise refuse(
                label, f"column {x + 1} looks like a time, and there is one other: no path"
            )
        counts = len(column_of(numbers, y)) > 2 and _counts(column_of(numbers, y))
        said = (f"column {y + 1}, which is taken as y, counts; is it one?",) if counts else ()
        return Columns(x, y, units="m (no header)", warnings=said)
    for looks in (_matrices, _quaternion, _parameter, _constant, better_pair):
        problem = looks(numbers, able)
        if problem:
            raise refuse(label, problem)
    return Columns(x, y, units="m (no header)", warnings=_doubts(numbers, able))


def _is_time(column: Array) -> bool:
    steps = np.diff(column)
    return bool(len(column) > 2 and column[0] > EPOCH and (steps >= 0).all() and steps.any())


def _nanoseconds(column: Array) -> bool:
    """Whether a column may be the part of a time below a second."""
    whole = bool((column == np.floor(column)).all())
    return whole and column.min() >= 0.0 and 1e6 < column.max() < 1e9


def _counts(column: Array) -> bool:
    return bool((np.diff(column) == 1.0).all() and column[0] in (0.0, 1.0))


def _quaternion(numbers: Sequence[Array | None], able: Sequence[int]) -> str:
    """Four columns side by side of length 1 are an orientation; the position is before it."""
    for n in range(len(able) - 3):
        four = [column_of(numbers, able[n + k]) for k in range(4)]
        norm = np.sqrt(sum(c * c for c in four))
        if np.abs(norm - 1.0).max() < 2e-3 and max(np.abs(c).max() for c in four) <= 1.002:
            first, last = able[n] + 1, able[n + 3] + 1
            if n < 2:
                return f"columns {first} to {last} look like a quaternion; say which are x and y"
            x, y = (able[n - 3], able[n - 2]) if n > 2 else (able[0], able[1])
            if (x, y) != (able[0], able[1]):
                return (
                    f"columns {first} to {last} look like a quaternion behind x, y, z; {say(x, y)}"
                )
            return ""
    return ""


def _matrices(numbers: Sequence[Array | None], able: Sequence[int]) -> str:
    """Twelve columns may be poses as the rows of 3 × 4 matrices (KITTI)."""
    if len(able) != 12:
        return ""
    table = np.stack([column_of(numbers, n) for n in able], axis=1).reshape(-1, 3, 4)
    turned = table[:, :, :3]
    error = np.abs(turned @ np.swapaxes(turned, 1, 2) - np.eye(3)).max()
    if error > 1e-2:
        return ""
    across = 7 if np.ptp(table[:, 1, 3]) >= np.ptp(table[:, 2, 3]) else 11
    return f"the rows look like 3 × 4 pose matrices (KITTI); {say(3, across)}"


def _parameter(numbers: Sequence[Array | None], able: Sequence[int]) -> str:
    """A first column that counts, is a time, or is the length of the way along the next two."""
    first, x, y = able[0], able[1], able[2]
    t, a, b = (column_of(numbers, n) for n in (first, x, y))
    if flat(a) and flat(b):
        return ""
    if _is_time(t):
        rest = able[2:4] if len(able) > 3 and _nanoseconds(a) else (x, y)
        return f"column {first + 1} looks like a time; {say(*rest)}"
    if _is_time(a):
        return f"column {x + 1} looks like a time; {say(first, y)}"
    if heading_fits(numbers, able, t, a):
        return ""
    if _counts(t) and not flat(a) and not flat(b):
        return f"column {first + 1} counts {t[0]:g}, {t[1]:g}, {t[2]:g}, …; {say(x, y)}"
    step, chord = np.diff(t), np.hypot(np.diff(a), np.diff(b))
    along = bool((step > 0).all() and np.abs(chord - step).max() <= 0.02 * step.mean())
    if along and not flat(a) and not flat(b):
        return f"column {first + 1} is the length of the way along the next two; {say(x, y)}"
    if not (flat(t) or flat(a) or flat(b)) and heading_fits(numbers, (x, y, first), a, b):
        return f"column {first + 1} is the heading of the way along the next two; {say(x, y)}"
    return ""


def _constant(numbers: Sequence[Array | None], able: Sequence[int]) -> str:
    first, second, third = (column_of(numbers, n) for n in able[:3])
    if flat(third) or (flat(first) and flat(second)):
        return ""
    if flat(second):
        return (
            f"column {able[1] + 1} is {second[0]:g} everywhere; if it is the height, "
            f"{say(able[0], able[2])}, else {say(able[0], able[1])}"
        )
    if flat(first):
        return (
            f"column {able[0] + 1} is {first[0]:g} everywhere; {say(able[1], able[2])}, "
            f"or {say(able[0], able[1])} if it is x"
        )
    return ""


def _doubts(numbers: Sequence[Array | None], able: Sequence[int]) -> tuple[str, ...]:
    """What is taken as x although it may be a time."""
    t, a, b = (column_of(numbers, n) for n in able[:3])
    x, y = able[1], able[2]
    if _counts(t) and not (flat(a) and flat(b)):
        return (f"column {able[0] + 1}, which is taken as x, counts; if it does, {say(x, y)}",)
    if _counts(a):
        return (f"column {x + 1}, which is taken as y, counts; is it one?",)
    if (np.diff(t) <= 0).any() or flat(a) or flat(b) or heading_fits(numbers, able, t, a):
        doubt = pair_doubt(numbers, able)
        return (doubt,) if doubt else ()
    return (
        f"column {able[0] + 1}, which is taken as x, grows all the way; if it is a time, {say(x, y)}",
    )


def as_column(convert: Callable[[object], float], cells: Sequence[object]) -> Array | None:
    """The numbers of a column, or None if any cell is something else."""
    try:
        return np.array([convert(cell) for cell in cells])
    except (ValueError, TypeError):
        return None
