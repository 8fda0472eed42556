"""The symbolic derivation: what it proves about the paper, and about the kernel that runs."""

import numpy as np
import pytest
import sympy as sp

from osculate.vehicle import Tricycle, derivation
from osculate.vehicle.derivation import derive, rod_inertia, steering_coefficient

pytestmark = pytest.mark.core


@pytest.fixture(scope="module")
def derived():
    return derive()


def test_the_motions_respect_every_constraint(derived):
    assert derived.constraint_residual() == sp.zeros(3, 2)


def test_the_mass_matrix_is_the_papers(derived):
    a, theta = derivation.a, derivation.theta
    front = derived.front_mass
    assert derived.mass == derived.mass.T
    assert sp.expand(derived.mass[0, 2] + a * front * sp.sin(theta)) == 0
    assert sp.expand(derived.mass[1, 2] - a * front * sp.cos(theta)) == 0


def test_masses_and_inertias_are_the_robots(derived):
    robot = Tricycle(body_mass=4.0, wheelbase=0.7, track_width=0.3, wheel_radius=0.12)
    values = {
        "M_b": robot.body_mass,
        "M_w": robot.wheel_mass,
        "I_w": robot.wheel_inertia,
        "I_wd": robot.wheel_yaw_inertia,
        "I_b": robot.body_inertia,
        "a": robot.wheelbase,
        "r": robot.wheel_radius,
        "d": robot.track_width,
    }
    numbers = {getattr(derivation, name): value for name, value in values.items()}
    assert float(derived.total_mass.subs(numbers)) == pytest.approx(robot.total_mass)
    assert float(derived.turn_inertia.subs(numbers)) == pytest.approx(robot.turn_inertia)
    assert float(derived.yaw_gain.subs(numbers)) == pytest.approx(robot.yaw_gain)


def test_erratum_1_the_steering_term_is_i_r_squared_and_only_that_conserves_energy(derived):
    a, r, inertia = derivation.a, derivation.r, derivation.I
    assert steering_coefficient(derived.speed_rate) == inertia * r**2
    assert steering_coefficient(derived.printed_speed_rate) == inertia * a * r**2
    assert derived.energy_rate(derived.speed_rate) == 0
    assert derived.energy_rate(derived.printed_speed_rate) != 0
    assert derived.energy_rate(derived.printed_speed_rate).subs(a, 1) == 0  # the wrong dimension


def test_erratum_2_the_rod():
    about_end, about_centre = rod_inertia()
    assert sp.simplify(about_end - about_centre - derivation.M_b * derivation.a**2 / 4) == 0


def test_erratum_3_the_torque_difference_is_what_an_open_differential_leaves(derived):
    turn = derivation.v * sp.tan(derivation.phi) / derivation.a
    left_out = derived.differential_residual()
    exact = turn.diff(derivation.t) / derived.yaw_gain
    assert sp.simplify(left_out.subs(derivation.u_1, exact)) == 0
    assert sp.simplify(sp.diff(left_out, derivation.u_1) + 1) == 0  # and for no other difference


@pytest.mark.parametrize("form", ["corrected", "printed"])
def test_the_kernel_is_the_derived_model(derived, form):
    assert derived.kernel_residual(form) == 0


def test_the_printed_numbers_of_eq_47(derived):
    robot = Tricycle()
    names = {
        derivation.a: robot.wheelbase,
        derivation.r: robot.wheel_radius,
        derivation.I_w: robot.wheel_inertia,
        derivation.M_1: robot.total_mass,
        derivation.I: robot.turn_inertia,
    }
    delta = derived.delta.subs(names)
    sine, cosine = (delta.coeff(f(derivation.phi) ** 2) for f in (sp.sin, sp.cos))
    scale = 27.0 / float(sine)
    assert float(cosine) * scale - 27.0 == pytest.approx(37.0)
    assert robot.wheel_radius * robot.wheelbase**2 * scale == pytest.approx(53.33, abs=5e-3)


def test_the_model_is_printed_as_latex(derived):
    text = derived.latex()
    assert r"\dot{v} = " in text
    assert r"\Delta = I r^{2}" in text
    assert text.count("{") == text.count("}")
    assert "varphi(t)" not in text
    assert np.all([len(line) < 2000 for line in text.splitlines()])
