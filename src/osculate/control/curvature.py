"""The paper's law: LQR with preview for yaw, integral sliding mode for speed, eqs (34)–(42).

Order of work as in Table 2: the yaw channel first (u₁, and with it the steering angle), then the
torque by feedback linearisation of the speed dynamics with that yaw acceleration, then the switching
term that rejects what the model does not know.
"""

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.contract import Controller, ControlPart, Start
from osculate.control.lqr import Regulator, exponential_preview, sampled_preview, yaw_regulator
from osculate.kernel import Grid, Nothing, Tables, compose, kernel, read
from osculate.spec import Spec, quantity
from osculate.target.contract import Reference, TargetPart
from osculate.target.profile import ExponentialPace
from osculate.vehicle.model import ReducedModel, drive_torque
from osculate.vehicle.motion import Motion


class SlidingMode(Spec):
    """Integral sliding mode with feedback linearisation of the speed, eqs (37)–(41)."""

    gain: float = quantity(
        "1/s", "decay rate of the speed error, κ (k in the paper)", default=600.0, gt=0
    )
    switching: float = quantity(
        "N m", "constant part of the switching torque, ε", default=0.1, ge=0
    )
    uncertainty: float = quantity(
        "N s", "part of the switching torque per m/s of speed error, E", default=0.2, ge=0
    )
    weight: float = quantity("1", "weight of the sliding function, G", default=1.0, gt=0)


class YawRegulator(Spec):
    """Weights of the yaw LQR, eq. (33)."""

    heading_weight: float = quantity(
        "1/rad²", "weight of the heading error, Q₁₁", default=1.0, gt=0
    )
    rate_weight: float = quantity(
        "s²/rad²", "weight of the yaw-rate error, Q₂₂", default=100.0, ge=0
    )
    effort_weight: float = quantity("1/(N m)²", "weight of u₁, R", default=1.0, gt=0)


class CurvatureParameters(NamedTuple):
    """Parameters of `curvature_law`."""

    model: ReducedModel
    heading_gain: float  # N m/rad
    rate_gain: float  # N m s/rad
    speed_gain: float  # 1/s, κ
    switching: float  # N m, ε / G
    uncertainty: float  # N s, E
    initial_speed: float  # m/s, v(0)
    at_rest: float  # 1/m, curvature that the steering is set to at standstill
    preview: Any  # parameters of the part ``anticipate``


class CurvatureMemory(NamedTuple):
    """Memory of `curvature_law`."""

    speed_target: float  # m/s, ∫ v̂̇ dt


class ExponentialPreview(NamedTuple):
    """Parameters of `anticipate_exponential`."""

    rate: float  # N m s/rad, factor of ω̂
    acceleration: float  # N m s²/rad, factor of ω̂̇


class SampledPreview(NamedTuple):
    """Parameters of `anticipate_sampled`."""

    grid: Grid
    end: float  # s, nothing is known to come after it


@kernel
def anticipate_exponential(
    t: float,
    feedback: float,
    speed_error: float,
    reference: Reference,
    p: CurvatureParameters,
    tables: NDArray[np.float64],
) -> float:
    """Yaw acceleration with the closed-form preview of an exponential yaw rate, eqs (34)–(35)."""
    preview = p.preview
    ahead = preview.rate * reference.yaw_rate + preview.acceleration * reference.yaw_drift
    return p.model.yaw_gain * (feedback + ahead)


@kernel
def anticipate_sampled(
    t: float,
    feedback: float,
    speed_error: float,
    reference: Reference,
    p: CurvatureParameters,
    tables: NDArray[np.float64],
) -> float:
    """Yaw acceleration with the tabulated preview of a known yaw rate, eqs (34)–(35)."""
    over = t > p.preview.end
    ahead, _ = read(p.preview.end if over else t, p.preview.grid, tables)
    return p.model.yaw_gain * (feedback + (0.0 if over else ahead))


@kernel
def anticipate_slaved(
    t: float,
    feedback: float,
    speed_error: float,
    reference: Reference,
    p: CurvatureParameters,
    tables: NDArray[np.float64],
) -> float:
    """Yaw acceleration for a target that follows the robot: its rate is fed forward.

    Both channels may be slaved to each other's acceleration: v̇ = −κ z + v̂̇(ω̇) and
    ω̇ = c u_fb + ω̂̇(v̇) are solved together; the product of the slaving gains is at most ¼.
    """
    acceleration = reference.speed_drift - p.speed_gain * speed_error
    wanted = (
        p.model.yaw_gain * feedback + reference.yaw_drift + reference.yaw_slaving * acceleration
    )
    return wanted / (1.0 - reference.yaw_slaving * reference.speed_slaving)


@kernel
def speed_torque(
    p: CurvatureParameters,
    motion: Motion,
    reference: Reference,
    memory: CurvatureMemory,
    yaw_acceleration: float,
    curvature: float,
) -> Any:
    """The drive torque u₂ = u₂₀ + u₂₁ (N m) and v̂̇ (m/s²), eqs (37)–(41)."""
    error = motion.speed - reference.speed
    target_rate = reference.speed_drift + reference.speed_slaving * yaw_acceleration
    wanted = target_rate - p.speed_gain * error
    torque = drive_torque(p.model, curvature, yaw_acceleration, wanted)
    sliding = motion.speed - p.initial_speed - memory.speed_target  # ϝ / G
    sign = (1.0 if sliding > 0.0 else 0.0) - (1.0 if sliding < 0.0 else 0.0)
    return torque - (p.switching + p.uncertainty * abs(error)) * sign, target_rate


class CurvatureLaw(Controller):
    """The paper's controller, eq. (42); gains and weights default to Section 5."""

    kind: Literal["curvature"] = "curvature"
    yaw: YawRegulator = YawRegulator()
    speed: SlidingMode = SlidingMode()

    def part(
        self, model: ReducedModel, target: TargetPart, start: Start, tables: Tables
    ) -> ControlPart:
        """See `Controller.part`."""
        solved = yaw_regulator(
            model.yaw_gain, self.yaw.heading_weight, self.yaw.rate_weight, self.yaw.effort_weight
        )
        anticipate, preview = _anticipation(solved, target, tables)
        parameters = CurvatureParameters(
            model=model,
            heading_gain=float(solved.gain[0]),
            rate_gain=float(solved.gain[1]),
            speed_gain=self.speed.gain,
            switching=self.speed.switching / self.speed.weight,
            uncertainty=self.speed.uncertainty,
            initial_speed=start.speed,
            at_rest=start.curvature,
            preview=preview,
        )
        template = "osculate.control.templates.curvature_law"
        law = compose(template, {"anticipate": anticipate}).curvature_law
        poles = np.abs(np.linalg.eigvals(solved.closed))
        return ControlPart(
            law, parameters, CurvatureMemory(0.0), float(max(poles.max(), self.speed.gain))
        )


def _anticipation(solved: Regulator, target: TargetPart, tables: Tables) -> tuple[Any, NamedTuple]:
    known = target.known_yaw
    if known is None:
        return anticipate_slaved, Nothing()
    if isinstance(known, ExponentialPace):
        return anticipate_exponential, ExponentialPreview(*exponential_preview(solved, known.decay))
    rows = sampled_preview(solved, known)
    grid = tables.add(rows, 0.0, known.step)
    return anticipate_sampled, SampledPreview(grid, known.step * (len(rows) - 1))
