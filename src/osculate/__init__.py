"""osculate: make a three-wheeled robot follow a curve exactly.

The public names are loaded on first use, so that ``import osculate`` stays fast.
"""

from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from osculate.control import CurvatureLaw as CurvatureLaw
    from osculate.control import CurvatureTracker as CurvatureTracker
    from osculate.control import Ekf as Ekf
    from osculate.control import FeedforwardLqr as FeedforwardLqr
    from osculate.control import Kanayama as Kanayama
    from osculate.control import Nmpc as Nmpc
    from osculate.control import PreviewLqr as PreviewLqr
    from osculate.control import PurePursuit as PurePursuit
    from osculate.control import Safety as Safety
    from osculate.control import SlidingMode as SlidingMode
    from osculate.control import SpeedLoop as SpeedLoop
    from osculate.control import Stanley as Stanley
    from osculate.control import Stepper as Stepper
    from osculate.control import YawRegulator as YawRegulator
    from osculate.curve import Arc as Arc
    from osculate.curve import Chain as Chain
    from osculate.curve import Clothoid as Clothoid
    from osculate.curve import Composite as Composite
    from osculate.curve import Curve as Curve
    from osculate.curve import CurveFile as CurveFile
    from osculate.curve import CurvePoint as CurvePoint
    from osculate.curve import Cycloid as Cycloid
    from osculate.curve import Laps as Laps
    from osculate.curve import Line as Line
    from osculate.curve import Nurbs as Nurbs
    from osculate.curve import Parametric as Parametric
    from osculate.curve import Pose as Pose
    from osculate.curve import Reading as Reading
    from osculate.curve import Segment as Segment
    from osculate.curve import Spline as Spline
    from osculate.curve import read_curve as read_curve
    from osculate.curve import read_file as read_file
    from osculate.errors import InvalidInput as InvalidInput
    from osculate.errors import InvalidScenario as InvalidScenario
    from osculate.errors import MissingExtra as MissingExtra
    from osculate.errors import NoSolution as NoSolution
    from osculate.errors import NotWritten as NotWritten
    from osculate.errors import OsculateError as OsculateError
    from osculate.plant import Actuated as Actuated
    from osculate.plant import Disturbance as Disturbance
    from osculate.plant import FrictionPatch as FrictionPatch
    from osculate.plant import Gusts as Gusts
    from osculate.plant import Late as Late
    from osculate.plant import Mujoco as Mujoco
    from osculate.plant import Patch as Patch
    from osculate.plant import Payload as Payload
    from osculate.plant import Reduced as Reduced
    from osculate.plant import SensorLoss as SensorLoss
    from osculate.plant import Sensors as Sensors
    from osculate.plant import Shove as Shove
    from osculate.plant import Slip as Slip
    from osculate.plant import Slippery as Slippery
    from osculate.plant import Slope as Slope
    from osculate.plant import SlowServo as SlowServo
    from osculate.plant import SteeringOffset as SteeringOffset
    from osculate.plant import StuckSteering as StuckSteering
    from osculate.plant import WeakMotor as WeakMotor
    from osculate.plant import WheelWear as WheelWear
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
    from osculate.simulation import Verdict as Verdict
    from osculate.simulation import VerdictKind as VerdictKind
    from osculate.simulation import simulate as simulate
    from osculate.simulation import simulate_batch as simulate_batch
    from osculate.simulation import variable_names as variable_names
    from osculate.study import Scenario as Scenario
    from osculate.study.comparison import Comparison as Comparison
    from osculate.study.comparison import Condition as Condition
    from osculate.study.comparison import Tuning as Tuning
    from osculate.study.comparison import compare as compare
    from osculate.study.comparison import paired_comparisons as paired_comparisons
    from osculate.study.comparison import tune as tune
    from osculate.target import Dynamical as Dynamical
    from osculate.target import Exponential as Exponential
    from osculate.target import Limits as Limits
    from osculate.target import Modified as Modified
    from osculate.target import Natural as Natural
    from osculate.target import Projected as Projected
    from osculate.target import SampledProfile as SampledProfile
    from osculate.target import SpeedPlan as SpeedPlan
    from osculate.target import Static as Static
    from osculate.target import plan_speed as plan_speed
    from osculate.vehicle import Actuators as Actuators
    from osculate.vehicle import Tricycle as Tricycle
    from osculate.vehicle import vehicle_named as vehicle_named

_ROOMS = {
    "control": (
        "CurvatureLaw",
        "CurvatureTracker",
        "Ekf",
        "FeedforwardLqr",
        "Kanayama",
        "Nmpc",
        "PreviewLqr",
        "PurePursuit",
        "Safety",
        "SlidingMode",
        "SpeedLoop",
        "Stanley",
        "Stepper",
        "YawRegulator",
    ),
    "curve": (
        "Arc",
        "Chain",
        "Clothoid",
        "Composite",
        "Curve",
        "CurveFile",
        "CurvePoint",
        "Cycloid",
        "Laps",
        "Line",
        "Nurbs",
        "Parametric",
        "Pose",
        "Reading",
        "Segment",
        "Spline",
        "read_curve",
        "read_file",
    ),
    "errors": (
        "InvalidInput",
        "InvalidScenario",
        "MissingExtra",
        "NoSolution",
        "NotWritten",
        "OsculateError",
    ),
    "plant": (
        "Actuated",
        "Disturbance",
        "FrictionPatch",
        "Gusts",
        "Late",
        "Mujoco",
        "Patch",
        "Payload",
        "Reduced",
        "SensorLoss",
        "Sensors",
        "Shove",
        "Slip",
        "Slippery",
        "Slope",
        "SlowServo",
        "SteeringOffset",
        "StuckSteering",
        "WeakMotor",
        "WheelWear",
    ),
    "scene": (
        "Block",
        "Disc",
        "Scene",
        "Wall",
    ),
    "simulation": (
        "Batch",
        "Continuous",
        "InitialState",
        "Metrics",
        "Run",
        "Sampled",
        "Verdict",
        "VerdictKind",
        "simulate",
        "simulate_batch",
        "variable_names",
    ),
    "study": ("Scenario",),
    "study.comparison": (
        "Comparison",
        "Condition",
        "Tuning",
        "compare",
        "paired_comparisons",
        "tune",
    ),
    "target": (
        "Dynamical",
        "Exponential",
        "Limits",
        "Modified",
        "Natural",
        "Projected",
        "SampledProfile",
        "SpeedPlan",
        "Static",
        "plan_speed",
    ),
    "vehicle": (
        "Actuators",
        "Tricycle",
        "vehicle_named",
    ),
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
