"""What controllers are compared on: curves, starts, conditions. And what they are tuned on."""

import math
from collections.abc import Iterable
from pathlib import Path

from pydantic import Field

from osculate.curve import Chain, Curve, CurveFile, Cycloid, Parametric, Segment, Spline
from osculate.errors import InvalidInput, choose
from osculate.plant import Actuated, Mujoco
from osculate.simulation import InitialState
from osculate.spec import Spec, quantity


class Condition(Spec):
    """How the robot differs from what its law believes."""

    plant: Actuated | Mujoco = Field(default=Actuated(), discriminator="kind")
    unknown_delay: float = quantity("s", "delay that the law does not know", default=0.0, ge=0)


#: Conditions by name.
CONDITIONS = {
    "ideal": Condition(),
    "slow-servo": Condition(plant=Actuated(servo=0.7)),
    "late": Condition(unknown_delay=0.04),
    "payload": Condition(plant=Actuated(payload=5.0)),
    "worn-wheels": Condition(plant=Actuated(wheel_wear=0.02)),
    "mujoco": Condition(plant=Mujoco()),
    "bent-steering": Condition(plant=Actuated(steering_offset=math.radians(1.0))),
}


def _slalom(places: Iterable[float], step: float) -> Spline:
    return Spline(points=tuple((step * n, y) for n, y in enumerate(places)))


#: The curves on which results are reported.
CURVES: dict[str, Curve] = {
    "cycloid": Cycloid.over(),
    "lemniscate": Parametric(
        x="3 * cos(p) / (1 + sin(p)**2)",
        y="3 * sin(p) * cos(p) / (1 + sin(p)**2)",
        end=2.0 * math.pi,
        loop=True,
    ),
    "slalom": _slalom([0.0, 0.5, 0.0, -0.5, 0.0, 0.5, 0.0, -0.5, 0.0], 1.5),
    "corner": Chain.corner(turn=math.pi / 2.0, radius=0.8, ramp=0.4, straight=2.0),
}


def curves(names: Iterable[str] | None = None, scale: float = 1.0) -> dict[str, Curve]:
    """Curves by name: built-in ones, or files (``scale`` multiplies their coordinates).

    Raises:
        InvalidInput: Neither a name nor a file.
    """
    chosen: dict[str, Curve] = {}
    for name in names or CURVES:
        if name in CURVES:
            chosen[name] = CURVES[name]
        elif Path(name).is_file():
            chosen[Path(name).stem] = CurveFile(path=name, scale=scale)
        else:
            raise InvalidInput("curve", name, f"must be a file or one of {', '.join(CURVES)}")
    return chosen


#: Starts by name; errors count once the robot had room to make them good.
STARTS = {
    "on-path": InitialState(),
    "offset": InitialState(cross_track=0.2, heading_error=math.radians(10.0), settled=3.0),
    "metre": InitialState(cross_track=1.0, settled=3.0),
    "across": InitialState(heading_error=math.radians(90.0), settled=3.0),
}


def starts(names: Iterable[str] | None = None) -> dict[str, InitialState]:
    """Starts by name.

    Raises:
        InvalidInput: No such start.
    """
    return {name: choose("start", name, STARTS) for name in names or ("on-path", "offset")}


def conditions(names: Iterable[str] | None = None) -> dict[str, Condition]:
    """Conditions by name.

    Raises:
        InvalidInput: No such condition.
    """
    return {name: choose("plant", name, CONDITIONS) for name in names or ("ideal",)}


def training_curves() -> dict[str, Curve]:
    """Curves for tuning; none of them is reported."""
    weave = Parametric(x="2 * p", y="0.4 * sin(1.3 * p) + 0.2 * sin(2.3 * p)", end=5.0)
    hairpin = Chain.corner(turn=-2.4, radius=1.1, ramp=0.7, straight=1.5)
    chicane = Chain(
        segments=(
            Segment(length=1.5),
            Segment(length=0.5, end_curvature=0.9),
            Segment(length=0.4, curvature=0.9),
            Segment(length=1.0, curvature=0.9, end_curvature=-0.9),
            Segment(length=0.4, curvature=-0.9),
            Segment(length=0.5, curvature=-0.9, end_curvature=0.0),
            Segment(length=1.5),
        )
    )
    return {"weave": weave, "hairpin": hairpin, "chicane": chicane}
