"""A scenario: one whole experiment, with the same fields in Python and in a YAML file."""

from collections.abc import Mapping
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, field_validator, model_validator

from osculate.control import CurvatureLaw, Ekf, Safety
from osculate.control.safety import foresee
from osculate.control.tracking import AnyTracker, PathTracker
from osculate.curve import AnyCurve, Cycloid
from osculate.curve.files.documents import load_yaml
from osculate.curve.files.source import read_text
from osculate.errors import InvalidInput, choose
from osculate.files import check_file, is_file, write_text
from osculate.plant import Actuated, AnyFault, AnyPlant, Disturbance, Mujoco, Reduced, Sensors, Slip
from osculate.scene import Scene
from osculate.simulation import AnyClock, Continuous, InitialState, Run, Sampled, simulate
from osculate.simulation.blocks import Report
from osculate.simulation.run import TRACKER_WORLD
from osculate.spec import Spec
from osculate.strict_json import strict_json
from osculate.target import AnyTarget, Limits, Modified, plan_speed
from osculate.vehicle import Tricycle, vehicle_named

AnyController = Annotated[CurvatureLaw | AnyTracker, Field(discriminator="kind")]


class Scenario(Spec):
    """Obstacle → curve → speed target → controllers → simulation: the five steps of Table 2.

    Every field has the value that `simulate` has by default, the paper's, on its cycloid and with nothing
    around; with a path tracker the plant is the actuated robot and
    the clock a sampled one, 100 Hz and 10 ms late. It may see through noisy ``sensors`` and an
    ``estimator``, be guarded by ``safety`` and suffer ``faults``. ``robot`` may be a name of the catalogue.
    In a file, a cycloid that gives no ``distance`` and ``height`` takes them from the scene's first wall,
    and so does the one that is driven where no curve is given.
    """

    name: str = "unnamed"
    description: str = ""
    scene: Scene = Scene()
    robot: Tricycle = Tricycle()
    curve: AnyCurve = Cycloid()
    target: AnyTarget = Modified()
    controller: AnyController = CurvatureLaw()
    plant: AnyPlant = Reduced()
    disturbance: Disturbance = Disturbance()
    clock: AnyClock = Continuous()
    initial: InitialState = InitialState()
    limits: Limits = Limits()
    sensors: Sensors | None = None
    estimator: Ekf | None = None
    safety: Safety | None = None
    faults: tuple[AnyFault, ...] = ()

    @field_validator("robot", mode="before")
    @classmethod
    def _named(cls, robot: Any) -> Any:
        return vehicle_named(robot) if isinstance(robot, str) else robot

    @model_validator(mode="before")
    @classmethod
    def _world(cls, fields: Any) -> Any:
        """A path tracker drives, unless said otherwise, the actuated robot at 100 Hz, 10 ms late."""
        law = fields.get("controller") if isinstance(fields, Mapping) else None
        kind = law.get("kind") if isinstance(law, Mapping) else getattr(law, "kind", None)
        if not isinstance(law, PathTracker) and kind in (None, "curvature"):
            return fields
        return {**TRACKER_WORLD, **fields}

    @classmethod
    def load(cls, source: str | Path) -> "Scenario":
        """Read a scenario from a YAML file, or by the name of a built-in one.

        Raises:
            InvalidInput: No such file or name, not YAML, or a field that is wrong.
            InvalidScenario: Several fields are wrong.
        """
        text, label = _text(str(source))
        return cls.parse(_with_folder(_with_obstacle(_mapping(text, label)), Path(source).parent))

    def on(self, plant: str) -> "Scenario":
        """The same scenario on another plant: ``actuated``, ``slip`` or ``mujoco``.

        What the scenario says of its own plant (payload, friction, ...) holds on the other as well.

        Raises:
            InvalidInput: No such plant, or one that has not what the scenario's plant is given.
        """
        plants: dict[str, type[Actuated | Slip | Mujoco]] = {
            "actuated": Actuated, "slip": Slip, "mujoco": Mujoco,
        }  # fmt: skip
        kind = choose("plant", plant, plants)
        given = self.plant.model_dump(exclude_defaults=True, exclude={"kind"})
        for name, value in given.items():
            if name not in kind.model_fields:
                message = f"does not fit the plant {plant}, which has no {name}"
                raise InvalidInput(f"plant.{name}", value, message)
        return self.but(plant=kind(**given))

    @cached_property
    def parts(self) -> dict[str, Any]:
        """The keyword arguments of `osculate.simulation` that this scenario stands for."""
        names = (
            "target", "controller", "plant", "disturbance", "clock", "initial", "limits", "scene",
            "sensors", "estimator", "safety", "faults",
        )  # fmt: skip
        unused = "target" if isinstance(self.controller, PathTracker) else "limits"
        given = [n for n in names if n != unused or n in self.model_fields_set]
        return {name: getattr(self, name) for name in given}

    def caution(self) -> str | None:
        """Where a steering that gets stuck would take the robot out of its corridor, in a sentence.

        None if nowhere, or where nothing guards a path tracker.

        Raises:
            InvalidInput: Limits that contradict each other.
            NoSolution: The robot cannot follow the curve.
        """
        if self.safety is None or not isinstance(self.clock, Sampled):
            return None
        period = self.clock.period
        task = (self.curve, self.robot, self.limits)
        foreseen, ceiling = foresee(self.safety, *task, period, round(self.clock.delay / period))
        return foreseen.caution(plan_speed(*task, ceiling)) if foreseen else None

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
    if is_file(path):
        return read_text(path).content, source
    known = built_in()
    if source in known:
        return known[source], source
    raise InvalidInput(
        "scenario", source, f"must be a YAML file or one of: {', '.join(sorted(known))}"
    )


def _check(text: str, label: str) -> None:
    """No key twice, no number that programs read differently, nothing without bounds."""
    try:
        load_yaml(text, label, lambda fraction: None, decimal=True)
    except InvalidInput as error:
        if "is not valid YAML" not in error.valid:
            raise InvalidInput("scenario", error.value, error.valid) from None


def _mapping(text: str, label: str) -> dict[str, Any]:
    import yaml

    _check(text, label)
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


def _with_folder(fields: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A curve's file is meant relative to the scenario's own folder."""
    curve = fields.get("curve")
    if not isinstance(curve, Mapping) or not isinstance(curve.get("path"), str):
        return fields
    beside = folder / curve["path"]
    return {**fields, "curve": {**curve, "path": str(beside)}} if is_file(beside) else fields


def _with_obstacle(fields: dict[str, Any]) -> dict[str, Any]:
    """Step 1 of Table 2: a cycloid without a size of its own goes over the scene's first wall."""
    curve, scene = fields.get("curve", {"kind": "cycloid"}), fields.get("scene")
    if not isinstance(curve, Mapping) or curve.get("kind") != "cycloid":
        return fields
    obstacles = scene.get("obstacles", ()) if isinstance(scene, Mapping) else ()
    listed = obstacles if isinstance(obstacles, list) else ()
    walls = [o for o in listed if isinstance(o, Mapping) and o.get("kind", "wall") == "wall"]
    if not walls:
        return fields
    sizes = {name: walls[0][name] for name in ("distance", "height") if name in walls[0]}
    return {**fields, "curve": {**sizes, **curve}}


def write_template(path: Path) -> list[Path]:
    """Write a commented scenario, and beside it the JSON schema that it names.

    Raises:
        InvalidInput: The file exists already, or cannot be written.
    """
    check_file("path", path)
    if path.exists():
        raise InvalidInput("path", str(path), "exists already; give another name")
    text = files("osculate.study").joinpath("template.yaml").read_text(encoding="utf-8")
    schema = path.with_name("scenario.schema.json")
    try:
        content = strict_json(Scenario.model_json_schema(), indent=1)
        write_text(schema, content + "\n")
        write_text(path, text)
    except OSError as error:
        raise InvalidInput("path", str(path), f"must be writable ({error})") from None
    return [path, schema]
