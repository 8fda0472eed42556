"""Whether other columns of a table without a header are a path rather than the first two."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from osculate.curve.files.found import Array

Numbers = Sequence[Array | None]  # the columns; None where there is text

FLAT = 1e-9  # of its size: a column that varies less is constant
FEWEST = 6  # points from which steps are compared
EVEN = 0.02  # of their mean: steps that vary less are even,
UNEVEN = 0.05  # and that vary more are not
LAST = 5  # columns that are looked at


def column_of(numbers: Numbers, n: int) -> Array:
    """A column that is known to hold numbers, shape (n,)."""
    column = numbers[n]
    assert column is not None
    return column


def flat(column: Array) -> bool:
    """Whether a column is constant."""
    return bool(np.ptp(column) <= FLAT * max(1.0, float(np.abs(column).max())))


def say(x: int, y: int) -> str:
    """What to say for these columns."""
    return f"say --columns {x + 1},{y + 1}"


def heading_fits(numbers: Numbers, able: Sequence[int], x: Array, y: Array) -> bool:
    """Whether some column after the first two is the direction of the steps (rad or degrees)."""
    direction = np.arctan2(np.diff(y), np.diff(x))
    for n in able[2:]:
        for unit in (1.0, np.pi / 180.0):
            heading = column_of(numbers, n) * unit
            if flat(heading):
                continue
            middle = 0.5 * (np.unwrap(heading)[1:] + np.unwrap(heading)[:-1])
            for given in (middle, heading[:-1], heading[1:]):
                apart = np.abs(np.angle(np.exp(1j * (given - direction))))
                if np.median(apart) < 0.03 and np.percentile(apart, 90) < 0.15:
                    return True
    return False


def better_pair(numbers: Numbers, able: Sequence[int]) -> str:
    """Two columns behind the first whose steps fit a path while those of the first two do not."""
    if _trusted(numbers, able):
        return ""
    first = able[0]
    own = _spread(_chords(numbers, able[0], able[1]))
    for x, y in _pairs(numbers, able):
        chords = _chords(numbers, x, y)
        if _speed_fits(column_of(numbers, first), chords):
            return f"column {first + 1} is the speed along columns {x + 1} and {y + 1}; {say(x, y)}"
        if own > UNEVEN and _spread(chords) < EVEN:
            return (
                f"the points of columns {x + 1} and {y + 1} are evenly spaced, those of columns "
                f"{first + 1} and {able[1] + 1} are not; {say(x, y)}, "
                f"or {say(first, able[1])} if they are x and y"
            )
    return ""


def pair_doubt(numbers: Numbers, able: Sequence[int]) -> str:
    """Why the second and third column may be x and y, though the first two may be as well."""
    if _trusted(numbers, able):
        return ""
    first, second = able[:2]
    own, sharp = _spread(_chords(numbers, first, second)), _turning(numbers, first, second)
    grid = _spread(np.diff(column_of(numbers, second))) < EVEN
    for x, y in _pairs(numbers, able):
        if x != second and _extent(numbers, x, y) < np.ptp(column_of(numbers, first)):
            continue  # widths beside a track
        other = _turning(numbers, x, y)
        rougher = sharp[0] > max(0.2, 2.0 * other[0]) or sharp[1] > max(2.0, 2.0 * other[1])
        evener = _spread(_chords(numbers, x, y)) < 0.5 * own
        if rougher or evener or (grid and x == second):
            return f"columns {x + 1} and {y + 1} may be x and y as well; if they are, {say(x, y)}"
    return ""


def _trusted(numbers: Numbers, able: Sequence[int]) -> bool:
    """Whether nothing speaks against the first two: too few points, or a heading or speed fits them."""
    x, y = (column_of(numbers, n) for n in able[:2])
    if len(x) < FEWEST or flat(x) or flat(y) or heading_fits(numbers, able, x, y):
        return True
    chords = _chords(numbers, able[0], able[1])
    return any(_speed_fits(column_of(numbers, n), chords) for n in able[2:])


def _pairs(numbers: Numbers, able: Sequence[int]) -> list[tuple[int, int]]:
    """Neighbouring columns behind the first that may be x and y: none constant, y no time or count."""
    return [
        (x, y)
        for x, y in pairwise(able[1:LAST])
        if not flat(column_of(numbers, x))
        and not flat(column_of(numbers, y))
        and _spread(np.diff(column_of(numbers, y))) > EVEN
    ]


def _chords(numbers: Numbers, x: int, y: int) -> Array:
    return np.hypot(np.diff(column_of(numbers, x)), np.diff(column_of(numbers, y)))


def _extent(numbers: Numbers, x: int, y: int) -> float:
    return float(min(np.ptp(column_of(numbers, x)), np.ptp(column_of(numbers, y))))


def _spread(steps: Array) -> float:
    """Standard deviation of steps, relative to their mean; of steps to and fro it is large."""
    return float(steps.std() / max(abs(float(steps.mean())), 1e-300))


def _turning(numbers: Numbers, x: int, y: int) -> tuple[float, float]:
    """Angles (rad) between steps that nine in ten, and that all do not exceed."""
    step = np.diff(column_of(numbers, x)) + 1j * np.diff(column_of(numbers, y))
    turn = np.abs(np.angle(step[1:] * step[:-1].conj()))
    return float(np.percentile(turn, 90)), float(turn.max())


def _speed_fits(column: Array, chords: Array) -> bool:
    """Whether a column that varies is proportional to the steps: a speed at even times."""
    if column.min() < 0.0 or _spread(column) < UNEVEN:
        return False
    for speed in (0.5 * (column[1:] + column[:-1]), column[:-1], column[1:]):
        moving = speed > 0.05 * speed.max()
        if moving.mean() < 0.5:
            continue
        times = chords[moving] / speed[moving]
        apart = np.abs(times / max(float(np.median(times)), 1e-300) - 1.0)
        if np.median(apart) < 0.01 and np.percentile(apart, 90) < 0.05:
            return True
    return False
