"""Whether and where runs hit an obstacle: from the record of one run, or from rows as they are made."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from osculate.curve import Curve
from osculate.kernel import names
from osculate.scene import Scene, first_contact
from osculate.simulation.records import Row
from osculate.simulation.verdict import Hit
from osculate.vehicle import Tricycle

Array = NDArray[np.float64]
SEEN = {
    "time": "time", "foot": "foot", "x": "motion.x", "y": "motion.y", "heading": "motion.heading",
}  # fmt: skip


class Placed(Protocol):
    """What is known of a robot and its path: a `Setup`."""

    @property
    def curve(self) -> Curve:
        """The path."""

    @property
    def robot(self) -> Tricycle:
        """The robot."""


def scene_of(given: Placed, driven: Placed, scene: Scene) -> Scene:
    """The scene of a run: walls stand ahead of the curve that was given, not of a way onto it."""
    return scene if driven.curve is given.curve else scene.fixed(_begin(given))


def clearance_of(setup: Placed, scene: Scene, columns: dict[str, Array]) -> Array:
    """Distance from the footprint to the nearest obstacle (m) along a record, shape (n,)."""
    return scene.clearance(
        _begin(setup), setup.robot.footprint.corners, columns["x"], columns["y"], columns["heading"]
    )


def find_hit(
    setup: Placed, scene: Scene, columns: dict[str, Array], clearance: Array
) -> Hit | None:
    """The first contact of a run with an obstacle.

    Args:
        setup: Robot and curve.
        scene: The obstacles.
        columns: Time, foot, x, y and heading, each of shape (n,).
        clearance: At the same samples (m), shape (n,).
    """
    places = (columns[name] for name in ("time", "x", "y", "heading"))
    corners = setup.robot.footprint.corners
    contact = first_contact(scene, _begin(setup), corners, clearance, *places)
    if contact is None:
        return None
    at = (float(columns[name][contact.sample]) for name in ("time", "foot", "x", "y"))
    return Hit(contact.obstacle, contact.kind, contact.penetration, *at)


class HitWatch:
    """Keeps of every row of a block what is near an obstacle, until all rows are made."""

    def __init__(self, setups: list[Any], scenes: list[Scene], row: Row) -> None:
        self._setups, self._scenes = setups, scenes
        leaves = list(names(row))
        self._leaves = [leaves.index(leaf) for leaf in SEEN.values()]
        self._near = [_near(*placed) for placed in zip(setups, scenes, strict=True)]
        self._kept: list[list[Array]] = [[] for _ in setups]
        self._last = np.empty((len(SEEN), len(setups)))

    def see(self, rows: Array) -> None:
        """Look at rows of the record, shape (rows, leaves, lanes); more lanes than setups are ignored.

        The last row that is seen is the one at the last instant, of every run at its own.
        """
        seen = rows[:, self._leaves]
        self._last = seen[-1] if len(seen) else self._last
        for lane, near in enumerate(self._near):
            columns = seen[:, :, lane]
            here = near(columns[:, 2], columns[:, 3])
            if here.any():
                self._kept[lane].append(columns[here])

    def hits(self) -> list[Hit | None]:
        """The first contact of every run."""
        runs = zip(self._setups, self._scenes, self._kept, self._last.T, strict=False)
        return [_hit(*run) for run in runs]


def _hit(setup: Placed, scene: Scene, kept: list[Array], last: Array) -> Hit | None:
    if not kept:
        return None
    rows = np.concatenate([*kept, last[None]])
    alive = rows[:, 0] < last[0]  # a lane goes on standing until all runs of its block have ended
    alive[-1] = True
    columns = dict(zip(SEEN, rows[alive].T, strict=True))
    clearance = clearance_of(setup, scene, columns)
    return find_hit(setup, scene, columns, clearance)


def _near(setup: Placed, scene: Scene) -> Callable[[Array, Array], NDArray[np.bool_]]:
    """Whether a robot at x and y can touch an obstacle at all."""
    reach = float(np.hypot(*np.array(setup.robot.footprint.corners).T).max())
    left, low, right, high = scene.geometry(_begin(setup)).bounds

    def near(x: Array, y: Array) -> NDArray[np.bool_]:
        across = (x >= left - reach) & (x <= right + reach)
        return across & (y >= low - reach) & (y <= high + reach)

    return near


def _begin(setup: Placed) -> tuple[float, float]:
    """Where the path begins (m)."""
    point = setup.curve.at(0.0)
    return float(point.x), float(point.y)
