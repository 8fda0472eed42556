"""Open or closed, and why; laps that run on past their start."""

from typing import Any, NamedTuple

import numpy as np

from osculate.curve.files.found import Array

GAP = 1.5  # median steps: ends further apart are no loop
TURN = 3.0  # median changes of heading: a join that turns further is no loop
LEAST_TURN = 0.1  # rad, of a join: where a loop is mostly straight the median says nothing
SAME = 0.01  # median steps: ends nearer than this are one point, written twice
FEW = 8  # points: fewer are a loop only if the first one is repeated at the end
BESIDE = 0.5  # median steps: a lap that runs on past its start is no further from its beginning
CLOSE = 0.25  # median steps: a last point nearer to the first one than this is left out


class Closure(NamedTuple):
    """Whether a list of points is a loop."""

    closed: bool
    why: str
    kept: int  # how many points from the first one on belong to it
    warnings: tuple[str, ...] = ()


class _Ring(NamedTuple):
    """Points as they would be a ring."""

    points: Array  # m, shape (n, 2)
    step: float  # m, median
    gap: float  # m, from the last point to the first
    same: bool  # the last point repeats the first one
    turn: float  # rad, usual change of heading
    join: float  # rad, largest change of heading at the join

    @property
    def smooth(self) -> bool:
        """Whether the heading turns at the join as it does elsewhere."""
        return self.join <= max(TURN * self.turn, LEAST_TURN)


def closure(points: Array, wish: bool | None) -> Closure:
    """Whether points are a loop: the user's word, else the gap and the heading at the join.

    Args:
        points: Shape (n, 2); points that stand still may be among them.
        wish: What the user said, or None.
    """
    count = len(points)
    moving = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 0.0])
    where = np.flatnonzero(moving)
    if wish is False:
        return Closure(False, "as told (--no-loop)", count)
    if len(where) < 3:
        why = "as told (--loop)" if wish else "it has fewer than three places"
        return Closure(bool(wish), why, count)
    ring = _ring(points[where])
    last = int(where[-1])
    kept = last if ring.same else count
    steps = f"{ring.gap:.3g} m apart ({ring.gap / ring.step:.2g} steps)"
    join, usual = np.degrees((ring.join, ring.turn))
    turns = f"the heading turns by {join:.3g}° there ({usual:.3g}° is usual)"
    near = ring.same or (len(where) >= FEW and ring.gap <= GAP * ring.step)
    if near and ring.smooth:
        return Closure(True, f"its ends are {steps} and {turns}", kept)
    overrun = _overrun(points[where], ring)
    if overrun:
        return _cut(overrun, where, count, wish)
    if wish:
        return Closure(True, f"as told (--loop); its ends are {steps}", kept)
    if near:
        return Closure(False, f"its ends are {steps}, but {turns}; --loop closes it", count)
    return Closure(False, f"its ends are {steps}", count)


def _ring(points: Array) -> _Ring:
    steps = np.hypot(*np.diff(points, axis=0).T)
    step = float(np.median(steps))
    gap = float(np.hypot(*(points[-1] - points[0])))
    same = len(points) > 3 and gap <= SAME * step
    ring = points[:-1] if same else points
    around = np.concatenate([ring, ring[:2]])
    turns = np.abs(_turns(around))  # of each point from the second one, over the join to the first
    inner, join = turns[: len(ring) - 2], turns[len(ring) - 2 :]
    usual = float(np.median(inner)) if len(inner) else 0.0
    return _Ring(points, step, gap, same, usual, float(join.max()))


def _turns(points: Array) -> Array:
    """Changes of heading (rad, within ±π), shape (n − 2,)."""
    dx, dy = np.diff(points, axis=0).T
    heading = np.arctan2(dy, dx)
    turns: Array = (np.diff(heading) + np.pi) % (2.0 * np.pi) - np.pi
    return turns


class _Overrun(NamedTuple):
    last: int  # point before the start is passed again
    beyond: float  # m, from there to the end
    before: float  # m, from the start to there
    follows: bool  # what comes after lies on the beginning


def _overrun(points: Array, ring: _Ring) -> _Overrun | None:
    """Where the points pass the first one again, in its direction."""
    if len(points) < FEW:
        return None
    step = np.diff(points, axis=0)
    length = np.hypot(*step.T)
    arc = np.concatenate([[0.0], np.cumsum(length)])
    share = np.clip(((points[0] - points[:-1]) * step).sum(axis=1) / length**2, 0.0, 1.0)
    apart = np.hypot(*(points[:-1] + share[:, None] * step - points[0]).T)
    heading = np.arctan2(step[:, 1], step[:, 0])
    turned = np.abs((heading - heading[0] + np.pi) % (2.0 * np.pi) - np.pi)
    allowed = max(TURN * ring.turn, LEAST_TURN)
    near = (apart <= BESIDE * ring.step) & (turned <= allowed) & (arc[:-1] > 4.0 * ring.step)
    if not near.any():
        return None
    first = int(near.argmax())
    behind = np.flatnonzero(~near[first:])
    run = near[first : first + int(behind[0])] if len(behind) else near[first:]
    at = first + int(apart[first : first + len(run)].argmin())
    foot = float(arc[at] + share[at] * length[at])
    beyond = float(arc[-1]) - foot
    if np.hypot(*(points[at] - points[0])) < CLOSE * ring.step:
        at -= 1
    follows = 0.0 < beyond < 0.5 * foot and _on_beginning(points, at, arc, beyond, ring)
    return _Overrun(at, beyond, foot, follows)


def _on_beginning(points: Array, at: int, arc: Array, beyond: float, ring: _Ring) -> bool:
    from scipy.spatial import KDTree

    reach = int(np.searchsorted(arc, beyond + 2.0 * ring.step)) + 2
    begin, tail = points[:reach], points[at + 1 :]
    dense = np.concatenate(
        [begin[:-1] + t * np.diff(begin, axis=0) for t in np.linspace(0.0, 1.0, 17)]
    )
    apart: Array = np.asarray(KDTree(dense).query(tail)[0])
    return bool(apart.max() <= (BESIDE + 1.0 / 16.0) * ring.step)


def _cut(overrun: _Overrun, where: Any, count: int, wish: bool | None) -> Closure:
    if not overrun.follows:
        if wish:
            return Closure(True, "as told (--loop)", count)
        why = (
            f"it passes its start after {overrun.before:.4g} m, but goes on for {overrun.beyond:.4g} m "
            "(several laps?); keep one lap, or --loop closes it"
        )
        return Closure(False, why, count)
    last = int(where[overrun.last])
    why = f"its end runs {overrun.beyond:.3g} m past its start"
    said = (
        f"{count - last - 1} points at the end, {overrun.beyond:.3g} m past the start, are left out"
    )
    return Closure(True, why, last + 1, (said,))
