"""The reduced dynamics, eq. (16), solved for the speed rate: one kernel for plant and controller.

With tan φ = a ω / v the steering rate is φ̇ = a (ω̇ v − ω v̇) / (v² + a² ω²), which makes (16) implicit
in v̇. With the ratio ρ = ω / v (the curvature being driven) it solves to

    v̇ = (r u₂ − J ρ ω̇) / (m + (I r² − J) ρ²),     m = M₁ r² + 2 I_w,     u₂ = T_l + T_r

where J is the coefficient of the steering term: I r² as the energies demand (then the denominator is
m alone), or I a r² as the paper prints it.
"""

from typing import NamedTuple

from osculate.kernel import kernel


class ReducedModel(NamedTuple):
    """Coefficients of the reduced dynamics."""

    wheelbase: float  # m, a
    wheel_radius: float  # m, r
    traction: float  # 1/m, 1/r: force per drive torque
    yaw_gain: float  # 1/(kg m²), c = r / (d I_w): yaw acceleration per N m of torque difference
    differential: float  # kg m², 1/c: torque difference per yaw acceleration
    drive_inertia: float  # kg m⁴ / m², m = M₁ r² + 2 I_w
    turn_inertia: float  # kg m⁴, I r²
    coupling: float  # J, coefficient of the steering term: I r² (corrected) or I a r² (printed)


@kernel
def driven_curvature(speed: float, yaw_rate: float, at_rest: float) -> float:
    """ω / v (1/m), and at standstill the curvature ``at_rest`` that the steering is set to."""
    moving = speed != 0.0
    return yaw_rate / (speed if moving else 1.0) if moving else at_rest


@kernel
def speed_rate(
    model: ReducedModel, curvature: float, yaw_acceleration: float, torque: float
) -> float:
    """v̇ (m/s²) under the total drive torque u₂ (N m), eq. (16) solved."""
    drive = model.wheel_radius * torque - model.coupling * curvature * yaw_acceleration
    return drive * (1.0 / _effective_inertia(model, curvature))  # the division starts early


@kernel
def drive_torque(
    model: ReducedModel, curvature: float, yaw_acceleration: float, acceleration: float
) -> float:
    """The total drive torque u₂ (N m) that gives v̇ (m/s²): the inverse of `speed_rate`."""
    drive = acceleration * _effective_inertia(model, curvature)
    return (drive + model.coupling * curvature * yaw_acceleration) * model.traction


@kernel
def steered_acceleration(
    model: ReducedModel, tangent: float, steering_rate: float, speed: float, torque: float
) -> float:
    """v̇ (m/s²) of a robot whose steering angle is a state of its own, eq. (16) corrected.

    Divided by a² cos² φ, eq. (16) needs only tan φ:
    (m + J tan² φ / a²) v̇ = r u₂ − J tan φ (1 + tan² φ) φ̇ v / a².
    """
    return (model.wheel_radius * torque - _swing(model, tangent, steering_rate, speed)) / _carried(
        model, tangent
    )


@kernel
def steered_torque(
    model: ReducedModel, tangent: float, steering_rate: float, speed: float, acceleration: float
) -> float:
    """The total drive torque u₂ (N m) that gives v̇ (m/s²): the inverse of `steered_acceleration`."""
    swing = _swing(model, tangent, steering_rate, speed)
    return (acceleration * _carried(model, tangent) + swing) * model.traction


@kernel
def _carried(model: ReducedModel, tangent: float) -> float:
    per_length = tangent / model.wheelbase
    return model.drive_inertia + model.turn_inertia * per_length * per_length


@kernel
def _swing(model: ReducedModel, tangent: float, steering_rate: float, speed: float) -> float:
    bend = tangent * (1.0 + tangent * tangent) / (model.wheelbase * model.wheelbase)
    return model.turn_inertia * bend * steering_rate * speed


@kernel
def _effective_inertia(model: ReducedModel, curvature: float) -> float:
    excess = model.turn_inertia - model.coupling
    return model.drive_inertia + excess * curvature * curvature


@kernel
def kinetic_energy(model: ReducedModel, speed: float, yaw_rate: float) -> float:
    """½ (M₁ + 2 I_w / r²) v² + ½ I ω² (J)."""
    twice = model.drive_inertia * speed * speed + model.turn_inertia * yaw_rate * yaw_rate
    return 0.5 * twice * model.traction * model.traction
