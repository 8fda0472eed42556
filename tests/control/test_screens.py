"""Each gate before the estimator's belief, alone: what passes, what does not, and where the border is."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import Ekf
from osculate.control.contract import Start
from osculate.control.estimation import gates, readings
from osculate.control.estimation.belief import Place
from osculate.control.estimation.gates import UNHEARD, GateMemory
from osculate.control.estimation.kinematics import ZERO, Covariance
from osculate.control.safety import watch
from osculate.control.safety.watch import UNSEEN
from osculate.kernel.trace import plain
from osculate.vehicle.catalogue import VEHICLES
from osculate.vehicle.measurement import FARTHEST, TURNS, Fix, Measurement
from osculate.vehicle.motion import Motion

P = {
    name: Ekf().part(robot, Start(0, 0, 0, 0, 0, 0), 0.01).parameters
    for name, robot in VEHICLES.items()
}
robots = st.sampled_from(list(P))
sides = st.sampled_from((-1.0, 1.0))
speeds, angles = st.floats(-2.0, 2.0), st.floats(-1.0, 1.0)
BAD = st.sampled_from((math.nan, math.inf, -math.inf, 1e300, -1e300))
NEVER = (math.nan, math.inf, -math.inf)


def moving(speed=0.0, **fields):
    return ZERO._replace(speed=speed, **fields)


def wheels_of(m, yaw_rate, track):
    """What the encoders of a robot say that moves as it is expected to."""
    scale = 1.0 + m.speed_scale
    return scale * (m.speed - 0.5 * track * yaw_rate), scale * (m.speed + 0.5 * track * yaw_rate)


@given(
    robot=robots, speed=speeds, rate=st.floats(-2.0, 2.0), wear=st.floats(-0.05, 0.05), side=sides
)
def test_wheels_pass_up_to_their_border(robot, speed, rate, wear, side):
    p = P[robot].gates
    m = moving(speed, speed_scale=wear)
    left, right = wheels_of(m, rate, p.track)
    allowed = p.wheels + p.part * abs(speed)

    def passes(a, b):
        z = Measurement(left + a, right + b, 0.0, 0.0, Fix(0, 0, 0, 0))
        return plain(gates.screen_wheels)(z, m, rate, p)

    near, far = 0.999 * side * allowed, 1.001 * side * allowed
    assert passes(near, near)
    assert not passes(far, far)
    assert passes(-near, near)
    assert not passes(-far, far)
    assert not passes(2.002 * side * allowed, 0.0)
    for value in NEVER:
        assert not passes(value, 0.0)
        assert not passes(0.0, value)


@given(
    robot=robots,
    rate=st.floats(-2.0, 2.0),
    bias=st.floats(-0.02, 0.02),
    side=sides,
    gap=st.floats(3, 9),
)
def test_a_gyro_has_to_agree_with_the_steering_or_the_wheels(robot, rate, bias, side, gap):
    p, m = P[robot].gates, moving(1.0, gyro_bias=bias)
    allowed = p.gyro + 0.5 * abs(rate)
    apart = rate + side * gap

    def passes(reading, rolled):
        z = Measurement(0.0, 0.0, 0.0, reading, Fix(0, 0, 0, 0))
        return plain(gates.screen_gyro)(z, m, rate, rolled, p)

    for rolled in (apart, math.nan):
        assert passes(rate + bias + 0.999 * side * allowed, rolled)
        assert not passes(rate + bias - 1.001 * side * allowed, rolled)
    assert passes(apart + bias + 0.999 * side * p.gyro, apart)
    assert not passes(apart + bias + 1.001 * side * p.gyro, apart)
    assert not any(passes(value, apart) for value in NEVER)


@given(
    robot=robots,
    speed=st.floats(0.3, 2.0),
    angle=angles,
    side=sides,
    way=sides,
    offset=st.floats(-0.03, 0.03),
)
def test_a_steering_angle_has_to_agree_with_its_servo_or_with_the_turn(
    robot, speed, angle, side, way, offset
):
    p = P[robot].gates
    m = moving(way * speed, steering_angle=angle, steering_bias=offset)

    def passes(reading, turned):
        z = Measurement(0.0, 0.0, reading, 0.0, Fix(0, 0, 0, 0))
        rate = m.speed * math.tan(turned + offset) / p.wheelbase
        return plain(gates.screen_steering)(z, m, rate, reading, p)

    other = angle - 0.7 if angle > 0.0 else angle + 0.7
    assert passes(angle + 0.99 * side * p.steering, other)
    assert not passes(
        angle + 1.01 * side * p.steering, angle + side * (1.02 * p.steering + p.turning)
    )
    assert passes(other + 0.99 * side * p.turning, other)
    assert (
        not passes(other + 1.01 * side * p.turning, other)
        or abs(other - angle) < p.steering + 2 * p.turning
    )
    assert not any(passes(value, angle) for value in NEVER)


@given(robot=robots, speed=st.floats(-0.19, 0.19), last=angles, side=sides)
def test_near_standstill_a_steering_angle_has_to_move_as_a_servo_does(robot, speed, last, side):
    p = P[robot].gates
    far = last - math.copysign(0.5, last)
    m = moving(speed, steering_angle=far)

    def passes(reading):
        z = Measurement(0.0, 0.0, reading, 0.0, Fix(0, 0, 0, 0))
        return plain(gates.screen_steering)(z, m, 0.0, last, p)

    assert passes(last + 0.99 * side * p.swing)
    assert not passes(last + 1.01 * side * p.swing)


@given(robot=robots, side=sides)
def test_no_steering_angle_beyond_the_lock(robot, side):
    p = P[robot].gates
    for part, right in ((0.999, True), (1.001, False)):
        reading = side * part * p.lock
        z = Measurement(0.0, 0.0, reading, 0.0, Fix(0, 0, 0, 0))
        assert (
            plain(gates.screen_steering)(z, moving(0.0, steering_angle=reading), 0.0, 0.0, p)
            is right
        )
        clean, _ = plain(gates.screen)(z, moving(0.0), 0.0, True, UNHEARD, p)
        assert (clean.steering_angle == reading) is right


coordinates = st.floats(-100.0, 100.0)


@given(
    robot=robots,
    x=coordinates,
    y=coordinates,
    heading=st.floats(-10.0, 10.0),
    part=st.floats(0.0, 1.0),
)
def test_a_pose_has_to_be_whole_of_an_age_that_can_be_and_new(robot, x, y, heading, part):
    p = P[robot].gates
    fix = Fix(x, y, heading, part * p.history)

    elsewhere = UNHEARD._replace(x=1e4)

    def passes(pose, memory=elsewhere):
        return plain(gates.screen_fix)(pose, memory, p)

    assert passes(fix)
    for age in (-1e-9, p.history + 1e-6, *NEVER):
        assert not passes(fix._replace(age=age))
    for name, most in {"x": FARTHEST, "y": FARTHEST, "heading": TURNS}.items():
        for value in (1.001 * most, -1.001 * most, *NEVER):
            assert not passes(fix._replace(**{name: value}))
        assert passes(fix._replace(**{name: -0.999 * most}))
    seen = GateMemory(0.0, x, y, heading, 1.01 * gates.STANDING)
    assert not passes(fix, seen)
    assert passes(fix, seen._replace(way=0.99 * gates.STANDING))
    for name in ("x", "y", "heading"):
        assert passes(fix, seen._replace(**{name: getattr(seen, name) + 1e-3}))


@given(robot=robots, name=st.sampled_from(Measurement._fields[:4]), value=BAD, fresh=st.booleans())
def test_what_is_refused_is_missing_and_nothing_else(robot, name, value, fresh):
    p, m = P[robot].gates, moving(1.0)
    good = Measurement(1.0, 1.0, 0.0, 0.0, Fix(0.1, 0.2, 0.3, 0.0))
    clean, memory = plain(gates.screen)(good._replace(**{name: value}), m, 0.0, fresh, UNHEARD, p)
    whole, _ = plain(gates.screen)(good, m, 0.0, fresh, UNHEARD, p)
    assert whole == good
    lost = {"left", "right"} if name in ("left", "right") else {name}
    for field in good._fields:
        if field in lost:
            assert math.isnan(getattr(clean, field))
        else:
            assert getattr(clean, field) == getattr(good, field)
    assert all(math.isfinite(entry) for entry in memory)
    assert (memory.x, memory.y, memory.heading, memory.way) == (0.1, 0.2, 0.3, 0.0)


def test_the_last_pose_is_remembered_until_another_comes():
    p, m = P["paper"].gates, moving(0.52)
    pose = Fix(0.1, 0.2, 0.3, 0.0)
    z, memory = Measurement(0.52, 0.52, 0.0, 0.0, pose), UNHEARD
    believed = []
    for _ in range(15):
        clean, memory = plain(gates.screen)(z, m, 0.0, False, memory, p)
        believed.append(clean.fix == pose)
    # 5.2 mm a period: ten of them are more than 0.05 m
    assert believed == [True] * 11 + [False] * 4
    nothing = z._replace(fix=Fix(math.nan, math.nan, math.nan, 0.0))
    _, later = plain(gates.screen)(nothing, m, 0.0, False, memory, p)
    assert later[1:4] == pose[:3]
    assert later.way == pytest.approx(memory.way + 0.0052)


@given(
    robot=robots,
    axis=st.sampled_from(("x", "y", "heading")),
    spread=st.floats(0.0, 3.0),
    side=sides,
)
def test_a_pose_fits_up_to_five_deviations_on_every_axis(robot, axis, spread, side):
    p = P[robot]
    own = {"x": p.position, "y": p.position, "heading": p.heading}[axis]
    rows = ZERO._replace(**{axis: spread * own})
    covariance = Covariance(*(rows if name == axis else ZERO for name in ZERO._fields))
    border = 5.0 * math.sqrt((1.0 + spread) * own)
    for part, right in ((0.999, True), (1.001, False)):
        off = Place(0.0, 0.0, 0.0)._replace(**{axis: side * part * border})
        assert plain(readings.fits)(off, covariance, p) is right
    off = Place(0.0, 0.0, 0.0)._replace(**{axis: math.nan})
    assert not plain(readings.fits)(off, covariance, p)


@given(robot=robots, way=st.floats(0.0, 6.3), side=sides, x=coordinates, y=coordinates)
def test_two_poses_agree_within_the_noise_of_both(robot, way, side, x, y):
    p = P[robot]
    before = Place(x, y, 3.0)
    reach, turn = 5.0 * math.sqrt(2.0 * p.position), 5.0 * math.sqrt(2.0 * p.heading)

    def agrees(part, turned):
        off = Place(
            x + part * reach * math.cos(way), y + part * reach * math.sin(way),
            before.heading + side * turned * turn + 2.0 * math.pi,
        )  # fmt: skip
        return plain(readings.agrees)(off, before, p)

    assert agrees(0.999, 0.999)
    assert not agrees(1.001, 0.0)
    assert not agrees(0.0, 1.001)


W = watch.WatchParameters(1.0, 0.01, 0.3, 0.2, 0.3, 0.5, 1.0, 0.4, 0.1)
FIELDS = {"x": "position", "y": "position", "heading": "heading", "speed": "speed",
          "yaw_rate": "yaw_rate", "steering_angle": "steering"}  # fmt: skip


@given(name=st.sampled_from(list(FIELDS)), side=sides, rate=st.floats(-1.0, 1.0), speed=speeds)
def test_a_field_that_jumps_is_blamed_and_replaced(name, side, rate, speed):
    expected = Motion(1.0, 2.0, 0.5, speed, rate, 0.2)
    border = getattr(W, FIELDS[name]) + (0.5 * abs(rate) if name == "yaw_rate" else 0.0)
    reason = getattr(watch, FIELDS[name].upper() if name != "steering_angle" else "STEERING_ANGLE")
    before = UNSEEN._replace(known=1.0, last=expected._replace(x=0.9))
    for part, wrong in ((0.999, False), (1.001, True)):
        motion = expected._replace(**{name: getattr(expected, name) + side * part * border})
        believed, cause = plain(watch.blame)(motion, expected, before, W)
        assert cause == (reason if wrong else 0.0)
        assert believed == (expected if wrong else motion)


def test_a_pose_that_stays_the_same_is_frozen_only_while_the_robot_moves():
    last = Motion(1.0, 2.0, 0.5, 0.3, 0.0, 0.0)
    before = UNSEEN._replace(known=1.0, last=last)
    for speed, wrong in ((0.3, True), (-0.3, True), (0.04, False)):
        expected = last._replace(speed=speed)
        _, cause = plain(watch.blame)(expected, expected, before, W)
        assert cause == (watch.POSITION if wrong else 0.0)
    for name in ("x", "y", "heading"):
        other = last._replace(**{name: getattr(last, name) + 1e-6})
        assert plain(watch.blame)(other, last, before, W)[1] == 0.0
    assert plain(watch.blame)(last, last, UNSEEN._replace(last=last), W)[1] == 0.0
