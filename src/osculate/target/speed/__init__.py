"""The fastest speed over arc length under all limits of robot and task, and which limit binds where.

With E(s) = v² / 2 the acceleration along the path is E' = dE/ds, and the limits are:

    speed, steering rate, lateral acceleration, tipping:   E ≤ E_max(s)
    acceleration:                                          −a_brake ≤ E' ≤ a_drive
    motor torque:   |(M + I κ²) E' + 2 I κ κ' E + F_roll| ≤ F_max        (linear in E and E')
    motor power:    the same force times v ≤ P_max
    jerk:           |v E''| ≤ j_max

E is a quadratic spline: E'' is constant in every cell, so that E' is continuous and a limit that holds for
the spline's coefficients holds between the nodes as well (`grid`). The fastest profile minimises ∫ ds / v.
The objective is linearised; 1 / v, which jerk and power are divided by, is convex in E and lies above its
tangent at the last iterate, so that the tangent is the stricter limit: every iterate keeps all limits. The
linear programmes are solved by HiGHS, a few suffice (`programme`). Speeds at the ends that cannot be
reached are refused with the distance that they need (`reach`).
"""

from osculate.target.speed.limits import Ceiling, Limits, rest_deceleration, rests_at_end
from osculate.target.speed.plan import RESTING, Begin, SpeedPlan, plan_from, plan_speed

__all__ = [
    "RESTING",
    "Begin",
    "Ceiling",
    "Limits",
    "SpeedPlan",
    "plan_from",
    "plan_speed",
    "rest_deceleration",
    "rests_at_end",
]
