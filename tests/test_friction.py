"""Friction in equilibrium: slip, stick, memory, events, energy, locking, against the references and itself."""

from __future__ import annotations

import dataclasses
import json
import math

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import gripper as gr
from gripper.assemble import setting
from gripper.contact.grip import Grip
from gripper.contact.kinematics import Kinematics
from gripper.contact.law import Law
from gripper.contact.linear import linearise
from gripper.contact.site import Site
from gripper.motion.tracker import Tracker, tracker_for
from gripper.statics.equilibrium import State
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.ellipse import Ellipse
from tests.rubbing import at, balance, check_coulomb, force, off
from tests.scenes import BEAM, EXACT, REFERENCE, TAPERED, Q, follow, micro_assembly, rotating_finger, still, unit_finger

FEM = json.loads((REFERENCE / "fem.json").read_text())
SLIPPERY, ROUGH = gr.Friction(coefficient=0.2), gr.Friction(coefficient=0.3)
RISING = [round(-0.1016 + 0.0127 * i, 6) for i in range(14)]
INSERTED = [0.086 - 0.026 * i / 36 for i in range(37)]


@pytest.fixture(scope="module")
def example_2():
    """Example II in both directions, with both theories."""
    values = sorted({*RISING, 0.05588})
    falling = [0.127, 0.08, *values[::-1]]
    return {
        (theory, way): gr.trace(rotating_finger(*poses, theory=theory, friction=SLIPPERY))
        for theory in ("shear", "bending")
        for way, poses in (("rising", values), ("falling", falling))
    }


@pytest.fixture(scope="module")
def example_1():
    """Example I, there and back."""
    values = sorted({*INSERTED, 0.06781, 0.064, 0.076, 0.072, 0.062}, reverse=True)
    return gr.trace(micro_assembly(*values, *values[-2::-1], friction=ROUGH))


# numbers from elsewhere


def test_a_scene_without_motion_slips_as_it_is_told():
    row = next(v for k, v in EXACT.items() if k.startswith("uniform finger on a circle"))["rows"][3]
    x, y, ratio, normal, fx, fy, s, _, energy = row
    assert ratio == 0.3
    friction = gr.Friction(coefficient=0.3, sense="baseward")
    target = Circle(radius=0.25).at(x=x, y=y)
    scene = gr.Scene(finger=unit_finger(), object=target, friction=friction, theory="bending", tolerance=1e-7)
    pose = gr.solve(scene).pose
    contact = pose.contacts[0]
    found = (*(-force(pose)), contact.normal_force, -contact.tangential_force, contact.s, pose.energy)
    np.testing.assert_allclose(found, (fx, fy, normal, 0.3 * normal, s, energy), rtol=1e-6)
    assert contact.state == "slip"


ROWS = [
    (theory, way, float(x), row["force_on_object"])
    for x, rows in BEAM["rotating_finger"]["poses"].items()
    for name, row in rows.items()
    if "mu = 0.2" in name
    for theory, way in [(name.split(",")[0], name.split()[-1])]
]


@pytest.mark.parametrize(("theory", "way", "x", "expected"), ROWS)
def test_example_2_has_the_reference_s_forces_in_both_directions(example_2, theory, way, x, expected):
    assert off(at(example_2[theory, way], x), expected) < 1e-5


@pytest.mark.parametrize("x", [0.06781, 0.064])
def test_example_1_has_the_reference_s_forces(example_1, x):
    expected = BEAM["micro_assembly"]["poses"][str(x)]["mu = 0.3"]
    pose = at(example_1, x)
    assert off(pose, expected["force_on_object"]) < 1e-6
    assert pose.contacts[0].normal_force == pytest.approx(expected["normal_force"], rel=1e-6)


SENSES = {
    ("shear", "rising"): [("stick", 0.04770), ("slip", 0.05051)],
    ("bending", "rising"): [("stick", 0.04735), ("slip", 0.05010)],
    ("shear", "falling"): [("touch", 0.0694), ("stick", 0.0477), ("slip", 0.0445)],
    ("bending", "falling"): [("touch", 0.0694), ("stick", 0.0473), ("slip", 0.0442)],
}


@pytest.mark.parametrize("way", SENSES)
def test_slip_stops_and_starts_where_the_reference_says(example_2, way):
    events = example_2[way].events
    assert [e.kind for e in events] == [kind for kind, _ in SENSES[way]]
    np.testing.assert_allclose([e.parameter for e in events], [x for _, x in SENSES[way]], rtol=0, atol=6e-5)


LAWS = {
    "svk, mu = 0.2, x_e falling, 5184 elements": (0.021, "falling"),
    "biot, mu = 0.2, x_e falling, 1296 elements": (0.006, "falling"),
    "svk, mu = 0.2, x_e rising, 1296 elements": (0.021, "rising"),
    "biot, mu = 0.2, x_e rising, 1296 elements": (0.006, "rising"),
}


@pytest.mark.parametrize("law", LAWS)
def test_example_2_is_as_near_to_finite_elements_as_the_beam_can_be(example_2, law):
    limit, way = LAWS[law]
    for row in FEM["rotating_finger"][law]:
        assert off(at(example_2["shear", way], row["x_e"]), row["force_on_object"]) < limit


def test_example_1_is_as_near_to_finite_elements_as_the_beam_can_be(example_1):
    for row in FEM["micro_assembly"]["rigid jaw, mu = 0.3, 4560 elements"][1:]:
        assert off(at(example_1, row["x_o"]), row["force_on_object"]) < 2e-3


# the history


def test_an_answer_does_not_depend_on_how_far_apart_the_poses_are():
    coarse = gr.trace(rotating_finger(*sorted({*RISING, 0.05588}), friction=SLIPPERY))
    fine = np.round(np.arange(-0.1016, 0.0640, 0.00079375), 8)
    fine = gr.trace(rotating_finger(*sorted({*fine.tolist(), *RISING, 0.05588}), friction=SLIPPERY))
    for pose in coarse.poses:
        assert off(pose, force(at(fine, pose.parameter))) < 1e-8
    for one, other in zip(coarse.events, fine.events, strict=True):
        assert (one.kind, one.parameter) == (other.kind, pytest.approx(other.parameter, abs=1e-8))


def test_a_motion_that_starts_in_contact_holds_as_if_it_had_come_that_way(example_2):
    late = gr.trace(rotating_finger(-0.0254, 0.0, friction=SLIPPERY))
    for pose in late.poses:
        assert pose.contacts[0].state == "slip"
        assert off(pose, force(at(example_2["shear", "rising"], pose.parameter))) < 1e-7
    assert late.poses[0].work == late.poses[0].dissipation == 0


def test_a_step_over_the_whole_of_the_stick_does_not_miss_it():
    leap = gr.trace(rotating_finger(0.127, 0.0508, 0.0254, friction=SLIPPERY))
    assert [e.kind for e in leap.events] == ["touch", "stick", "slip"]
    assert leap.events[2].parameter == pytest.approx(0.0445, abs=4e-5)


def test_where_the_motion_turns_the_contact_sticks_first(example_1):
    kinds = [(e.kind, e.parameter) for e in example_1.events]
    turned = kinds.index(("stick", INSERTED[-1]))
    assert kinds[turned + 1][0] == "slip"
    assert 0 < kinds[turned + 1][1] - INSERTED[-1] < 1e-4


def test_a_turning_point_within_the_stick_leads_back_along_the_same_curve():
    there = gr.trace(micro_assembly(*INSERTED, 0.06000577, 0.0600115, 0.06000577, 0.06, friction=ROUGH))
    *_, a, b, c, d = there.poses
    assert [p.contacts[0].state for p in (a, b, c)] == ["stick"] * 3
    assert off(a, force(c)) < 1e-9
    assert off(d, force(there.poses[36])) < 1e-9


def test_the_whole_scene_moved_rigidly_makes_no_slip():
    x, y = 0.09 * sympy.cos(Q) + 0.012 * sympy.sin(Q), 0.09 * sympy.sin(Q) - 0.012 * sympy.cos(Q)
    target = Ellipse(semi_axes=(0.04953, 0.033655)).at(x=x + Q, y=y - Q, angle=Q)
    finger = TAPERED.at(x=Q, y=-Q, angle=Q)
    motion = gr.Motion("q", (0.0, 0.3, 1.0, 2.0))
    result = gr.trace(gr.Scene(finger=finger, object=target, motion=motion, theory="shear", friction=SLIPPERY))
    for pose in result.poses:
        assert off(pose, force(result.poses[0])) < 1e-7
        assert abs(pose.dissipation) <= 1e-9 * pose.energy
        assert abs(pose.work) <= 1e-9 * pose.energy
    assert not result.events


# mu = 0 and small


def numbers(result):
    return [dataclasses.replace(p, seconds=0.0).to_dict() for p in result.poses]


@pytest.mark.parametrize("coefficient", [0, 0.0, {"finger": 0, "jaw": 0}])
def test_a_coefficient_of_0_leaves_friction_out(coefficient):
    values = (0.08, 0.072, 0.064, 0.06, 0.066)
    without = gr.trace(micro_assembly(*values))
    nothing = gr.trace(micro_assembly(*values, friction=gr.Friction(coefficient=coefficient)))
    assert numbers(without) == numbers(nothing)
    assert nothing.loop is None
    scene = micro_assembly(*values, friction=gr.Friction(coefficient=coefficient))
    assert setting(scene).friction is None
    assert tracker_for(setting(scene)) is Tracker
    assert [(part.what, part.why) for part in gr.assemble(still(scene)).left_out if part.what == "friction"]
    for solved in follow(scene):
        assert solved.equilibrium.linear.rubbing is None
        assert all(
            site.grip is None and site.unknowns == site.unknown_places for site in solved.equilibrium.state.sites
        )


def test_small_friction_is_a_small_change():
    values = (0.086, 0.072, 0.066, 0.064, 0.06)
    without = gr.trace(micro_assembly(*values))
    for mu in (1e-3, 1e-6):
        little = gr.trace(micro_assembly(*values, friction=gr.Friction(coefficient=mu)))
        for one, other in zip(little.poses[1:], without.poses[1:], strict=True):
            assert off(one, force(other)) < 2 * mu


# Coulomb's law


@settings(max_examples=15, deadline=None)
@given(
    st.floats(0.01, 0.8),
    st.floats(0.45, 0.85),
    st.floats(-0.2, -0.05),
    st.floats(0.08, 0.25),
    st.sampled_from(["tipward", "baseward"]),
)
def test_friction_of_a_given_sense_follows_coulomb_s_law(mu, x, y, radius, sense):
    friction = gr.Friction(coefficient=mu, sense=sense)
    scene = gr.Scene(finger=unit_finger(), object=Circle(radius=radius).at(x=x, y=y), friction=friction)
    pose = gr.solve(scene).poses[0]
    assert pose.status in ("contact", "free")
    check_coulomb(pose, lambda _: mu)
    for contact in pose.contacts:
        assert (contact.tangential_force > 0) == (sense == "tipward")


def rolled_over(mu, x, drift, depth, values):
    """A circle that presses the finger at x and drifts along it, here and back."""
    target = Circle(radius=0.15).at(x=x + drift * 0.2 * Q, y=-0.2 + depth * Q)
    friction = gr.Friction(coefficient=mu)
    return gr.trace(gr.Scene(finger=unit_finger(), object=target, motion=gr.Motion("q", values), friction=friction))


@settings(max_examples=8, deadline=None)
@given(st.floats(0.02, 0.5), st.floats(0.3, 0.9), st.floats(-0.5, 1.0), st.floats(0.05, 0.18))
def test_friction_along_any_motion_follows_coulomb_s_law_and_dissipates(mu, x, drift, depth):
    poses = rolled_over(mu, x, drift, depth, (0.0, 0.4, 0.8, 1.0, 0.8, 0.5, 0.2)).poses
    for pose in poses:
        assert pose.status in ("contact", "free")
        check_coulomb(pose, lambda _: mu)
        assert pose.checks.other_solutions == ()
        assert pose.checks.singularity is None or pose.checks.singularity > 0
    assert balance(poses).max() < 1e-3


def test_near_the_clamp_slip_that_reverses_ends_in_stick_and_not_in_a_snap():
    result = rolled_over(0.441, 0.2408, 0.004, 0.07, (0.0, 0.4, 0.8, 1.0, 0.8, 0.5, 0.2))
    assert "snap" not in {event.kind for event in result.events}
    assert balance(result.poses).max() < 1e-3


def test_the_balance_of_energy_converges_with_the_steps():
    def off_balance(parts):
        values = [*np.linspace(0.3, 1.0, 7 * parts + 1).tolist()]
        return balance(rolled_over(0.3, 0.45, 0.3, 0.12, (0.0, *values)).poses[1:]).mean()

    coarse, middle, fine = (off_balance(parts) for parts in (1, 2, 4))
    assert fine < middle / 3 < coarse / 9


def test_mu_may_vary_along_the_finger_and_differ_on_the_jaw(example_1):
    s = sympy.Symbol("s")
    graded = gr.trace(rotating_finger(-0.0254, 0.0, 0.0254, friction=gr.Friction(coefficient=0.1 + s)))
    for pose in graded.poses:
        contact = pose.contacts[0]
        assert abs(contact.tangential_force) == pytest.approx((0.1 + contact.s) * contact.normal_force, rel=1e-3)
    values = (0.086, 0.072, 0.06781)
    jaw = gr.trace(micro_assembly(*values, friction=gr.Friction(coefficient={"finger": 0.9, "jaw": 0.3})))
    assert off(jaw.poses[-1], force(at(example_1, 0.06781))) < 1e-9


# energy


def test_work_is_stored_or_lost_at_every_step(example_1, example_2):
    assert balance(example_1.poses).max() < 1e-4
    for result in example_2.values():
        assert balance(result.poses).max() < 1e-4


def test_work_is_stored_or_lost_where_the_axis_stretches_too():
    """The way along the finger is measured along its stretched face, or slip would work on what is not there."""
    poses = gr.trace(rotating_finger(*RISING, theory="stretch", friction=SLIPPERY)).poses
    assert {"slip", "stick"} == {contact.state for pose in poses for contact in pose.contacts}
    assert balance(poses).max() < 1e-4


def test_the_motion_s_force_is_the_slope_of_work_also_with_friction():
    values = np.linspace(0.07, 0.066, 9)
    poses = gr.trace(micro_assembly(0.086, *values.tolist(), friction=ROUGH)).poses[1:]
    by_force = np.trapezoid([p.motion_force for p in poses], values)
    assert by_force == pytest.approx(poses[-1].work - poses[0].work, rel=1e-3)


def test_the_loop_is_closed_and_its_peaks_do_not_depend_on_the_poses(example_1):
    loop = example_1.loop
    coarse = gr.trace(micro_assembly(*INSERTED[::3], *INSERTED[-4::-3], friction=ROUGH)).loop
    for name in ("peak_insertion_force", "peak_insertion_parameter", "peak_retention_force", "ratio"):
        assert getattr(coarse, name) == pytest.approx(getattr(loop, name), rel=1e-6)
    assert loop.work_in - loop.work_out == pytest.approx(loop.dissipation, rel=1e-4)
    sampled = [p.motion_force for p in example_1.poses]
    assert loop.peak_insertion_force >= -min(sampled)
    assert loop.peak_retention_force >= max(sampled)
    assert "loop" in example_1.to_dict()


# the paper's


def test_the_published_model_splits_the_frictionless_force():
    def pose(**options):
        friction = gr.Friction(coefficient=0.3, sense="baseward", **options)
        scene = gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=0.0), friction=friction)
        return gr.solve(scene)

    without = gr.solve(gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=0.0)))
    published, exact = pose(model="published"), pose()
    assert published.tip == without.tip
    assert published.clamp_moment == without.clamp_moment
    x, y = published.contacts[0].point
    fx, fy = published.force_on_object
    assert -(x * fy - y * fx) == pytest.approx(published.clamp_moment, rel=1e-6)
    check_coulomb(published.pose, lambda _: 0.3)
    assert 0.003 < off(published.pose, force(exact.pose)) < 0.03
    assert any("paper's approximation" in note for note in published.model.not_modelled)


# what a user may ask


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"coefficient": -0.1}, "coefficient must be at least 0; got -0.1"),
        ({"coefficient": 0.1 - sympy.Symbol("s")}, "coefficient must be at least 0; got"),
        ({"coefficient": sympy.Symbol("z")}, "coefficient must be a number or an expression in s; got z"),
        ({"coefficient": 0.2, "sense": "tipward"}, "sense must be left out: in a motion"),
        ({"coefficient": 0.2, "model": "published"}, "sense must be 'tipward' or 'baseward' in the published model"),
    ],
)
def test_a_scene_refuses_friction_that_makes_no_sense(options, message):
    with pytest.raises(ValueError, match=message):
        rotating_finger_of_one_metre(gr.Friction(**options))


def rotating_finger_of_one_metre(friction):
    motion = gr.Motion("q", (0.0, 1.0))
    return gr.Scene(finger=unit_finger(), object=Circle(radius=0.2).at(x=Q, y=-0.1), motion=motion, friction=friction)


def test_a_scene_without_motion_needs_a_sense():
    with pytest.raises(ValueError, match=r"friction must come with a motion, along which .*; got neither"):
        gr.Scene(finger=unit_finger(), object=Circle(radius=0.2), friction=SLIPPERY)


@pytest.mark.parametrize("options", [{"model": "viscous"}, {"sense": "up"}, {"coefficient": {"finger": 0.1}}])
def test_friction_refuses_what_it_does_not_know(options):
    with pytest.raises(ValueError, match="must"):
        gr.Friction(**{"coefficient": 0.2, **options})


# derivatives

MADE = {
    "tangent": (Site("tangent", 0, (0.6,)),),
    "upper": (Site("tangent", 1, (0.6,)),),
    "patch": (Site("patch", 0, (0.6, 0.65), modes=2),),
    "corner": (Site("tangent", 0, (0.5,)), Site("corner", 4, ())),
}


@pytest.mark.parametrize("hold", ["slip", "stick"])
@pytest.mark.parametrize("kind", MADE)
def test_the_linearisation_with_friction_is_the_derivative_of_its_equations(kind, hold):
    scene = rotating_finger(0.0, 0.1)
    fixed = setting(scene)
    law = Law(0.2 + 2 * sympy.Symbol("s"), 0.3, fixed.outline, fixed.sections.length, 0)
    grip = Grip(law, hold, 1 if hold == "slip" else 0, 0.13)
    sites = law.grouped(tuple(dataclasses.replace(site, grip=grip) for site in MADE[kind]))
    beam, random = fixed.beam(sites, 4), np.random.default_rng(1)
    z = 0.05 * np.sin(np.arange(beam.size))
    load = 0.5 + random.random(sum(site.multipliers for site in sites))
    frame = Kinematics(scene, fixed.sections.length).frame

    def lin(state, q=0.02):
        return linearise(beam, state.z, fixed.outline, fixed.obstacle(frame(q)), state.sites, state.multipliers)

    def equations(state, q=0.02):
        found = lin(state, q)
        return np.concatenate([state.z - found.loads.T @ state.multipliers, found.values, found.residuals])

    state = State(beam, z, sites, load)
    if hold == "stick":
        anchors = lin(state, 0.01).rubbing.anchors
        held = [
            dataclasses.replace(site, grip=dataclasses.replace(site.grip, anchor=anchor))
            for site, anchor in zip(sites, anchors, strict=True)
        ]
        state = State(beam, z + 0.001, tuple(held), load)
    found, n, m = lin(state), beam.size, len(load)
    matrix = np.block(
        [
            [np.eye(n) - found.hessian, -found.loads.T, -found.load_slopes],
            [found.gradients, np.zeros((m, m)), found.value_slopes],
            [found.residual_gradients, np.zeros((len(found.residuals), m)), found.residual_slopes],
        ]
    )
    values, residuals, loads = found.rates()
    rates = np.concatenate([-loads, values, residuals])
    step = 1e-6
    for _ in range(4):
        way = random.standard_normal(len(matrix)) * np.r_[np.ones(n + m), np.full(len(matrix) - n - m, 1e-3)]
        parts = np.split(step * way, [n, n + m])
        change = equations(state.moved(*parts)) - equations(state.moved(*(-part for part in parts)))
        np.testing.assert_allclose(change / (2 * step), matrix @ way, atol=1e-4 * np.abs(matrix @ way).max())
    change = equations(state, 0.02 + step) - equations(state, 0.02 - step)
    np.testing.assert_allclose(change / (2 * step), rates, atol=1e-6 * math.sqrt(rates @ rates))


def test_friction_makes_balance_checks_of_the_whole_force():
    for solved in follow(rotating_finger(-0.0254, 0.0, friction=SLIPPERY)):
        checks = solved.result.checks
        assert checks.stability is None
        assert max(checks.force_balance, checks.moment_balance) < 1e-3


# what it costs


def test_a_pose_that_slips_costs_at_most_three_times_one_without_friction():
    def costs(friction):
        gr.trace(micro_assembly(0.08, 0.07, friction=friction))  # compiles what is compiled once
        seconds = [gr.trace(micro_assembly(*INSERTED, *INSERTED[-2::-1], friction=friction)).poses for _ in range(2)]
        best = [min(one.seconds, other.seconds) for one, other in zip(*seconds, strict=True)]
        slipping = [cost for cost, pose in zip(best, seconds[0], strict=True) if pose.status == "contact"]
        return np.median(slipping), sum(best)

    (slipping, loop), (smooth, there_and_back) = costs(ROUGH), costs(None)
    assert slipping < 3 * smooth
    assert loop < 3 * there_and_back
