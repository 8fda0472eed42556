"""The plant on tyres that slip: its fields, and how finely it must be integrated."""

from typing import Literal

import numpy as np

from osculate.control.contract import Start
from osculate.kernel.maths import atan, sincos
from osculate.plant.actuated import CRAWL, ActuatedPlant
from osculate.plant.contract import PlantPart
from osculate.plant.planar import SlipParameters, SlipState, measure_slip, slip_rates, slip_wheels
from osculate.plant.tyre import Patch, TyreParameters, spots
from osculate.spec import quantity
from osculate.vehicle.brake import brake_parameters
from osculate.vehicle.tricycle import Tricycle

RK4_LIMIT = 2.785  # |λ| h beyond which RK4 amplifies a decaying mode
BRAKE_CRAWL = 0.05  # m/s, speed at which a brake has half of its size: wheels alone are light
MARGIN = 0.8  # of that limit: loads that shift stiffen a tyre by up to a quarter


class Slip(ActuatedPlant):
    """The robot with its actuators on tyres that slip."""

    kind: Literal["slip"] = "slip"
    friction: float = quantity("1", "friction of a tyre, along the wheel", default=0.8, gt=0)
    lateral_friction: float = quantity(
        "1", "friction of a tyre across the wheel, per that along it", default=1.0, gt=0
    )
    stiffness: float = quantity(
        "1", "force of a tyre per load and slip, while the slip is small", default=12.0, gt=0
    )
    creep: float = quantity(
        "m/s", "rolling speed below which slip counts as at this speed", default=0.3, gt=0
    )
    patches: tuple[Patch, ...] = ()
    differential: Literal["independent", "open", "locked"] = "independent"

    def part(self, robot: Tricycle, start: Start) -> PlantPart:
        """See `Plant.part`."""
        p = self.parameters(robot)
        angle = float(atan(robot.wheelbase * start.curvature))
        across, ahead = (float(v) for v in sincos(p.turn * (angle + p.offset)))
        yaw_rate = start.speed * across / (ahead * p.reach)
        turn = 0.0 if p.locked else p.half_track * yaw_rate
        front = start.speed * ahead + p.reach * yaw_rate * across
        state = SlipState(
            start.x, start.y, start.heading, start.speed, 0.0, yaw_rate, angle, 0.0, 0.0, 0.0,
            (start.speed - turn) / p.radius, (start.speed + turn) / p.radius, front / p.radius,
            0.0, 0.0,
        )  # fmt: skip
        return PlantPart(slip_rates, measure_slip, slip_wheels, p, state)

    def parameters(self, robot: Tricycle) -> SlipParameters:
        """The numbers for the kernels."""
        real = self.real(robot)
        a, d, radius, spin = real.wheelbase, real.track_width, real.wheel_radius, real.wheel_inertia
        mass, turn = real.weight / real.gravity, real.wheel_angle(1.0)
        carried = real.turn_inertia - spin * (a**2 + d**2 / 2.0) / radius**2
        tyre = TyreParameters(
            self.friction, self.lateral_friction**-2, self.stiffness, self.creep**2,
            spots(self.patches),
        )  # fmt: skip
        return SlipParameters(
            model=real.reduced_model(),
            actuators=robot.actuators.parameters(self.servo),
            tyre=tyre,
            mass=mass,
            weight=real.weight,
            yaw_inertia=carried - mass * real.centre_ahead**2,
            centre=turn * real.centre_ahead,
            height=real.centre_height,
            reach=turn * a,
            turn=turn,
            offset=self.steering_offset,
            half_track=d / 2.0,
            agility=1.0 / spin,
            radius=radius,
            nominal_radius=robot.wheel_radius,
            resistance=0.5 * robot.actuators.rolling_resistance * real.weight * radius,
            open=float(self.differential == "open"),
            locked=float(self.differential == "locked"),
            brake=brake_parameters(robot.brake, robot.total_mass * robot.wheel_radius, BRAKE_CRAWL),
        )

    def longest_step(self, robot: Tricycle) -> float:
        """See `Plant.longest_step`: at standstill, where the tyres are stiffest."""
        p = self.parameters(robot)
        act = p.actuators
        angles = np.linspace(0.0, act.angle_limit, 16)
        rates = [_tyre_rate(p, angle) for angle in angles]
        return MARGIN * RK4_LIMIT / max(*rates, act.damping, act.frequency, act.motor_rate)


def _tyre_rate(p: SlipParameters, angle: float) -> float:
    """The fastest rate (1/s) at which (u, w, r, Ω_left, Ω_right, Ω_front) come to rest at standstill."""
    across, ahead, side, radius = np.sin(angle), np.cos(angle), p.half_track, p.radius
    reach, centre = abs(p.reach), abs(p.centre)
    mass = np.diag([p.mass, p.mass, p.yaw_inertia + p.mass * centre**2, *[1.0 / p.agility] * 3])
    mass[1, 2] = mass[2, 1] = p.mass * centre
    front = p.weight * centre / reach
    rear = 0.5 * (p.weight - front)
    slips = np.array(
        [
            [1.0, 0.0, -side, -radius, 0.0, 0.0],
            [1.0, 0.0, side, 0.0, -radius, 0.0],
            [ahead, across, reach * across, 0.0, 0.0, -radius],
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [-across, ahead, reach * ahead, 0.0, 0.0, 0.0],
        ]
    )
    loads = np.array([rear, rear, front, 2.0 * rear, front])
    damping = slips.T @ np.diag(p.tyre.stiffness * loads / np.sqrt(p.tyre.squared_creep)) @ slips
    damping[3, 3] += p.resistance * radius / CRAWL
    damping[4, 4] += p.resistance * radius / CRAWL
    return float(np.abs(np.linalg.eigvals(np.linalg.solve(mass, damping))).max())
