"""Runs in MuJoCo: the compiled tracker at its own rate, the physics engine at its own.

The record and the metrics are those of every run; positions and speeds are MuJoCo's.
"""

from collections import deque
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.control.tracking import PathTracker, Stepper
from osculate.control.tracking.contract import foot_of
from osculate.errors import InvalidInput
from osculate.kernel import leaves
from osculate.plant import Mujoco
from osculate.scene import Scene
from osculate.simulation.blocks import Report
from osculate.simulation.clock import Sampled
from osculate.simulation.loop import SPEED_LIMIT, Setup, blank_row, with_approach
from osculate.simulation.metrics import Metrics
from osculate.simulation.records import Row
from osculate.simulation.run import Run, clearance_of
from osculate.simulation.variables import ROW
from osculate.target import Reference
from osculate.vehicle import Command, Motion

REPORTS = 100  # calls of the progress function


def run_physics(setup: Setup, scene: Scene, report: Report | None = None) -> Run:
    """Run a path tracker in MuJoCo.

    Raises:
        InvalidInput: A law that is no path tracker, or a clock that is not sampled.
        MissingExtra: MuJoCo is not installed.
    """
    law, clock, plant = setup.controller, setup.clock, setup.plant
    assert isinstance(plant, Mujoco)
    if not isinstance(law, PathTracker):
        raise InvalidInput("controller", law, "must be a path tracker on this plant")
    if not isinstance(clock, Sampled):
        raise InvalidInput(
            "clock", clock, "a path tracker decides at instants; must be Sampled(...)"
        )
    setup = with_approach(setup)
    start = setup.initial.on(setup.curve)
    robot = plant.robot(setup.robot, start, clock.step)
    stepper = Stepper(
        law, setup.curve, setup.robot, setup.limits, period=clock.period,
        delay=round(clock.delay / clock.period) * clock.period, motion=robot.measure(),
        progress=setup.initial.arc_length,
    )  # fmt: skip
    rest = Command(float(np.arctan(setup.robot.wheelbase * start.curvature)), 0.0, 0.0)
    pipe: deque[Command] = deque([rest] * (clock.delay_steps + 1), maxlen=clock.delay_steps + 1)
    decided, rows, travelled, ended = rest, [], 0.0, "time"
    for n in range(clock.steps + 1):
        motion = robot.measure()
        if n % clock.substeps == 0:
            decided = stepper.step(motion)
            if report and n % max(1, clock.steps // REPORTS) < clock.substeps:
                report(n / clock.steps)
        pipe.append(decided)
        rows.append(_row(n * clock.step, motion, pipe[0], stepper, travelled))
        if not np.isfinite(motion).all() or abs(motion.speed) > SPEED_LIMIT or robot.tipped:
            rows.pop()
            ended = "diverged"
            break
        if rows[-1][_FOOT] >= stepper.length:
            ended = "path end"
            break
        robot.step(pipe[0])
        travelled += clock.step * motion.speed
    columns = {v.name: c for v, c in zip(ROW, np.array(rows).T.copy(), strict=True)}
    metrics = _metrics(setup, scene, columns, ended)
    return Run(setup, scene, columns, metrics, _message(columns, ended), stepper.plan)


_FOOT = list(Row._fields).index("foot") - len(Row._fields)  # the last leaves are single numbers


def _row(
    time: float, motion: Motion, command: Command, stepper: Stepper, travelled: float
) -> list[float]:
    memory = stepper.memory
    foot = foot_of(
        motion.x, motion.y, motion.heading, memory.progress, stepper.table, stepper.tables
    )
    bend, wanted = foot.curvature, memory.speed.model
    reference = Reference(
        wanted, 0.0, 0.0, bend * motion.speed, 0.0, 0.0, bend, motion.heading - foot.heading_error
    )
    errors = blank_row().errors._replace(
        heading=foot.heading_error,
        yaw_rate=motion.yaw_rate - bend * motion.speed,
        speed=motion.speed - wanted,
    )
    row = Row(
        time, motion, reference, command, errors, travelled, foot.arc_length, foot.aside,
        foot.heading_error,
    )  # fmt: skip
    return list(leaves(row))


def _metrics(setup: Setup, scene: Scene, c: dict[str, NDArray[np.float64]], ended: str) -> Metrics:
    counts = c["foot"] >= setup.initial.settled
    off, turned = (np.where(counts, c[n], 0.0) for n in ("cross_track_error", "heading_error"))
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
    near = None if scene.is_empty else float(clearance_of(setup, scene, c).min())
    assert {*numbers, "clearance_min", "ended"} == {field.name for field in fields(Metrics)}
    return Metrics(**numbers, clearance_min=near, ended=ended)


def _message(c: dict[str, NDArray[np.float64]], ended: str) -> str:
    time, speed = c["time"][-1], c["speed"][-1]
    if ended == "path end":
        return f"reached the end of the path at t = {time:.3f} s, moving at {speed:.3f} m/s"
    if ended == "diverged":
        return f"diverged after t = {time:.3f} s: the robot tipped over or left all bounds"
    return f"ended after its duration of {time:.3f} s, {c['arc_length'][-1]:.4f} m on the path"
