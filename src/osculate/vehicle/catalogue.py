"""Robots to start from, with the reasoning behind their numbers.

The body's inertia is that of a homogeneous box about its own centre, M (L² + W²) / 12; wheels are
homogeneous discs, M r² / 2 about the axle and M r² / 4 about the vertical.
"""

from osculate.errors import choose
from osculate.vehicle.actuators import Actuators
from osculate.vehicle.brake import Brake
from osculate.vehicle.tricycle import Tricycle

#: The paper's robot (Table 1); its actuators are those of a small research robot.
PAPER = Tricycle()

#: A warehouse tugger: 1 t, wheelbase 1.2 m, body 1.6 m × 0.8 m. Two 0.5 kW drives with about 60 N m at
#: the wheel (0.6 m/s² empty), an electric steering servo that turns lock to lock in under 2 s, a spring
#: brake that stops it with 1.5 m/s² and holds it on a slope of 15 %.
TUGGER = Tricycle(
    body_mass=940.0,
    wheel_mass=20.0,
    wheel_inertia=0.4,
    wheel_yaw_inertia=0.2,
    body_inertia=250.0,
    wheelbase=1.2,
    wheel_radius=0.2,
    track_width=0.6,
    wheel_width=0.08,
    centre_height=0.5,
    centre_ahead=0.5,
    overhang=0.1,
    brake=Brake(deceleration=1.5, holding_torque=320.0),
    actuators=Actuators(
        steering_frequency=14.0,
        steering_damping=0.9,
        steering_rate_limit=1.8,
        steering_angle_limit=1.3,
        motor_lag=0.03,
        torque_limit=60.0,
        power_limit=1000.0,
        rolling_resistance=0.015,
    ),
)

#: A three-wheeled counterbalance truck of 3 t: two driven wheels under the forks, one steered wheel
#: under the counterweight. Driving forks first its order of axles is reversed: O is the driven axle,
#: the steered wheel follows behind it and turns to the other side (`Tricycle.wheel_angle`).
#: Its brake holds it on a slope of 20 %.
FORKLIFT = Tricycle(
    body_mass=2850.0,
    wheel_mass=50.0,
    wheel_inertia=1.3,
    wheel_yaw_inertia=0.66,
    body_inertia=1250.0,
    wheelbase=1.4,
    wheel_radius=0.23,
    track_width=0.95,
    wheel_width=0.18,
    centre_height=0.6,
    centre_ahead=0.75,
    overhang=0.2,
    steered="rear",
    brake=Brake(deceleration=2.0, holding_torque=1400.0),
    actuators=Actuators(
        steering_frequency=10.0,
        steering_damping=1.0,
        steering_rate_limit=1.5,
        steering_angle_limit=1.4,
        motor_lag=0.04,
        torque_limit=420.0,
        power_limit=9000.0,
        rolling_resistance=0.015,
    ),
)

VEHICLES = {"paper": PAPER, "tugger": TUGGER, "forklift": FORKLIFT}


def vehicle_named(name: str) -> Tricycle:
    """A robot of the catalogue by its name.

    Raises:
        InvalidInput: No such robot; lists the names.
    """
    return choose("robot", name, VEHICLES)
