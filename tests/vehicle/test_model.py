"""The robot's numbers and its reduced dynamics."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from osculate import InvalidInput, InvalidScenario, Tricycle
from osculate.vehicle.model import drive_torque, driven_curvature, kinetic_energy, speed_rate

speeds = st.floats(0.05, 10)
curvatures = st.floats(-3, 3)
accelerations = st.floats(-5, 5)


def test_the_papers_robot_has_the_papers_constants():
    robot = Tricycle()
    assert robot.total_mass == pytest.approx(10.0)
    assert robot.turn_inertia == pytest.approx(0.81)
    assert robot.yaw_gain == pytest.approx(50.0)
    model = robot.reduced_model()
    # eq. (47) scaled by 3000 / 1.2: 37 cos² φ + 27, and 53.33
    assert model.drive_inertia * model.wheelbase**2 / model.turn_inertia == pytest.approx(64 / 27)
    assert model.coupling == model.turn_inertia
    printed = robot.reduced_model("printed").coupling / model.coupling
    assert 27 * printed == pytest.approx(10.8)


@given(speeds, curvatures, accelerations, st.floats(-20, 20))
def test_the_corrected_model_conserves_energy(v, k, yaw_acceleration, torque):
    model = Tricycle().reduced_model()
    omega = k * v
    rate = speed_rate(model, driven_curvature(v, omega, 0.0), yaw_acceleration, torque)
    scale = model.traction**2
    power = (model.drive_inertia * v * rate + model.turn_inertia * omega * yaw_acceleration) * scale
    assert power == pytest.approx(torque * v / 0.1, abs=1e-9)


def test_the_printed_model_does_not():
    robot = Tricycle()
    model = robot.reduced_model("printed")
    rate = speed_rate(model, 0.5, 1.0, 0.0)
    power = model.drive_inertia * rate + model.turn_inertia * 0.5 * 1.0
    assert abs(power) > 1e-4


@given(st.sampled_from(["corrected", "printed"]), curvatures, accelerations, accelerations)
def test_the_torque_for_an_acceleration_gives_it(form, k, yaw_acceleration, acceleration):
    model = Tricycle().reduced_model(form)
    torque = drive_torque(model, k, yaw_acceleration, acceleration)
    assert speed_rate(model, k, yaw_acceleration, torque) == pytest.approx(acceleration, abs=1e-9)


@given(st.floats(-10, 10), st.floats(-10, 10))
def test_the_driven_curvature_is_the_ratio_or_what_the_steering_is_set_to(v, omega):
    assume(v == 0.0 or abs(v) > 1e-6)
    expected = omega / v if v != 0.0 else 0.25
    assert driven_curvature(v, omega, 0.25) == pytest.approx(expected)


def test_energy_is_a_quadratic_form():
    model = Tricycle().reduced_model()
    assert kinetic_energy(model, 2.0, 0.0) == pytest.approx(0.5 * 12.0 * 4.0)
    assert kinetic_energy(model, 0.0, 3.0) == pytest.approx(0.5 * 0.81 * 9.0)


@pytest.mark.parametrize(
    "field", ["body_mass", "wheel_mass", "wheelbase", "wheel_radius", "track_width"]
)
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), "heavy", None])
def test_bad_numbers_are_refused_by_name(field, value):
    with pytest.raises(InvalidInput) as caught:
        Tricycle(**{field: value})
    assert caught.value.field == f"Tricycle.{field}"
    assert f"Tricycle.{field}" in str(caught.value)
    assert "must be" in str(caught.value)


def test_all_problems_are_listed():
    with pytest.raises(InvalidScenario) as caught:
        Tricycle(body_mass=-1, wheel_mass=0, colour="red")
    assert {p.field for p in caught.value.problems} == {
        "Tricycle.body_mass",
        "Tricycle.wheel_mass",
        "Tricycle.colour",
    }
    assert "wheelbase" in str(caught.value)  # the valid fields are named


def test_an_unknown_form_is_refused():
    with pytest.raises(InvalidInput, match="corrected, printed"):
        Tricycle().reduced_model("wrong")


def test_the_footprint_holds_all_wheels():
    robot = Tricycle()
    xs, ys = zip(*robot.footprint.corners, strict=True)
    assert max(xs) == pytest.approx(robot.wheelbase + robot.wheel_radius)
    assert min(xs) == pytest.approx(-robot.wheel_radius)
    assert max(ys) == -min(ys) == pytest.approx(0.12)
