"""The robot: one steered front wheel, two driven rear wheels (Table 1)."""

import math
from functools import cached_property
from typing import Literal, NamedTuple, Self

from pydantic import model_validator

from osculate.errors import InvalidInput, choose
from osculate.spec import Spec, quantity
from osculate.vehicle.actuators import Actuators
from osculate.vehicle.brake import Brake
from osculate.vehicle.model import ReducedModel


class Footprint(NamedTuple):
    """The rectangle that the robot covers, in its own frame (origin O, x forward, y left)."""

    front: float  # m, from O to the foremost point
    rear: float  # m, from O to the rearmost point, positive
    half_width: float  # m

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """The four corners (m), counter-clockwise."""
        return (
            (-self.rear, -self.half_width),
            (self.front, -self.half_width),
            (self.front, self.half_width),
            (-self.rear, self.half_width),
        )


class Tricycle(Spec):
    """Masses, inertias and lengths of a three-wheeled robot; the defaults are the paper's (Table 1).

    The tracked point O is the middle of the rear axle, which is also the origin of ``base_link``.

    Raises:
        InvalidInput: A value is not positive, the centre of mass is not between axle and steered wheel (the
            robot would tip over standing), or the inertia is less than the masses have there.
    """

    kind: Literal["tricycle"] = "tricycle"
    body_mass: float = quantity("kg", "mass of the centre rod (body), M_b", default=3.0, gt=0)
    wheel_mass: float = quantity("kg", "mass of each wheel, M_w", default=2.0, gt=0)
    wheel_inertia: float = quantity(
        "kg m²", "inertia of a wheel about its axle, I_w", default=0.01, gt=0
    )
    wheel_yaw_inertia: float = quantity(
        "kg m²",
        "inertia of a wheel about the vertical through its centre, I_wd",
        default=0.005,
        gt=0,
    )
    body_inertia: float = quantity(
        "kg m²",
        "inertia of the body about the vertical through its own centre, midway between axle and steered "
        "wheel, I_b",
        default=0.16,
        gt=0,
    )
    wheelbase: float = quantity(
        "m", "rear-axle midpoint O to steered wheel P, a", default=0.4, gt=0
    )
    wheel_radius: float = quantity("m", "radius of the wheels, r", default=0.1, gt=0)
    track_width: float = quantity("m", "distance between the rear wheels, d", default=0.2, gt=0)
    wheel_width: float = quantity(
        "m", "width of a wheel; the footprint ends at the tyres' outer faces", default=0.04, gt=0
    )
    gravity: float = quantity("m/s²", "gravitational acceleration, g", default=9.8, gt=0)
    centre_height: float = quantity("m", "height of the centre of mass", default=0.15, gt=0)
    centre_ahead: float = quantity(
        "m", "centre of mass from the axle towards the steered wheel", default=0.2
    )
    overhang: float = quantity(
        "m",
        "from the steered wheel's and the axle's outer points to the body's ends",
        default=0.0,
        ge=0,
    )
    steered: Literal["front", "rear"] = "front"
    actuators: Actuators = Actuators()
    brake: Brake | None = None

    @model_validator(mode="after")
    def _possible(self) -> Self:
        a, x = self.wheelbase, self.centre_ahead
        if not 0.0 <= x < a:
            raise InvalidInput(
                "centre_ahead", x, f"must be from 0 to below wheelbase = {a:g} m, between axle and steered "
                "wheel: the robot would tip over standing",
            )  # fmt: skip
        if not all(0.0 < number < math.inf for number in self.reduced_model()):
            raise InvalidInput(
                "", self, "has sizes, masses or inertias that are too unequal to compute with"
            )
        needed = (self.weight / self.gravity) * x**2 - a**2 * (self.body_mass / 4 + self.wheel_mass)
        if self.body_inertia <= needed:
            raise InvalidInput(
                "body_inertia", self.body_inertia, f"must be above {needed:.6g} kg m²: masses whose centre "
                f"is centre_ahead = {x:g} m ahead of the axle have more inertia",
            )  # fmt: skip
        return self

    @cached_property
    def total_mass(self) -> float:
        """M₁ = M_b + 3 M_w + I_w / r² (kg): all masses, and the front wheel's spin."""
        return self.body_mass + 3 * self.wheel_mass + self.wheel_inertia / self.wheel_radius**2

    @cached_property
    def turn_inertia(self) -> float:
        """I (kg m²) of eq. (A7): everything that turns with the robot, about O.

        I_b is about the body's own centre, as the term (a²/4) M_b demands. The paper's value is about O
        (erratum 2); it is kept as the default so that its robot is reproduced.
        """
        return (
            self.body_inertia
            + 2 * self.wheel_yaw_inertia
            + self.wheelbase**2 / 4 * self.body_mass
            + self.track_width**2 / 2 * self.wheel_mass
            + self.wheelbase**2 * self.wheel_mass
            + (self.wheelbase / self.wheel_radius) ** 2 * self.wheel_inertia
        )

    @cached_property
    def yaw_gain(self) -> float:
        """C = r / (d I_w) of eq. (16): yaw acceleration per N m of torque difference u₁."""
        return self.wheel_radius / (self.track_width * self.wheel_inertia)

    @property
    def footprint(self) -> Footprint:
        """Rectangle around the wheels and the body."""
        steered = self.wheelbase + self.wheel_radius + self.overhang
        fixed = self.wheel_radius + self.overhang
        half_width = self.track_width / 2 + self.wheel_width / 2
        if self.steered == "rear":
            return Footprint(front=fixed, rear=steered, half_width=half_width)
        return Footprint(front=steered, rear=fixed, half_width=half_width)

    @property
    def motor_deceleration(self) -> float:
        """Deceleration (m/s²) that both motors give together at their limit, without load."""
        return 2.0 * self.actuators.torque_limit / (self.wheel_radius * self.total_mass)

    @property
    def weight(self) -> float:
        """Weight (N)."""
        return (self.body_mass + 3 * self.wheel_mass) * self.gravity

    @property
    def tipping_acceleration(self) -> float:
        """Lateral acceleration (m/s²) at which the inner drive wheel lifts.

        The robot tips about the line from its steered wheel to the outer drive wheel, which passes the
        centre of mass at (d/2) (1 − x/a) to its side.
        """
        support = self.track_width / 2 * (1.0 - self.centre_ahead / self.wheelbase)
        return self.gravity * support / self.centre_height

    def wheel_angle(self, steering_angle: float) -> float:
        """Angle (rad) of the steered wheel against the body for a steering angle of the model.

        The model steers a wheel ahead of the axle. A wheel behind it describes the same circle when it
        is turned to the other side: minus the angle.
        """
        return -steering_angle if self.steered == "rear" else steering_angle

    def reduced_model(self, form: str = "corrected") -> ReducedModel:
        """Coefficients of eq. (16), solved for v̇, for the kernels.

        Args:
            form: ``"corrected"`` (steering term I r², conserves energy) or ``"printed"`` (I a r²).
        """
        factor = choose("form", form, {"corrected": 1.0, "printed": self.wheelbase})
        turn = self.turn_inertia * self.wheel_radius**2
        return ReducedModel(
            wheelbase=self.wheelbase,
            wheel_radius=self.wheel_radius,
            traction=1.0 / self.wheel_radius,
            yaw_gain=self.yaw_gain,
            differential=1.0 / self.yaw_gain,
            drive_inertia=self.total_mass * self.wheel_radius**2 + 2 * self.wheel_inertia,
            turn_inertia=turn,
            coupling=turn * factor,
        )
