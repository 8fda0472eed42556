"""Runs in MuJoCo: the compiled pilot at its own rate, the physics engine at its own.

The record and the metrics are those of every run; positions and speeds are MuJoCo's.
"""

from collections import deque
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.control import Start, Stepper
from osculate.control.pilot import Insight
from osculate.control.tracking import PathTracker
from osculate.control.tracking.contract import foot_of
from osculate.errors import InvalidInput
from osculate.kernel import Nothing, compose, leaves, rebuild, zeros
from osculate.plant import Mujoco, Push, World
from osculate.scene import Scene
from osculate.simulation.blocks import Report
from osculate.simulation.clock import Sampled
from osculate.simulation.events import EventParameters, no_events, watch_events
from osculate.simulation.hits import clearance_of, find_hit, scene_of
from osculate.simulation.loop import (
    BLANK,
    SPEED_LIMIT,
    TEMPLATES,
    Setup,
    Surroundings,
    cautions,
    checked_world,
    estimator_of,
    motion_at,
    path_end,
    sampled_clock,
    surroundings,
    with_approach,
)
from osculate.simulation.metrics import ENDINGS, Metrics
from osculate.simulation.outcomes import corridor_in, describe_path
from osculate.simulation.records import DIVERGED, FINISHED, RUNNING, STOPPED, Row
from osculate.simulation.run import Run
from osculate.simulation.tally import empty_tally
from osculate.simulation.templates.engine import STANDSTILL
from osculate.simulation.variables import variables_of
from osculate.simulation.verdict import Outcome, Verdict, judge
from osculate.target import Reference
from osculate.vehicle import Command, Motion
from osculate.vehicle.measurement import NO_FIX, Measurement

REPORTS = 100  # calls of the progress function


def run_physics(setup: Setup, scene: Scene, report: Report | None = None) -> Run:
    """Run a path tracker in MuJoCo.

    Raises:
        InvalidInput: A law that is no path tracker, a clock that is not sampled, what MuJoCo has not.
        MissingExtra: MuJoCo is not installed.
    """
    if not isinstance(setup.controller, PathTracker):
        raise InvalidInput("controller", setup.controller, "must be a path tracker on this plant")
    clock = sampled_clock(setup)
    world = checked_world(setup)
    if setup.disturbance != type(setup.disturbance)():
        message = "acts on equations, not on bodies; give faults=(Gusts(...), Shove(...))"
        raise InvalidInput("disturbance", setup.disturbance, message)
    given, setup = setup, with_approach(setup)
    scene = scene_of(given, setup, scene)
    start = setup.initial.on(setup.curve)
    drive = _Drive(setup, world, clock, start, corridor_in(setup, scene))
    caution = cautions(setup, world, drive.stepper.plan, drive.stepper.caution)
    code = RUNNING
    for n in range(clock.steps + 1):
        if report and n % max(1, clock.steps // REPORTS) == 0:
            report(n / clock.steps)
        code = drive.observe(n)
        if code != RUNNING:
            break
        drive.advance()
    columns = drive.columns()
    near = None if scene.is_empty else clearance_of(setup, scene, columns)
    metrics = _metrics(setup, columns, near, ENDINGS[code])
    verdict = _verdict(setup, scene, drive, columns, code, near)
    stepper = drive.stepper
    return Run(setup, scene, columns, metrics, verdict, stepper.plan, caution)


class _Drive:
    """One run under way."""

    def __init__(
        self, setup: Setup, world: World, clock: Sampled, start: Start, corridor: EventParameters
    ) -> None:
        plant, law = world.plant, setup.controller
        assert isinstance(plant, Mujoco)
        assert isinstance(law, PathTracker)
        self.clock = clock
        self.robot = plant.robot(setup.robot, start, clock.step)
        self.senses = _Senses(surroundings(setup, world))
        self.stepper = Stepper(
            law, setup.curve, setup.robot, setup.limits, period=clock.period,
            delay=round(clock.delay / clock.period) * clock.period, motion=motion_at(setup, start),
            progress=setup.initial.arc_length, estimator=estimator_of(setup), safety=setup.safety,
        )  # fmt: skip
        self.watched = setup.sensors is not None or setup.safety is not None
        rest = Command(float(np.arctan(setup.robot.wheelbase * start.curvature)), 0.0, 0.0, 0.0)
        waits = clock.delay_steps + round(world.delay / clock.step) + 1
        self.pipe: deque[Command] = deque([rest] * waits, maxlen=waits)
        self.told, self.push = rest, Push(0.0, 0.0, 0.0, 0.0)
        self.path_end = path_end(setup.curve, setup.limits)
        self.progress, self.travelled = setup.initial.arc_length, 0.0
        self.insight: Any = Nothing()
        self.corridor, self.events = corridor, no_events(start.x, start.y)
        self.tipped = False
        self.wanted = 0.0  # m/s, speed that the law aims at
        self.rows: list[list[float]] = []

    def observe(self, n: int) -> float:
        """Decide if it is time to, keep a row; whether and how the run has ended."""
        motion = self.robot.measure()
        t = n * self.clock.step
        if n % self.clock.substeps == 0:
            self._decide(t, motion)
        self.pipe.append(self.told)
        self.tipped = self.robot.tipped
        if not np.isfinite(motion).all() or abs(motion.speed) > SPEED_LIMIT or self.tipped:
            return DIVERGED
        row = self._row(t, motion)
        self._watch(row, motion)
        self.rows.append(list(leaves(row)))
        self.progress = row.foot
        if row.foot >= self.path_end:
            return FINISHED
        if abs(motion.speed) < STANDSTILL and self.stepper.arrived:
            return FINISHED
        stopped = self.stepper.stopping and abs(motion.speed) < STANDSTILL
        return STOPPED if stopped else RUNNING

    def _watch(self, row: Row, motion: Motion) -> None:
        elapsed = self.clock.step if self.rows else 0.0
        tally = empty_tally(row.foot)._replace(
            cross_track=row.cross_track, heading_error=row.heading_error
        )
        self.events = watch_events(row.time, elapsed, motion, tally, self.events, self.corridor)

    def _decide(self, t: float, motion: Motion) -> None:
        seen = self.senses.sense(motion, self.robot.wheels())
        decided = self.stepper.step(seen)
        self.wanted = self.stepper.memory.speed.model
        self.told, self.push = self.senses.act(t, motion, self.told, decided)
        if not self.watched:
            return
        belief, alarm = self.stepper.belief, float(self.stepper.intervention)
        m = motion if belief is None else belief.mean
        why = self.stepper.alarm
        self.insight = Insight(m.x, m.y, m.heading, m.speed, alarm, why.excess, why.cause)

    def advance(self) -> None:
        """One step of the engine."""
        before = self.robot.measure().speed
        self.robot.step(self.pipe[0], self.push)
        self.travelled += self.clock.step * before

    def _row(self, time: float, motion: Motion) -> Row:
        stepper = self.stepper
        foot = foot_of(
            motion.x, motion.y, motion.heading, self.progress, stepper.table, stepper.tables
        )
        bend, wanted = foot.curvature, self.wanted
        reference = Reference(
            wanted, 0.0, 0.0, bend * motion.speed, 0.0, 0.0, bend,
            motion.heading - foot.heading_error,
        )  # fmt: skip
        errors = BLANK.errors._replace(
            heading=foot.heading_error,
            yaw_rate=motion.yaw_rate - bend * motion.speed,
            speed=motion.speed - wanted,
        )
        return Row(
            time, motion, reference, self.pipe[0], errors, self.travelled, foot.arc_length,
            foot.aside, foot.heading_error, self.insight,
        )  # fmt: skip

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """The record by the names of its variables."""
        known = variables_of(BLANK._replace(insight=self.insight))
        table = np.array(self.rows).T.copy()
        return {v.name: c for v, c in zip(known, table, strict=False)}


class _Senses:
    """The compiled sensors, pushes and actuator faults of one run."""

    def __init__(self, around: Surroundings) -> None:
        self._noisy = around.sensors != Nothing()
        likes = {
            "LIKE_SENSORS": around.sensors, "LIKE_MEMORY": around.memory,
            "LIKE_BLOWS": around.blows, "LIKE_IMPAIRMENT": around.impairment,
        }  # fmt: skip
        shapes = {name: zeros(value) for name, value in likes.items()}
        self._engine = compose(f"{TEMPLATES}.surroundings", {**around.bindings, **shapes})
        self._sensors, self._memory, self._blows, self._impairment = map(_column, likes.values())
        nothing = Motion(*[0.0] * 6)
        self._seen = _column(Measurement(0.0, 0.0, 0.0, 0.0, NO_FIX) if self._noisy else nothing)
        self._push = np.zeros((4, 1))

    def sense(self, motion: Motion, wheels: Any) -> Any:
        """What is reported: a `Measurement`, or the motion itself."""
        if not self._noisy:
            return motion
        self._engine.sense_once(
            _column(motion), _column(wheels), self._memory, self._sensors, self._seen
        )
        values = iter(self._seen[:, 0].tolist())
        return rebuild(Measurement(0.0, 0.0, 0.0, 0.0, NO_FIX), values)

    def act(self, t: float, motion: Motion, before: Command, decided: Command) -> Any:
        """What the actuators are told, and what pushes the robot."""
        told = _column(decided)
        self._engine.act_once(
            t, _column(motion), _column(before), told, self._blows, self._impairment, self._push
        )
        return Command(*told[:, 0].tolist()), Push(*self._push[:, 0].tolist())


def _column(value: Any) -> NDArray[np.float64]:
    return np.array(list(leaves(value)), dtype=float).reshape(-1, 1)


def _metrics(
    setup: Setup, c: dict[str, NDArray[np.float64]], clearance: Any, ended: str
) -> Metrics:
    counts = c["foot"] >= setup.initial.settled
    uncounted = 0.0 if counts.any() else np.nan
    off, turned = (
        np.where(counts, c[n], uncounted) for n in ("cross_track_error", "heading_error")
    )
    samples = max(int(counts.sum()), 1)
    end = setup.curve.at(setup.curve.length)
    step = float(setup.clock.step)
    torque = c["torque_left"] + c["torque_right"]
    values: dict[str, Any] = {
        "path_length": setup.curve.length,
        "travelled": c["arc_length"][-1],
        "duration": c["time"][-1],
        "cross_track_rms": np.sqrt((off**2).sum() / samples),
        "cross_track_max": np.abs(off).max(),
        "heading_error_rms": np.sqrt((turned**2).sum() / samples),
        "heading_error_max": np.abs(turned).max(),
        "speed_max": np.abs(c["speed"]).max(),
        "steering_angle_max": np.abs(c["steering_angle"]).max(),
        "steering_rate_max": np.abs(np.diff(c["steering_angle"])).max(initial=0.0) / step,
        "torque_left_max": np.abs(c["torque_left"]).max(),
        "torque_right_max": np.abs(c["torque_right"]).max(),
        "steering_travel": np.abs(np.diff(c["steering_angle"])).sum(),
        "torque_travel": np.abs(np.diff(torque, prepend=0.0)).sum(),
        "energy": step * np.abs(torque * c["speed"]).sum() / setup.robot.wheel_radius,
        "end_position_error": np.hypot(c["x"][-1] - end.x, c["y"][-1] - end.y),
    }
    numbers = {name: float(value) for name, value in values.items()}
    near = None if clearance is None else float(clearance.min())
    assert {*numbers, "clearance_min", "ended"} == {field.name for field in fields(Metrics)}
    return Metrics(**numbers, clearance_min=near, ended=ended)


def _verdict(
    setup: Setup, scene: Scene, drive: _Drive, c: dict[str, NDArray[np.float64]], code: float,
    clearance: Any,
) -> Verdict:  # fmt: skip
    last = {name: float(values[-1]) for name, values in c.items()}
    outcome = Outcome(
        code=code,
        tipped=float(drive.tipped),
        place=last["foot"],
        cross_track=last["cross_track_error"],
        intervention=last.get("intervention", 0.0),
        excess=last.get("corridor_excess", 0.0),
        cause=last.get("intervention_cause", 0.0),
        stop=float(drive.stepper.memory.stop.alarm.reason) if code == STOPPED else 0.0,
        slid=drive.events.slid,
        first=drive.events.first,
        **{name: last[name] for name in ("time", "arc_length", "x", "y", "speed")},
        **describe_path(setup, scene, drive.corridor.half_width),
    )
    hit = None if clearance is None else find_hit(setup, scene, c, clearance)
    return judge(outcome, hit)
