"""A closed loop: one choice of every part, made once, before anything runs."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.control import Controller, CurvatureLaw, Errors, Start
from osculate.curve import Curve, tabulate
from osculate.kernel import Nothing, Tables, compose, leaves
from osculate.plant import Disturbance, Plant, Reduced
from osculate.plant.disturbance import DisturbanceMemory, disturb, perceive
from osculate.simulation.clock import Clock, Continuous, Sampled
from osculate.simulation.records import (
    RUNNING,
    Held,
    Parameters,
    Progress,
    Row,
    State,
    Status,
)
from osculate.simulation.tally import empty_tally
from osculate.spec import Spec, quantity
from osculate.target import Modified, Reference, Target, TargetMemory
from osculate.vehicle import Command, Motion, Tricycle

TEMPLATES = "osculate.simulation.templates"
SPEED_LIMIT = 1e5  # m/s, beyond which a run counts as diverged


class InitialState(Spec):
    """Where a run starts, relative to the start of the curve; by default on it and at rest."""

    cross_track: float = quantity("m", "lateral offset, left of the curve is positive", default=0.0)
    heading_error: float = quantity("rad", "heading minus the curve's", default=0.0)
    speed: float = quantity("m/s", "initial speed", default=0.0)
    yaw_rate: float = quantity("rad/s", "initial yaw rate", default=0.0)

    def on(self, curve: Curve) -> Start:
        """The initial state in the map frame."""
        point = curve.at(0.0)
        heading = float(point.heading)
        return Start(
            x=float(point.x) - self.cross_track * np.sin(heading),
            y=float(point.y) + self.cross_track * np.cos(heading),
            heading=heading + self.heading_error,
            speed=self.speed,
            yaw_rate=self.yaw_rate,
            curvature=float(point.curvature),
        )


class Setup(NamedTuple):
    """The objects a closed loop is made of."""

    curve: Curve
    robot: Tricycle = Tricycle()
    target: Target = Modified()
    controller: Controller = CurvatureLaw()
    plant: Plant = Reduced()
    disturbance: Disturbance = Disturbance()
    clock: Clock = Continuous()
    initial: InitialState = InitialState()


@dataclass(frozen=True)
class Loop:
    """A closed loop ready to run in any number of lanes."""

    setup: Setup
    bindings: dict[str, Any]  # what the templates are composed with
    parameters: Parameters
    initial: Progress
    tables: NDArray[np.float64]

    @cached_property
    def _engines(self) -> dict[int, Any]:
        return {}

    def engine(self, lanes: int) -> Any:
        """The compiled engine for blocks of ``lanes`` runs."""
        if lanes not in self._engines:
            self._engines[lanes] = self._compose(lanes)
        return self._engines[lanes]

    def _compose(self, lanes: int) -> Any:
        world = "sampled" if isinstance(self.setup.clock, Sampled) else "continuous"
        dynamics = compose(f"{TEMPLATES}.{world}", self.bindings)
        stepper = compose(f"{TEMPLATES}.rk4", {"rates": dynamics.rates})
        return compose(
            f"{TEMPLATES}.engine",
            {
                "decide": dynamics.decide,
                "hold": dynamics.hold,
                "respond": dynamics.respond,
                "rk4": stepper.rk4,
                "measure": self.bindings["measure"],
                "LANES": lanes,
                "SAMPLED": world == "sampled",
            },
        )


def close_loop(setup: Setup, tables: Tables | None = None) -> Loop:
    """Tabulate, solve and choose everything that a run of ``setup`` needs.

    Several loops may share their ``tables``; each then keeps the array as it was after its own.

    Raises:
        InvalidInput: Parts that do not fit each other, or a step too large for the loop.
    """
    curve, robot, clock = setup.curve, setup.robot, setup.clock
    tables = tables or Tables()
    table = tabulate(curve, tables)
    start = setup.initial.on(curve)
    plant = setup.plant.part(robot, start)
    target = setup.target.part(curve, table, robot, tables)
    control = setup.controller.part(setup.plant.model(robot), target, start, tables)
    clock.check(control.fastest_rate)
    sampled = isinstance(clock, Sampled)
    parameters = Parameters(
        plant=plant.parameters,
        disturbance=setup.disturbance.parameters(),
        pace=target.pace.parameters,
        target=target.parameters,
        control=control.parameters,
        curve=table,
        delay=float(clock.delay_steps),
        finish=curve.length if target.follows_path else math.inf,
        deadline=math.inf if target.follows_path else target.pace.duration,
        speed_limit=SPEED_LIMIT,
    )
    rest = Command(float(np.arctan(robot.wheelbase * start.curvature)), 0.0, 0.0)
    heading = float(curve.at(0.0).heading)
    state = State(
        plant.state,
        DisturbanceMemory(0.0),
        TargetMemory(0.0, heading),
        Nothing() if sampled else control.memory,
    )
    held = (
        Held(control.memory, _blank(Reference), Errors(0.0, 0.0, 0.0), (rest,) * _slots(clock))
        if isinstance(clock, Sampled)
        else Nothing()
    )
    bindings = {
        "control": control.control,
        "disturb": disturb,
        "perceive": perceive,
        "measure": plant.measure,
        "plant_rates": plant.rates,
        "refer": target.refer,
        "pace": target.pace.pace,
    }
    initial = Progress(state, held, empty_tally(0.0), Status(RUNNING, 0.0))
    return Loop(setup, bindings, parameters, initial, tables.array)


def blank_row() -> Row:
    """A row of zeros: the shape of a record."""
    return Row(0.0, _blank(Motion), _blank(Reference), _blank(Command), _blank(Errors), *[0.0] * 4)


def size(value: Any) -> int:
    """Number of leaves of a nested tuple."""
    return sum(1 for _ in leaves(value))


def _blank(kind: Any) -> Any:
    return kind(*[0.0] * len(kind._fields))


def _slots(clock: Sampled) -> int:
    """Commands to remember: a power of two, so that few delays need machine code of their own."""
    needed = -(-clock.delay_steps // clock.substeps) + 1
    return max(2, 1 << (needed - 1).bit_length())
