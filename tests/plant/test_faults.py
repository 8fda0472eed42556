"""Faults: each changes what it says, they add up, and what does not fit is explained."""

import math

import numpy as np
import pytest
from pydantic import TypeAdapter

from osculate import (
    Actuated,
    Continuous,
    CurvatureTracker,
    Cycloid,
    InvalidInput,
    Limits,
    Reduced,
    Sampled,
    Slip,
    simulate,
    simulate_batch,
)
from osculate.control import Safety
from osculate.kernel.trace import plain
from osculate.plant import (
    AnyFault,
    FrictionPatch,
    Gusts,
    Late,
    Payload,
    SensorLoss,
    Sensors,
    Shove,
    Slippery,
    Slope,
    SlowServo,
    SteeringOffset,
    StuckSteering,
    WeakMotor,
    WheelWear,
    world_of,
)
from osculate.plant.faults import HEARD, World
from osculate.plant.sensors import Outage
from osculate.plant.weather import blow_all, impair
from osculate.simulation.loop import close_loop
from osculate.simulation.run import make_setup
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import Motion
from osculate.vehicle.motion import Command

CLOCK = Sampled(period=0.01, delay=0.01, duration=2.0)
WORLD = {
    "controller": CurvatureTracker(), "plant": Actuated(), "sensors": Sensors(), "clock": CLOCK,
    "safety": Safety(disobedience=10.0), "limits": Limits(speed=1.0),
}  # fmt: skip
SLALOM = CURVES["slalom"]
blow, impaired = plain(blow_all), plain(impair)
EVERY = {
    "payload": Payload(mass=2.0), "wear": WheelWear(loss=0.1), "offset": SteeringOffset(angle=0.1),
    "servo": SlowServo(frequency=0.5), "late": Late(delay=0.02), "slope": Slope(), "gusts": Gusts(),
    "shove": Shove(), "patch": FrictionPatch(x=1, y=2), "slippery": Slippery(), "loss": SensorLoss(),
    "motor": WeakMotor(), "stuck": StuckSteering(),
}  # fmt: skip


def pushes(faults, times, motion=Motion(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)):
    """Along, aside and yaw, shape (3, times)."""
    blows = world_of(Slip(), faults).padded_blows
    found = [blow(float(t), motion, blows) for t in times]
    return np.array([(p.acceleration, p.aside, p.yaw_acceleration) for p in found]).T


def record(*faults, curve=SLALOM, **parts):
    return simulate(curve, faults=faults, **{**WORLD, **parts})


@pytest.mark.parametrize(
    ("fault", "field", "value"),
    [
        ("payload", "payload", 2.0),
        ("wear", "wheel_wear", pytest.approx(0.1)),
        ("offset", "steering_offset", 0.1),
        ("servo", "servo", 0.5),
        ("slippery", "friction", 0.3),
    ],
)
def test_a_fault_of_the_plant_changes_one_field(fault, field, value):
    plant = world_of(Slip(), [EVERY[fault]]).plant
    assert getattr(plant, field) == value
    assert plant.model_copy(update={field: getattr(Slip(), field)}) == Slip()


@pytest.mark.parametrize("name", EVERY)
def test_a_fault_changes_one_thing_of_the_world(name):
    fields = ("plant", "delay", "outages", "blows", "impairment")
    clean, world = World(Slip()), world_of(Slip(), [EVERY[name]])
    changed = [field for field in fields if getattr(world, field) != getattr(clean, field)]
    assert len(changed) == 1
    kept = TypeAdapter(AnyFault).validate_json(EVERY[name].model_dump_json())
    assert kept == EVERY[name]


def test_faults_add_up():
    faults = [
        Payload(mass=2.0), Payload(mass=3.0), WheelWear(loss=0.1), WheelWear(loss=0.2),
        SteeringOffset(angle=0.1), SteeringOffset(angle=-0.3), SlowServo(frequency=0.5),
        SlowServo(frequency=0.8), Late(delay=0.02), Late(delay=0.03), FrictionPatch(x=1, y=2),
        FrictionPatch(x=3, y=4), StuckSteering(time=5.0), StuckSteering(time=3.0),
        WeakMotor(side="left"), WeakMotor(side="right", strength=0.2, time=4.0),
        SensorLoss(sensor="gyro"), SensorLoss(sensor="pose", time=1.0, duration=2.0),
    ]  # fmt: skip
    world = world_of(Slip(payload=1.0), faults)
    plant = world.plant
    assert plant.payload == 6.0
    assert plant.wheel_wear == pytest.approx(1.0 - 0.9 * 0.8)
    assert plant.steering_offset == pytest.approx(-0.2)
    assert plant.servo == pytest.approx(0.4)
    assert world.delay == pytest.approx(0.05)
    assert [(p.x, p.y) for p in plant.patches] == [(1.0, 2.0), (3.0, 4.0)]
    assert world.impairment == (3.0, 0.0, 0.5, 4.0, 0.2)
    assert world.outages == HEARD._replace(gyro=Outage(2.0, math.inf), pose=Outage(1.0, 3.0))


def test_pushes_add_up():
    times = np.arange(0.0, 4.0, 0.13)
    parts = [Slope(grade=0.1), Shove(time=1.0, duration=0.5, aside=2.0, yaw=1.0), Gusts(yaw=0.2)]
    together = pushes(parts, times)
    alone = [pushes([part], times) for part in parts[:2]]
    # a gust's numbers depend on its place among the pushes: behind two that do nothing it is the same
    still = Slope(grade=0.0)
    assert together == pytest.approx(sum(alone) + pushes([still, still, parts[2]], times))


def test_two_gusts_are_independent():
    times = np.arange(0.0, 600.0, 0.31)
    one, two = Gusts(along=1.0, seed=3), Gusts(along=1.0, seed=3)
    first, both = pushes([one], times)[0], pushes([one, two], times)[0]
    second = both - first
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.1


@pytest.mark.parametrize(
    ("plant", "fault", "field"),
    [
        (Reduced(), "payload", "payload"),
        (Reduced(), "wear", "wheel_wear"),
        (Reduced(), "offset", "steering_offset"),
        (Reduced(), "servo", "servo"),
        (Actuated(), "patch", "patches"),
        (Actuated(), "slippery", "friction"),
    ],
)
def test_a_plant_without_what_a_fault_changes(plant, fault, field):
    name = type(plant).__name__
    with pytest.raises(InvalidInput, match=f"does not fit the plant {name}, which has no {field}"):
        world_of(plant, [EVERY[fault]])


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"faults": (SensorLoss(),), "sensors": None}, r"sensors must be Sensors\(\.\.\.\)"),
        ({"faults": (Late(delay=0.0105),)}, r"faults\.delay .*multiple of step = 0\.001 s"),
        ({"faults": ("rain",)}, "faults = 'rain': must be a Fault"),
        ({"faults": [Late()]}, "faults = .*must be a tuple"),
        ({"faults": (Slippery(),)}, "Actuated, which has no friction"),
    ],
)
def test_faults_that_do_not_fit_are_explained(parts, message):
    with pytest.raises(InvalidInput, match=message):
        simulate(SLALOM, **{**WORLD, **parts})


@pytest.mark.parametrize("fault", ["late", "slope", "gusts", "shove", "motor", "stuck"])
def test_faults_act_at_instants(fault):
    with pytest.raises(InvalidInput, match=r"act at instants; clock must be Sampled"):
        simulate(Cycloid.over(), clock=Continuous(), plant=Reduced(), faults=(EVERY[fault],))


@pytest.mark.xfail(reason="half-way between two random numbers gusts have 0.71 of their size")
@pytest.mark.parametrize("time", [0.1, 0.3, 1.0])
def test_gusts_have_the_deviations_they_state(time):
    gusts = Gusts(along=0.5, aside=0.2, yaw=0.7, time=time, seed=5)
    deviations = pushes([gusts], np.arange(0.0, 8000.0, 3.37) * time).std(axis=1)
    assert deviations == pytest.approx([0.5, 0.2, 0.7], rel=0.05)


def test_gusts_wander_within_their_time():
    time = 0.4
    times = np.arange(0.0, 1200.0, 0.37)
    now = pushes([Gusts(time=time)], times)
    assert np.abs(now.mean(axis=1)).max() < 0.05
    assert abs(np.corrcoef(now[0], now[1])[0, 1]) < 0.1
    soon, later, beyond = (
        np.corrcoef(now[0], pushes([Gusts(time=time)], times + lag)[0])[0, 1]
        for lag in (0.02, 0.4, 0.81)
    )
    assert soon > 0.97
    assert later < 0.5
    assert abs(beyond) < 0.1


def test_gusts_are_smooth():
    times = np.arange(0.0, 3.0, 1e-3)
    along = pushes([Gusts(along=1.0, time=0.3)], times)[0]
    assert (
        np.abs(np.diff(along)).max() < 1e-3 / 0.3 * 1.5 * 6.0
    )  # slope of the blend, two far numbers
    assert np.abs(np.diff(along, 2)).max() < 1e-3


def test_gusts_are_reproduced_by_their_seed():
    times = np.arange(0.0, 5.0, 0.1)
    first, again, other = (pushes([Gusts(seed=seed)], times) for seed in (1, 1, 2))
    assert (first == again).all()
    assert (first != other)[:2].all()


@pytest.mark.parametrize("heading", [0.0, 0.7, math.pi / 2, -2.0])
@pytest.mark.parametrize("direction", [0.0, 1.0])
def test_a_slope_pulls_down(heading, direction):
    slope = Slope(grade=0.1, direction=direction)
    motion = Motion(0.0, 0.0, heading, 1.0, 0.0, 0.0)
    (along,), (aside,), (yaw,) = pushes([slope], [0.0], motion)
    pull = 9.8 * math.sin(math.atan(0.1))
    assert along == pytest.approx(-pull * math.cos(heading - direction))
    assert aside == pytest.approx(pull * math.sin(heading - direction))
    assert yaw == 0.0


def test_a_shove_is_over_when_it_says():
    shove = Shove(time=1.0, duration=0.2, along=1.0, aside=2.0, yaw=3.0)
    found = pushes([shove], [0.999, 1.0, 1.199, 1.2001])
    assert found.tolist() == [[0, 1, 1, 0], [0, 2, 2, 0], [0, 3, 3, 0]]


def test_actuators_do_less_than_they_are_told():
    faults = [StuckSteering(time=2.0), WeakMotor(side="right", strength=0.5, time=1.0)]
    p = world_of(Slip(), faults).impairment
    before, told = Command(0.1, 0.0, 0.0), Command(0.3, 2.0, 4.0)
    assert impaired(0.99, before, told, p) == (0.3, 2.0, 4.0)
    assert impaired(1.0, before, told, p) == (0.3, 2.0, 2.0)
    assert impaired(2.0, before, told, p) == (0.1, 2.0, 2.0)
    both = [WeakMotor(side=side, strength=0.0) for side in ("left", "right")]
    assert impaired(0.0, before, told, world_of(Slip(), both).impairment) == (0.3, 0.0, 0.0)


def test_stuck_steering_keeps_its_angle():
    run = record(StuckSteering(time=1.0))
    time, angle = run.columns["time"], run.columns["commanded_steering_angle"]
    stuck = angle[time > 1.0 + 1e-9]
    assert len(set(stuck)) == 1
    assert len(set(angle[time < 1.0])) > 50
    assert run.columns["steering_angle"][-1] == pytest.approx(stuck[-1], abs=1e-3)


def test_a_weak_motor_halves_its_torque():
    run = record(WeakMotor(side="left", strength=0.5, time=1.0))
    time, left, right = (run.columns[name] for name in ("time", "torque_left", "torque_right"))
    late = time > 1.01 + 1e-9  # what is decided at 1 s acts a period later
    assert (left[late] == 0.5 * right[late]).all()
    assert (left[time < 1.01 - 1e-9] == right[time < 1.01 - 1e-9]).all()
    assert np.abs(right[late]).max() > 0.1


def test_a_slope_costs_torque():
    grade = 0.1
    up, level = (
        record(Slope(grade=g), clock=CLOCK.model_copy(update={"duration": 4.0})) for g in (grade, 0)
    )
    cruise = level.columns["time"] > 3.0
    more = [
        (r.columns["torque_left"] + r.columns["torque_right"])[cruise].mean() for r in (up, level)
    ]
    robot = level.setup.robot
    speeds = np.cos(up.columns["heading"][cruise]).mean()
    inertia = robot.total_mass + 2.0 * robot.wheel_inertia / robot.wheel_radius**2
    force = inertia * 9.8 * math.sin(math.atan(grade)) * speeds
    assert more[0] - more[1] == pytest.approx(force * robot.wheel_radius, rel=0.05)
    assert up.columns["speed"][cruise].mean() == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("delay", [0.0, 0.001, 0.025, 0.06])
def test_late_delays_by_exactly_what_it_says(delay):
    faults = (Late(delay=delay),) if delay else ()
    loop = close_loop(make_setup(SLALOM, None, {**WORLD, "faults": faults}))
    assert loop.parameters.delay == 10 + round(1000 * delay)
    assert len(loop.initial.held.commands) * 10 > loop.parameters.delay + 9


def test_a_late_command_acts_late():
    run, late = (record(*faults, clock=SHORT) for faults in ((), (Late(delay=0.06),)))
    name = "torque_left"
    first, delayed = (np.flatnonzero(r.columns[name])[0] for r in (run, late))
    assert (first, delayed) == (10, 70)
    assert late.columns[name][70:80].tolist() == run.columns[name][10:20].tolist()


SHORT = CLOCK.model_copy(update={"duration": 0.2})


def test_a_tuple_is_for_all_runs_and_a_list_for_each():
    seeds = {"vary": {"sensors.seed": [1.0, 1.0, 1.0]}}
    stuck = [(StuckSteering(time=t), Gusts(seed=3)) for t in (0.5, 1.0, 9.0)]
    parts = {**WORLD, "record_every": 10}
    each = simulate_batch(SLALOM, faults=stuck, **seeds, **parts)
    same = simulate_batch(SLALOM, faults=stuck[1], **seeds, **parts)
    assert (same.record == same.record[1]).all()
    assert (each.record[1] == same.record[1]).all()
    assert (each.record[0] != each.record[1]).any()
    assert (each.record[2] != each.record[1]).any()
    single = record(*stuck[1])
    for n, name in enumerate(single.columns):
        lane = same.record[0, :, n]
        assert (lane == single.columns[name][: 10 * len(lane) : 10]).all(), name


def test_runs_of_a_batch_need_the_same_kinds_of_faults():
    with pytest.raises(InvalidInput, match="run 1 .*must have the same kinds of parts"):
        simulate_batch(SLALOM, faults=[(), (StuckSteering(),)], **WORLD)
    with pytest.raises(InvalidInput, match="must have the length of"):
        simulate_batch(SLALOM, faults=[(), ()], runs=3, **WORLD)
