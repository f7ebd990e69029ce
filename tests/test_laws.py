"""Nonlinear material: fibres, sections, and fingers of them, against plane strips, quadrature, shooting and elements."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize

import gripper as gr
from gripper.assemble import setting
from gripper.energy import energy, energy_gradient, energy_hessian
from gripper.laws import section_law
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle
from tests.scenes import REFERENCE, RUBBER, TAPERED, rotating_finger

FEM = json.loads((REFERENCE / "fem.json").read_text())["rotating_finger"]
LARGE = ("logarithmic", "st_venant_kirchhoff", "neo_hookean")
YIELDING = 0.02


def yielding(strain: float) -> float:
    """A curve that flattens, over E."""
    return YIELDING * math.tanh(strain / YIELDING)


STRAINS = np.linspace(0, 0.1, 101)[1:]
CURVE = tuple((float(e), 4.8e6 * yielding(float(e))) for e in STRAINS)
MATERIALS = {law: replace(RUBBER, law=law) for law in LARGE} | {"secant": replace(RUBBER, law="secant", table=CURVE)}
every_law = pytest.mark.parametrize("law", MATERIALS)


def law_of(law: str, **changes: object) -> object:
    return section_law(replace(MATERIALS[law], **changes))


def of(law: str, scene: gr.Scene) -> gr.Scene:
    """The scene with a finger of this material."""
    body = replace(scene.finger.body, material=MATERIALS[law])
    return replace(scene, finger=replace(scene.finger, body=body))


# ---- Fibres and sections.


@every_law
@pytest.mark.parametrize("plane", ["stress", "strain"])
@given(strain=st.floats(-0.35, 0.6))
def test_stress_is_the_slope_of_a_fibre_s_energy_and_its_modulus_the_slope_of_that(
    law: str, plane: str, strain: float
) -> None:
    fibre, h = law_of(law, plane=plane).fibre, 1e-5
    table = np.array(fibre.answer(np.array([strain - h, strain, strain + h])))
    slopes = (table[:, 2] - table[:, 0]) / (2 * h)
    assert slopes[:2] == pytest.approx(table[1:, 1], abs=1e-4)


@every_law
@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.4, 0.49])
def test_every_fibre_begins_with_young_s_modulus(law: str, plane: str, nu: float) -> None:
    fibre = law_of(law, plane=plane, poisson_ratio=nu).fibre
    energy, stress, modulus = fibre.answer(np.array([0.0]))
    assert [energy[0], stress[0], modulus[0]] == pytest.approx([0, 0, 1], abs=1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.4])
@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("law", LARGE)
def test_the_section_is_the_plane_problem_of_a_bent_strip_to_the_fourth_order(law: str, plane: str, nu: float) -> None:
    section = law_of(law, plane=plane, poisson_ratio=nu)
    for k, e in ((0.3, 0.0), (0.2, -0.01)):
        strip, higher = least_energy(law, plane, nu, k, e), 0.15 * k**4 + 0.03 * abs(e)
        assert section.phi(np.array([k]), np.array([e]))[0][0] == pytest.approx(strip, rel=higher)


def least_energy(law: str, plane: str, nu: float, k: float, e: float) -> float:
    """Least < W(stretch along, stretch across) > over the fibres' places y(eta), of mean 0, over E (of bending)."""
    x, weights = np.polynomial.legendre.leggauss(20)
    y = np.polynomial.legendre.legvander(x, 7)[:, 1:]
    slopes = np.array([np.polynomial.legendre.Legendre.basis(i).deriv()(x) for i in range(1, 8)]).T * 2

    def mean(c: np.ndarray) -> float:
        along, across = 1 + e - k * (y @ c), slopes @ c
        inside_out = min(along.min(), across.min()) <= 0
        return 1e3 if inside_out else weights / 2 @ plane_energy(law, plane, nu, along, across)

    return minimize(mean, np.eye(7)[0] / 2, method="BFGS", options={"gtol": 1e-11}).fun


def plane_energy(law: str, plane: str, nu: float, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Energy of two principal stretches over the modulus of bending."""
    if law == "neo_hookean":
        mu, lame = 1 / (2 * (1 + nu)), nu / ((1 + nu) * (1 - 2 * nu))
        u = np.ones_like(a)
        for _ in range(40 if plane == "stress" else 0):  # square of the third stretch: no stress along it
            u = u - (mu * (u - 1) + lame * np.log(a * b * np.sqrt(u))) / (mu + lame / 2 / u)
        J = a * b * np.sqrt(u)
        unit = 1 / (1 - nu**2) if plane == "strain" else 1.0
        return (mu / 2 * (a**2 + b**2 + u - 3 - 2 * np.log(J)) + lame / 2 * np.log(J) ** 2) / unit
    nu = nu / (1 - nu) if plane == "strain" else nu
    e1, e2 = (np.log(a), np.log(b)) if law == "logarithmic" else ((a**2 - 1) / 2, (b**2 - 1) / 2)
    return ((1 + nu) * (e1 + e2) ** 2 + (1 - nu) * (e1 - e2) ** 2) / (4 * (1 - nu**2))


@every_law
@pytest.mark.parametrize("k", [0.01, 0.06, 0.15])
def test_moment_and_axial_force_are_the_integrals_of_the_stress_over_the_thickness(law: str, k: float) -> None:
    section, nu, e = law_of(law), RUBBER.poisson_ratio, 0.003
    thin = 1 - nu * e

    def fibre(strain: float) -> float:
        """Stress over E: of the table the curve that it was taken from."""
        return yielding(strain) if law == "secant" else float(section.fibre.answer(np.array([strain]))[1][0])

    moment = quad(lambda y: -y * thin * fibre(e - k * thin * y), -0.5, 0.5, epsabs=1e-12)[0]
    force = quad(lambda y: (1 + nu * k * y) * fibre(e - k * thin * y), -0.5, 0.5, epsabs=1e-12)[0]
    a, b = section.fibre.begins(nu)
    c = (b - nu**2 / 6 - 2 * a * nu / 3 - (1 - nu**2)) / 240
    across = (4 * c * k**3 * (1 + 24 * abs(c) * k**2)) / (1 + 48 * abs(c) * k**2) ** 2
    phi = section.phi(np.array([k]), np.array([e]))
    assert phi[1][0] == pytest.approx(moment + across, rel=2e-6)
    assert phi[2][0] == pytest.approx(force, abs=2e-8)


@every_law
@given(k=st.floats(-0.8, 0.8))
def test_without_axial_force_the_axis_stretches_until_there_is_none(law: str, k: float) -> None:
    section = law_of(law)
    *_, e = section.bent(np.array([k]))
    assert section.phi(np.array([k]), e)[2][0] == pytest.approx(0, abs=1e-9)


# ---- The energy of a finger.


@every_law
@pytest.mark.parametrize("theory", ["bending", "shear", "stretch"])
def test_gradient_and_hessian_of_the_energy_are_its_differences(law: str, theory: str) -> None:
    beam = setting(of(law, rotating_finger(0.0)), theory).beam((), 4)
    z = np.random.default_rng(3).normal(size=beam.size) * 0.2
    h, n = 1e-5, beam.size
    slopes = [(energy(beam, z + h * d) - energy(beam, z - h * d)) / (2 * h) for d in np.eye(n)]
    bends = [(energy_gradient(beam, z + h * d) - energy_gradient(beam, z - h * d)) / (2 * h) for d in np.eye(n)]
    assert energy_gradient(beam, z) == pytest.approx(np.array(slopes), abs=1e-8)
    assert energy_hessian(beam, z) == pytest.approx(np.array(bends), abs=1e-7)


@every_law
@pytest.mark.parametrize("theory", ["bending", "shear", "stretch"])
def test_at_small_strain_every_law_is_the_linear_one(law: str, theory: str) -> None:
    scene = of(law, rotating_finger(0.0))
    finger = Uniform(length=0.2, thickness=0.01, width=0.02, material=MATERIALS[law])
    beam = setting(replace(scene, finger=finger), theory).beam((), 3)
    z = np.random.default_rng(1).normal(size=beam.size)
    assert energy_hessian(beam, 0 * z) == pytest.approx(np.eye(beam.size), abs=1e-12)
    assert energy(beam, 1e-5 * z) == pytest.approx(1e-10 * (z @ z) / 2, rel=1e-4)
    assert energy_gradient(beam, 1e-5 * z) == pytest.approx(1e-5 * z, abs=1e-9)
