"""osculate: make a three-wheeled robot follow a curve exactly.

The public names are loaded on first use, so that ``import osculate`` stays fast.
"""

from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from osculate.control import CurvatureLaw as CurvatureLaw
    from osculate.control import SlidingMode as SlidingMode
    from osculate.control import YawRegulator as YawRegulator
    from osculate.curve import Curve as Curve
    from osculate.curve import CurvePoint as CurvePoint
    from osculate.curve import Cycloid as Cycloid
    from osculate.curve import Parametric as Parametric
    from osculate.errors import InvalidInput as InvalidInput
    from osculate.errors import InvalidScenario as InvalidScenario
    from osculate.errors import MissingExtra as MissingExtra
    from osculate.errors import NoSolution as NoSolution
    from osculate.errors import OsculateError as OsculateError
    from osculate.plant import Disturbance as Disturbance
    from osculate.plant import Reduced as Reduced
    from osculate.scene import Block as Block
    from osculate.scene import Disc as Disc
    from osculate.scene import Scene as Scene
    from osculate.scene import Wall as Wall
    from osculate.simulation import Batch as Batch
    from osculate.simulation import Continuous as Continuous
    from osculate.simulation import InitialState as InitialState
    from osculate.simulation import Metrics as Metrics
    from osculate.simulation import Run as Run
    from osculate.simulation import Sampled as Sampled
    from osculate.simulation import simulate as simulate
    from osculate.simulation import simulate_batch as simulate_batch
    from osculate.simulation import variable_names as variable_names
    from osculate.study import Scenario as Scenario
    from osculate.target import Dynamical as Dynamical
    from osculate.target import Exponential as Exponential
    from osculate.target import Modified as Modified
    from osculate.target import Natural as Natural
    from osculate.target import Projected as Projected
    from osculate.target import SampledProfile as SampledProfile
    from osculate.target import Static as Static
    from osculate.vehicle import Tricycle as Tricycle

_ROOMS = {
    "control": ("CurvatureLaw", "SlidingMode", "YawRegulator"),
    "curve": ("Curve", "CurvePoint", "Cycloid", "Parametric"),
    "errors": ("InvalidInput", "InvalidScenario", "MissingExtra", "NoSolution", "OsculateError"),
    "plant": ("Disturbance", "Reduced"),
    "scene": ("Block", "Disc", "Scene", "Wall"),
    "simulation": (
        "Batch",
        "Continuous",
        "InitialState",
        "Metrics",
        "Run",
        "Sampled",
        "simulate",
        "simulate_batch",
        "variable_names",
    ),
    "study": ("Scenario",),
    "target": (
        "Dynamical",
        "Exponential",
        "Modified",
        "Natural",
        "Projected",
        "SampledProfile",
        "Static",
    ),
    "vehicle": ("Tricycle",),
}
_HOME = {name: room for room, names in _ROOMS.items() for name in names}

__all__ = [*_HOME, "__version__"]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    if name == "__version__":
        try:
            return version("osculate")
        except PackageNotFoundError:
            return "0+unknown"
    if name not in _HOME:
        raise AttributeError(f"module 'osculate' has no attribute {name!r}")
    value = getattr(import_module(f"osculate.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
