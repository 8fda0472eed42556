"""What people use today, in the same contract, with the same speed loop, tuned by the same optimiser.

Pure pursuit (Coulter 1992), Stanley (Hoffmann et al. 2007) on the path of the front wheel, Kanayama's
and Samson's law, the linear-quadratic regulator with curvature feed-forward, and the same regulator with
the look-ahead and servo inverse of `CurvatureTracker`.
"""

from math import sqrt
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking.contract import FREE, PathTracker, Road, SteerPart, View
from osculate.control.tracking.curvature_tracker import demand_linearly, exact_part
from osculate.curve.table import CurveTable, point_at
from osculate.kernel import Nothing, kernel
from osculate.kernel.maths import atan, sincos, wrap_angle
from osculate.spec import quantity


class PursuitParameters(NamedTuple):
    """Parameters of `steer_pursuit`."""

    wheelbase: float  # m
    shortest: float  # m
    time: float  # s


@kernel
def steer_pursuit(
    view: View,
    memory: Nothing,
    p: PursuitParameters,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Any:
    """The arc through a point of the path ahead."""
    reach = p.time * view.motion.speed
    reach = reach if reach > p.shortest else p.shortest
    goal = point_at(view.foot.arc_length + reach, curve, tables)
    dx, dy = goal.x - view.motion.x, goal.y - view.motion.y
    sine, cosine = sincos(view.motion.heading)
    aside = dy * cosine - dx * sine
    square = dx * dx + dy * dy
    bend = 2.0 * aside / (square if square > 1e-6 else 1e-6)
    return atan(p.wheelbase * bend), FREE, memory


class PurePursuit(PathTracker):
    """Steer along the arc through the point of the path that is a look-ahead distance away."""

    kind: Literal["pure-pursuit"] = "pure-pursuit"
    tunable: ClassVar[dict[str, tuple[float, float]]] = {
        "lookahead": (0.05, 2.0),
        "lookahead_time": (0.02, 1.5),
    }
    lookahead: float = quantity("m", "shortest look-ahead distance", default=0.2, gt=0)
    lookahead_time: float = quantity("s", "look-ahead distance per speed", default=0.353, ge=0)

    def steering_part(self, road: Road) -> SteerPart:
        """See `PathTracker.steering_part`."""
        parameters = PursuitParameters(road.robot.wheelbase, self.lookahead, self.lookahead_time)
        return SteerPart(steer_pursuit, parameters, Nothing())


class StanleyParameters(NamedTuple):
    """Parameters of `steer_stanley`."""

    wheelbase: float  # m
    gain: float  # 1/s
    softening: float  # m/s
    damping: float  # s, of the yaw rate


@kernel
def steer_stanley(
    view: View,
    memory: Nothing,
    p: StanleyParameters,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Any:
    """Point the wheel along the path of the front wheel, and towards it."""
    sine, cosine = sincos(view.motion.heading)
    x = view.motion.x + p.wheelbase * cosine
    y = view.motion.y + p.wheelbase * sine
    s = view.foot.arc_length
    aside = 0.0
    direction = 0.0
    for _ in range(3):
        rear = point_at(s, curve, tables)
        rear_sine, rear_cosine = sincos(rear.heading)
        slope = p.wheelbase * rear.curvature
        direction = rear.heading + atan(slope)
        front_sine, front_cosine = sincos(direction)
        dx = x - rear.x - p.wheelbase * rear_cosine
        dy = y - rear.y - p.wheelbase * rear_sine
        aside = dy * front_cosine - dx * front_sine
        s = s + (dx * front_cosine + dy * front_sine) / sqrt(1.0 + slope * slope)
    pull = atan(p.gain * aside / (p.softening + abs(view.motion.speed)))
    surplus = view.motion.yaw_rate - view.foot.curvature * view.motion.speed
    angle = wrap_angle(direction - view.motion.heading) - pull - p.damping * surplus
    return angle, FREE, memory


class Stanley(PathTracker):
    """Stanley's law, on the path that the front wheel takes when O is on the curve."""

    kind: Literal["stanley"] = "stanley"
    tunable: ClassVar[dict[str, tuple[float, float]]] = {
        "gain": (0.1, 20.0),
        "softening": (0.01, 2.0),
        "damping": (0.001, 0.5),
    }
    gain: float = quantity("1/s", "gain of the front wheel's cross-track error", default=20.0, gt=0)
    softening: float = quantity("m/s", "speed below which the gain softens", default=0.0104, ge=0)
    damping: float = quantity("s", "damping of the yaw rate", default=0.438, ge=0)

    def steering_part(self, road: Road) -> SteerPart:
        """See `PathTracker.steering_part`."""
        parameters = StanleyParameters(
            road.robot.wheelbase, self.gain, self.softening, self.damping
        )
        return SteerPart(steer_stanley, parameters, Nothing())


class FeedbackParameters(NamedTuple):
    """Parameters of `steer_kanayama` and `steer_feedforward`."""

    wheelbase: float  # m
    aside: float  # 1/m²
    heading: float  # 1/m
    lead: float  # s, feed-forward ahead of the foot


@kernel
def steer_kanayama(
    view: View,
    memory: Nothing,
    p: FeedbackParameters,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Any:
    """ω = v [κ cos e / (1 − κ y) − k_y y sin(e)/e − k_e sin e]."""
    e = view.foot.heading_error
    sine, cosine = sincos(e)
    q = 1.0 - view.foot.curvature * view.foot.aside
    small = abs(e) < 1e-6
    sinc = 1.0 if small else sine / (1.0 if small else e)
    bend = view.foot.curvature * cosine / (q if q > 0.2 else 0.2)
    bend = bend - p.aside * view.foot.aside * sinc - p.heading * sine
    return atan(p.wheelbase * bend), FREE, memory


@kernel
def steer_feedforward(
    view: View,
    memory: Nothing,
    p: FeedbackParameters,
    curve: CurveTable,
    tables: NDArray[np.float64],
) -> Any:
    """φ = atan(a κ) of the path a little ahead, plus linear feedback of y and e."""
    ahead = point_at(view.foot.arc_length + p.lead * view.motion.speed, curve, tables)
    bend = ahead.curvature - p.aside * view.foot.aside - p.heading * view.foot.heading_error
    return atan(p.wheelbase * bend), FREE, memory


class Kanayama(PathTracker):
    """The Lyapunov law of Kanayama (1990) and Samson (1993) for a path."""

    kind: Literal["kanayama"] = "kanayama"
    tunable: ClassVar[dict[str, tuple[float, float]]] = {
        "aside_gain": (0.3, 60.0),
        "heading_gain": (0.3, 20.0),
    }
    aside_gain: float = quantity("1/m²", "gain of the cross-track error", default=12.8, gt=0)
    heading_gain: float = quantity("1/m", "gain of the heading error", default=6.83, gt=0)

    def steering_part(self, road: Road) -> SteerPart:
        """See `PathTracker.steering_part`."""
        parameters = FeedbackParameters(
            road.robot.wheelbase, self.aside_gain, self.heading_gain, 0.0
        )
        return SteerPart(steer_kanayama, parameters, Nothing())


def double_integrator_gains(aside: float, heading: float, effort: float) -> tuple[float, float]:
    """Gains of y and e of the regulator of y' = e, e' = u, by `osculate.control.lqr`."""
    from osculate.control.lqr import regulator

    a = np.array([[0.0, 1.0], [0.0, 0.0]])
    solved = regulator(a, np.array([0.0, 1.0]), np.diag([aside, heading]), effort)
    return float(solved.gain[0]), float(solved.gain[1])


class FeedforwardLqr(PathTracker):
    """Linear-quadratic regulator of the kinematic errors with curvature feed-forward.

    Over arc length the lateral errors form a double integrator, whose regulator does not depend on the
    speed.
    """

    kind: Literal["lqr"] = "lqr"
    tunable: ClassVar[dict[str, tuple[float, float]]] = {
        "aside_weight": (1.0, 1e4),
        "heading_weight": (0.01, 100.0),
        "lead": (0.005, 0.4),
    }
    aside_weight: float = quantity("1/m²", "weight of the cross-track error", default=149.0, gt=0)
    heading_weight: float = quantity("1/rad²", "weight of the heading error", default=9.95, ge=0)
    effort_weight: float = quantity("m²", "weight of the curvature correction", default=1.0, gt=0)
    lead: float = quantity("s", "how far ahead the curvature is read", default=0.122, ge=0)

    def steering_part(self, road: Road) -> SteerPart:
        """See `PathTracker.steering_part`."""
        gains = double_integrator_gains(self.aside_weight, self.heading_weight, self.effort_weight)
        parameters = FeedbackParameters(road.robot.wheelbase, *gains, self.lead)
        return SteerPart(steer_feedforward, parameters, Nothing())


class PreviewLqr(PathTracker):
    """The same regulator behind the look-ahead and the servo inverse of `CurvatureTracker`.

    The default weights recover over about 0.25 m without swinging; every robot of the catalogue comes back
    from 0.6 m aside with them. Larger ones suit small robots with a fast servo.
    """

    kind: Literal["lqr-preview"] = "lqr-preview"
    tunable: ClassVar[dict[str, tuple[float, float]]] = {
        "aside_weight": (1.0, 1e4),
        "heading_weight": (0.01, 100.0),
    }
    aside_weight: float = quantity("1/m²", "weight of the cross-track error", default=256.0, gt=0)
    heading_weight: float = quantity("1/rad²", "weight of the heading error", default=32.0, ge=0)
    effort_weight: float = quantity("m²", "weight of the curvature correction", default=1.0, gt=0)
    lateral_acceleration: float = quantity(
        "m/s²", "largest lateral acceleration, corrections included", default=3.0, gt=0
    )
    horizon: float | None = quantity(
        "s", "half of the servo's inversion; by default from servo, delay and noise", default=None,
        gt=0,
    )  # fmt: skip

    def steering_part(self, road: Road) -> SteerPart:
        """See `PathTracker.steering_part`."""
        gains = double_integrator_gains(self.aside_weight, self.heading_weight, self.effort_weight)
        return exact_part(
            road,
            demand_linearly,
            horizon=self.horizon,
            lateral=self.lateral_acceleration,
            linear=gains,
        )
