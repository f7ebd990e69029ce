"""Nonlinear material: fibres, sections, fingers of them, against plane strips, quadrature, shooting and elements."""

from __future__ import annotations

import json
import math
import re
import runpy
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize

import gripper as gr
from gripper.assemble import setting
from gripper.beam.energy import energy, energy_gradient, energy_hessian
from gripper.beam.sections import sections
from gripper.explain import explain
from gripper.laws import Response, section_law
from gripper.scenefile import SceneFileError, dumps, loads, read
from gripper.solve import AXIAL, UNLOADING
from gripper.study.published import solve_as_published
from gripper.study.shooting import NoReferenceError, shooting
from gripper.verify import overview, verify
from gripper.verify.material import Law as ElementLaw
from gripper_plugins.fingers import Tapered, Uniform
from gripper_plugins.objects import Circle
from tests.scenes import REFERENCE, RUBBER, rotating_finger

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


@pytest.mark.parametrize("slope", [-0.09, -0.03, 0.2])
@pytest.mark.parametrize(("M", "q"), [(1.0, 0.0), (0.0, 1.0), (1.0, 3.0), (1.0, -3.0)])
def test_a_tapered_section_stores_what_its_shear_stress_does(slope: float, M: float, q: float) -> None:
    w0, small = 0.1, 1e-5
    law = MATERIALS["neo_hookean"]
    finger = Tapered(length=1.0, base_thickness=w0, tip_thickness=w0 + slope, width=1.0, material=law)
    E, G = law.youngs_modulus, law.G

    def pull(s: float, y: float) -> float:
        """Resultant of the bending stress above y: its slope along the finger is tau (faces are free)."""
        w = w0 + slope * s
        return (M + q * s) * 12 / w**3 * (w**2 / 4 - y**2) / 2

    def tau(y: float) -> float:
        return (pull(small, y) - pull(-small, y)) / (2 * small)

    coefficient = law.shear_coefficient  # stands for 5/6
    stored = 12 * M**2 / (2 * E * w0**3) + quad(lambda y: tau(y) ** 2, -w0 / 2, w0 / 2)[0] / (2 * G)
    stored += (1 / coefficient - 6 / 5) * q**2 / (2 * G * w0)
    scales = sections(finger)
    response, tiny = Response(scales.law, scales, np.zeros(1), 2), 1e-6
    loads = tiny * np.array([M / scales.energy_scale, -q / scales.force_scale])  # Q = - dM/ds
    strains = np.linalg.solve(response.stiffness(np.zeros((2, 1)))[..., 0], loads)
    energy = response.energy(strains[:, None])[0] * scales.energy_scale
    assert energy == pytest.approx(tiny**2 * stored, rel=1e-6)


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


# ---- Fingers.

PLACES = (0.0508, 0.0254, 0.0, -0.0254, -0.0508, -0.0762, -0.1016)
ELEMENTS = {
    "st_venant_kirchhoff": "svk, mu = 0, 5184 elements",
    "logarithmic": "hencky, mu = 0, 1296 elements",
    "neo_hookean": "neo-Hookean, mu = 0, 1296 elements",
}


def apart(pose: gr.PoseResult, row: dict) -> float:
    force = np.array(row["force_on_object"])
    return float(np.linalg.norm(pose.force_on_object_finger_frame - force) / np.linalg.norm(force))


@pytest.mark.parametrize("law", ELEMENTS)
def test_every_pose_is_within_0_4_percent_of_the_elements_of_the_same_law(law: str) -> None:
    result = gr.trace(of(law, rotating_finger(0.08, *PLACES, theory="stretch")))
    rows = {row["x_e"]: row for row in FEM[ELEMENTS[law]]}
    assert max(apart(pose, rows[pose.parameter]) for pose in result.poses[1:]) < 0.004
    for pose in result.poses[1:]:
        assert math.hypot(*pose.tip) == pytest.approx(math.hypot(*rows[pose.parameter]["tip"]), abs=3e-4)


@pytest.mark.parametrize(("way", "start"), [("rising, 1296", ()), ("falling, 5184", (0.08,))])
def test_with_friction_every_pose_is_within_0_4_percent_of_the_elements_of_the_same_law(way: str, start: tuple) -> None:
    rows = FEM[f"svk, mu = 0.2, x_e {way} elements"]
    values = [*start, *(row["x_e"] for row in rows)]
    scene = rotating_finger(*values, theory="stretch", friction=gr.Friction(coefficient=0.2))
    poses = gr.trace(of("st_venant_kirchhoff", scene)).poses[len(start) :]
    assert max(apart(pose, row) for pose, row in zip(poses, rows, strict=True)) < 0.004


def test_auto_takes_the_stretch_of_the_axis_where_the_law_makes_it_matter() -> None:
    result = gr.trace(of("logarithmic", rotating_finger(0.08, -0.0508, theory="auto")))
    assert result.model.theory == "stretch"
    assert apart(result.poses[-1], FEM[ELEMENTS["logarithmic"]][4]) < 0.004


@pytest.mark.parametrize(
    ("law", "theory"), [("secant", "bending"), ("logarithmic", "shear"), ("neo_hookean", "stretch")]
)
def test_along_a_motion_the_work_is_the_energy_s(law: str, theory: str) -> None:
    h = 2e-4
    values = [0.045 + i * h for i in (-2, -1, 0, 1, 2)]
    scene = of(law, rotating_finger(0.07, *values, theory=theory, tolerance=1e-8))
    far, near, middle, nearer, farther = gr.trace(scene).poses[1:]
    slope = (far.energy - 8 * near.energy + 8 * nearer.energy - farther.energy) / (12 * h)
    assert middle.motion_force == pytest.approx(slope, rel=1e-6)


def test_a_finger_that_yields_is_bent_as_shooting_bends_it() -> None:
    s_c, force = 0.07, 0.2  # the force stands across the axis, at the contact
    material = MATERIALS["secant"]
    finger = Uniform(length=0.1, thickness=0.006, width=0.02, material=material)
    EA, w, nu = material.youngs_modulus * 0.02 * 0.006, 0.006, material.poisson_ratio

    def mean(what: Callable[[float, float], float], k: float, e: float) -> float:
        """Over the thickness: of a function of the stress and the place."""
        return quad(lambda y: what(yielding(e - k * (1 - nu * e) * y), y), -0.5, 0.5, epsabs=1e-13)[0]

    def moment(k: float) -> float:
        e = brentq(lambda e: mean(lambda stress, y: stress * (1 + nu * k * y), k, e), -0.01, 0.01, xtol=1e-14)
        c = -(nu**2 / 6 + 1 - nu**2) / 240
        across = 4 * c * k**3 * (1 + 24 * abs(c) * k**2) / (1 + 48 * abs(c) * k**2) ** 2
        return EA * w * (mean(lambda stress, y: -stress * (1 - nu * e) * y, k, e) + across)

    ks = np.linspace(0, 0.16, 81)
    bent = CubicSpline([moment(float(k)) for k in ks], ks / w)

    def along(_: float, y: np.ndarray) -> list[float]:  # backwards from the contact, in its section's axes
        x, _, psi = y
        return [-math.cos(psi), -math.sin(psi), -float(bent(-force * x))]

    x, y, psi = solve_ivp(along, (0, s_c), [0, 0, 0], rtol=1e-11, atol=1e-13).y[:, -1]
    turn = np.exp(-1j * psi)
    foot = -complex(x, y) * turn  # the contact's section, from the clamp
    centre = foot - 1j * turn * (w / 2 + 0.01)
    scene = gr.Scene(
        finger=finger,
        object=Circle(radius=0.01).at(x=centre.real, y=centre.imag),
        theory="bending",
        tolerance=1e-8,
    )
    (pose,) = gr.solve(scene).poses
    assert pose.reason is None
    assert 0.03 < pose.max_strain < 0.08
    (contact,) = pose.contacts
    assert contact.normal_force == pytest.approx(force, rel=1e-5)
    assert contact.s == pytest.approx(s_c, abs=1e-6)
    assert pose.tip_rotation == pytest.approx(-psi, rel=1e-5)


@settings(max_examples=6, deadline=None)
@given(law=st.sampled_from(LARGE), x=st.floats(0.05, 0.09), push=st.floats(1e-4, 0.02), factor=st.floats(0.1, 10))
def test_mirrored_it_bends_the_other_way_and_forces_grow_with_the_modulus(
    law: str, x: float, push: float, factor: float
) -> None:
    material = MATERIALS[law]
    finger = Uniform(length=0.1, thickness=0.008, width=0.02, material=material)
    stiff = replace(material, youngs_modulus=4.8e6 * factor, shear_modulus=1.71e6 * factor)
    scene = gr.Scene(finger=finger, object=Circle(radius=0.02).at(x=x, y=-0.024 + push), theory="stretch")
    mirrored = replace(scene, object=Circle(radius=0.02).at(x=x, y=0.024 - push), approach=(0, -1))
    stiffer = replace(scene, finger=replace(finger, material=stiff))
    (one,), (other,), (more,) = (gr.solve(each).poses for each in (scene, mirrored, stiffer))
    assert one.status == other.status == more.status == "contact"
    assert other.force_on_object == pytest.approx((one.force_on_object[0], -one.force_on_object[1]), rel=1e-5)
    assert more.force_on_object == pytest.approx(tuple(factor * f for f in one.force_on_object), rel=1e-6)


def test_a_strain_beyond_the_table_fails_and_says_so() -> None:
    material = replace(RUBBER, law="secant", table=tuple(point for point in CURVE if point[0] < 0.04))
    scene = rotating_finger(0.08, 0.0254, -0.0254, 0.0508)
    finger = replace(scene.finger, body=replace(scene.finger.body, material=material))
    poses = gr.trace(replace(scene, finger=finger)).poses
    assert [pose.status for pose in poses] == ["free", "failed", "failed", "contact"]
    assert re.fullmatch(
        r"a fibre's strain is 0\.\d+: the material's law is known from -0.039 to 0.039", poses[1].reason
    )
    assert poses[3].max_strain < 0.039


def test_strains_beyond_the_table_between_two_poses_are_told() -> None:
    material = replace(RUBBER, law="secant", table=((0.02, 9e4), (0.05, 21e4), (0.09, 35e4)))
    scene = rotating_finger(0.08, 0.02, -0.1016)
    finger = replace(scene.finger, body=replace(scene.finger.body, material=material))
    result = gr.trace(replace(scene, finger=finger))
    assert [pose.status for pose in result.poses] == ["free", "contact", "contact"]
    assert result.summary().strain > 0.09
    (warning,) = result.model.warnings
    assert warning.startswith("strains reach 0.10") and "known from -0.09 to 0.09" in warning


# ---- What is refused.


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"law": "rubber"}, "law must be one of linear, secant, logarithmic"),
        ({"law": "secant"}, "table must be given with law 'secant'"),
        ({"law": "logarithmic", "table": CURVE}, "table must be given with law 'secant'"),
        ({"law": "secant", "table": ()}, "table must hold a strain and its stress"),
        ({"law": "secant", "table": ((0.01, 4e4), (0.02, 3e4))}, "table must rise from the origin"),
        ({"law": "secant", "table": ((0.01, -4e4),)}, "table must rise from the origin"),
        ({"law": "secant", "table": ((0.01, 4e4), (0.01, 5e4))}, "table must rise from the origin"),
        ({"law": "secant", "table": ((0.01, 1e4),)}, "youngs_modulus must be at most 3 times the stress over strain"),
        ({"law": "secant", "table": ((-1.5, -4e7), (0.01, 4.8e4))}, "table must hold strains above -1"),
        ({"law": "secant", "table": ((0.01, 4e4, 1.0),)}, r"table\[0\] must have 2 entries"),
        ({"law": "secant", "table": 3.0}, "table must hold pairs"),
    ],
)
def test_a_law_that_cannot_be_is_refused(changes: dict, rule: str) -> None:
    with pytest.raises(ValueError, match=rule):
        replace(RUBBER, **changes)


def test_what_does_not_know_a_law_refuses_it() -> None:
    scene = of("logarithmic", rotating_finger(0.08, 0.0508))
    result = gr.trace(scene)
    with pytest.raises(ValueError, match="law must be 'linear', as the paper's is"):
        solve_as_published(scene, 0.0508)
    kept = result.poses[-1].kept
    with pytest.raises(NoReferenceError, match="shooting knows the linear law alone"):
        shooting(kept.setting, kept.equilibrium)
    assert {UNLOADING, AXIAL} <= set(result.model.not_modelled)


# ---- The elements' counterparts.


@pytest.mark.parametrize("plane", ["stress", "strain"])
@given(values=st.tuples(*[st.floats(-0.2, 0.2)] * 4))
def test_the_elements_neo_hookean_law_is_that_of_the_principal_stretches(plane: str, values: tuple) -> None:
    material = replace(RUBBER, plane=plane)
    law, F = ElementLaw.of(material, "neo_hookean"), np.eye(2) + np.reshape(values, (2, 2))
    a, b = np.linalg.svd(F, compute_uv=False)
    energy, stress, stiffness = law.respond(F.reshape(1, 4))
    known = plane_energy("neo_hookean", plane, 0.4, np.array([a]), np.array([b]))
    assert energy[0] == pytest.approx(material.bending_modulus * known[0], rel=1e-9, abs=1e-3)
    h = 1e-6
    moved = [law.respond((F.reshape(4) + sign * h * np.eye(4)).reshape(4, 4)) for sign in (1, -1)]
    assert stress[0] == pytest.approx((moved[0][0] - moved[1][0]) / (2 * h), abs=20)
    assert stiffness[0] == pytest.approx((moved[0][1] - moved[1][1]) / (2 * h), abs=20)


def test_the_elements_neo_hookean_law_reproduces_its_reference() -> None:
    report = verify(
        of("neo_hookean", rotating_finger(0.08, 0.0, theory="stretch")), (0.0,), elements=(60, 4), laws=False
    )
    (pose,) = report.poses
    assert report.model.law == "neo_hookean"
    known = np.array(FEM[ELEMENTS["neo_hookean"]][2]["force_on_object"])
    assert np.linalg.norm(pose.elements.force - known) < 0.004 * np.linalg.norm(known)
    assert pose.force_difference < 0.006


def test_the_gallery_compares_every_law_with_its_elements(tmp_path: Path) -> None:
    path = Path(__file__).parents[1] / "gallery/material_laws.py"
    script = runpy.run_path(str(path))
    found = script["main"](tmp_path, places=(0.0254, 0.0508), mesh=(24, 2))
    assert set(found) == set(LARGE)
    assert {report.model.law for report in found.values()} == {"hencky", "svk", "neo_hookean"}
    assert all(report.largest_difference < 0.02 for report in found.values())  # of a coarse mesh
    assert overview(found).count("%") == 2 * len(LARGE)
    assert (tmp_path / "material_laws.png").stat().st_size > 5000


def test_elements_refuse_a_table() -> None:
    with pytest.raises(
        ValueError, match=r"law must be one of linear, st_venant_kirchhoff, .* to be verified; got 'secant'"
    ):
        verify(of("secant", rotating_finger(0.08, 0.0)), (0.0,))


# ---- Scene files.

MEASURED = """
[material]
youngs_modulus = "2.6 GPa"
poisson_ratio = 0.35
law = "secant"
table = [[0.005, "12.6 MPa"], [0.01, "23.5 MPa"], [0.02, "41 MPa"], [0.04, "59 MPa"]]
[finger]
profile = "uniform"
length = "57 mm"
thickness = "3.2 mm"
width = "9.5 mm"
[object]
surface = "circle"
radius = "9 mm"
[object.pose]
x = "50 mm"
y = "-8 mm"
"""


def test_a_scene_file_names_a_law_and_its_result_is_one_too(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(MEASURED)
    result = gr.solve(read(file))
    (pose,) = result.poses
    assert pose.status == "contact"
    again = tmp_path / "result.json"
    again.write_text(json.dumps(result.to_dict()))
    assert read(again).finger.body.material.table == read(file).finger.body.material.table
    assert gr.solve(read(again)).poses[0].force_on_object == pose.force_on_object
    assert loads(dumps(read(file))).finger.body.material.table == read(file).finger.body.material.table
    named = [d.why for d in explain(read(file)).decisions if d.what == "material law" and d.needed]
    assert len(named) == 1 and named[0].startswith("secant")


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ('"secant"', '"elastic"', "material.law.*must be 'linear', 'secant'"),
        ('law = "secant"', "", "material.table.*must be given with law 'secant'"),
        ('[0.01, "23.5 MPa"]', '[0.01, "3.5 MPa"]', "material.table.*must rise from the origin"),
        ('[0.01, "23.5 MPa"]', '[0.01, "23.5 MPa", 1]', r"material.table\[1\].*must have 2 entries"),
        ("2.6 GPa", "9 GPa", "material.youngs_modulus.*must be at most 3 times"),
    ],
)
def test_a_bad_law_in_a_scene_file_is_named(tmp_path: Path, old: str, new: str, rule: str) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(MEASURED.replace(old, new))
    with pytest.raises(SceneFileError, match=rule):
        read(file)
