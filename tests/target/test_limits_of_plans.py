"""A plan keeps every limit, between its nodes too; or it is refused with what is impossible.

The oracle knows nothing of the planner: it reads the plan as the kernels do, differentiates it in time,
and takes the forces from the vehicle's own model.
"""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from osculate import (
    Actuated,
    Chain,
    CurvatureTracker,
    FrictionPatch,
    InitialState,
    InvalidInput,
    Laps,
    Limits,
    Line,
    Mujoco,
    NoSolution,
    Parametric,
    Slip,
    Slippery,
    Spline,
    Stepper,
    Tricycle,
    plan_speed,
    simulate,
    vehicle_named,
)
from osculate.kernel import Tables, read
from osculate.kernel.trace import plain
from osculate.plant import world_of
from osculate.plant.grip import foresee_sliding
from osculate.target.speed import Begin, plan_from
from osculate.target.speed.grid import bound_cells, bound_coefficients
from osculate.vehicle import Motion
from osculate.vehicle.model import steered_torque

SLACK = 1.0 + 1e-6
FINE = 40  # samples of a cell

WAVE = Spline(points=((0, 0), (1.5, 0.5), (3, 0), (4.5, -0.5), (6, 0)))
RING = Spline(points=((0, 0), (4, -1), (6, 2), (2, 4)), loop=True)

coordinates = st.floats(-2.0, 2.0)
waypoints = st.lists(coordinates, min_size=4, max_size=8).map(
    lambda ys: Spline(points=tuple((2.5 * n, y) for n, y in enumerate(ys)))
)
corners = st.builds(
    lambda turn, radius, straight: Chain.corner(
        turn=turn, radius=radius, ramp=0.6 * turn * radius, straight=straight
    ),
    st.floats(0.4, 2.0), st.floats(1.5, 4.0), st.floats(0.5, 6.0),
)  # fmt: skip
waves = st.builds(
    lambda height, end: Parametric(x="3 * p", y=f"{height} * sin(p)", end=end),
    st.floats(0.1, 2.0), st.floats(1.0, 9.0),
)  # fmt: skip
rings = st.builds(
    lambda a, b: Spline(points=((a, 0), (0, b), (-a, 0), (0, -b)), loop=True),
    st.floats(3.0, 9.0), st.floats(3.0, 9.0),
)  # fmt: skip
lines = st.builds(lambda d: Line(distance=d), st.floats(0.3, 30.0))
curves = st.one_of(waypoints, corners, waves, rings, lines, rings.map(lambda r: Laps(track=r)))
robots = st.builds(
    lambda name, torque, power, rolling: _changed(vehicle_named(name), torque, power, rolling),
    st.sampled_from(("paper", "tugger", "forklift")),
    st.floats(0.3, 1.5), st.sampled_from((None, 0.3, 1.0)), st.floats(0.0, 0.02),
)  # fmt: skip
limits = st.builds(
    Limits,
    speed=st.floats(0.3, 4.0),
    lateral_acceleration=st.floats(0.05, 3.0),
    acceleration=st.floats(0.1, 2.0),
    deceleration=st.floats(0.1, 2.0),
    jerk=st.floats(0.1, 30.0),
    steering=st.floats(0.1, 1.0),
    torque=st.floats(0.5, 1.0),
    tipping=st.floats(0.1, 1.0),
    creep=st.floats(0.01, 0.1),
)
shares = st.one_of(st.none(), st.floats(0.0, 1.0))


def _changed(robot, torque, power, rolling):
    act = robot.actuators
    power = None if power is None else power * torque * act.torque_limit / robot.wheel_radius
    return robot.but(
        actuators=act.but(
            torque_limit=torque * act.torque_limit, power_limit=power, rolling_resistance=rolling
        )
    )


def used(plan, curve, robot, task):
    """Largest use of every limit, 1 where it binds."""
    s = np.linspace(0.0, curve.length, FINE * (len(plan.arc_length) - 1) + 1)
    energy = CubicHermiteSpline(plan.arc_length, plan.energy, plan.acceleration)(s)
    step = s[1]
    speed = np.sqrt(2.0 * energy)
    a = np.diff(energy) / step
    jerk = np.abs(np.diff(a)) / step * speed[1:-1]
    bend = curve.at(s)
    wheelbase, act = robot.wheelbase, robot.actuators
    tangent = wheelbase * bend.curvature
    rate = wheelbase * bend.curvature_rate * speed / (1.0 + tangent**2)
    model = robot.reduced_model()
    slope = np.concatenate([a[:1], 0.5 * (a[1:] + a[:-1]), a[-1:]])
    torque = steered_torque.py_func(model, tangent, rate, speed, slope)
    torque = torque + act.rolling_resistance * robot.weight * robot.wheel_radius
    uses = {
        "speed": speed / task.speed,
        "lateral": speed**2 * np.abs(bend.curvature) / task.lateral_acceleration,
        "tipping": speed**2 * np.abs(bend.curvature) / task.tipping / robot.tipping_acceleration,
        "steering rate": np.abs(rate) / task.steering / act.steering_rate_limit,
        "acceleration": a / task.acceleration,
        "deceleration": -a / task.deceleration,
        "jerk": jerk / task.jerk,
        "torque": np.abs(torque) / task.torque / (2.0 * act.torque_limit),
    }
    if act.power_limit is not None:
        power = torque * speed / robot.wheel_radius
        uses["power"] = power / task.torque / act.power_limit
    return {name: float(np.max(values)) for name, values in uses.items()}


def planned(curve, robot, task):
    """The plan and no message, or no plan and why."""
    try:
        return plan_speed(curve, robot, task), ""
    except NoSolution as refusal:
        return None, str(refusal)


@settings(max_examples=20, deadline=None)
@given(curves, robots, limits, shares, shares)
def test_every_limit_is_kept_between_the_nodes_too(curve, robot, task, first, last):
    task = task.but(
        start_speed=None if first is None else first * task.speed,
        end_speed=None if last is None else last * task.speed,
    )
    plan, refusal = planned(curve, robot, task)
    if plan is None:
        assert re.search("lower|raise|the limit is", refusal)
        return
    uses = used(plan, curve, robot, task)
    assert max(uses.values()) <= SLACK, uses
    for place, given_speed in ((0, task.start_speed), (-1, task.end_speed)):
        if given_speed is not None:
            assert plan.speed[place] == pytest.approx(max(given_speed, task.creep), rel=1e-6)
        if given_speed is not None or not curve.closed:
            assert abs(plan.acceleration[place]) < 1e-7


@pytest.mark.parametrize(("jerk", "seconds"), [(10.0, 7.7), (1.0, 8.4), (0.1, 12.4)])
def test_an_open_plan_begins_and_ends_without_acceleration(jerk, seconds):
    """A ramp from 0.05 m/s over half of the wave and back takes 12.3 s with 0.1 m/s³."""
    plan = plan_speed(WAVE, Tricycle(), Limits(speed=1.0, jerk=jerk))
    assert plan.acceleration[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert plan.duration == pytest.approx(seconds, rel=0.01)


def ramp(first, last, acceleration, jerk):
    """Distance (m) of a change of speed, by integrating the acceleration's trapezoid."""
    change = abs(last - first)
    peak = min(acceleration, math.sqrt(change * jerk))
    rise, hold = peak / jerk, change / peak - peak / jerk if peak else 0.0
    t = np.linspace(0.0, 2.0 * rise + hold, 20_001)
    a = np.minimum(np.minimum(jerk * t, peak), jerk * (t[-1] - t))
    v = first + math.copysign(1.0, last - first) * np.cumsum(a) * t[1]
    return float(np.trapezoid(v, t))


@settings(max_examples=25, deadline=None)
@given(
    wanted=st.floats(0.2, 2.0), size=st.floats(0.3, 2.0), jerk=st.floats(1.0, 30.0),
    room=st.floats(0.3, 3.0), end=st.booleans(),
)  # fmt: skip
def test_a_speed_at_an_end_is_kept_where_there_is_room_for_it(wanted, size, jerk, room, end):
    needed = ramp(wanted, 0.05, size, jerk)
    length = room * needed
    both = {"acceleration": size, "deceleration": size, "jerk": jerk, "speed": 2.0}
    task = Limits(**both, **{"end_speed" if end else "start_speed": wanted})
    strong = vehicle_named("paper")
    strong = strong.but(actuators=strong.actuators.but(torque_limit=50.0))
    if room < 0.99:
        with pytest.raises(
            NoSolution, match=r"it needs [\d.]+ m .*\([\d.]+ m within the jerk"
        ) as why:
            plan_speed(Line(distance=length), strong, task)
        (told,) = re.findall(r"\(([\d.e-]+) m within", str(why.value))
        assert float(told) == pytest.approx(needed, rel=0.01)
    elif room > 1.25:  # the grid of a short path is coarse
        plan = plan_speed(Line(distance=length), strong, task)
        assert plan.speed[-1 if end else 0] == pytest.approx(wanted, rel=1e-6)


def test_what_an_end_needs_is_told():
    short = Spline(points=((0, 0), (0.1, 0), (0.2, 0)))
    why = r"from 0\.9 m/s it needs 0\.505 m to stop \(.*\), the path has 0\.2 m; start slower"
    with pytest.raises(NoSolution, match=why):
        plan_speed(short, Tricycle(), Limits(start_speed=0.9))
    with pytest.raises(NoSolution, match=r"lateral acceleration allows .* at the start"):
        plan_speed(RING, Tricycle(), Limits(speed=3.0, start_speed=3.0, lateral_acceleration=0.5))


@pytest.mark.parametrize(
    ("initial", "limits", "error"),
    [
        ({"speed": 0.9}, {}, NoSolution),
        ({"speed": 0.9}, {"start_speed": 0.9}, NoSolution),
        ({"speed": 0.3}, {"start_speed": 0.1}, NoSolution),
        ({"speed": 0.9, "arc_length": 0.1}, {}, NoSolution),
        ({"speed": 3.0}, {}, NoSolution),
        ({}, {"start_speed": 3.0}, InvalidInput),
        ({}, {"creep": 2.0}, InvalidInput),
    ],
)
def test_a_robot_that_begins_too_fast_is_refused(initial, limits, error):
    short = Spline(points=((0, 0), (0.1, 0), (0.2, 0)))
    parts = {"controller": CurvatureTracker(), "limits": Limits(**limits)}
    with pytest.raises(error, match=r"start slower|must be at most speed"):
        simulate(short, initial=InitialState(**initial), **parts)


@pytest.mark.parametrize("curve", [WAVE, RING])
def test_a_robot_that_moves_already_is_planned_for(curve):
    start = curve.at(0.0)
    motion = Motion(float(start.x), float(start.y), float(start.heading), 0.7, 0.0, 0.0)
    resting, moving = (
        plan_from(Begin(0.0, speed), curve, Tricycle(), Limits(speed=0.8)) for speed in (0.0, 0.7)
    )
    assert moving.speed[0] >= 0.7 * (1.0 - 1e-9)
    assert moving.duration <= resting.duration
    assert max(used(moving, curve, Tricycle(), Limits(speed=0.8)).values()) <= SLACK
    stepper = Stepper(CurvatureTracker(), curve, limits=Limits(speed=0.8), motion=motion)
    assert stepper.plan.energy == pytest.approx(moving.energy)


@pytest.mark.parametrize(("place", "speed"), [(0.05, 0.6), (4.9, 0.95), (0.05, 0.1)])
def test_a_robot_that_begins_further_on_is_planned_for_from_there(place, speed):
    """Faster than planned just after the start, or while the plan brakes already; and slower."""
    task = Limits(speed=1.0, deceleration=0.5)
    usual = plan_speed(WAVE, Tricycle(), task)
    strong = task.but(deceleration=1.5)
    begin = Begin(place, speed)
    plan = plan_from(begin, WAVE, Tricycle(), strong if place > 1.0 else task)
    faster = speed > usual.at(place).speed
    assert plan.arc_length[0] == (place if faster and place < 1.0 else 0.0)
    assert plan.at(place).speed >= speed * (1.0 - 1e-9)
    tables = Tables()
    grid = plan.table(tables)
    s = np.linspace(place, WAVE.length, 101)
    told = [math.sqrt(2.0 * plain(read)(x, grid, tables.array)[0]) for x in s]
    assert told == pytest.approx(plan.at(s).speed, rel=1e-6, abs=1e-6)


def test_a_robot_that_cannot_brake_in_time_further_on_is_refused():
    with pytest.raises(NoSolution, match=r"from 0\.95 m/s it needs .* m to stop"):
        plan_from(Begin(WAVE.length - 0.5, 0.95), WAVE, Tricycle(), Limits(deceleration=0.5))


def test_limits_below_the_creeping_speed_are_kept():
    """The steering rate allows 0.03 m/s where the corner begins to turn."""
    tight = Chain.corner(turn=1.5, radius=0.5, ramp=0.1, straight=0.5)
    slow = vehicle_named("paper")
    slow = slow.but(actuators=slow.actuators.but(steering_rate_limit=0.4))
    task = Limits(creep=0.1)
    plan = plan_speed(tight, slow, task)
    assert plan.speed.min() < 0.5 * task.creep
    assert max(used(plan, tight, slow, task).values()) <= SLACK
    slower = slow.but(actuators=slow.actuators.but(steering_rate_limit=0.1))
    with pytest.raises(
        NoSolution, match=r"at s = .* m steering rate allows .* m/s, less than 0\.02"
    ):
        plan_speed(tight, slower, task)


@given(st.floats(0.05, 1.2), st.floats(0.1, 12.0), st.sampled_from(("paper", "tugger", "forklift")))
@settings(max_examples=20, deadline=None)
def test_sliding_is_foreseen_where_a_limit_is_beyond_the_grip(friction, lateral, name):
    robot = vehicle_named(name)
    task = Limits(speed=0.5, lateral_acceleration=lateral, tipping=1.0)
    plan = SLOW[name]
    across = min(lateral, robot.tipping_acceleration)
    share = 1.0 - robot.centre_ahead / robot.wheelbase
    along = min(task.acceleration, task.torque * robot.motor_deceleration)
    beyond = across > friction * robot.gravity or along > friction * robot.gravity * share
    for plant, faults in (
        (Slip(friction=friction), ()), (Mujoco(friction=friction), ()),
        (Slip(), (Slippery(friction=friction),)),
    ):  # fmt: skip
        world = world_of(plant, faults)
        told = foresee_sliding(world.plant, robot, task, WAVE, plan)
        assert (told is not None) == beyond
    rolling = foresee_sliding(Actuated(), robot, task, WAVE, plan)
    assert (rolling is not None) == (across > 0.8 * robot.gravity)


def test_a_slippery_patch_below_the_path_is_foreseen():
    plan = plan_speed(WAVE, Tricycle(), Limits())
    tight = float(WAVE.at(plan.arc_length).curvature.argmin())
    place = WAVE.at(plan.arc_length[int(tight)])
    patch = {"x": float(place.x), "y": float(place.y), "radius": 0.2, "friction": 0.02}
    on, beside = (
        world_of(Slip(), (FrictionPatch(**{**patch, "y": patch["y"] + aside}),)).plant
        for aside in (0.0, 1.0)
    )
    told = foresee_sliding(on, Tricycle(), Limits(), WAVE, plan)
    assert re.search(r"at s = .* m the plan asks for more than the floor's grip", told)
    assert foresee_sliding(beside, Tricycle(), Limits(), WAVE, plan) is None


SLOW = {
    name: plan_speed(
        WAVE, vehicle_named(name), Limits(speed=0.1, acceleration=0.02, deceleration=0.02)
    )
    for name in ("paper", "tugger", "forklift")
}


@given(
    levels=st.lists(st.floats(0.05, 3.0), min_size=3, max_size=6),
    places=st.lists(st.floats(0.02, 0.98), min_size=5, max_size=5, unique=True),
    slopes=st.one_of(
        st.just([0.0] * 6), st.lists(st.floats(-2.0, 2.0), min_size=6, max_size=6)
    ),
    around=st.booleans(),
)  # fmt: skip
def test_the_bounds_of_the_coefficients_keep_a_limit_with_jumps_between_the_samples(
    levels, places, slopes, around
):
    cells, m = 24, 8
    edges = np.sort(places)[: len(levels) - 1]

    def cap(x):
        piece = np.searchsorted(edges, x, side="right")
        return np.array(levels)[piece] * np.exp(0.3 * np.array(slopes)[piece] * x)

    x = np.linspace(0.0, 1.0, cells * m + 1)
    nodes, middle = bound_cells(cap(x), m)
    c = bound_coefficients(nodes, middle, around)
    f = np.linspace(0.0, 1.0, 41)
    spline = (
        0.5 * (1.0 - f) ** 2 * c[:-2, None]
        + (0.5 + f - f**2) * c[1:-1, None]
        + 0.5 * f**2 * c[2:, None]
    )
    inner = slice(0 if around else 1, None if around else -1)  # free ends are bounded at the node
    here = (np.arange(cells)[:, None] + f) / cells
    gap = np.abs(here[..., None] - edges).min(axis=-1) > 1.0 / (m * cells)
    assert (spline <= cap(here) * SLACK)[inner][gap[inner]].all()
    if not any(slopes):  # then no place is lower than both samples beside it
        either = np.maximum(cap(here - 1e-9), cap(here + 1e-9))  # at the very jump
        assert (spline <= either * SLACK)[inner].all()


def test_motors_too_weak_for_a_given_end_are_named():
    weak = vehicle_named("tugger")
    weak = weak.but(actuators=weak.actuators.but(torque_limit=30.0))
    with pytest.raises(
        NoSolution, match=r"with the end at 1 m/s on 1 m: motors, jerk and the other"
    ):
        plan_speed(Line(distance=1.0), weak, Limits(end_speed=1.0))


@pytest.mark.parametrize("name", ["paper", "tugger", "forklift"])
@pytest.mark.parametrize(("grip", "slides"), [(0.98, True), (1.02, False)])
def test_the_drive_wheels_carry_their_part_of_the_weight(name, grip, slides):
    robot = vehicle_named(name)
    task = Limits(speed=0.1, lateral_acceleration=0.01, acceleration=0.2, deceleration=0.2)
    share = 1.0 - robot.centre_ahead / robot.wheelbase
    plant = Slip(friction=grip * 0.2 / robot.gravity / share)
    told = foresee_sliding(plant, robot, task, WAVE, SLOW[name])
    assert ("drive wheels" in (told or "")) == slides
