"""The plant every user has: a steering servo, motors with lag and limits, rolling resistance.

ω = v tan φ / a with the servo's angle φ, and v obeys eq. (16) corrected with the servo's rate. The
torque difference does nothing: given the steering it is what the differential leaves (erratum 3).
"""

from typing import ClassVar, Literal, NamedTuple

from osculate.control.contract import Start
from osculate.kernel import kernel
from osculate.kernel.maths import atan, sincos, tan
from osculate.plant.contract import Plant, PlantPart, Push
from osculate.spec import quantity
from osculate.vehicle.actuators import ActuatorParameters, ActuatorState, actuator_rates
from osculate.vehicle.brake import BrakeParameters, brake_parameters, brake_torque
from osculate.vehicle.model import ReducedModel, steered_acceleration
from osculate.vehicle.motion import Command, Motion, Wheels
from osculate.vehicle.tricycle import Tricycle

CRAWL = 0.002  # m/s, speed at which rolling resistance has half of its size


class ActuatedPlant(Plant):
    """A robot with its actuators; the fields say how it differs from what its law believes."""

    payload: float = quantity(
        "kg", "load on the body's centre that no law knows", default=0.0, ge=0
    )
    servo: float = quantity(
        "1", "natural frequency of the steering servo, per that of the robot", default=1.0, gt=0
    )
    wheel_wear: float = quantity(
        "1", "loss of wheel radius, part of the radius", default=0.0, ge=0, lt=0.5
    )
    steering_offset: float = quantity("rad", "wheel's angle minus servo's angle", default=0.0)

    def real(self, robot: Tricycle) -> Tricycle:
        """The robot as it is: loaded, its wheels worn."""
        bare = robot.weight / robot.gravity
        moment = bare * robot.centre_ahead + self.payload * robot.wheelbase / 2.0
        return robot.but(
            body_mass=robot.body_mass + self.payload,
            centre_ahead=moment / (bare + self.payload),
            wheel_radius=robot.wheel_radius * (1.0 - self.wheel_wear),
        )

    @property
    def odometry(self) -> float:
        """Speed by the wheels' encoders, which know no wear, per speed."""
        return 1.0 / (1.0 - self.wheel_wear)


class ActuatedState(NamedTuple):
    """State of the actuated plant."""

    x: float  # m
    y: float  # m
    heading: float  # rad
    speed: float  # m/s
    steering_angle: float  # rad, as the servo sees it
    steering_rate: float  # rad/s
    torque_left: float  # N m
    torque_right: float  # N m


class ActuatedParameters(NamedTuple):
    """Parameters of the actuated plant."""

    model: ReducedModel
    actuators: ActuatorParameters
    resistance: float  # N m, torque of both drives that overcomes rolling resistance
    offset: float  # rad, wheel's angle minus servo's angle
    odometry: float  # measured speed per speed
    half_track: float  # m, d / 2
    brake: BrakeParameters


@kernel
def actuated_rates(
    state: ActuatedState, command: Command, push: Push, p: ActuatedParameters
) -> ActuatedState:
    """Servo, motors, eqs (2), (6) and (16)."""
    now = ActuatorState(
        state.steering_angle, state.steering_rate, state.torque_left, state.torque_right
    )
    moved = actuator_rates(now, command, p.actuators)
    tangent = tan(state.steering_angle + p.offset)
    sine, cosine = sincos(state.heading)
    drag = p.resistance * state.speed / (abs(state.speed) + CRAWL)
    drag = drag + brake_torque(command.brake, state.speed, p.brake)
    torque = state.torque_left + state.torque_right - drag
    acceleration = steered_acceleration(p.model, tangent, moved.steering_angle, state.speed, torque)
    return ActuatedState(
        x=state.speed * cosine,
        y=state.speed * sine,
        heading=state.speed * tangent / p.model.wheelbase + push.yaw_rate,
        speed=acceleration + push.acceleration,
        steering_angle=moved.steering_angle,
        steering_rate=moved.steering_rate,
        torque_left=moved.torque_left,
        torque_right=moved.torque_right,
    )


@kernel
def measure_actuated(state: ActuatedState, p: ActuatedParameters) -> Motion:
    """Pose exactly, steering angle as the servo's encoder and speed as the wheels' encoders see it."""
    speed = state.speed * p.odometry
    yaw_rate = state.speed * tan(state.steering_angle + p.offset) / p.model.wheelbase
    return Motion(state.x, state.y, state.heading, speed, yaw_rate, state.steering_angle)


@kernel
def actuated_wheels(state: ActuatedState, p: ActuatedParameters) -> Wheels:
    """Rolling, eq. (3), on worn wheels: v ∓ (d/2) ω, as the encoders see it."""
    yaw_rate = state.speed * tan(state.steering_angle + p.offset) / p.model.wheelbase
    turn = p.half_track * yaw_rate
    return Wheels((state.speed - turn) * p.odometry, (state.speed + turn) * p.odometry)


class Actuated(ActuatedPlant):
    """The robot with its actuators, rolling without slip."""

    kind: Literal["actuated"] = "actuated"
    feels: ClassVar[frozenset[str]] = frozenset({"acceleration", "yaw_rate"})

    def part(self, robot: Tricycle, start: Start) -> PlantPart:
        """See `Plant.part`."""
        real = self.real(robot)
        rolling = robot.actuators.rolling_resistance
        parameters = ActuatedParameters(
            model=real.reduced_model(),
            actuators=robot.actuators.parameters(self.servo),
            resistance=rolling * real.weight * real.wheel_radius,
            offset=self.steering_offset,
            odometry=self.odometry,
            half_track=0.5 * robot.track_width,
            brake=brake_parameters(robot.brake, robot.total_mass * robot.wheel_radius, CRAWL),
        )
        angle = float(atan(robot.wheelbase * start.curvature))
        state = ActuatedState(start.x, start.y, start.heading, start.speed, angle, 0.0, 0.0, 0.0)
        return PlantPart(actuated_rates, measure_actuated, actuated_wheels, parameters, state)
