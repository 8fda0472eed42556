"""How runs went and ended, from what the engine leaves of them."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from osculate.control.pilot import Insight
from osculate.kernel import leaves, rebuild
from osculate.scene import Scene
from osculate.simulation.events import Event, EventParameters
from osculate.simulation.loop import Loop, Setup, corridor_of
from osculate.simulation.records import STOPPED, Progress, Row
from osculate.simulation.verdict import Hit, Outcome, Verdict, judge


def corridor_in(setup: Setup, scene: Scene) -> EventParameters:
    """What counts as leaving the path: the scene's corridor, if no safety layer has a narrower one."""
    events = corridor_of(setup)
    if scene.corridor is None or (setup.safety and setup.safety.half_width <= scene.corridor):
        return events
    return events._replace(half_width=scene.corridor)


def in_corridor(loop: Loop, scene: Scene) -> Loop:
    """The loop with the corridor of a scene."""
    events = corridor_in(loop.setup, scene)
    return replace(loop, parameters=loop.parameters._replace(events=events))


def path_of(loop: Loop, scene: Scene) -> dict[str, float]:
    """What `outcomes` has to know of path, law and corridor."""
    timetable = loop.parameters.deadline < math.inf
    half_width = loop.parameters.events.half_width
    return describe_path(loop.setup, scene, half_width, loop.plan is None, timetable)


def describe_path(
    setup: Setup, scene: Scene, half_width: float, timed: bool = False, timetable: bool = False
) -> dict[str, float]:
    """The fields of an `Outcome` from ``length`` on."""
    return {
        "length": setup.curve.length,
        "closed": float(setup.curve.closed),
        "timed": float(timed),
        "timetable": float(timetable),
        "half_width": half_width,
        "given": float(setup.safety is not None or scene.corridor is not None),
    }


def outcomes(final: Progress, last: Row, **path: Any) -> Outcome:
    """How all runs went and ended; leaves of shape (runs,).

    Args:
        final: The runs at their last instant; leaves of shape (runs,).
        last: Their last rows, likewise.
        **path: The remaining fields of an `Outcome`, from ``length`` on: numbers, or of shape (runs,).
    """
    code = np.asarray(final.status.code)
    nothing = np.zeros_like(code)
    insight = last.insight
    seen = isinstance(insight, Insight)
    stop = getattr(final.held, "stop", nothing)
    made = Outcome(
        code=code,
        tipped=nothing,
        time=final.status.time,
        place=last.foot,
        arc_length=last.arc_length,
        x=last.motion.x,
        y=last.motion.y,
        speed=last.motion.speed,
        cross_track=last.cross_track,
        intervention=insight.intervention if seen else nothing,
        excess=insight.excess if seen else nothing,
        cause=insight.cause if seen else nothing,
        stop=np.where(code == STOPPED, stop, 0.0),
        slid=final.events.slid,
        first=final.events.first,
        **path,
    )
    return rebuild(made, (np.broadcast_to(leaf, code.shape) for leaf in leaves(made)))


def verdicts(all_of_them: Outcome, hits: Sequence[Hit | None]) -> list[Verdict]:
    """The verdict on every run."""
    columns = (
        map(Event._make, zip(*(np.asarray(leaf).tolist() for leaf in field), strict=True))
        if isinstance(field, Event)
        else field.tolist()
        for field in all_of_them
    )
    ones = map(Outcome._make, zip(*columns, strict=True))
    return [judge(one, hit) for one, hit in zip(ones, hits, strict=True)]
