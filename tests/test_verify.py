from __future__ import annotations

import ast
import json
import math
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

import gripper as gr
import gripper.verify
from gripper.cli import app
from gripper.fingers import S
from gripper.verify import verify
from gripper.verify.body import Body, positive, solve
from gripper.verify.elements import Elements
from gripper.verify.follow import Follower
from gripper.verify.material import LAWS, InvertedError, Law
from gripper.verify.mesh import build
from gripper.verify.motion import Frame, passing, relative
from gripper.verify.outline import JAW
from gripper.verify.run import Found, Model, assembled, run
from gripper.verify.touch import History
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.polygon import PolygonJaw
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.loads import Force
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.polygon import Polygon
from tests import scenes

FEM = json.loads((scenes.REFERENCE / "fem.json").read_text())
SOFT = gr.Material(youngs_modulus=1.0, poisson_ratio=0.3)
EVERY_LAW = pytest.mark.parametrize("law", list(LAWS))


def rotation(angle):
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def follow(scene, values, **model):
    """The elements' poses of a motion at these values."""
    values = list(values)
    return run(scene, Model(**model), values, [True] * len(values), lambda: None)


def still(scene, **model):
    """The elements' only pose."""
    return run(scene, Model(**model), [0.0], [True], lambda: None)[0]


# Material laws


@EVERY_LAW
@settings(max_examples=60, deadline=None)
@given(values=st.lists(st.floats(-0.3, 0.3), min_size=4, max_size=4))
def test_energy_stress_and_stiffness_of_a_law_belong_to_its_principal_strains(law, values):
    f = np.eye(2).ravel() + np.array(values)
    assume(np.linalg.det(f.reshape(2, 2)) > 0.2)
    stretches = np.linalg.svd(f.reshape(2, 2), compute_uv=False)
    e1, e2 = {"svk": (stretches**2 - 1) / 2, "biot": stretches - 1, "hencky": np.log(stretches)}[law]
    respond = Law.of(SOFT, law).respond
    energy, stress, stiffness = respond(f[None])
    assert energy[0] == pytest.approx((e1**2 + 0.6 * e1 * e2 + e2**2) / (2 * (1 - 0.09)), abs=1e-12)
    step = 1e-6
    pairs = [(respond((f + step * axis)[None]), respond((f - step * axis)[None])) for axis in np.eye(4)]
    assert stress[0] == pytest.approx([(a[0][0] - b[0][0]) / (2 * step) for a, b in pairs], abs=1e-8)
    rows = np.array([(a[1][0] - b[1][0]) / (2 * step) for a, b in pairs])
    np.testing.assert_allclose(stiffness[0], rows, atol=1e-7)


@EVERY_LAW
def test_a_rotation_makes_no_stress(law):
    turned = np.array([rotation(angle).ravel() for angle in np.linspace(-3, 3, 13)])
    energy, stress, _ = Law.of(SOFT, law).respond(turned)
    np.testing.assert_allclose(energy, 0, atol=1e-30)
    np.testing.assert_allclose(stress, 0, atol=1e-15)


@EVERY_LAW
@pytest.mark.parametrize(("plane", "E", "nu"), [("stress", 1.0, 0.3), ("strain", 1 / 0.91, 0.3 / 0.7)])
def test_at_small_strain_every_law_is_hookes(law, plane, E, nu):
    material = gr.Material(youngs_modulus=1.0, poisson_ratio=0.3, plane=plane)
    hooke = E / (1 - nu**2) * np.array([[1, 0, 0, nu], [0, (1 - nu) / 2, (1 - nu) / 2, 0]])
    _, _, stiffness = Law.of(material, law).respond(np.eye(2).reshape(1, 4))
    np.testing.assert_allclose(stiffness[0][:2], hooke, atol=1e-12)


def test_a_law_refuses_what_it_cannot_do():
    with pytest.raises(LookupError, match=r"'rubber'; known: svk, biot, hencky"):
        Law.of(SOFT, "rubber")
    with pytest.raises(ValueError, match=r"poisson_ratio must be at most 0\.499 in plane strain"):
        Law.of(gr.Material(youngs_modulus=1.0, poisson_ratio=0.5, plane="strain"), "svk")
    with pytest.raises(InvertedError):
        Law.of(SOFT, "svk").respond(np.array([[1.0, 0, 0, -0.1]]))


# Elements


def tapered(law="biot", elements=(5, 3)):
    finger = scenes.TAPERED
    mesh = build(finger, elements)
    return mesh, Elements(mesh, Law.of(finger.material, law))


@EVERY_LAW
def test_a_constant_strain_is_carried_without_forces_inside(law):
    mesh, elements = tapered(law)
    gradient = np.array([[1.05, 0.08], [-0.03, 0.94]])
    energy, forces = elements.forces(mesh.nodes @ gradient.T + [0.1, -0.2])
    inside = np.setdiff1d(mesh.elements, np.append(mesh.outline.edges, np.arange(mesh.across)))
    scale = np.abs(forces).max()
    assert inside.size > 20
    np.testing.assert_allclose(forces[inside], 0, atol=1e-12 * scale)
    volume = 0.1778 * (0.030 + 0.017) / 2 * 0.025
    density = Law.of(scenes.RUBBER, law).respond(gradient.reshape(1, 4))[0][0]
    assert energy == pytest.approx(volume * density, rel=1e-12)


@EVERY_LAW
def test_a_rigid_motion_makes_no_forces(law):
    mesh, elements = tapered(law)
    energy, forces = elements.forces(mesh.nodes @ rotation(2.0).T + [1.0, -3.0])
    assert energy < 1e-20
    np.testing.assert_allclose(forces, 0, atol=1e-8)


@EVERY_LAW
def test_forces_are_the_slope_of_the_energy_and_the_tangent_theirs(law):
    mesh, elements = tapered(law)
    rng = np.random.default_rng(3)
    at = mesh.nodes + rng.normal(scale=2e-4, size=mesh.nodes.shape)
    way = rng.normal(size=at.shape)
    step = 1e-8
    (before, first), (after, second) = elements.forces(at - step * way), elements.forces(at + step * way)
    forces, values = elements.tangent(at)
    assert np.sum(forces * way) == pytest.approx((after - before) / (2 * step), rel=1e-6)
    product = np.bincount(elements.rows, values * way.ravel()[elements.columns], at.size).reshape(-1, 2)
    np.testing.assert_allclose(product, (second - first) / (2 * step), atol=1e-5 * np.abs(product).max())


def test_inverted_elements_are_refused():
    mesh, elements = tapered()
    for work in (elements.forces, elements.largest_strain):
        with pytest.raises(InvertedError):
            work(mesh.nodes * [1, -1])
    folded = mesh.nodes.copy()
    folded[mesh.tip - mesh.across // 2] += [-0.0128, 0]  # a corner of the finger, seen at the nodes alone
    elements.forces(folded)
    with pytest.raises(InvertedError, match="at a node"):
        elements.largest_strain(folded)


@pytest.mark.parametrize(
    "row",
    scenes.EXACT[
        "cantilever, dead tip load (Bisshopp & Drucker 1945; digits by elliptic "
        "integrals, agreeing with Mattiasson 1981)"
    ]["rows"],
)
def test_a_slender_cantilever_bends_as_the_elastica(row):
    load, deflection, shortening = row[:3]
    w = 0.005
    finger = Uniform(
        length=1.0, thickness=w, width=1.0, material=gr.Material(youngs_modulus=12 / w**3, poisson_ratio=0.0)
    )
    mesh = build(finger, (80, 1))
    elements = Elements(mesh, Law.of(finger.material, "biot"))
    body = Body(mesh, elements)
    dead = np.zeros_like(mesh.nodes)
    at = body.start
    for part in np.linspace(0, 1, 11)[1:]:
        dead[mesh.tip, 1] = part * load
        for _ in range(30):
            positions = body.positions(at)
            forces, values = elements.tangent(positions)
            residual = body.reduced(forces - dead, at)
            if np.linalg.norm(residual) < 1e-5:
                break
            at = at - solve(body.matrix([(values, elements.rows, elements.columns)], forces, at), residual)
    x, y = body.positions(at)[mesh.tip]
    assert np.linalg.norm(residual) < 1e-5
    assert (1 - x, y) == pytest.approx((shortening, deflection), abs=3e-4)


# The system: clamp, rigid jaw, contact, friction


def corner_scene():
    """A finger with a jaw between a corner and a circle's flank, roughly."""
    jaw = Triangle(length=0.3, lead_angle=0.5, return_angle=1.2)
    return scenes.unit_finger(jaw=jaw), Polygon(vertices=((-0.2, -0.3), (0.2, -0.3), (0.0, 0.0)))


CASES = {
    "a face": (scenes.unit_finger(), Circle(radius=0.25), Frame(0.6, -0.279, 0.4)),
    "a jaw": (corner_scene()[0], Circle(radius=0.25), Frame(1.15, -0.35, 0.4)),
    "the object's corner": (scenes.unit_finger(), corner_scene()[1], Frame(0.6, -0.029, 0.2)),
    "the object's corner on a jaw": (corner_scene()[0], corner_scene()[1], Frame(1.15, -0.09, 0.2)),
}


@pytest.mark.parametrize("jaw", ["rigid", "elastic"])
@pytest.mark.parametrize(("friction", "slip"), [(0.0, 0.0), (0.3, 1e-2), (0.3, 1e-9)], ids=["none", "slip", "stick"])
@pytest.mark.parametrize("case", CASES)
def test_the_tangent_is_the_slope_of_the_residual(case, friction, slip, jaw):
    finger, body, frame = CASES[case]
    rough = gr.Friction(coefficient=friction)
    scene = gr.Scene(finger=finger, object=body, motion=gr.Motion("q", (0.0,)), friction=rough)
    setting, _ = assembled(scene, Model(elements=(12, 2), jaw=jaw))
    system, at = setting.system, setting.system.body.start
    before = Frame(frame.x - slip, frame.y, frame.angle)
    history = History(system.body.positions(at), before, np.zeros(system.contact.count))
    rng = np.random.default_rng(5)
    at = at + rng.normal(scale=1e-9, size=at.size)
    touch = system.residual(at, frame, history)[1]
    assert touch.at.size > 0
    assert bool(np.all(touch.sticking)) == (friction > 0 and slip < 1e-6)
    way, step = rng.normal(size=at.size), 1e-10
    after, first = system.residual(at + step * way, frame, history), system.residual(at - step * way, frame, history)
    slope = (after[0] - first[0]) / (2 * step)
    assert np.array_equal(after[1].at, first[1].at)
    np.testing.assert_allclose(system.matrix(at, touch) @ way, slope, atol=2e-6 * np.abs(slope).max())


def test_a_system_that_one_spring_makes_unstable_is_seen():
    mesh, elements = tapered()
    body = Body(mesh, elements)
    values = elements.tangent(mesh.nodes)[1]
    matrix = body.matrix([(values, elements.rows, elements.columns)], np.zeros_like(mesh.nodes), body.start)
    assert positive(matrix)
    tip = body.size - mesh.across
    push = np.zeros(body.size)
    push[tip] = 1.0
    softest = 1 / solve(matrix, push)[tip]
    for share, holds in ((0.99, True), (1.01, False)):
        weakened = matrix.copy()
        weakened[tip, tip] -= share * softest
        assert positive(weakened) == holds


# Poses


def unit_scene(x=0.7, y=0.0, body=None, **finger):
    return gr.Scene(finger=scenes.unit_finger(**finger), object=(body or Circle(radius=0.25)).at(x=x, y=y))


COARSE = {"elements": (30, 2), "law": "biot"}


def test_a_free_finger_carries_nothing():
    pose = still(unit_scene(y=-0.5), **COARSE)
    assert (pose.status, pose.force, pose.contacts, pose.depth) == ("free", (0, 0), (), 0)
    assert pose.tip == pytest.approx((1, 0))


@lru_cache
def pressed():
    return still(unit_scene(), **COARSE)


def test_the_finger_stays_out_of_the_object():
    assert 0 < pressed().depth < 1e-5


def test_moving_and_turning_the_scene_changes_nothing():
    turn = 0.7
    x, y = rotation(turn) @ (0.7, 0.0)
    scene = gr.Scene(
        finger=scenes.unit_finger().at(x=3, y=-1, angle=turn), object=Circle(radius=0.25).at(x=3 + x, y=y - 1)
    )
    assert still(scene, **COARSE).force == pytest.approx(pressed().force, rel=1e-7)


def test_the_mirrored_scene_has_the_mirrored_answer():
    scene = gr.Scene(finger=scenes.unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=0.0), approach=(0.0, -1.0))
    pose = still(scene, **COARSE)
    assert pose.force == pytest.approx((pressed().force[0], -pressed().force[1]), rel=1e-6)
    assert [contact.on for contact in pose.contacts] == ["upper"]


def test_a_stiffer_material_bends_alike():
    stiff = gr.Material(youngs_modulus=7 * 12 / 0.06**3, poisson_ratio=0.3)
    pose = still(unit_scene(material=stiff), **COARSE)
    assert pose.tip == pytest.approx(pressed().tip, abs=1e-8)
    assert pose.force == pytest.approx(tuple(7 * f for f in pressed().force), rel=1e-6)


@pytest.mark.parametrize("axis", [0, 1])
def test_the_force_is_the_slope_of_the_energy(axis):
    energies, step = [], 1e-4
    for side in (-step, step):
        scene = unit_scene(x=0.7 + side * (axis == 0), y=side * (axis == 1))
        setting, _ = assembled(scene, Model(**COARSE))
        solution = Follower(setting, relative(scene), 0.0, 0.0, (0.0, 1.0)).advance(0.0)
        strain = setting.system.elements.forces(solution.positions)[0]
        energies.append(strain + float(solution.touch.energy.sum()))
    slope = (energies[1] - energies[0]) / (2 * step)
    assert slope == pytest.approx(-pressed().force[axis], rel=1e-4)


@pytest.mark.parametrize("mu", [0.1, 0.4])
def test_a_sliding_contact_pulls_with_mu_times_its_normal_force(mu):
    flat = Polygon(vertices=((-0.5, -0.3), (0.5, -0.3), (0.5, 0.0), (-0.5, 0.0)))
    scene = gr.Scene(
        finger=scenes.unit_finger(),
        object=flat.at(x=0.9 - scenes.Q, y=0.1 - scenes.Q),
        motion=gr.Motion("q", (0.2, 0.0)),
        friction=gr.Friction(coefficient=mu),
    )
    pose = follow(scene, (0.2, 0.0), elements=(16, 2))[-1]
    fx, fy = pose.force
    normal = sum(contact.normal_force for contact in pose.contacts)
    assert math.hypot(fx, fy) == pytest.approx(normal * math.hypot(1, mu), rel=1e-6)


def test_a_jaw_may_have_friction_of_its_own():
    values = (0.08, 0.072)

    def force(mu):
        scene = scenes.micro_assembly(*values, friction=gr.Friction(coefficient=mu))
        return follow(scene, values, elements=(20, 2))[-1].force

    rough, smooth = force(0.3), force(0.0)
    assert force({"finger": 0.3, "jaw": 0.0}) == pytest.approx(smooth, rel=1e-6)
    assert force({"finger": 0.1, "jaw": 0.3}) == pytest.approx(rough, rel=1e-6)
    assert math.dist(rough, smooth) > 0.3 * math.hypot(*smooth)


@pytest.mark.parametrize("approach", [(0.0, 1.0), (0.0, -1.0)])
@pytest.mark.parametrize("sense", ["tipward", "baseward"])
def test_without_a_motion_friction_has_the_sense_that_the_scene_says(sense, approach):
    friction = gr.Friction(coefficient=0.3, sense=sense)
    placed = Circle(radius=0.25).at(x=0.7, y=0.0)
    scene = gr.Scene(finger=scenes.unit_finger(), object=placed, approach=approach, friction=friction)
    expected = gr.solve(scene).force_on_object
    assert math.dist(still(scene, **COARSE).force, expected) < 1e-2 * math.hypot(*expected)


def test_a_corner_thinner_than_an_element_does_not_slip_through():
    needle = Polygon(vertices=((-0.015, -0.3), (0.015, -0.3), (0.0, 0.0)))
    scene = unit_scene(x=0.713, y=0.1, body=needle)
    pose = still(scene, **COARSE)
    expected = gr.solve(scene)
    assert pose.force == pytest.approx(expected.force_on_object, rel=5e-3)
    assert [contact.on for contact in pose.contacts] == ["lower"]
    assert pose.contacts[0].s == pytest.approx(expected.contacts[0].s, abs=1e-3)


def test_a_finger_that_loses_its_hold_snaps_free():
    scene = gr.Scene(
        finger=scenes.unit_finger(),
        object=Circle(radius=0.25).at(x=0.95, y=scenes.Q),
        motion=gr.Motion("q", (-0.36, 0.8)),
    )
    held, gone = follow(scene, (-0.36, 0.65, 0.8), elements=(14, 1), law="biot")[1:]
    assert (held.status, held.snapped) == ("contact", False)
    assert (gone.status, gone.snapped) == ("free", True)
    assert gone.tip == pytest.approx((1, 0), abs=1e-6)


# Against the reference file (tests/reference/fem.json: error below 0.3 %)


def assert_as_reference(found, rows, within, strain=5e-3):
    assert len(found) == len(rows) > 0
    for pose, row in zip(found, rows, strict=True):
        assert pose.status == "contact"
        force = row["force_on_object"]
        assert math.dist(pose.force, force) < within * math.hypot(*force), row
        assert pose.tip == pytest.approx(row["tip"], abs=2e-5)
        assert pose.max_strain == pytest.approx(row["max_strain"], rel=strain, abs=1e-5)


def rotating(name, start, mu=0.0, **model):
    rows = FEM["rotating_finger"][name]
    values = [*start, *(row["x_e"] for row in rows)]
    scene = scenes.rotating_finger(*values, friction=gr.Friction(coefficient=mu))
    return follow(scene, values, elements=(108, 3), **model)[len(start) :], rows


@EVERY_LAW
def test_every_law_reproduces_its_reference_of_the_rotating_finger(law):
    name = {"svk": "svk, mu = 0, 5184 elements"}.get(law, f"{law}, mu = 0, 1296 elements")
    assert_as_reference(*rotating(name, (0.127,), law=law), within=0.003)


@pytest.mark.parametrize(
    ("name", "start", "law"),
    [
        ("svk, mu = 0.2, x_e falling, 5184 elements", (0.127,), "svk"),
        ("biot, mu = 0.2, x_e falling, 1296 elements", (0.127,), "biot"),
        ("svk, mu = 0.2, x_e rising, 1296 elements", (), "svk"),  # the first pose slides as the motion does
        ("biot, mu = 0.2, x_e rising, 1296 elements", (), "biot"),
    ],
)
def test_friction_reproduces_its_reference_of_the_rotating_finger(name, start, law):
    assert_as_reference(*rotating(name, start, law=law, mu=0.2), within=0.003)


def test_where_slip_turns_the_answer_does_not_depend_on_how_far_apart_the_poses_are():
    def last(*values):
        scene = scenes.rotating_finger(*values, friction=gr.Friction(coefficient=0.2))
        return follow(scene, values, elements=(27, 3))[-1]

    far, near = last(0.03, 0.0508), last(0.03, 0.04, 0.044, *np.arange(0.046, 0.0507, 5e-4), 0.0508)
    assert near.contacts[0].state == "stick"  # most points have turned, the beam slips the other way already
    assert math.dist(far.force, near.force) < 0.01 * math.hypot(*near.force)


def test_a_long_step_that_meets_the_object_does_not_count_its_way_there_as_slip():
    corners = [0.025 * np.exp(2j * np.pi * i / 24) for i in range(24)]
    target = Polygon(vertices=tuple((c.real, c.imag) for c in corners)).at(x=0.07, y=-0.02 + scenes.Q)
    nylon = gr.Material(youngs_modulus=2e9, poisson_ratio=0.4)
    scene = gr.Scene(
        finger=Uniform(length=0.1, thickness=0.006, width=0.01, material=nylon),
        object=target,
        motion=gr.Motion("q", (-0.02, -0.005)),  # which touches at -0.008, after two steps and a half
        friction=gr.Friction(coefficient=0.3),
    )
    pose, expected = follow(scene, (-0.02, -0.005), elements=(30, 2))[-1], gr.trace(scene).poses[-1]
    assert expected.force_on_object[0] > 3  # towards the tip; the way there, along the bent face, led to the base
    assert math.dist(pose.force, expected.force_on_object) < 0.01 * math.hypot(*pose.force)


@pytest.mark.parametrize(
    ("name", "jaw", "mu", "within"),
    [
        ("rigid jaw, mu = 0, 4560 elements", "rigid", 0.0, 0.003),
        ("rigid jaw, mu = 0.3, 4560 elements", "rigid", 0.3, 0.003),
        ("jaw of the finger's material, mu = 0, 8622 elements", "elastic", 0.0, 0.003),
        ("jaw of the finger's material, mu = 0.3, 2230 elements", "elastic", 0.3, 0.003),
    ],
)
def test_the_micro_assembly_finger_reproduces_its_reference(name, jaw, mu, within):
    rows = [row for row in FEM["micro_assembly"][name] if row["force_on_object"][1]]
    values = [0.08, *(row["x_o"] for row in rows)]
    scene = scenes.micro_assembly(*values, friction=gr.Friction(coefficient=mu))
    free, *found = follow(scene, values, elements=(108, 3), jaw=jaw)
    assert free.status == "free"
    if "2230" in name:  # its first touch is 1.1 % apart: the tests below say why
        found, rows = found[1:], rows[1:]
    assert_as_reference(found, rows, within, strain=2e-2)


# The one row of the reference that is further away: its light touch is narrower than the distance of its contact points

LIGHT = 0.076
"""Where the pin first presses the jaw."""


def light_row(mu):
    """The reference's row of the light touch on an elastic jaw."""
    (name,) = (name for name in FEM["micro_assembly"] if name.startswith(f"jaw of the finger's material, mu = {mu}, "))
    (row,) = (row for row in FEM["micro_assembly"][name] if row["x_o"] == LIGHT)
    return row["force_on_object"]


def lightly(*values, mu=0.3, **model):
    scene = scenes.micro_assembly(*values, friction=gr.Friction(coefficient=mu))
    (pose,) = (
        pose for pose, x in zip(follow(scene, values, jaw="elastic", **model), values, strict=True) if x == LIGHT
    )
    return pose


def steepness(force):
    """How far a force on the object leans from the finger's normal, in rad."""
    return math.atan2(force[0], -force[1])


def test_the_light_touch_does_not_depend_on_mesh_steps_or_start():
    once = lightly(0.08, LIGHT, elements=(54, 2)).force
    others = [lightly(0.08, LIGHT, elements=mesh).force for mesh in ((27, 2), (108, 3))]
    others += [lightly(*np.linspace(0.08, LIGHT, 9), elements=(54, 2)).force]  # in short steps
    others += [lightly(LIGHT, 0.07, elements=(54, 2)).force]  # pressed from above, not slid there
    assert max(math.dist(other, once) for other in others) < 1e-3 * math.hypot(*once)
    assert 1.0e-2 < math.dist(light_row(0.3), once) / math.hypot(*once) < 1.2e-2


def test_the_light_touch_slides_at_coulombs_angle_and_the_references_does_not():
    rough, smooth = lightly(0.08, LIGHT, elements=(108, 3)), lightly(0.08, LIGHT, mu=0.0, elements=(108, 3))
    assert rough.tip == pytest.approx(smooth.tip, abs=1e-6)  # the jaw's face stands at the same angle
    assert steepness(rough.force) - steepness(smooth.force) == pytest.approx(math.atan(0.3), abs=2e-4)
    assert math.dist(smooth.force, light_row(0)) < 1e-3 * math.hypot(*smooth.force)
    assert steepness(light_row(0.3)) - steepness(light_row(0)) > math.atan(0.3) + 7e-3


def on_one_point(setting, along):
    """The same finger, whose jaw touches nowhere but at this place along it."""
    contact = setting.system.contact
    away = np.where(contact.part[contact.places.edge] == JAW, np.abs(contact.places.along - along), np.inf)
    place = contact.places.pick([int(np.argmin(away))])
    place = replace(place, stiffness=30 * place.stiffness)  # which otherwise thirty or so share
    return replace(setting, system=replace(setting.system, contact=replace(contact, places=place)))


def test_one_contact_point_beside_the_light_touch_gives_the_force_of_the_reference():
    found, expected = lightly(0.08, LIGHT, elements=(108, 3)), light_row(0.3)
    radius = scenes.micro_assembly(LIGHT).object.body.radius
    beside = radius * (steepness(expected) - steepness(found.force))  # leans as far as the circle does there
    scene = scenes.micro_assembly(0.08, LIGHT, friction=gr.Friction(coefficient=0.3))
    setting, _ = assembled(scene, Model(elements=(108, 3), jaw="elastic"))

    def pressed_at(along):
        solution = Follower(on_one_point(setting, along), relative(scene), 0.08, LIGHT, (0.0, -1.0)).advance(LIGHT)
        return solution.touch.on_object

    there = found.contacts[0].s
    assert math.dist(pressed_at(there), found.force) < 1e-3 * math.hypot(*expected)
    assert math.dist(pressed_at(there - beside), expected) < 3e-4 * math.hypot(
        *expected
    )  # both components, of one number
    mesh = build(scenes.STRAIGHT, (167, 10), "elastic")
    face = np.linalg.norm(np.ptp(mesh.nodes[mesh.outline.edges[mesh.outline.part == JAW]][:, [0, 2]], axis=1), axis=1)
    assert len(mesh.elements) == 2230  # a mesh of the reference's size, its nodes half an edge apart
    assert 6e-5 < beside < face.min() / 4


# Meshes


def test_a_jaw_with_an_undercut_is_not_meshed():
    finger = Uniform(
        length=1.0,
        thickness=0.1,
        width=1.0,
        material=SOFT,
        jaw=PolygonJaw(vertices=((0.1, -0.05), (0.0, -0.2), (0.4, -0.05))),
    )
    build(finger, (4, 2), "rigid")
    with pytest.raises(ValueError, match="jaw must stand on the finger's face"):
        build(finger, (4, 2), "elastic")


@pytest.mark.parametrize("side", ["lower", "upper"])
def test_an_elastic_jaw_keeps_its_corners_and_its_name(side):
    jaw = Triangle(length=0.3, lead_angle=0.5, return_angle=1.2, side=side)
    mesh = build(scenes.unit_finger(jaw=jaw), (10, 2), "elastic")
    corners = mesh.nodes[mesh.outline.corners]
    hook = np.array(jaw.polygon(0.06))[1] + [1, 0]
    assert np.min(np.linalg.norm(corners - hook, axis=1)) < 1e-12
    on_jaw = mesh.nodes[mesh.outline.edges[mesh.outline.part == 3]]
    assert np.all(on_jaw[:, :, 0] >= 1) and np.all(on_jaw[:, :, 1] * (1 if side == "upper" else -1) > 0)


def test_a_profile_must_be_positive():
    with pytest.raises(ValueError, match=r"width must be positive along the finger, in m; got -0\.5"):
        build(scenes.unit_finger(width=1 - 1.5 * S), (4, 2))


# The report


@lru_cache
def report():
    return verify(scenes.micro_assembly(0.086, 0.062), (0.08, 0.07), elements=(20, 2), law="biot")


def test_the_report_compares_pose_by_pose():
    free, held = report().poses
    assert (free.elements.status, free.force_difference) == ("free", None)
    assert 0 < held.force_difference < 5e-3
    assert held.mesh_error < 1e-2
    assert held.tip_difference < 1e-5
    assert set(held.laws) == {"svk", "hencky"}
    assert report().largest_difference == held.force_difference
    assert report().failed == ()


def test_the_report_is_a_table_a_csv_and_json():
    text = str(report()).splitlines()
    assert all(len(line) <= 120 for line in text)
    assert any(line.split()[:2] == ["0.07", "contact"] for line in text)
    rows = report().csv().splitlines()
    assert rows[0].startswith("q,status,elements_force_x_N")
    assert [len(row.split(",")) for row in rows] == [rows[0].count(",") + 1] * 3
    written = json.loads(json.dumps(report().to_dict(), allow_nan=False))
    assert written["poses"][1]["elements"]["contacts"][0]["on"] == "jaw"


def broken():
    free, held = report().poses
    lost = replace(held, elements=Found(status="failed", reason="an element is inverted"), force_difference=None)
    return replace(report(), poses=(free, lost))


def test_a_pose_without_an_answer_is_named_with_its_reason_and_has_no_numbers():
    (lost,) = broken().failed
    assert lost == broken().poses[1]
    assert broken().largest_difference is None
    assert "q = 0.07: elements: an element is inverted" in str(broken()).splitlines()
    assert broken().to_dict()["poses"][1]["elements"]["force"] is None


def test_a_scene_of_one_pose_is_verified_beside_a_result_that_is_there():
    scene, calls = unit_scene(), []
    result = gr.solve(scene)
    single = verify(scene, elements=(60, 4), law="biot", laws=False, result=result, progress=lambda *n: calls.append(n))
    assert single.poses[0].gripper.force == result.force_on_object
    assert single.largest_difference < 5e-3
    assert calls == [(1, 2), (2, 2)]


def test_poses_may_be_chosen_along_a_motion_that_turns():
    back = gr.Motion("q", (0.0, 1.0, 2.0, 1.0, 0.0))
    assert passing(back, (0.5, 1.5, 0.5)) == ([0.0, 0.5, 1.5, 2.0, 0.5], [False, True, True, False, True])
    assert passing(back, (2.0,)) == ([0.0, 2.0], [False, True])
    assert passing(back, None) == ([0.0, 1.0, 2.0, 1.0, 0.0], [True] * 5)
    with pytest.raises(ValueError, match=r"values that the motion passes, 0 to 2 to 0, in its order; got 3\.0"):
        passing(back, (0.5, 3.0))


def test_poses_of_a_motion_that_goes_one_way_may_be_given_in_any_order():
    falling = gr.Motion("q", (2.0, 1.0, 0.0))
    assert passing(falling, (2.0,)) == ([2.0, 1.0], [True, False])  # the way on says how the first pose slides
    assert passing(falling, (0.5, 2.0, 1.5)) == ([2.0, 1.5, 0.5], [True, True, True])
    for poses, words in (((), "at least one value; got none"), ((2.5,), r"passes, 2 to 0; got 2\.5")):
        with pytest.raises(ValueError, match=words):
            passing(falling, poses)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"elements": (1, 2)}, ValueError, "elements must be two whole numbers, at least 2"),
        ({"law": "rubber"}, LookupError, "unknown law 'rubber'; known: svk, biot, hencky"),
        ({"jaw": "none"}, LookupError, "unknown jaw 'none'; known: rigid, elastic"),
        ({"poses": (1.0,)}, ValueError, r"poses must be left out for a scene without motion; got \[1\.0\]"),
    ],
)
def test_wrong_arguments_are_named(arguments, error, words):
    scene = unit_scene(y=-0.5)
    with pytest.raises(error, match=words):
        verify(scene, result=gr.solve(scene), **arguments)


@dataclass(frozen=True, kw_only=True)
class Heavy(gr.Scene):
    """A scene with a number that the elements have not heard of."""

    gravity: float = 0.0


def test_a_scene_that_the_elements_would_not_take_in_whole_is_refused():
    parts = {"finger": scenes.unit_finger(), "object": Circle(radius=0.25).at(x=0.7, y=-0.5)}
    light = Heavy(**parts)
    assert verify(light, elements=(8, 2), laws=False, result=gr.solve(light)).failed == ()
    with pytest.raises(ValueError, match=r"gravity must be left out .* the elements do not know it; got 9\.81"):
        verify(Heavy(**parts, gravity=9.81))


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"rest_curvature": 0.5}, r"finger\.rest_curvature must be left out to be verified"),
        ({"base": gr.Base(rotational_stiffness=2.0)}, r"finger\.base must be left out to be verified"),
    ],
)
def test_a_finger_that_is_bent_at_rest_or_held_softly_is_refused_by_name(more, words):
    scene = gr.Scene(finger=scenes.unit_finger(**more), object=Circle(radius=0.25).at(x=0.7, y=-0.5))
    with pytest.raises(ValueError, match=words):
        verify(scene)


def test_loads_are_refused_by_name():
    loaded = gr.Scene(**{**vars(unit_scene()), "loads": (Force(force=(0.0, 1.0)),)})
    with pytest.raises(ValueError, match=r"loads must be left out to be verified, as the elements do not know it"):
        verify(loaded)


# The command


HOOK = (Path(__file__).parent.parent / "gallery" / "micro_assembly.toml").read_text()
QUICK = ("--elements", "20x2", "--no-laws")


def command(folder, text, *arguments):
    path = folder / "scene.toml"
    path.write_text(text)
    return CliRunner().invoke(app, ["verify", str(path), "-o", str(folder / "out"), *arguments])


def test_the_command_prints_its_table_on_one_screen_and_writes_it_three_times(tmp_path):
    outcome = command(tmp_path, HOOK, *QUICK, "--poses", "64 mm, 0.07", "--jaw", "elastic")
    assert (outcome.exit_code, outcome.stderr) == (0, "")
    lines = outcome.stdout.splitlines()
    assert len(lines) < 24 and all(len(line) <= 120 for line in lines)
    paths = [tmp_path / "out" / name for name in ("verify.json", "verify.csv", "verify.md")]
    assert lines[-3:] == [str(path) for path in paths]
    data, rows, prose = json.loads(paths[0].read_text()), paths[1].read_text().splitlines(), paths[2].read_text()
    assert data["model"]["jaw"] == "elastic" and data["largest_difference"] < 0.01
    assert [pose["parameter"] for pose in data["poses"]] == [0.07, 0.064]  # in the motion's order
    assert [row.split(",")[0] for row in rows] == ["x_o", "0.07", "0.064"]
    assert prose.count("| 0.064 | ") == 2 and lines[0] in prose


def test_the_command_chooses_poses_in_contact(tmp_path):
    few = HOOK.replace("poses = 37", "poses = 3").replace("from = 0.086", "from = 0.08").replace("0.050", "0.07")
    outcome = command(tmp_path, few, *QUICK)
    chosen = [pose["parameter"] for pose in json.loads((tmp_path / "out" / "verify.json").read_text())["poses"]]
    assert outcome.exit_code == 0
    assert chosen == pytest.approx([0.075, 0.07])


@pytest.mark.parametrize(("within", "status"), [("1 %", 0), ("0.01", 0), ("0.001 %", 1)])
def test_a_difference_beyond_the_limit_ends_the_command_with_status_1(tmp_path, within, status):
    outcome = command(tmp_path, HOOK, *QUICK, "--poses", "0.07", "--within", within)
    largest = json.loads((tmp_path / "out" / "verify.json").read_text())["largest_difference"]
    assert 1e-5 < largest < 1e-2
    assert outcome.exit_code == status
    beyond = f"the forces differ by up to {100 * largest:.2f} %, more than --within {within}"
    assert outcome.stderr.splitlines() == [beyond] * status


def test_a_pose_without_an_answer_ends_the_command_with_status_1_and_all_others_are_written(tmp_path, monkeypatch):
    monkeypatch.setattr("gripper.verify.verify", lambda *_, **__: broken())  # one takes a minute to fail by itself
    outcome = command(tmp_path, HOOK, "--poses", "0.08, 0.07", "--within", "1 %")
    assert (outcome.exit_code, outcome.stderr) == (1, "")
    assert "q = 0.07: elements: an element is inverted" in outcome.stdout.splitlines()
    free, lost = json.loads((tmp_path / "out" / "verify.json").read_text())["poses"]
    assert (free["elements"]["status"], lost["elements"]["force"]) == ("free", None)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--within", "much"), "within must be a positive number, or one with %: expression must hold known names"),
        (("--within", "-1 %"), "within must be a positive number, or one with %; got '-1 %'"),
        (("--poses", "1"), "scene.toml: poses must be values that the motion passes, 0.086 to 0.05; got 1.0"),
        (("--poses", "0.07, x"), "poses must be numbers with commas between, or all: expression must hold known names"),
        (("--elements", "9"), "elements must be two whole numbers, as 108x4; got '9'"),
        (("--elements", "1x1", "--poses", "0.07"), "elements must be two whole numbers, at least 2; got (1, 1)"),
    ],
)
def test_a_bad_option_ends_with_status_2_one_line_and_nothing_written(tmp_path, arguments, words):
    outcome = command(tmp_path, HOOK, *arguments)
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert words in outcome.stderr and len(outcome.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


# Independence


FOLDER = Path(gripper.verify.__file__).parent
SHARED = {
    "fingers",
    "friction",
    "objects",
    "pose",
    "results",
    "result",
    "scene",
    "verify",
}  # data, g and the profile


@pytest.mark.parametrize("module", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_the_elements_share_nothing_with_the_solver_but_data(module):
    tree = ast.parse(module.read_text())
    names = [
        f"{node.module}.{alias.name}" for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names
    ]
    names += [alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names]
    ours = {name.split(".")[1] for name in names if name.startswith("gripper.")}
    assert ours <= SHARED


def test_solving_does_not_import_the_elements():
    code = """
import sys, gripper as gr, gripper.plot, gripper.cli
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects.circle import Circle
rubber = gr.Material(youngs_modulus=1e6, poisson_ratio=0.3)
finger = Uniform(length=1.0, thickness=0.05, width=1.0, material=rubber)
gr.solve(gr.Scene(finger=finger, object=Circle(radius=0.25).at(x=0.7, y=-0.2)))
print([name for name in sys.modules if name.startswith("gripper.verify")])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
