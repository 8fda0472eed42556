"""Before a run: from which speed a robot whose steering gets stuck still stops inside its corridor.

With the steering stuck at the curvature of the path at s, the robot goes on along a circle and leaves the
corridor after the distance D(s). That it is stuck shows once the path asks for another angle, after the
distance d(s), and it stops after reacting for the time t with the deceleration b. It stays inside if

    v t + v² / (2 b) ≤ D − d,      so      v ≤ −b t + √(b² t² + 2 b (D − d)).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from osculate.curve.contract import Curve
from osculate.target.speed import Ceiling, SpeedPlan

Array = NDArray[np.float64]

NODES = 600  # places from which circles are driven
STEPS = 160  # points of each circle
NAME = "stuck steering"  # as a limit of the speed plan


@dataclass(frozen=True)
class StuckSteering:
    """Where the steering may get stuck, and what becomes of it; arrays of shape (n,) or (n, m)."""

    arc_length: Array  # m, of the places, shape (n,)
    distance: Array  # m, driven since, shape (m,)
    aside: Array  # m, distance from the curve, shape (n, m)
    unseen: Array  # m, driven before it can be noticed, shape (n,)
    half_width: float  # m
    reaction: float  # s
    deceleration: float  # m/s²

    @property
    def speeds(self) -> Array:
        """Fastest speed (m/s) from which the robot stops inside the corridor, shape (n,)."""
        outside = self.aside > self.half_width
        leaves = outside.any(axis=1)
        exit_ = np.where(leaves, self.distance[outside.argmax(axis=1)], self.distance[-1])
        room = np.maximum(exit_ - self.unseen, 0.0)
        delay = self.deceleration * self.reaction
        speed: Array = np.sqrt(delay**2 + 2.0 * self.deceleration * room) - delay
        return np.where(leaves, speed, np.inf)

    @property
    def ceiling(self) -> Ceiling:
        """The same as a limit of the speed plan."""
        speeds = np.minimum(self.speeds, 1e3)
        return Ceiling(NAME, tuple(self.arc_length.tolist()), tuple(speeds.tolist()))

    def stop(self, place: int, speed: float) -> float:
        """Distance from the curve (m) where a stop from ``speed`` (m/s) ends."""
        way = speed * self.reaction + 0.5 * speed * speed / self.deceleration
        return float(np.interp(self.unseen[place] + way, self.distance, self.aside[place]))

    def caution(self, plan: SpeedPlan) -> str | None:
        """Where a plan is too fast for a steering that gets stuck, in a sentence; None if nowhere."""
        speed = np.interp(self.arc_length, plan.arc_length, plan.speed)
        excess = np.array([self.stop(n, v) for n, v in enumerate(speed)]) - self.half_width
        worst = int(excess.argmax())
        if excess[worst] <= 0.0:
            return None
        allowed = self.speeds[worst]
        return (
            f"if the steering gets stuck at s = {self.arc_length[worst]:.3g} m the robot leaves its "
            f"corridor of ±{self.half_width:g} m by {excess[worst]:.2g} m before it stands: it drives "
            f"{speed[worst]:.2g} m/s there, {allowed:.2g} m/s would be slow enough"
        )


def foresee_stuck_steering(
    curve: Curve, *, wheelbase: float, half_width: float, reaction: float, deceleration: float,
    disobedience: float, fastest: float,
) -> StuckSteering:  # fmt: skip
    """Drive a circle from many places of a curve.

    Args:
        curve: The curve.
        wheelbase: Of the robot (m).
        half_width: Of the corridor (m).
        reaction: From the instant at which it shows to the beginning of the braking (s).
        deceleration: Of the stop (m/s²).
        disobedience: Change of the angle (rad) that has to be asked for before it shows.
        fastest: Speed (m/s) up to which to look.
    """
    s = np.linspace(0.0, curve.length, NODES)
    start = curve.at(s)
    reach = fastest * reaction + 0.5 * fastest**2 / deceleration + 2.0 * wheelbase
    distance = np.linspace(0.0, min(2.0 * reach, curve.length), STEPS)
    bend = start.curvature[:, None]
    turn = bend * distance
    heading = start.heading[:, None] + 0.5 * turn
    chord = distance * np.sinc(0.5 * turn / np.pi)
    x = start.x[:, None] + chord * np.cos(heading)
    y = start.y[:, None] + chord * np.sin(heading)
    along = s[:, None] + distance
    known = along <= curve.length
    foot = np.minimum(along, curve.length)
    aside = np.zeros_like(foot)
    for _ in range(3):
        near = curve.at(foot)
        dx, dy = x - near.x, y - near.y
        cosine, sine = np.cos(near.heading), np.sin(near.heading)
        aside = dy * cosine - dx * sine
        slack = np.maximum(1.0 - near.curvature * aside, 0.2)
        foot = np.clip(foot + (dx * cosine + dy * sine) / slack, 0.0, curve.length)
    asked = np.arctan(wheelbase * curve.at(np.minimum(along, curve.length)).curvature)
    shown = np.abs(asked - asked[:, :1]) > disobedience
    unseen = np.where(shown.any(axis=1), distance[shown.argmax(axis=1)], 0.0)
    off = np.maximum.accumulate(np.where(known, np.abs(aside), 0.0), axis=1)
    return StuckSteering(s, distance, off, unseen, half_width, reaction, deceleration)
