"""Clothoids between poses from a library, and whether what it returns is a way from one to the other."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from osculate.curve.spirals import Pose, Segmented
from osculate.errors import InvalidInput, InvalidScenario, MissingExtra, NoSolution

DETOUR = 10.0  # times the distance: a fitted clothoid that is longer goes round in circles


@contextmanager
def fitting(start: Pose, end: Pose) -> Iterator[None]:
    """Refuse poses at one place, and turn what the library or its results raise into one sentence."""
    distance = float(np.hypot(end.x - start.x, end.y - start.y))
    if not distance > 1e-9 * max(1.0, abs(start.x), abs(start.y)):
        raise InvalidInput(
            "end", f"({end.x:g}, {end.y:g})", "must be another place than the start: no clothoid "
            "turns on the spot",
        )  # fmt: skip
    try:
        yield
    except (RuntimeError, InvalidInput, InvalidScenario) as error:
        raise NoSolution(f"no clothoid leads {_between(start, end)} ({error})") from None


def require_arrival(found: Segmented, start: Pose, end: Pose) -> None:
    """Check what a library returned: it must end at the end, and not by a large detour."""
    distance = float(np.hypot(end.x - start.x, end.y - start.y))
    last = found.at(found.length) if found.length <= DETOUR * distance else None
    if last is None:
        raise NoSolution(
            f"no sensible clothoid leads {_between(start, end)}: the one found is {found.length:.4g} m "
            f"long for a distance of {distance:.4g} m; put a pose between"
        )
    miss = float(np.hypot(last.x - end.x, last.y - end.y))
    turned = abs(np.angle(np.exp(1j * (float(last.heading) - end.heading))))
    if not (miss <= 1e-6 * distance and turned <= 1e-6):
        raise NoSolution(
            f"no clothoid leads {_between(start, end)}: the one found misses the end by {miss:.4g} m and "
            f"is turned by {np.degrees(turned):.4g}° from it"
        )


def _between(start: Pose, end: Pose) -> str:
    first, last = (f"({p.x:g}, {p.y:g}, {p.heading:.4g} rad)" for p in (start, end))
    return f"from {first} to {last}"


def pyclothoids() -> Any:
    """The library.

    Raises:
        MissingExtra: It is not installed.
    """
    try:
        import pyclothoids as library
    except ImportError:
        raise MissingExtra("clothoids", "pyclothoids") from None
    return library
