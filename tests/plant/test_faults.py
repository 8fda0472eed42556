"""Faults: each changes what it says, they add up, and they fit the plant or say so."""

import math

import numpy as np
import pytest

from osculate import (
    Actuated,
    Continuous,
    CurvatureTracker,
    FrictionPatch,
    Gusts,
    InvalidInput,
    Late,
    Limits,
    Mujoco,
    Payload,
    Reduced,
    Sampled,
    SensorLoss,
    Shove,
    Slip,
    Slippery,
    Slope,
    SlowServo,
    SteeringOffset,
    StuckSteering,
    WeakMotor,
    WheelWear,
    simulate,
    simulate_batch,
)
from osculate.plant import world_of
from osculate.plant.faults import STREAMS
from osculate.plant.weather import blow_all, impair, strength
from osculate.study.comparison.suite import CURVES
from osculate.vehicle import Command, Motion

HERE = Motion(0.0, 0.0, math.pi / 2.0, 1.0, 0.0, 0.0)


def test_faults_of_the_robot_add_up():
    faults = (
        Payload(mass=2.0), Payload(mass=1.0), WheelWear(loss=0.1), WheelWear(loss=0.1),
        SteeringOffset(angle=0.1), SlowServo(frequency=0.5), Late(delay=0.02), Late(delay=0.01),
    )  # fmt: skip
    world = world_of(Actuated(), faults)
    plant = world.plant
    assert (plant.payload, plant.servo, plant.steering_offset) == (3.0, 0.5, 0.1)
    assert plant.wheel_wear == pytest.approx(0.19)
    assert world.delay == pytest.approx(0.03)
    assert world.calm


def test_faults_of_the_floor():
    patch = FrictionPatch(x=1.0, y=2.0, radius=0.5, friction=0.1)
    plant = world_of(Slip(), (Slippery(friction=0.3), patch, patch)).plant
    assert plant.friction == 0.3
    assert len(plant.patches) == 2


@pytest.mark.parametrize("fault", [Payload(mass=1.0), Slippery(), SlowServo()])
def test_what_the_plant_has_not_is_refused(fault):
    with pytest.raises(InvalidInput, match="does not fit the plant Reduced, which has no"):
        world_of(Reduced(), (fault,))


def test_pushes_add_up_in_the_robots_frame():
    world = world_of(Slip(), (Slope(grade=0.1), Shove(time=1.0, duration=0.5, along=2.0, yaw=3.0)))
    pull = 9.8 * 0.1 / math.hypot(1.0, 0.1)
    early, late = (blow_all(t, HERE, world.padded_blows) for t in (0.5, 1.2))
    assert early.aside == pytest.approx(pull)  # heading north, the slope rises to the east
    assert early.acceleration == pytest.approx(0.0, abs=1e-12)
    assert (late.acceleration, late.yaw_acceleration) == pytest.approx((2.0, 3.0))


def test_gusts_have_their_size_and_change_in_their_time():
    world = world_of(Slip(), (Gusts(along=0.4, aside=0.2, time=0.5, seed=3),))
    t = np.arange(0.0, 500.0, 0.05)
    pushes = np.array([blow_all(float(x), HERE, world.padded_blows) for x in t])
    assert pushes[:, 0].std() == pytest.approx(0.4, rel=0.08)
    assert pushes[:, 3].std() == pytest.approx(0.2, rel=0.08)
    assert abs(np.diff(pushes[:, 0])).max() < 0.5  # no jumps: a tenth of a blend
    other = world_of(Slip(), (Gusts(along=0.4, seed=4),))
    assert blow_all(1.0, HERE, other.padded_blows) != blow_all(1.0, HERE, world.padded_blows)


def test_two_gusts_with_one_seed_are_independent():
    """Equal noises are not one noise of twice the size; nor are those of sensors with the same seed."""
    one, two = Gusts(along=0.4, time=0.05, seed=3), Gusts(along=0.4, time=0.05, seed=3)
    blows = world_of(Slip(), (one, two)).padded_blows
    assert blows[0].stream != blows[1].stream
    t = np.arange(0.0, 40.0, 0.05)
    first, second = (np.array([strength(x, blow)[0] for x in t]) for blow in blows)
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.12
    total = np.array([blow_all(x, HERE, blows).acceleration for x in t])
    assert total.std() == pytest.approx(0.4 * np.sqrt(2.0), rel=0.12)
    assert min(blow.stream for blow in blows) >= STREAMS  # sensors draw from those below


@pytest.mark.parametrize("plant", [Actuated(), Reduced(), Mujoco(), Slip()], ids=lambda p: p.kind)
@pytest.mark.parametrize(
    ("fault", "felt"),
    [
        (Shove(along=1.0), {"actuated", "reduced", "mujoco", "slip"}),
        (Shove(along=1.0, aside=2.0), {"mujoco", "slip"}),
        (Shove(aside=0.0, yaw=2.0), {"reduced", "mujoco", "slip"}),
        (Shove(), {"mujoco", "slip"}),
        (Gusts(), {"actuated", "reduced", "mujoco", "slip"}),
        (Gusts(aside=0.1), {"mujoco", "slip"}),
        (Slope(), {"actuated", "reduced", "mujoco", "slip"}),
        (Slope(grade=0.0), {"actuated", "reduced", "mujoco", "slip"}),
    ],
)
def test_a_push_that_a_plant_cannot_feel_is_refused(plant, fault, felt):
    if plant.kind in felt:
        assert len(world_of(plant, (fault,)).blows) == 1
    else:
        with pytest.raises(
            InvalidInput, match=f"moves nothing on the plant {type(plant).__name__}"
        ):
            world_of(plant, (fault,))


def test_actuators_fail_at_their_time():
    faults = (StuckSteering(time=2.0), WeakMotor(side="right", strength=0.25, time=1.0))
    p = world_of(Actuated(), faults).impairment
    before, now = Command(0.1, 0.0, 0.0), Command(0.3, 2.0, 2.0)
    assert impair(0.5, before, now, p) == now
    assert impair(1.0, before, now, p) == Command(0.3, 2.0, 0.5)
    assert impair(2.0, before, now, p) == Command(0.1, 2.0, 0.5)


def test_a_slope_costs_torque_and_a_batch_takes_faults_for_all_or_for_each():
    parts = {"controller": CurvatureTracker(), "limits": Limits(speed=0.5)}
    up = (Slope(grade=0.08),)
    flat = simulate(CURVES["slalom"], **parts)
    steep = simulate(CURVES["slalom"], faults=up, **parts)
    assert steep.metrics.energy > 1.2 * flat.metrics.energy
    each = simulate_batch(CURVES["slalom"], faults=[up, (Slope(grade=0.04),)], **parts)
    both = simulate_batch(CURVES["slalom"], faults=up, runs=2, **parts)
    assert each.metrics.energy[0] == both.metrics.energy[0] == steep.metrics.energy
    assert each.metrics.energy[1] < each.metrics.energy[0]


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"faults": (SensorLoss(),)}, r"a sensor fails: sensors must be Sensors"),
        ({"faults": (Late(delay=0.0005),)}, r"must add up to a multiple of step"),
        ({"faults": "nonsense"}, "must be a tuple"),
        ({"faults": ("nonsense",)}, "must be a Fault"),
        ({"plant": Slip(stiffness=1e3)}, r"clock.step = 0.001: too large for this plant"),
    ],
)
def test_what_has_no_effect_is_refused(parts, message):
    parts = {"controller": CurvatureTracker(), "clock": Sampled(delay=0.01), **parts}
    with pytest.raises(InvalidInput, match=message):
        simulate(CURVES["corner"], **parts)


def test_a_continuous_law_knows_no_instants():
    with pytest.raises(InvalidInput, match="clock must be Sampled"):
        simulate(CURVES["cycloid"], clock=Continuous(), faults=(Slope(),))
