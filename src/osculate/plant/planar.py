"""The robot on tyres that slip: planar motion, three spinning wheels, loads that shift.

O moves with u along and w to the left of the heading and the body turns with r. With the mass m, its
centre x_c ahead of O, and the yaw inertia J about that centre, the forces of the ground on the wheels
(sum X, Y; moment M about O) give

    m (u̇ − w r − x_c r²) = X,    m (ẇ + u r + x_c ṙ) = Y,    J ṙ = M − x_c Y,    I_w Ω̇ = T − R X_wheel

A robot whose steered wheel is behind the axle is the same with a wheelbase, a centre and a steering
angle that are negative. As stiffness grows the tyres roll without slip, and the motion becomes that of
`Actuated`, eq. (16), whose inertia I holds the spin of the wheels as well; without it what is left is

    J + m x_c² = I − (a / r)² I_w − I_w d² / (2 r²)

Loads shift quasi-statically with the ground's force per mass, of which a lag of 30 ms (body and tyres
give way) makes a state. The front wheel on the centre line carries no roll. Wheels that lift carry
nothing, but the robot does not tip over: that takes `Mujoco`.
"""

from typing import Any, NamedTuple

from osculate.kernel import kernel
from osculate.kernel.maths import clip, sincos
from osculate.plant.actuated import CRAWL
from osculate.plant.contract import Push
from osculate.plant.tyre import Planar, TyreParameters, friction_at, tyre_force
from osculate.vehicle.actuators import ActuatorParameters, ActuatorState, actuator_rates
from osculate.vehicle.brake import BrakeParameters, brake_torque
from osculate.vehicle.model import ReducedModel
from osculate.vehicle.motion import Command, Motion, Wheels

LOAD_LAG = 0.03  # s, of the loads behind the forces that shift them


class SlipState(NamedTuple):
    """State of the slipping plant."""

    x: float  # m, of O
    y: float  # m
    heading: float  # rad
    speed: float  # m/s, u
    lateral_speed: float  # m/s, w
    yaw_rate: float  # rad/s, r
    steering_angle: float  # rad, as the servo sees it
    steering_rate: float  # rad/s
    torque_left: float  # N m
    torque_right: float  # N m
    spin_left: float  # rad/s, Ω
    spin_right: float  # rad/s
    spin_front: float  # rad/s
    pitching: float  # m/s², force of the ground per mass, along, as the loads feel it
    rolling: float  # m/s², likewise aside


class SlipParameters(NamedTuple):
    """Parameters of the slipping plant; those with a direction point from O to the steered wheel."""

    model: ReducedModel
    actuators: ActuatorParameters
    tyre: TyreParameters
    mass: float  # kg, m
    weight: float  # N
    yaw_inertia: float  # kg m², J, about the centre of mass
    centre: float  # m, x_c, signed
    height: float  # m, of the centre of mass
    reach: float  # m, O to the steered wheel, signed
    turn: float  # 1, or −1 where the steered wheel is behind
    offset: float  # rad, wheel's angle minus servo's angle
    half_track: float  # m, d / 2
    agility: float  # 1/(kg m²), 1 / I_w
    radius: float  # m, R
    nominal_radius: float  # m, of which the encoders know
    resistance: float  # N m, torque of each drive wheel that overcomes rolling resistance
    open: float  # 1: both drive wheels get the mean torque
    locked: float  # 1: both drive wheels spin as one
    brake: BrakeParameters


class Contacts(NamedTuple):
    """What acts between each wheel and the ground: a load (N), or a force in the wheel's directions."""

    left: Any
    right: Any
    front: Any


@kernel
def wheel_loads(state: SlipState, p: SlipParameters) -> Contacts:
    """Normal loads (N): no wheel pulls, and together they carry the weight."""
    still = p.weight * p.centre / p.reach
    front = clip(still - p.mass * p.height * state.pitching / p.reach, 0.0, p.weight)
    half = 0.5 * (p.weight - front)
    shift = clip(0.5 * p.mass * p.height * state.rolling / p.half_track, -half, half)
    return Contacts(half - shift, half + shift, front)


@kernel
def ground_forces(state: SlipState, steer: Planar, p: SlipParameters) -> Contacts:
    """Forces (N) on the wheels; ``steer`` is the steered wheel's direction on the body."""
    load = wheel_loads(state, p)
    sine, cosine = sincos(state.heading)
    east, north = p.half_track * sine, p.half_track * cosine
    turn = p.half_track * state.yaw_rate
    swing = state.lateral_speed + p.reach * state.yaw_rate
    left = friction_at(state.x - east, state.y + north, p.tyre)
    right = friction_at(state.x + east, state.y - north, p.tyre)
    front = friction_at(state.x + p.reach * cosine, state.y + p.reach * sine, p.tyre)
    ahead = Planar(
        state.speed * steer.along + swing * steer.aside,
        swing * steer.along - state.speed * steer.aside,
    )
    beside_left = Planar(state.speed - turn, state.lateral_speed)
    beside_right = Planar(state.speed + turn, state.lateral_speed)
    return Contacts(
        tyre_force(beside_left, p.radius * state.spin_left, load.left, left, p.tyre),
        tyre_force(beside_right, p.radius * state.spin_right, load.right, right, p.tyre),
        tyre_force(ahead, p.radius * state.spin_front, load.front, front, p.tyre),
    )


@kernel
def spin_rates(state: SlipState, brake: float, grip: Contacts, p: SlipParameters) -> Contacts:
    """Ω̇ of the wheels (rad/s²): motors through the differential, rolling resistance, brake, ground."""
    mean = 0.5 * (state.torque_left + state.torque_right)
    tread_left, tread_right = p.radius * state.spin_left, p.radius * state.spin_right
    left = (mean if p.open > 0.5 else state.torque_left) - p.radius * grip.left.along
    right = (mean if p.open > 0.5 else state.torque_right) - p.radius * grip.right.along
    left = left - p.resistance * tread_left / (abs(tread_left) + CRAWL)
    right = right - p.resistance * tread_right / (abs(tread_right) + CRAWL)
    left = left - 0.5 * brake_torque(brake, tread_left, p.brake)
    right = right - 0.5 * brake_torque(brake, tread_right, p.brake)
    common = 0.5 * (left + right)
    return Contacts(
        p.agility * (common if p.locked > 0.5 else left),
        p.agility * (common if p.locked > 0.5 else right),
        -p.agility * p.radius * grip.front.along,
    )


@kernel
def slip_rates(state: SlipState, command: Command, push: Push, p: SlipParameters) -> SlipState:
    """Servo, motors, wheels, and the body under the forces of the ground: see the module."""
    now = ActuatorState(
        state.steering_angle, state.steering_rate, state.torque_left, state.torque_right
    )
    moved = actuator_rates(now, command, p.actuators)
    across, ahead = sincos(p.turn * (state.steering_angle + p.offset))
    grip = ground_forces(state, Planar(ahead, across), p)
    spin = spin_rates(state, command.brake, grip, p)
    aside = grip.front.along * across + grip.front.aside * ahead
    along = (
        grip.left.along + grip.right.along + grip.front.along * ahead - grip.front.aside * across
    )
    moment = p.half_track * (grip.right.along - grip.left.along) + p.reach * aside
    aside = aside + grip.left.aside + grip.right.aside
    yaw = (moment - p.centre * aside) / p.yaw_inertia + push.yaw_acceleration
    u, w, r = state.speed, state.lateral_speed, state.yaw_rate
    sine, cosine = sincos(state.heading)
    return SlipState(
        x=u * cosine - w * sine,
        y=u * sine + w * cosine,
        heading=r + push.yaw_rate,
        speed=along / p.mass + w * r + p.centre * r * r + push.acceleration,
        lateral_speed=aside / p.mass - u * r - p.centre * yaw + push.aside,
        yaw_rate=yaw,
        steering_angle=moved.steering_angle,
        steering_rate=moved.steering_rate,
        torque_left=moved.torque_left,
        torque_right=moved.torque_right,
        spin_left=spin.left,
        spin_right=spin.right,
        spin_front=spin.front,
        pitching=(along / p.mass - state.pitching) * (1.0 / LOAD_LAG),
        rolling=(aside / p.mass - state.rolling) * (1.0 / LOAD_LAG),
    )


@kernel
def measure_slip(state: SlipState, p: SlipParameters) -> Motion:
    """Pose and yaw rate exactly, the rest as the encoders of wheels and servo see it."""
    speed = 0.5 * p.nominal_radius * (state.spin_left + state.spin_right)
    return Motion(state.x, state.y, state.heading, speed, state.yaw_rate, state.steering_angle)


@kernel
def slip_wheels(state: SlipState, p: SlipParameters) -> Wheels:
    """What the encoders of the drive wheels see."""
    return Wheels(p.nominal_radius * state.spin_left, p.nominal_radius * state.spin_right)
