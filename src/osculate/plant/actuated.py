"""The plant every user has: a steering servo, motors with lag and limits, rolling resistance.

ω = v tan φ / a with the servo's angle φ, and v obeys eq. (16) corrected with the servo's rate. The
torque difference does nothing: given the steering it is what the differential leaves (erratum 3).
"""

from typing import Literal, NamedTuple

from osculate.control.contract import Start
from osculate.kernel import kernel
from osculate.kernel.maths import atan, clip, sincos, tan
from osculate.plant.contract import Plant, PlantPart, Push
from osculate.spec import quantity
from osculate.vehicle.model import ReducedModel, steered_acceleration
from osculate.vehicle.motion import Command, Motion
from osculate.vehicle.tricycle import Tricycle

CRAWL = 0.002  # m/s, speed at which rolling resistance has half of its size


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
    frequency: float  # rad/s, natural frequency of the servo
    damping: float  # 2 ζ ω, 1/s
    rate_limit: float  # rad/s
    angle_limit: float  # rad
    motor_rate: float  # 1/s
    torque_limit: float  # N m, each wheel
    resistance: float  # N m, torque of both drives that overcomes rolling resistance
    offset: float  # rad, wheel's angle minus servo's angle
    odometry: float  # measured speed per speed


@kernel
def actuated_rates(
    state: ActuatedState, command: Command, push: Push, p: ActuatedParameters
) -> ActuatedState:
    """Servo, motors, eqs (2), (6) and (16)."""
    wanted = clip(command.steering_angle, -p.angle_limit, p.angle_limit)
    pull = (
        p.frequency * p.frequency * (wanted - state.steering_angle)
        - p.damping * state.steering_rate
    )
    outward = pull * state.steering_rate > 0.0 and abs(state.steering_rate) >= p.rate_limit
    rate = clip(state.steering_rate, -p.rate_limit, p.rate_limit)
    tangent = tan(state.steering_angle + p.offset)
    sine, cosine = sincos(state.heading)
    drag = p.resistance * state.speed / (abs(state.speed) + CRAWL)
    torque = state.torque_left + state.torque_right - drag
    left = clip(command.torque_left, -p.torque_limit, p.torque_limit)
    right = clip(command.torque_right, -p.torque_limit, p.torque_limit)
    return ActuatedState(
        x=state.speed * cosine,
        y=state.speed * sine,
        heading=state.speed * tangent / p.model.wheelbase + push.yaw_rate,
        speed=steered_acceleration(p.model, tangent, rate, state.speed, torque) + push.acceleration,
        steering_angle=rate,
        steering_rate=0.0 if outward else pull,
        torque_left=(left - state.torque_left) * p.motor_rate,
        torque_right=(right - state.torque_right) * p.motor_rate,
    )


@kernel
def measure_actuated(state: ActuatedState, p: ActuatedParameters) -> Motion:
    """Pose exactly, steering angle as the servo's encoder and speed as the wheels' encoders see it."""
    speed = state.speed * p.odometry
    yaw_rate = state.speed * tan(state.steering_angle + p.offset) / p.model.wheelbase
    return Motion(state.x, state.y, state.heading, speed, yaw_rate, state.steering_angle)


class Actuated(Plant):
    """The robot with its actuators; the fields say how it differs from what its law believes."""

    kind: Literal["actuated"] = "actuated"
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

    def part(self, robot: Tricycle, start: Start) -> PlantPart:
        """See `Plant.part`."""
        loaded = robot.model_copy(update={"body_mass": robot.body_mass + self.payload})
        real = Tricycle(
            **{
                **{name: getattr(loaded, name) for name in type(robot).model_fields},
                "wheel_radius": robot.wheel_radius * (1.0 - self.wheel_wear),
            }
        )
        act = robot.actuators
        frequency = act.steering_frequency * self.servo
        model = real.reduced_model()
        parameters = ActuatedParameters(
            model=model,
            frequency=frequency,
            damping=2.0 * act.steering_damping * frequency,
            rate_limit=act.steering_rate_limit,
            angle_limit=act.steering_angle_limit,
            motor_rate=1.0 / act.motor_lag,
            torque_limit=act.torque_limit,
            resistance=act.rolling_resistance * real.weight * real.wheel_radius,
            offset=self.steering_offset,
            odometry=1.0 / (1.0 - self.wheel_wear),
        )
        angle = float(atan(robot.wheelbase * start.curvature))
        state = ActuatedState(start.x, start.y, start.heading, start.speed, angle, 0.0, 0.0, 0.0)
        return PlantPart(actuated_rates, measure_actuated, parameters, state)
