"""The slipping plant: its limits, its energy, the friction of the ground, wheels and differentials."""

import math

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import (
    Actuated,
    Actuators,
    CurvatureTracker,
    Limits,
    Patch,
    Sampled,
    Slip,
    Tricycle,
    simulate,
    simulate_batch,
    vehicle_named,
)
from osculate.control.contract import Start
from osculate.kernel import axpy
from osculate.kernel.trace import plain
from osculate.plant import Push
from osculate.plant.actuated import actuated_rates
from osculate.plant.planar import SlipState, slip_rates, wheel_loads
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import Command

ROBOTS = {name: vehicle_named(name) for name in ("paper", "tugger", "forklift")}
STILL = Push(0.0, 0.0, 0.0, 0.0)
AHEAD = Start(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
CLOCK = Sampled(period=0.01, delay=0.01, duration=60.0)
SMOOTH = Actuators(rolling_resistance=0.0)
INDEPENDENT, OPEN, LOCKED = (Slip(differential=kind) for kind in ("independent", "open", "locked"))
speeds = st.floats(-5, 5)
states = st.builds(
    SlipState,
    *[speeds] * 6, st.floats(-1.2, 1.2), st.floats(-3, 3), *[speeds] * 2, *[st.floats(-99, 99)] * 3,
    *[st.floats(-20, 20)] * 2,
)  # fmt: skip
plants = st.builds(
    Slip,
    friction=st.floats(0.05, 1.5),
    lateral_friction=st.floats(0.3, 3.0),
    patches=st.just(
        (Patch(x=0, y=0, radius=1, friction=0.1), Patch(x=0, y=1, radius=2, friction=2))
    ),
    differential=st.sampled_from(["independent", "open", "locked"]),
)


def runner(rates):
    """RK4 over ``steps`` steps: steering angle · sin(rate t), torques torque · cos(rate t)."""

    @numba.njit
    def slope(t, state, p, angle, left, right, rate):
        swing, fade = np.sin(rate * t), np.cos(rate * t)
        command = Command(angle * (swing if rate > 0.0 else 1.0), left * fade, right * fade, 0.0)
        return rates(state, command, STILL, p)

    @numba.njit
    def run(state, p, angle, left, right, rate, h, steps):
        for n in range(steps):
            t, program = n * h, (p, angle, left, right, rate)
            k1 = slope(t, state, *program)
            k2 = slope(t + h / 2, axpy(h / 2, k1, state), *program)
            k3 = slope(t + h / 2, axpy(h / 2, k2, state), *program)
            k4 = slope(t + h, axpy(h, k3, state), *program)
            state = axpy(h / 6, axpy(2.0, k3, axpy(2.0, k2, axpy(1.0, k4, k1))), state)
        return state

    return run


slip_run, actuated_run = runner(slip_rates), runner(actuated_rates)


def drive(plant, seconds, *, robot=None, start=AHEAD, angle=0.0, torque=0.0, **state):
    """The state after some time of constant commands."""
    robot = robot or Tricycle(actuators=SMOOTH)
    part = plant.part(robot, start)
    h = min(1e-3, plant.longest_step(robot))
    begin = part.state._replace(**state)
    left, right = torque if isinstance(torque, tuple) else (torque, torque)
    return slip_run(begin, part.parameters, angle, left, right, 0.0, h, round(seconds / h))


def energy_rate(state, rate, p):
    """Ė (W) of E = ½ m |v_C|² + ½ J r² + ½ I_w Σ Ω²."""
    aside = state.lateral_speed + p.centre * state.yaw_rate
    power = p.mass * (state.speed * rate.speed)
    power += p.mass * aside * (rate.lateral_speed + p.centre * rate.yaw_rate)
    power += p.yaw_inertia * state.yaw_rate * rate.yaw_rate
    return power + sum(w * a for w, a in zip(state[10:13], rate[10:13], strict=True)) / p.agility


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("flaws", [{}, {"wheel_wear": 0.05, "steering_offset": 0.02, "servo": 0.7}])
def test_as_tyres_stiffen_it_becomes_the_actuated_plant(name, flaws):
    """Every part of the motion, as 1 / stiffness."""
    robot, start = ROBOTS[name], Start(0.0, 0.0, 0.3, 0.8, 0.0, 0.2)
    flaws = {**flaws, "payload": 0.3 * robot.body_mass} if flaws else {}
    torque = (0.08 if name == "paper" else 0.4) * robot.actuators.torque_limit
    rigid = Actuated(**flaws).part(robot, start)
    program = 0.4, torque, torque, 2.0
    there = actuated_run(rigid.state, rigid.parameters, *program, 2e-4, 10000)
    errors = []
    for stiffness in (24.0, 96.0, 384.0):
        plant = Slip(stiffness=stiffness, friction=50.0, **flaws)
        part = plant.part(robot, start)
        steps = math.ceil(2.0 / plant.longest_step(robot))
        here = slip_run(part.state, part.parameters, *program, 2.0 / steps, steps)
        motions = (
            part.measure(here, part.parameters),
            rigid.measure(there, rigid.parameters),
            part.wheels(here, part.parameters),
            rigid.wheels(there, rigid.parameters),
        )
        ours, theirs, treads, tracks = (np.array(motion) for motion in motions)
        errors.append([np.abs(ours - theirs).max(), np.abs(treads - tracks).max()])
    ratios = np.divide(errors[:-1], errors[1:])
    assert ratios == pytest.approx(4.0, rel=0.05)
    assert np.max(errors[-1]) < 2e-3


@given(plants, states, st.sampled_from(sorted(ROBOTS)))
def test_ground_and_tyres_never_create_energy(plant, state, name):
    """Ė ≤ torques' power, in every state; coasting it only falls."""
    robot = ROBOTS[name].model_copy(update={"actuators": SMOOTH})
    part = plant.part(robot, AHEAD)
    if plant.differential == "locked":
        state = state._replace(spin_right=state.spin_left)
    left, right = state.torque_left, state.torque_right
    if plant.differential == "open":
        left = right = 0.5 * (left + right)
    rate = part.rates(state, Command(0.0, 0.0, 0.0), STILL, part.parameters)
    gain = energy_rate(state, rate, part.parameters)
    scale = 1e-9 * (1.0 + abs(np.array(rate)).max() * part.parameters.mass * 1e2)
    assert gain <= left * state.spin_left + right * state.spin_right + scale
    coasting = part.rates(
        state._replace(torque_left=0.0, torque_right=0.0), Command(0.0, 0.0, 0.0), STILL,
        part.parameters,
    )  # fmt: skip
    assert energy_rate(state, coasting, part.parameters) <= scale


@given(plants, states)
def test_the_ground_carries_the_weight_and_no_wheel_pulls(plant, state):
    part = plant.part(Tricycle(), AHEAD)
    loads = wheel_loads(state, part.parameters)
    assert sum(loads) == pytest.approx(Tricycle().weight)
    assert min(loads) >= 0.0
    rate = part.rates(state, Command(0.0, 0.0, 0.0), STILL, part.parameters)
    force = np.hypot(rate.pitching * 0.03 + state.pitching, rate.rolling * 0.03 + state.rolling)
    roughest = max(plant.friction, 2.0) * max(1.0, plant.lateral_friction)
    assert force <= roughest * Tricycle().gravity * (1 + 1e-9)


def test_the_inner_wheel_lifts_at_the_tipping_acceleration():
    for robot in ROBOTS.values():
        part = Slip().part(robot, AHEAD)
        tipping = part.state._replace(rolling=robot.tipping_acceleration)
        assert wheel_loads(tipping, part.parameters).left == pytest.approx(0.0, abs=1e-9)
        braking = wheel_loads(part.state._replace(pitching=-1.0), part.parameters)
        shifted = part.parameters.mass * robot.centre_height / robot.wheelbase
        still = wheel_loads(part.state, part.parameters)
        assert braking.front - still.front == pytest.approx(robot.wheel_angle(shifted))


@pytest.mark.parametrize("ahead", [0.1, 0.2, 0.3])
def test_steady_turns_are_neutral_and_the_tail_hangs_out(ahead):
    """Stiffness per load: all slip angles are aᵧ / (g C), wherever the centre of mass is."""
    robot = Tricycle(centre_ahead=ahead, body_inertia=0.5, actuators=SMOOTH)
    plant = Slip(friction=2.0)
    for speed, angle in ((0.1, 0.5), (1.5, 0.1)):
        start = Start(0.0, 0.0, 0.0, speed, 0.0, math.tan(angle) / robot.wheelbase)
        end = drive(plant, 0.6, robot=robot, start=start, angle=angle)
        turning = end.speed * math.tan(angle) / robot.wheelbase
        assert end.yaw_rate == pytest.approx(turning, rel=0.01)
        slip = end.lateral_speed / np.hypot(end.speed, plant.creep)
        expected = -end.speed * end.yaw_rate / robot.gravity / plant.stiffness
        assert slip == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.3])
def test_on_slippery_ground_the_turn_is_as_wide_as_friction_allows(friction):
    start = AHEAD._replace(speed=2.5)
    end = drive(Slip(friction=friction), 0.5, start=start, angle=0.6)
    assert 0.85 * friction < end.rolling / 9.8 <= friction
    assert end.yaw_rate < 0.8 * end.speed * math.tan(0.6) / 0.4


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_over_ice_a_wheel_spins_and_the_other_turns_the_robot(side):
    """Only a locked differential brings the torque to where it grips."""
    ice = (Patch(x=0.0, y=20.05 * side, radius=20.0, friction=0.02),)
    free, shared, locked = (
        drive(Slip(patches=ice, differential=kind), 0.15, torque=0.8)
        for kind in ("independent", "open", "locked")
    )
    assert side * (free.spin_left - free.spin_right) > 2.0
    assert side * free.yaw_rate > 1e-3
    assert locked.speed > 1.05 * shared.speed


def test_differentials_share_torque_or_spin():
    command = Command(0.3, 0.0, 0.0)
    part = OPEN.part(Tricycle(), AHEAD)
    uneven = part.state._replace(torque_left=2.0, torque_right=0.5)
    even = part.state._replace(torque_left=1.25, torque_right=1.25)
    shared, mean = (part.rates(s, command, STILL, part.parameters) for s in (uneven, even))
    assert shared[3:6] + shared[10:13] == mean[3:6] + mean[10:13]
    locked = drive(LOCKED, 1.0, angle=0.4, torque=(0.4, 0.1))
    free = drive(INDEPENDENT, 1.0, angle=0.4, torque=(0.25, 0.25))
    assert locked.spin_left == locked.spin_right
    assert free.spin_right - free.spin_left == pytest.approx(0.2 * free.yaw_rate / 0.1, rel=0.1)
    assert locked.yaw_rate / locked.speed < 0.97 * free.yaw_rate / free.speed


def test_pushes_act_on_the_body():
    part = Slip().part(Tricycle(), AHEAD)
    state, p = part.state._replace(lateral_speed=0.1, yaw_rate=0.3), part.parameters
    command = Command(0.0, 0.0, 0.0)
    quiet, pushed = (part.rates(state, command, push, p) for push in (STILL, Push(1, 2, 3, 4)))
    moved = pushed._replace(x=0.0), quiet._replace(x=0.0)
    change = SlipState(*np.subtract(*moved))
    assert change.speed == pytest.approx(1.0)
    assert change.yaw_rate == pytest.approx(2.0)
    assert change.heading == pytest.approx(3.0)
    assert change.lateral_speed + p.centre * change.yaw_rate == pytest.approx(4.0)
    assert sum(np.abs(change)) == pytest.approx(1.0 + 2.0 + 3.0 + 3.6)


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("fields", [{}, {"stiffness": 30.0, "creep": 0.1, "payload": 5.0}])
def test_the_longest_step_is_stable_and_four_times_as_long_is_not(name, fields):
    robot, plant = ROBOTS[name], Slip(**fields)
    part = plant.part(robot, AHEAD._replace(speed=0.0))
    nudged = part.state._replace(spin_left=1e-6, spin_front=1e-6, lateral_speed=1e-7)

    def left_over(step):
        end = slip_run(nudged, part.parameters, 1.0, 0.0, 0.0, 0.0, step, 300)
        return max(abs(v) for v in (*end[3:6], *end[10:13]))

    longest = plant.longest_step(robot)
    assert left_over(longest) < 1e-6
    assert left_over(longest / 0.81) < 1e-6
    assert left_over(4.0 * longest) > 1e-3


def test_the_papers_robot_may_be_stepped_by_a_millisecond():
    assert Slip().longest_step(Tricycle()) >= 1e-3
    assert Actuated().longest_step(Tricycle()) == math.inf


@given(plants, states)
def test_compiled_and_plain_rates_have_the_same_bits(plant, state):
    part = plant.part(Tricycle(), AHEAD)
    args = state, Command(0.3, 1.0, -2.0), Push(0.1, 0.2, 0.3, 0.4), part.parameters
    assert part.rates(*args) == plain(slip_rates)(*args)
    assert part.measure(state, part.parameters) == part.measure.py_func(state, part.parameters)
    assert part.wheels(state, part.parameters) == part.wheels.py_func(state, part.parameters)


def test_a_lane_is_the_single_run_bit_for_bit():
    parts = {
        "plant": Slip(friction=0.5, patches=(Patch(x=3.0, y=0.3, radius=0.5, friction=0.2),)),
        "controller": CurvatureTracker(),
        "clock": CLOCK.model_copy(update={"duration": 3.0}),
        "limits": Limits(speed=1.5),
    }
    robots = [Tricycle(body_mass=mass) for mass in (2.5, 3.0)]
    batch = simulate_batch(CURVES["slalom"], robots, record_every=1, **parts)
    for n, robot in enumerate(robots):
        run = simulate(CURVES["slalom"], robot, **parts)
        for column, variable in enumerate(run.columns):
            lane = batch.record[n, :, column]
            assert (lane == run.columns[variable][: len(lane)]).all(), variable


def test_the_tracker_follows_on_slipping_tyres():
    law = {"controller": CurvatureTracker(), "clock": CLOCK, "limits": Limits(speed=1.0)}
    grip = simulate(CURVES["slalom"], plant=Slip(), **law)
    with pytest.warns(UserWarning, match=r"lateral_acceleration = 2 m/s² exceeds µ g = 1\.47 m/s²"):
        ice = simulate(CURVES["slalom"], plant=Slip(friction=0.15), **law)
    assert ice.caution is not None
    assert grip.caution is None
    assert grip.metrics.ended == ice.metrics.ended == "path end"
    assert grip.metrics.cross_track_rms < 1.5e-3
    assert ice.metrics.cross_track_rms > 1.2 * grip.metrics.cross_track_rms
