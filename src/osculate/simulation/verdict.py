"""The verdict on a run: what happened first, in one word and one sentence.

| kind | what happened | exit code |
|---|---|---|
| reached | the robot is at the end of the path | 0 |
| infeasible | there is no such run: the plan says that the robot cannot | 2 |
| hit | its footprint touched an obstacle | 10 |
| left | O was as far off as the corridor is wide, or it spun, tipped over or ran past the end | 11 |
| stopped | the safety layer stopped it | 12 |
| diverged | its next state is not finite, or beyond all speeds | 13 |
| late | its time was over before it was there | 14 |
| reversed | it went 0.1 m backwards along the path, and had not slid | 15 |

Of several things the first in time counts; at one instant a hit comes before leaving, leaving before going
backwards, and all of them before the way in which the run ended. The sentence also tells that. A run that
diverges leaves its path or turns back on the way: that is told, but the verdict is that it diverged, unless
it slid there.

A path tracker has reached the end of an open curve within 20 mm of it along the path, and a closed curve
after its length. A law of the paper has when its timetable is over or its target has come within 20 mm of
the end, whatever its speed, unless the robot is a metre or more short of it.
"""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any, NamedTuple

from osculate.control.reasons import ARRIVED, explain
from osculate.errors import NoSolution
from osculate.simulation.events import BACKWARD, LEFT, OFF_PATH, RECENT, REVERSED, Event
from osculate.simulation.records import DIVERGED, FINISHED, RUNNING, STOPPED

NEAR = 0.02  # m, from the end along the path: there
AT_REST = 1e-3  # m/s
WORTH_SAYING = 1e-3  # m


class VerdictKind(StrEnum):
    """What became of a run."""

    REACHED = "reached"
    HIT = "hit"
    LEFT = "left"
    REVERSED = "reversed"
    STOPPED = "stopped"
    DIVERGED = "diverged"
    LATE = "late"
    INFEASIBLE = "infeasible"


INTERNAL_ERROR, WRONG_INPUT = 1, 2
EXIT_CODES = {
    VerdictKind.REACHED: 0,
    VerdictKind.INFEASIBLE: WRONG_INPUT,
    VerdictKind.HIT: 10,
    VerdictKind.LEFT: 11,
    VerdictKind.STOPPED: 12,
    VerdictKind.DIVERGED: 13,
    VerdictKind.LATE: 14,
    VerdictKind.REVERSED: 15,
}


@dataclass(frozen=True)
class Verdict:
    """What became of a run: what happened first, where and when.

    Attributes:
        kind: In a word.
        sentence: In a sentence without a full stop, with the way in which the run ended.
        place: Arc length of the nearest point of the curve (m); None if there is no run.
        x: Position of O (m), likewise.
        y: Likewise.
        time: When (s), likewise.
        reason: Why, if that is known; empty if not.
        obstacle: Number of the obstacle that was hit, in the order of the scene, from 1.
        penetration: The deepest that the robot went into it (m): how far it would have to be moved, without
            turning, to be free.
    """

    kind: VerdictKind
    sentence: str
    place: float | None = None
    x: float | None = None
    y: float | None = None
    time: float | None = None
    reason: str = ""
    obstacle: int | None = None
    penetration: float | None = None

    @property
    def reached(self) -> bool:
        """Whether all is well."""
        return self.kind is VerdictKind.REACHED

    @property
    def exit_code(self) -> int:
        """Exit code of ``osculate run``."""
        return EXIT_CODES[self.kind]

    def as_dict(self) -> dict[str, Any]:
        """Names to values, for JSON."""
        return {**asdict(self), "kind": str(self.kind)}

    def __str__(self) -> str:
        """Kind and sentence."""
        return f"{self.kind}: {self.sentence}"


class Hit(NamedTuple):
    """The first contact with an obstacle."""

    obstacle: int  # number in the scene, from 1
    kind: str  # of obstacle
    penetration: float  # m
    time: float  # s
    place: float  # m, arc length of the nearest point
    x: float  # m, of O
    y: float  # m


class Outcome(NamedTuple):
    """The numbers from which a verdict follows: floats of one run, or arrays of shape (runs,)."""

    code: Any  # RUNNING (its time was over), FINISHED, DIVERGED or STOPPED
    tipped: Any  # 1 if it ended because the robot fell on its side
    time: Any  # s, at the end; so are all of these
    place: Any  # m, arc length of the nearest point
    arc_length: Any  # m, distance travelled, progress of a target
    x: Any  # m
    y: Any  # m
    speed: Any  # m/s
    cross_track: Any  # m
    intervention: Any  # number of what is intervened, 0 is nothing
    excess: Any  # m, predicted distance beyond the corridor
    cause: Any  # number of what caused it
    stop: Any  # number of the reason of a stop
    slid: Any  # s, when it last slid
    first: Event
    length: Any  # m, of the path
    closed: Any  # 1 for a closed path
    timed: Any  # 1 for a law that follows a target over time
    timetable: Any  # 1 if that is a timetable with an end
    half_width: Any  # m, of the corridor
    given: Any  # 1 if somebody gave that corridor


class _End(NamedTuple):
    """How a run ended."""

    kind: VerdictKind
    sentence: str
    reason: str = ""


def infeasible(error: NoSolution) -> Verdict:
    """The verdict on a run that cannot be."""
    return Verdict(VerdictKind.INFEASIBLE, str(error), reason=str(error))


def judge(o: Outcome, hit: Hit | None = None) -> Verdict:
    """The verdict on one run.

    Args:
        o: How it went and ended.
        hit: The first contact with an obstacle.
    """
    end, event = _ending(o), o.first
    mishap = f"{_mishap(o)} {_where(event)}" if event.kind else ""
    on_the_way = end.kind is VerdictKind.DIVERGED and not event.slid
    if hit is not None and (not mishap or on_the_way or hit.time <= event.time):
        return Verdict(
            VerdictKind.HIT, _then(_contact(hit), hit.time, o, end), hit.place, hit.x, hit.y, hit.time,
            obstacle=hit.obstacle, penetration=hit.penetration,
        )  # fmt: skip
    if mishap and on_the_way:
        sentence = f"{end.sentence}; before that it {mishap}"
        return Verdict(end.kind, sentence, o.place, o.x, o.y, o.time, end.reason)
    if mishap:
        reason = "slid" if event.slid else ""
        kind = VerdictKind.REVERSED if event.kind == REVERSED else VerdictKind.LEFT
        words = f"{mishap}; it then {_contact(hit)}" if hit else mishap
        sentence = _then(words, event.time, o, end)
        return Verdict(kind, sentence, event.place, event.x, event.y, event.time, reason)
    return Verdict(end.kind, end.sentence, o.place, o.x, o.y, o.time, end.reason)


def _contact(hit: Hit) -> str:
    """What was hit, where and how deep."""
    deep = _length(hit.penetration)
    return f"hit obstacle {hit.obstacle} ({hit.kind}) {_where(hit)}, {deep} deep"


def _ending(o: Outcome) -> _End:
    """How the run ended, whatever happened before."""
    slid = bool(o.time - o.slid <= RECENT)
    if o.tipped:
        words = f"tipped over {_where(o)}"
        return _End(
            VerdictKind.LEFT, f"slid and {words}" if slid else words, "slid" if slid else "tipped"
        )
    if o.code == DIVERGED:
        return _diverged(o, slid)
    if o.code == STOPPED:
        why = _intervention(o, o.stop).removeprefix("stopped: ")
        return _End(VerdictKind.STOPPED, f"ended at standstill {_where(o)}: {why}", why)
    if abs(o.cross_track) >= o.half_width:
        off = f"{_length(abs(o.cross_track))} off the path"
        return _End(VerdictKind.LEFT, f"ended {off} {_where(o)}")
    if not o.timed and not o.closed and o.place > o.length + NEAR:
        words = f"ran {_length(o.place - o.length)} past the end of the path at t = {o.time:.3f} s"
        return _End(VerdictKind.LEFT, f"{words}, {_moving(o)}", "ran past the end")
    kind = VerdictKind.REACHED if _has_reached(o) else VerdictKind.LATE
    waits = _intervention(o, o.intervention) if kind is VerdictKind.LATE else ""
    return _End(kind, _arrival(o) + (f": {waits}" if waits else ""), waits)


def _has_reached(o: Outcome) -> bool:
    short = o.length - o.place
    if o.timed:
        return bool((o.code == FINISHED or o.length - o.arc_length <= NEAR) and short < OFF_PATH)
    return bool(short <= NEAR)


def _arrival(o: Outcome) -> str:
    """Where a run is that ended by itself or by its clock."""
    if o.code == RUNNING:
        return f"ended after its duration of {o.time:.3f} s{_off(o, 'the end of the path')}, {_moving(o)}"
    if o.timetable:
        words, end = "completed its timetable", "the end of the path"
    elif abs(o.length - o.place) <= NEAR:
        words, end = "reached the end of the path", "it"
    else:
        words = "drove the length of the path" if o.timed else "came to rest"
        end = "the end of the path"
    return f"{words} at t = {o.time:.3f} s{_off(o, end)}, {_moving(o)}"


def _off(o: Outcome, end: str) -> str:
    """How far from the end along the path, if that is worth a word."""
    short = o.length - o.place
    side = "before" if short > 0.0 else "beyond"
    return f", {_length(abs(short))} {side} {end}" if abs(short) >= WORTH_SAYING else ""


def _diverged(o: Outcome, slid: bool) -> _End:
    reason = "slid" if slid else ""
    words = (
        f"diverged after t = {o.time:.3f} s: the next state is not finite or beyond the speed limit; "
        f"last speed {o.speed:.4g} m/s, cross-track error {o.cross_track:.4g} m"
    )
    return _End(VerdictKind.DIVERGED, words + ("; it slid" if reason else ""), reason)


def _intervention(o: Outcome, number: float) -> str:
    """The reason with a number in words, with what is known of it; empty if there is none."""
    if number in (0.0, ARRIVED):
        return ""
    known = o.intervention == number
    return explain(number, o.excess if known else 0.0, o.cause if known else 0.0)


def _then(words: str, time: float, o: Outcome, end: _End) -> str:
    """An event, and how the run ended after it."""
    return f"{words}; it then {end.sentence}" if time < o.time else words


def _mishap(o: Outcome) -> str:
    """What went wrong first."""
    if o.first.kind == LEFT:
        corridor = f"the corridor of {o.half_width:g} m to each side"
        words = f"left {corridor if o.given else f'the path by {o.half_width:g} m'}"
    else:
        words = f"went {BACKWARD:g} m backwards along the path"
    return f"slid and {words}" if o.first.slid else words


def _where(at: Any) -> str:
    place = f"{at.place:.3f} m on the path"
    return f"at t = {at.time:.3f} s, {place}, at ({at.x:.3f}, {at.y:.3f}) m"


def _moving(o: Outcome) -> str:
    return "at rest" if abs(o.speed) < AT_REST and not o.timed else f"moving at {o.speed:.3f} m/s"


def _length(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1.0 else f"{1e3 * metres:.3g} mm"
