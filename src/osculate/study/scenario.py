"""A scenario: one whole experiment, with the same fields in Python and in a YAML file."""

from collections.abc import Mapping
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any

from osculate.control import CurvatureLaw
from osculate.curve import AnyCurve, Cycloid
from osculate.errors import InvalidInput
from osculate.plant import Disturbance, Reduced
from osculate.scene import Scene, Wall
from osculate.simulation import AnyClock, Continuous, InitialState, Run, simulate
from osculate.simulation.blocks import Report
from osculate.spec import Spec
from osculate.target import AnyTarget, Modified
from osculate.vehicle import Tricycle

DEFAULT = "paper"


class Scenario(Spec):
    """Obstacle → curve → speed target → controllers → simulation: the five steps of Table 2.

    Every field has the paper's value by default. In a file, a cycloid that gives no ``distance`` and
    ``height`` takes them from the first wall of the scene.
    """

    name: str = "unnamed"
    description: str = ""
    scene: Scene = Scene(obstacles=(Wall(),))
    robot: Tricycle = Tricycle()
    curve: AnyCurve = Cycloid()
    target: AnyTarget = Modified()
    controller: CurvatureLaw = CurvatureLaw()
    plant: Reduced = Reduced()
    disturbance: Disturbance = Disturbance()
    clock: AnyClock = Continuous()
    initial: InitialState = InitialState()

    @classmethod
    def load(cls, source: str | Path) -> "Scenario":
        """Read a scenario from a YAML file, or by the name of a built-in one.

        Raises:
            InvalidInput: No such file or name, not YAML, or a field that is wrong.
            InvalidScenario: Several fields are wrong.
        """
        text, label = _text(str(source))
        return cls.parse(_with_obstacle(_mapping(text, label)))

    @cached_property
    def parts(self) -> dict[str, Any]:
        """The keyword arguments of `osculate.simulation` that this scenario stands for."""
        names = ("target", "controller", "plant", "disturbance", "clock", "initial", "scene")
        return {name: getattr(self, name) for name in names}

    def run(self, report: Report | None = None) -> Run:
        """Simulate it once."""
        return simulate(self.curve, self.robot, report=report, **self.parts)


def built_in() -> dict[str, str]:
    """Names and texts of the scenarios that come with the package."""
    folder = files("osculate.study") / "scenarios"
    return {
        item.name.removesuffix(".yaml"): item.read_text(encoding="utf-8")
        for item in sorted(folder.iterdir(), key=lambda item: item.name)
        if item.name.endswith(".yaml")
    }


def _text(source: str) -> tuple[str, str]:
    path = Path(source)
    if path.is_file():
        return path.read_text(encoding="utf-8"), source
    known = built_in()
    if source in known:
        return known[source], source
    raise InvalidInput(
        "scenario", source, f"must be a YAML file or one of: {', '.join(sorted(known))}"
    )


def _mapping(text: str, label: str) -> dict[str, Any]:
    import yaml

    try:
        loaded = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        reason = getattr(error, "problem", None) or str(error)
        raise InvalidInput("scenario", label, f"is not valid YAML{where}: {reason}") from None
    if not isinstance(loaded, Mapping):
        raise InvalidInput("scenario", label, "must hold a mapping of fields to values")
    return dict(loaded)


def _with_obstacle(fields: dict[str, Any]) -> dict[str, Any]:
    """Step 1 of Table 2: a cycloid without a size of its own goes over the scene's first wall."""
    curve, scene = fields.get("curve"), fields.get("scene")
    if not isinstance(curve, Mapping) or curve.get("kind") != "cycloid":
        return fields
    obstacles = scene.get("obstacles", ()) if isinstance(scene, Mapping) else ()
    walls = [o for o in obstacles if isinstance(o, Mapping) and o.get("kind", "wall") == "wall"]
    if not walls:
        return fields
    sizes = {name: walls[0][name] for name in ("distance", "height") if name in walls[0]}
    return {**fields, "curve": {**sizes, **curve}}
