"""Nonlinear model-predictive control of the steering, by CasADi and IPOPT.

State (s, y, e, φ, φ̇) in the path frame with the servo's dynamics, at the speed driven, over a horizon of
equal steps; the cost weighs y, e and the changes of the command. Solved anew at every decision, started
from the last solution shifted by one step. The delay is looked through as in `CurvatureTracker`.
"""

from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking.contract import Road, TrackingMemory, View, foot_of
from osculate.control.tracking.external import Decide, ExternalTracker
from osculate.control.tracking.pipe import PipeParameters, look_ahead
from osculate.curve.contract import Curve
from osculate.errors import import_extra
from osculate.spec import quantity
from osculate.vehicle.motion import Motion

NODES = 800  # of the curvature's interpolation
TIGHT = 1.0  # rad, largest heading error of the prediction


class Nmpc(ExternalTracker):
    """Nonlinear model-predictive steering (extra ``mpc``)."""

    kind: Literal["nmpc"] = "nmpc"
    tunable: ClassVar[dict[str, tuple[float, float]]] = {}
    horizon: int = quantity("1", "steps of the horizon", default=15, ge=3, le=60)
    step: float = quantity("s", "length of a step", default=0.04, gt=0)
    aside_weight: float = quantity("1/m²", "weight of the cross-track error", default=400.0, gt=0)
    heading_weight: float = quantity("1/rad²", "weight of the heading error", default=4.0, ge=0)
    change_weight: float = quantity(
        "1/rad²", "weight of changes of the command", default=0.02, gt=0
    )

    def load(self) -> Any:
        """See `ExternalTracker.load`: the module of CasADi."""
        return import_extra("casadi", "mpc", "casadi")

    def decider(self, curve: Curve, road: Road, tables: NDArray[np.float64]) -> Decide:
        """See `ExternalTracker.decider`.

        Raises:
            MissingExtra: CasADi is not installed.
        """
        solver, rates, most = self._solver(curve, road)
        act, n = road.robot.actuators, self.horizon
        pipe = PipeParameters(
            act.servo(0.5 * road.period), road.robot.wheelbase, road.period, float(road.delay)
        )
        guess = np.zeros(n)

        def decide(motion: Motion, memory: TrackingMemory) -> float:
            nonlocal guess
            steering = memory.steering._replace(angle=motion.steering_angle)
            moved = memory.progress + road.period * motion.speed
            foot = foot_of(motion.x, motion.y, motion.heading, moved, road.curve, tables)
            view = View(motion, foot, steering, 0.0, memory.pending, 0.0, 1.0)
            pose = look_ahead(view, 0.0, pipe)
            ahead = foot.arc_length + road.delay * road.period * motion.speed
            foot = foot_of(pose.x, pose.y, pose.heading, ahead, road.curve, tables)
            start = [
                foot.arc_length, foot.aside, np.clip(foot.heading_error, -TIGHT, TIGHT),
                pose.steering.angle, pose.steering.rate,
            ]  # fmt: skip
            last = memory.pending[0].steering_angle
            given = [*start, max(pose.speed, 0.05), last]
            solved = solver(x0=guess, p=given, lbx=-most, ubx=most, lbg=rates[0], ubg=rates[1])
            commands = np.array(solved["x"]).ravel()
            guess = np.append(commands[1:], commands[-1])
            return float(commands[0])

        return decide

    def _solver(self, curve: Curve, road: Road) -> tuple[Any, tuple[float, float], float]:
        ca = self.load()
        robot, act = road.robot, road.robot.actuators
        margin = 2.0
        s = np.linspace(-margin, curve.length + margin, NODES)
        bend = curve.at(s % curve.length if curve.closed else s).curvature
        curvature = ca.interpolant("curvature", "bspline", [s], np.asarray(bend))
        x, u, v = ca.MX.sym("x", 5), ca.MX.sym("u"), ca.MX.sym("v")
        w, z = act.steering_frequency, act.steering_damping
        k = curvature(x[0])
        progress = v * ca.cos(x[2]) / ca.fmax(1.0 - k * x[1], 0.2)
        rates = ca.vertcat(
            progress,
            v * ca.sin(x[2]),
            v * ca.tan(x[3]) / robot.wheelbase - k * progress,
            x[4],
            w**2 * (u - x[3]) - 2.0 * z * w * x[4],
        )
        f = ca.Function("f", [x, u, v], [rates])
        h = self.step
        k1 = f(x, u, v)
        k2 = f(x + h / 2 * k1, u, v)
        k3 = f(x + h / 2 * k2, u, v)
        k4 = f(x + h * k3, u, v)
        move = ca.Function("move", [x, u, v], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
        commands, given = ca.MX.sym("commands", self.horizon), ca.MX.sym("given", 7)
        state, before, cost, turning = given[:5], given[6], ca.MX(0.0), []
        for n in range(self.horizon):
            state = move(state, commands[n], given[5])
            cost += self.aside_weight * state[1] ** 2 + self.heading_weight * state[2] ** 2
            cost += self.change_weight * (commands[n] - before) ** 2
            before = commands[n]
            turning.append(state[4])
        cost += 5.0 * self.aside_weight * state[1] ** 2
        problem = {"x": commands, "p": given, "f": cost, "g": ca.vertcat(*turning)}
        options = {
            "ipopt": {"print_level": 0, "sb": "yes", "max_iter": 25, "tol": 1e-6},
            "print_time": False,
        }
        solver = ca.nlpsol("nmpc", "ipopt", problem, options)
        rate = act.steering_rate_limit
        return solver, (-rate, rate), act.steering_angle_limit
