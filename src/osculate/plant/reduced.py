"""The paper's plant, eq. (16): a robot whose steering follows perfectly."""

from typing import ClassVar, Literal, NamedTuple

from osculate.control.contract import Start
from osculate.kernel import kernel
from osculate.kernel.maths import atan, sincos
from osculate.plant.contract import Plant, PlantPart, Push
from osculate.vehicle.model import ReducedModel, driven_curvature, speed_rate
from osculate.vehicle.motion import Command, Motion, Wheels
from osculate.vehicle.tricycle import Tricycle


class ReducedState(NamedTuple):
    """State of the reduced plant; the steering angle follows from ω / v."""

    x: float  # m
    y: float  # m
    heading: float  # rad
    speed: float  # m/s
    yaw_rate: float  # rad/s


class ReducedParameters(NamedTuple):
    """Parameters of the reduced plant."""

    model: ReducedModel
    at_rest: float  # 1/m, curvature that the steering is set to at standstill
    half_track: float  # m, d / 2


@kernel
def reduced_rates(
    state: ReducedState, command: Command, push: Push, p: ReducedParameters
) -> ReducedState:
    """Eqs (2) and (16): ω̇ = c u₁, and v̇ under u₂ with the actual ω̇."""
    sine, cosine = sincos(state.heading)
    difference = command.torque_right - command.torque_left
    yaw_acceleration = p.model.yaw_gain * difference + push.yaw_acceleration
    curvature = driven_curvature(state.speed, state.yaw_rate, p.at_rest)
    torque = command.torque_left + command.torque_right
    acceleration = speed_rate(p.model, curvature, yaw_acceleration, torque)
    return ReducedState(
        x=state.speed * cosine,
        y=state.speed * sine,
        heading=state.yaw_rate + push.yaw_rate,
        speed=acceleration + push.acceleration,
        yaw_rate=yaw_acceleration,
    )


@kernel
def measure_reduced(state: ReducedState, p: ReducedParameters) -> Motion:
    """Everything is known exactly; φ = arctan(a ω / v), eq. (6)."""
    curvature = driven_curvature(state.speed, state.yaw_rate, p.at_rest)
    return Motion(
        state.x,
        state.y,
        state.heading,
        state.speed,
        state.yaw_rate,
        atan(p.model.wheelbase * curvature),
    )


@kernel
def reduced_wheels(state: ReducedState, p: ReducedParameters) -> Wheels:
    """Rolling, eq. (3): v ∓ (d/2) ω."""
    turn = p.half_track * state.yaw_rate
    return Wheels(state.speed - turn, state.speed + turn)


class Reduced(Plant):
    """The reduced dynamics, eq. (16): corrected, or with the coefficient as the paper prints it."""

    kind: Literal["reduced"] = "reduced"
    feels: ClassVar[frozenset[str]] = frozenset({"acceleration", "yaw_acceleration", "yaw_rate"})
    starts_turning: ClassVar[bool] = True
    form: Literal["corrected", "printed"] = "corrected"

    def model(self, robot: Tricycle) -> ReducedModel:
        """The plant's own model: what the law inverts is what the plant obeys."""
        return robot.reduced_model(self.form)

    def part(self, robot: Tricycle, start: Start) -> PlantPart:
        """See `Plant.part`."""
        return PlantPart(
            reduced_rates,
            measure_reduced,
            reduced_wheels,
            ReducedParameters(self.model(robot), start.curvature, 0.5 * robot.track_width),
            ReducedState(start.x, start.y, start.heading, start.speed, start.yaw_rate),
        )
