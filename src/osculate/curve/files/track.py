"""From chosen columns to what was found: units, the globe, speeds."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from osculate.curve.files.columns import Columns
from osculate.curve.files.found import Array, Found, refuse
from osculate.curve.files.globe import project


def track(
    columns: Columns,
    values: Mapping[int, Any],
    written: str,
    source: tuple[str, str],
    label: str,
    *,
    names: Sequence[str],
    places: Sequence[int],
    place: str,
    warnings: tuple[str, ...] = (),
    more: tuple[tuple[str, str], ...] = (),
) -> Found:
    """What was found, from the chosen columns.

    Args:
        columns: Which columns, in which units.
        values: Their numbers, each of shape (n,); None where a speed is no number.
        written: The format.
        source: Label and value of the row that says where the points come from.
        label: The file, for messages.
        names: Names of the columns.
        places: Where each point stands.
        place: What `places` counts.
        warnings: What may be wrong.
        more: Further rows.

    Raises:
        InvalidInput: Degrees that are no place on the globe.
    """
    x = columns.factor_x * np.asarray(values[columns.x], dtype=float)
    y = columns.factor_y * np.asarray(values[columns.y], dtype=float)
    units, doubts = columns.units, (*warnings, *columns.warnings)
    rows: tuple[tuple[str, str], ...] = (source, *more)
    if columns.geographic:
        points, origin = project(x, y, lambda n: f"{place} {places[n]}", label)
        units, rows = "degrees, projected to m", (*rows, ("origin", origin))
    else:
        points = np.stack([x, y], axis=1)
    speeds, name = None, ""
    if columns.speed is not None:
        name = names[columns.speed].strip(" \"'")
        given = values[columns.speed]
        if given is None:
            doubts = (*doubts, f"the speeds in {name} are not used: some are no numbers")
        else:
            speeds = columns.speed_factor * np.asarray(given, dtype=float)
    return Found(
        written, points, None, rows, units, None, speeds, name if speeds is not None else "",
        places, place, doubts,
    )  # fmt: skip


def of_points(points: Sequence[Sequence[Any]], label: str, what: str) -> Array:
    """Pairs of numbers as an array of shape (n, 2).

    Raises:
        InvalidInput: One is no pair of numbers; says which.
    """
    from osculate.curve.files.numbers import number

    pairs = np.empty((len(points), 2))
    for n, point in enumerate(points):
        if not isinstance(point, (list, tuple)) or len(point) < 2:
            raise refuse(label, f"must be at least two numbers, is {point!r:.60}", f"{what} {n}")
        for k in (0, 1):
            try:
                pairs[n, k] = number(point[k])
            except ValueError as error:
                raise refuse(label, f"its {'xy'[k]} {error}", f"{what} {n}") from None
    return pairs
