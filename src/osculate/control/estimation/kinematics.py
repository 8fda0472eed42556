"""State and covariance of the estimator, and the two things a Kalman filter does with them.

Rows of the covariance are tuples shaped as the state, so that F P Fᵀ and every scalar correction are sums
of rows. All corrections of an instant share one linearisation.
"""

from typing import Any, NamedTuple

from osculate.kernel import axpy, dot, kernel, transpose


class Kinematics(NamedTuple):
    """The filter's state, or one row of its covariance."""

    x: float  # m
    y: float  # m
    heading: float  # rad, of the body
    speed: float  # m/s, of O
    steering_angle: float  # rad, of the servo
    steering_rate: float  # rad/s
    steering_bias: float  # rad, b: wheel minus servo
    speed_scale: float  # g: encoders report (1 + g) times the speed
    gyro_bias: float  # rad/s, β
    slip: float  # rad s²/m, c: slip angle of O per lateral acceleration
    understeer: float  # rad s²/m, k: understeer gradient
    swerve: float  # rad/s, δ: yaw rate that steering does not explain


class Covariance(NamedTuple):
    """Rows of a matrix, one for every entry of the state."""

    x: Kinematics
    y: Kinematics
    heading: Kinematics
    speed: Kinematics
    steering_angle: Kinematics
    steering_rate: Kinematics
    steering_bias: Kinematics
    speed_scale: Kinematics
    gyro_bias: Kinematics
    slip: Kinematics
    understeer: Kinematics
    swerve: Kinematics


class Slopes(NamedTuple):
    """Entries of F = ∂(next state)/∂(state) that are neither 0 nor 1; the angle's own in the servo."""

    x_heading: float
    x_speed: float
    x_slip: float
    y_heading: float
    y_speed: float
    y_slip: float
    turn: float  # ∂θ/∂φ = ∂θ/∂b
    turn_rate: float  # ∂θ/∂φ̇
    turn_speed: float
    turn_understeer: float
    turn_swerve: float
    swerve: float  # what is left of δ
    e11: float
    e12: float
    e21: float
    e22: float


class Clue(NamedTuple):
    """One scalar measurement, linearised."""

    slope: Kinematics  # ∂(reading)/∂(state)
    surprise: float  # reading minus expectation; not a number if there is none
    variance: float
    surprising: (
        float  # normalised innovation squared, beyond which its own square adds to the variance
    )


class Learned(NamedTuple):
    """What the clues of one instant have changed so far."""

    shift: Kinematics
    covariance: Covariance


IMPOSSIBLE = 1e12  # normalised innovation squared of what is no reading at all
_SIZE = len(Kinematics._fields)
ZERO = Kinematics(*[0.0] * _SIZE)
UNITS = Covariance(*[Kinematics(*[float(n == m) for m in range(_SIZE)]) for n in range(_SIZE)])


@kernel
def spread(c: Covariance, f: Slopes, q: Kinematics) -> Covariance:
    """F P Fᵀ + Q."""
    return widen(carry(transpose(carry(c, f)), f), q)


@kernel
def carry(c: Covariance, f: Slopes) -> Covariance:
    """F times a matrix, row by row."""
    x = axpy(f.x_slip, c.slip, axpy(f.x_speed, c.speed, axpy(f.x_heading, c.heading, c.x)))
    y = axpy(f.y_slip, c.slip, axpy(f.y_speed, c.speed, axpy(f.y_heading, c.heading, c.y)))
    heading = axpy(f.turn, c.steering_bias, axpy(f.turn, c.steering_angle, c.heading))
    heading = axpy(f.turn_rate, c.steering_rate, axpy(f.turn_speed, c.speed, heading))
    heading = axpy(f.turn_understeer, c.understeer, heading)
    heading = axpy(f.turn_swerve, c.swerve, heading)
    swerve = axpy(f.swerve, c.swerve, ZERO)
    angle = axpy(f.e11, c.steering_angle, axpy(f.e12, c.steering_rate, ZERO))
    rate = axpy(f.e21, c.steering_angle, axpy(f.e22, c.steering_rate, ZERO))
    return Covariance(
        x, y, heading, c.speed, angle, rate, c.steering_bias, c.speed_scale, c.gyro_bias, c.slip,
        c.understeer, swerve,
    )  # fmt: skip


@kernel
def widen(c: Covariance, q: Kinematics) -> Covariance:
    """The matrix with ``q`` added to its diagonal."""
    return Covariance(
        axpy(q.x, UNITS.x, c.x),
        axpy(q.y, UNITS.y, c.y),
        axpy(q.heading, UNITS.heading, c.heading),
        axpy(q.speed, UNITS.speed, c.speed),
        axpy(q.steering_angle, UNITS.steering_angle, c.steering_angle),
        axpy(q.steering_rate, UNITS.steering_rate, c.steering_rate),
        axpy(q.steering_bias, UNITS.steering_bias, c.steering_bias),
        axpy(q.speed_scale, UNITS.speed_scale, c.speed_scale),
        axpy(q.gyro_bias, UNITS.gyro_bias, c.gyro_bias),
        axpy(q.slip, UNITS.slip, c.slip),
        axpy(q.understeer, UNITS.understeer, c.understeer),
        axpy(q.swerve, UNITS.swerve, c.swerve),
    )


@kernel
def times(c: Covariance, h: Kinematics) -> Kinematics:
    """The matrix times a column."""
    return Kinematics(
        dot(c.x, h), dot(c.y, h), dot(c.heading, h), dot(c.speed, h), dot(c.steering_angle, h),
        dot(c.steering_rate, h), dot(c.steering_bias, h), dot(c.speed_scale, h),
        dot(c.gyro_bias, h), dot(c.slip, h), dot(c.understeer, h), dot(c.swerve, h),
    )  # fmt: skip


@kernel
def learn(so_far: Learned, clue: Clue) -> Any:
    """One scalar correction, and the squared normalised innovation (not a number without a reading).

    A reading that is not finite changes nothing; one that surprises too much has little weight.
    """
    c = so_far.covariance
    gain = times(c, clue.slope)
    spread = dot(clue.slope, gain) + clue.variance
    surprise = clue.surprise - dot(clue.slope, so_far.shift)
    square = surprise * surprise
    nis = square / spread
    spread = spread + (square if nis > clue.surprising else 0.0)
    believed = nis < IMPOSSIBLE
    factor = 1.0 / spread if believed else 0.0
    step = factor * surprise if believed else 0.0
    shift = axpy(step, gain, so_far.shift)
    g = axpy(-factor, gain, ZERO)
    covariance = Covariance(
        axpy(g.x, gain, c.x),
        axpy(g.y, gain, c.y),
        axpy(g.heading, gain, c.heading),
        axpy(g.speed, gain, c.speed),
        axpy(g.steering_angle, gain, c.steering_angle),
        axpy(g.steering_rate, gain, c.steering_rate),
        axpy(g.steering_bias, gain, c.steering_bias),
        axpy(g.speed_scale, gain, c.speed_scale),
        axpy(g.gyro_bias, gain, c.gyro_bias),
        axpy(g.slip, gain, c.slip),
        axpy(g.understeer, gain, c.understeer),
        axpy(g.swerve, gain, c.swerve),
    )
    return Learned(shift, covariance), nis
