"""What is given acts or is refused: every part, every field of every part, every argument.

Parts, fields and arguments come from the signatures and the classes themselves, so that a new one is
tested, or fails here until somebody says what it does.
"""

from typing import Literal, get_args, get_origin

import numpy as np
import pytest

from osculate import (
    Actuated,
    Arc,
    Chain,
    Continuous,
    CurvatureTracker,
    Cycloid,
    Disc,
    Disturbance,
    Ekf,
    InitialState,
    Limits,
    Line,
    Mujoco,
    NoSolution,
    OsculateError,
    Projected,
    PurePursuit,
    Reduced,
    Safety,
    Sampled,
    Scene,
    Segment,
    Sensors,
    Slip,
    Slope,
    Tricycle,
    simulate,
)
from osculate.plant import AnyFault, world_of
from osculate.simulation.loop import Setup
from osculate.simulation.run import make_setup
from osculate.spec import Spec
from osculate.target import plan_speed
from osculate.vehicle import Brake

BEND = Arc(radius=1.0, angle=0.8)
CLOCK = Sampled(period=0.01, delay=0.01, duration=3.0)
LAW = {
    "curve": Cycloid(),
    "clock": Continuous(duration=1.0),
    "disturbance": Disturbance.internal(5.0, 5.0, heading_amplitude=0.1, yaw_rate_amplitude=0.1),
    "initial": InitialState(cross_track=0.1),
}
TRACKER = {"curve": BEND, "controller": CurvatureTracker(), "clock": CLOCK}
SEEN = {"pose_latency": 0.02, "pose_dropout": 0.1, "pose_outliers": 0.2, "pose_rate": 25.0}
WORLDS = {
    "law": LAW,
    "tracker": TRACKER,
    "pursuit": {**TRACKER, "controller": PurePursuit(lookahead=0.4)},
    "noisy": {**TRACKER, "sensors": Sensors(**SEEN, pose_jitter=0.02), "estimator": Ekf()},
    "mujoco": {**TRACKER, "plant": Mujoco(), "clock": CLOCK.but(duration=0.3)},
}
#: Something to be near to.
SCENE = Scene(obstacles=(Disc(x=1.0, y=-1.0, radius=0.1),))

#: Another value of every part.
OTHER = {
    "curve": Arc(radius=1.2, angle=0.8),
    "robot": Tricycle(body_mass=4.0),
    "target": Projected(),
    "controller": PurePursuit(lookahead=0.5),
    "plant": Actuated(payload=1.0),
    "disturbance": Disturbance(speed_amplitude=0.2),
    "clock": Sampled(period=0.01, delay=0.0, duration=0.3),
    "initial": InitialState(cross_track=0.05),
    "limits": Limits(acceleration=0.5),
    "sensors": Sensors(**SEEN, pose_jitter=0.02, seed=5),
    "estimator": Ekf(gate=2.0),
    "safety": Safety(half_width=0.02),
    "faults": (Slope(grade=0.03),),
}


def outcome(parts):
    """Everything a run says: record, metrics, message."""
    given = dict(parts)
    run = simulate(given.pop("curve"), given.pop("robot", None), scene=SCENE, **given)
    return (
        {name: column.tobytes() for name, column in run.columns.items()},
        run.metrics,
        run.verdict.sentence,
    )


def attempt(call):
    """What a call gives, and the package's error if it gives none."""
    try:
        return call(), None
    except OsculateError as error:
        return None, error


@pytest.fixture(scope="module")
def outcomes():
    """Of every world, made when it is needed."""
    return {}


@pytest.mark.parametrize("part", Setup._fields)
@pytest.mark.parametrize("world", ["law", "tracker", "noisy", "mujoco"])
def test_a_part_changes_the_run_or_is_refused_by_its_name(world, part, outcomes):
    if world == "mujoco":
        pytest.importorskip("mujoco")
    if world not in outcomes:
        outcomes[world] = outcome(WORLDS[world])
    other = OTHER[part]
    changed, refused = attempt(lambda: outcome({**WORLDS[world], part: other}))
    if refused is None:
        assert changed != outcomes[world]
    else:
        assert part in str(refused) or part == "controller", refused  # or what it needs is named


#: What is looked at field by field, in which world.
FIELDS = {
    "law": ("target", "controller", "plant", "disturbance", "clock", "initial"),
    "tracker": ("robot", "controller", "plant", "clock", "initial", "limits"),
    "pursuit": ("controller",),
    "noisy": ("sensors", "estimator"),
}
#: Fields that act where these worlds do not go: what they are for, and below a test of each kind.
ELSEWHERE = {
    "initial.approach": "a permission",
    "robot.steered": "the sign of the wheel's angle outside of the laws",
    "robot.brake": "for stops",
    "robot.centre_height": "tips the robot: the plan of a harder task",
    "robot.centre_ahead": "tips the robot: the plan of a harder task",
    "robot.actuators.steering_rate_limit": "the plan of a harder task",
    "robot.actuators.steering_angle_limit": "the plan of a harder task",
    "robot.actuators.torque_limit": "the plan of a harder task",
    "limits.steering": "the plan of a harder task",
    "limits.torque": "the plan of a harder task",
    "limits.tipping": "the plan of a harder task",
    "controller.lateral_acceleration": "a start far off the curve",
    "estimator.patience": "poses that are wrong several times in a row",
    "estimator.doubt": "poses that are worse than the estimator knows",
}
#: Values that need no machine code of their own, and of fields whose value says nothing about their kind.
VALUES = {
    "clock.step": [0.0005],
    "clock.period": [0.02],
    "clock.delay": [0.0],
    "clock.unknown_delay": [0.04],
    "estimator.history": [0.05, 0.02],
    "initial.arc_length": [0.1],
    "sensors.outlier_size": [0.02],
    "initial.settled": [0.2],
    "robot.brake": [Brake(deceleration=1.0, holding_torque=5.0)],
}


def alternatives(path, value, annotation):
    """Other values of a field, the likeliest first; those that are refused do not count."""
    if path in VALUES:
        return VALUES[path]
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, str):
        return [choice for choice in choices(annotation) if choice != value]
    if isinstance(value, int):
        return [value + 1]
    if isinstance(value, float):
        return [1.3 * value + 0.01, 0.7 * value, 0.3 * value, 3.0 * value]
    return [0.5, 0.1, 2.0] if value is None else []


def choices(annotation):
    if get_origin(annotation) is Literal:
        return list(get_args(annotation))
    return [choice for inner in get_args(annotation) for choice in choices(inner)]


def variants(spec, path):
    """Every field by its dotted name, with copies of the object that differ in it alone."""
    for name, info in type(spec).model_fields.items():
        here, value = f"{path}.{name}", getattr(spec, name)
        if isinstance(value, Spec):
            for inner, copies in variants(value, here):
                yield inner, [spec.but(**{name: copy}) for copy in copies]
        elif name != "kind":
            copies = []
            for other in alternatives(here, value, info.annotation):
                try:
                    copies.append(spec.but(**{name: other}))
                except OsculateError:
                    continue
            yield here, [copy for copy in copies if copy != spec]


def acts(parts, part, copies, before):
    """Whether one of the copies changes the run, or all are refused in words that tell why."""
    tried = (attempt(lambda c=copy: outcome({**parts, part: c})) for copy in copies)
    refused = 0
    for changed, error in tried:
        if error is None and changed != before:
            return True
        refused += error is not None
    return refused == len(copies) > 0


@pytest.mark.parametrize(("world", "part"), [(w, p) for w, parts in FIELDS.items() for p in parts])
def test_every_field_of_a_part_changes_the_run_or_is_refused(world, part, outcomes):
    if world not in outcomes:
        outcomes[world] = outcome(WORLDS[world])
    given = dict(WORLDS[world])
    setup = make_setup(given.pop("curve"), given.pop("robot", None), given)
    whole = getattr(setup, part)
    idle = {
        path for path, copies in variants(whole, part)
        if not acts(WORLDS[world], part, copies, outcomes[world])
    }  # fmt: skip
    assert idle <= set(ELSEWHERE)


HARD = Chain(
    segments=(
        Segment(length=0.5, curvature=-1.5, end_curvature=1.5),
        Segment(length=3.0, curvature=1.5, end_curvature=0.2),
    )
)
FAST = Limits(
    speed=9.0, lateral_acceleration=30.0, acceleration=30.0, deceleration=30.0, jerk=300.0
)


@pytest.mark.parametrize("path", [p for p, why in ELSEWHERE.items() if "harder task" in why])
def test_limits_that_do_not_bind_on_an_easy_task_bind_on_a_harder_one(path):
    part = path.split(".")[0]
    task = {"robot": Tricycle(), "limits": FAST}
    speed = plan_speed(HARD, **task).speed
    copies = dict(variants(task[part], part))[path]
    assert any((planned(HARD, {**task, part: copy}) != speed).any() for copy in copies)


def planned(curve, task):
    try:
        return plan_speed(curve, **task).speed
    except NoSolution:
        return np.array([0.0])


def test_the_largest_lateral_acceleration_bounds_the_way_back_from_far_off():
    parts = {
        "initial": InitialState(cross_track=0.5),
        "limits": Limits(start_speed=1.0),
        "clock": CLOCK,
    }
    calm, wild = (
        simulate(Line(distance=3), controller=CurvatureTracker(lateral_acceleration=a), **parts)
        for a in (0.5, 3.0)
    )
    sideways = [np.abs(r.columns["speed"] * r.columns["yaw_rate"]).max() for r in (calm, wild)]
    assert sideways[0] < 0.7 < sideways[1]


@pytest.mark.parametrize(
    ("other", "seen"),
    [
        (Ekf(doubt=0.1), {"position_noise": 0.02}),
        (Ekf(patience=1), {"pose_outliers": 0.95, "outlier_size": 0.6}),
    ],
)
def test_an_estimator_that_is_surprised(other, seen):
    sensors = WORLDS["noisy"]["sensors"].but(**seen)
    first, second = (
        outcome({**WORLDS["noisy"], "sensors": sensors, "estimator": e}) for e in (Ekf(), other)
    )
    assert first != second


FAULTS = {cls.__name__: cls for cls in get_args(get_args(AnyFault)[0])}
NEEDED = {"Payload": {"mass": 1.0}, "FrictionPatch": {"x": 0.3, "y": 0.0}}


@pytest.mark.parametrize("plant", [Actuated(), Reduced(), Slip(), Mujoco()], ids=lambda p: p.kind)
@pytest.mark.parametrize("name", FAULTS)
def test_every_field_of_a_fault_changes_the_world_or_is_refused(name, plant):
    fault = FAULTS[name](**NEEDED.get(name, {}))
    if name == "Gusts":
        fault = fault.but(along=0.2)
    before, refused = attempt(lambda: world_of(plant, (fault,)))
    if refused is not None:
        assert refused.field == "faults"
        return
    for path, copies in variants(fault, "fault"):
        assert copies, path
        for copy in copies:
            after, refused = attempt(lambda c=copy: world_of(plant, (c,)))
            assert after != before if refused is None else refused.field == "faults", path
