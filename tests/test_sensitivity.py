"""Sensitivities: against differences of the same discrete equations, of whole solves, and laws that they must obey."""

from __future__ import annotations

import dataclasses
import math
import pickle
import re

import numpy as np
import pytest
import sympy

import gripper as gr
from gripper.assemble import setting
from gripper.contact.kinematics import Kinematics
from gripper.fingers import S
from gripper.objects import FeatureSurface
from gripper.parameters import numbers, replaced
from gripper.pose import placed
from gripper.sensitivity import PoseSensitivity
from gripper.sensitivity.object_rates import object_rates
from gripper.sensitivity.opened import NotOpenError
from gripper.statics.answer import Answer, pose_result
from gripper.statics.certificate import survey
from gripper.statics.newton import polished, settle
from gripper.statics.verified import Verified
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.loads import FollowingForce, Force, Gravity, Moment, Tendon
from gripper_plugins.objects import (
    Circle,
    Difference,
    Ellipse,
    Grown,
    HalfPlane,
    Intersection,
    Polygon,
    Spline,
    Union,
)
from tests.scenes import PLASTIC, RUBBER, TAPERED, Q, follow, micro_assembly, rotating_finger, unit_finger

ROUGH, SLIPPERY = gr.Friction(coefficient=0.3), gr.Friction(coefficient=0.2)
NAMES = [f.name for f in dataclasses.fields(PoseSensitivity) if f.name not in ("parameter", "kind", "reason")]


def bent(curvature, **options):
    """A finger that is bent at rest, and a circle that comes from below."""
    motion, body = gr.Motion("q", (-0.6, -0.1)), Circle(radius=0.15).at(x=0.6, y=Q)
    return gr.Scene(finger=unit_finger(rest_curvature=curvature), object=body, motion=motion, **options)


BLUNT = tuple((0.0089 * math.cos(a), 0.0089 * math.sin(a)) for a in np.arange(0.1, 6.0, math.pi / 4))
UNEVEN = ((0.02, 0.0), (0.011, 0.015), (-0.012, 0.013), (-0.02, -0.001), (-0.004, -0.009), (0.01, -0.014))


def pushed(body, angle, theory, **options):
    """Example II's finger, and an object that comes from below."""
    motion = gr.Motion("q", (-0.06, -0.025))
    return gr.Scene(finger=TAPERED, object=body.at(x=0.12, y=Q, angle=angle), motion=motion, theory=theory, **options)


MOTIONS = {
    "I, lead face": micro_assembly(0.086, 0.0678),
    "I, hook's corner": micro_assembly(0.086, 0.0629),
    "I, lead face, slipping": micro_assembly(0.086, 0.0678, friction=ROUGH),
    "I, hook's corner, slipping": micro_assembly(0.086, 0.055, friction=ROUGH),
    "II": rotating_finger(-0.1016, 0.0),
    "II, bending": rotating_finger(-0.1016, 0.0508, theory="bending"),
    "II, slipping": rotating_finger(-0.1016, 0.0, friction=SLIPPERY),
    "II, slipping the other way": rotating_finger(-0.1016, 0.06, friction=SLIPPERY),
    "I, hook's corner, stretch, slipping": micro_assembly(0.086, 0.055, theory="stretch", friction=ROUGH),
    "II, stretch": rotating_finger(-0.1016, 0.0, theory="stretch"),
    "II, stretch, slipping": rotating_finger(-0.1016, 0.0, theory="stretch", friction=SLIPPERY),
    "a polygon's corner, slipping": pushed(Polygon(vertices=UNEVEN), 0.3, "shear", friction=SLIPPERY),
    "a polygon clockwise": pushed(Polygon(vertices=UNEVEN[::-1]), 0.3, "bending"),
    "a spline, slipping": pushed(Spline(points=UNEVEN), 0.3, "shear", friction=SLIPPERY),
    "a jaw's corner on a polygon's edge": dataclasses.replace(
        micro_assembly(0.086, 0.055, friction=ROUGH), object=Polygon(vertices=BLUNT).at(x=Q, y=-0.0105)
    ),
    "bent at rest, slipping": bent(-1.0 + 3.0 * S, theory="bending", friction=SLIPPERY),
    "bent at rest beyond a kink, stretch": bent(sympy.Max(0, S - 0.4) * 3, theory="stretch"),
    "bent at rest by a step, touching nothing": bent(sympy.Piecewise((0.8, S < 0.35), (-0.5, True)), theory="shear"),
}

BASE = gr.Base(rotational_stiffness=8.0)
TENDON = Tendon(tension=5.0, offset=-0.009, guides=(0.06, 0.15))
SHARP = ((0.005, 12.6e6), (0.01, 23.5e6), (0.02, 41e6), (0.04, 59e6))


def made(scene, **options):
    """The scene with another base or another material's law."""
    base, law = options.pop("base", None), options
    finger = scene.finger.body if isinstance(scene.finger, gr.Placed) else scene.finger
    other = dataclasses.replace(finger, base=base, material=dataclasses.replace(finger.material, **law))
    placed = dataclasses.replace(scene.finger, body=other) if isinstance(scene.finger, gr.Placed) else other
    return dataclasses.replace(scene, finger=placed)


LOADED = {
    "II, an elastic base, slipping": made(rotating_finger(-0.1016, 0.0, friction=SLIPPERY), base=BASE),
    "I, hook's corner, an elastic base, stretch": made(micro_assembly(0.086, 0.0629, theory="stretch"), base=BASE),
    "II, in its weight, pushed at the tip": rotating_finger(
        -0.1016, 0.0, loads=(Gravity(density=1150.0), Force(force=(0.3, -0.2 + 3 * Q), offset=(0.002, 0.005)))
    ),
    "II, a tendon and a moment": rotating_finger(-0.1016, 0.0, loads=(TENDON, Moment(moment=0.02, s=0.11))),
    "I, a dead force in the clamp's axes, slipping": micro_assembly(
        0.086, 0.0678, friction=ROUGH, loads=(Force(force=(0.5, 0.3), s=0.03, frame="finger"),)
    ),
    "a following force, stretch, an elastic base": made(
        pushed(Circle(radius=0.02), 0.0, "stretch", loads=(FollowingForce(force=(-1.0, -0.6), s=0.1),)), base=BASE
    ),
    "bent at rest, in its weight, touching nothing": bent(
        -1.0 + 3.0 * S, theory="bending", loads=(Gravity(mass_per_length=0.02 + 0.01 * S),)
    ),
}
COMPOSED = {
    "a corner cut into a circle": pushed(
        Difference(parts=(Circle(radius=0.02), Circle(radius=0.02).at(x=0.012, y=0.022))), 0.0, "bending"
    ),
    "grown": pushed(Grown(part=Polygon(vertices=UNEVEN), distance=0.002), 0.3, "shear"),
}
LAWS = {
    "II, neo-Hookean, plane strain, slipping": made(
        rotating_finger(-0.1016, 0.0, friction=SLIPPERY), law="neo_hookean", plane="strain"
    ),
    "II, logarithmic, stretch": made(rotating_finger(-0.1016, 0.0, theory="stretch"), law="logarithmic"),
    "I, lead face, a measured curve": made(micro_assembly(0.086, 0.0678), law="secant", table=SHARP),
    "II, St. Venant-Kirchhoff, an elastic base": made(
        rotating_finger(-0.1016, 0.0), law="st_venant_kirchhoff", base=BASE
    ),
}


def read(pose, name):
    """A number of a pose, as an array."""
    return np.array(getattr(pose, name), dtype=float)


def solved(scene, state, parameter):
    """The pose of a scene on the segments of a known state, cut anew until they end at its contacts."""
    fixed = dataclasses.replace(setting(scene), tolerance=1e-8)  # segments end at the contacts, to round-off
    kinematics = Kinematics(scene, fixed.sections.length)
    law = fixed.friction
    grips = [site.grip and dataclasses.replace(site.grip, law=law) for site in state.sites]
    sites = tuple(dataclasses.replace(site, grip=grip) for site, grip in zip(state.sites, grips, strict=True))
    state = dataclasses.replace(state, sites=sites)
    found = settle(fixed, fixed.obstacle(kinematics.frame(parameter)), state, state.beam.order)
    equilibrium = polished(fixed, found)
    answer = Answer(Verified(equilibrium, survey(fixed, equilibrium.obstacle, equilibrium.state)), 0.0, 0.0, 0)
    return pose_result(fixed, answer, parameter, kinematics.placement(parameter))


@pytest.mark.parametrize("motion", MOTIONS)
def test_derivatives_are_those_of_the_discrete_equations_by_every_number(motion):
    agree_with_differences(MOTIONS[motion], r"^(?!object.(vertices|points).[13-9])", fine=True)  # of points a few


@pytest.mark.parametrize("motion", LOADED)
def test_so_are_those_by_loads_and_by_an_elastic_base(motion):
    agree_with_differences(
        LOADED[motion], r"loads|finger.base|length|angle|youngs|thickness|rest|object.pose.y", fine=True
    )


@pytest.mark.parametrize("motion", LAWS)
def test_so_are_those_under_a_law_of_the_material_s_own(motion):
    agree_with_differences(LAWS[motion], r"material|finger.base|length|thickness|coefficient")


@pytest.mark.parametrize("motion", COMPOSED)
def test_so_are_those_by_the_numbers_of_an_object_s_parts(motion):
    agree_with_differences(
        COMPOSED[motion], r"object.parts?\b.*(radius|x|angle|vertices.[23])|object.distance", fine=True
    )


def beside(body, finger=TAPERED, **options):
    """A finger and what it does not touch."""
    return gr.Scene(finger=finger, object=body, motion=gr.Motion("q", (-0.06, -0.035)), theory="bending", **options)


NEARBY = {
    "a face and a grown triangle": beside(
        Grown(part=Polygon(vertices=UNEVEN[::2]), distance=0.004).at(x=0.12, y=Q - 0.01, angle=0.3)
    ),
    "the tip's corner and an ellipse": beside(Ellipse(semi_axes=(0.02, 0.012)).at(x=0.2, y=Q, angle=0.4)),
    "a face and a polygon's corner": beside(Polygon(vertices=UNEVEN).at(x=0.12, y=Q, angle=0.3)),
    "a jaw's corner and a pin": micro_assembly(0.2, 0.095),
    "a face that its weight bends": beside(
        Circle(radius=0.01).at(x=0.1, y=Q - 0.03), TAPERED.at(angle=0.1), loads=(Gravity(density=1150.0),)
    ),
}


@pytest.mark.parametrize("motion", NEARBY)
def test_so_are_those_of_the_least_distance_of_what_does_not_touch(motion):
    scene = NEARBY[motion]
    result = gr.trace(scene)
    assert result.poses[-1].status == "free" and result.poses[-1].min_gap > 1e-3
    agree_with_differences(scene, r"object.(?!vert)|vertices.2|jaw|length|thickness|angle|loads|youngs")
    assert abs(result.sensitivity("object.pose.y").poses[-1].min_gap) > 0.1


def agree_with_differences(scene, keys, *, fine=False):
    """Compare the derivatives of a motion's last pose, by the numbers whose keys match, with central differences.

    These are of second order, or where numbers bend fast (fine) of fourth.
    """
    *_, last = follow(scene)
    result = gr.trace(scene)
    for key, sensitivity in result.sensitivities().items():
        if not re.search(keys, key):
            continue
        value, exact = numbers(scene)[key], sensitivity.poses[-1]
        step = (1e-3 if fine else 2e-4) * (1.0 if key == "finger.rest_curvature" else abs(value) or 1e-2)
        shifted = {
            n: solved(replaced(scene, {key: value + n * step}), last.equilibrium.state, scene.motion.values[-1])
            for n in ((-2, -1, 1, 2) if fine else (-1, 1))
        }
        assert exact.kind == "exact"
        for name in NAMES:
            near, far = (read(shifted[n], name) - read(shifted[-n], name) for n in (1, 2 if fine else 1))
            differences = (8 * near - far) / (12 * step) if fine else near / (2 * step)
            if name == "min_gap" and result.poses[-1].contacts:
                assert exact.min_gap == 0 and abs(shifted[1].min_gap) < 1e-10
                continue
            size = max(np.abs(read(shifted[1], name)).max(), 1e-5) / (abs(value) or 1.0)
            np.testing.assert_allclose(
                read(exact, name), differences, rtol=1e-5, atol=1e-6 * size, err_msg=f"{key} {name}"
            )


def test_a_contact_that_sticks_remembers_through_its_derivatives_where_it_began_to():
    scene = rotating_finger(-0.1016, 0.0, 0.04, 0.049, friction=SLIPPERY)  # sticks from 0.0477 on
    result = gr.trace(scene)
    assert result.poses[-1].contacts[0].state == "stick"
    for key in ("object.pose.y", "finger.tip_thickness", "friction.coefficient"):
        exact, value = result.sensitivity(key).poses[-1], numbers(scene)[key]
        step = 1e-3 * value
        there, back = (gr.trace(replaced(scene, {key: value + h})).poses[-1] for h in (step, -step))
        for name in ("energy", "force_on_object", "max_strain"):
            differences = (read(there, name) - read(back, name)) / (2 * step)
            np.testing.assert_allclose(read(exact, name), differences, rtol=1e-3, err_msg=f"{key} {name}")


@pytest.mark.parametrize(("theory", "reached"), [("bending", -0.1795), ("shear", -0.1798)])
def test_a_contact_that_sticks_from_its_first_touch_on_began_where_it_was_met(theory, reached):
    """The object comes the way that the finger's face gives way, so that nothing slips at first."""
    circle = Circle(radius=0.15).at(x=0.6 + 0.075 * (Q + 0.18), y=Q)
    scene = gr.Scene(finger=unit_finger(), object=circle, motion=gr.Motion("q", (-0.25, reached)), theory=theory)
    scene = dataclasses.replace(scene, friction=gr.Friction(coefficient=0.5), tolerance=1e-6)  # for the differences
    result = gr.trace(scene)
    assert [contact.state for contact in result.poses[-1].contacts] == ["stick"]
    for key in ("object.pose.y", "finger.thickness"):
        exact, value = result.sensitivity(key).poses[-1], numbers(scene)[key]
        step = 1e-5 * (value or 0.1)
        there, back = (gr.trace(replaced(scene, {key: value + h})).poses[-1] for h in (step, -step))
        for name in ("energy", "force_on_object", "max_strain"):
            differences = (read(there, name) - read(back, name)) / (2 * step)
            np.testing.assert_allclose(read(exact, name), differences, rtol=1e-5, err_msg=f"{key} {name}")


PASSED = {
    "I": micro_assembly(*np.linspace(0.086, 0.054, 13)),  # needs most where the lead face ends, holds on the corner
    "I, there and back with friction": micro_assembly(*np.linspace(0.086, 0.054, 7), 0.06, 0.07, friction=ROUGH),
    "II": rotating_finger(*np.linspace(-0.1016, 0.06, 9)),
    "I, pushed at its middle": micro_assembly(
        *np.linspace(0.086, 0.06, 7), 0.07, loads=(Force(force=(0.5, 0.3), s=0.03, frame="finger"),)
    ),
}
BOOKED = {
    "work_in": 1e-3,
    "work_out": 2e-3,
    "dissipation": 1e-3,
}  # the errors of what is booked, by the length of steps
COUNTED = {"parameter", "poses", "failed", "locked"}


@pytest.mark.parametrize("motion", PASSED)
def test_derivatives_of_the_summary_follow_its_numbers_or_say_why_there_are_none(motion):
    scene = PASSED[motion]
    result = gr.trace(scene)
    key = next(key for key in ("friction.coefficient", "loads[0].force[1]", "finger.length") if key in numbers(scene))
    found, value = result.sensitivity(key), numbers(scene)[key]
    step = 3e-3 * value
    shifted = {n: gr.trace(replaced(scene, {key: value + n * step})).summary() for n in (-2, -1, 1, 2)}
    for name, exact in found.summary.items():
        if exact is None:
            assert len(found.reasons[name]) > 10
            continue
        near, far = (getattr(shifted[n], name) - getattr(shifted[-n], name) for n in (1, 2))
        off = 1e-5 * np.ptp(scene.motion.values) / step if name.endswith("_at") else 1e-9  # smooth peaks lie that near
        assert exact == pytest.approx((8 * near - far) / (12 * step), rel=BOOKED.get(name, 3e-4), abs=off), name
    assert set(found.summary) | COUNTED == {f.name for f in dataclasses.fields(result.summary())}
    known = {name for name, exact in found.summary.items() if exact is not None}
    assert known >= {"insertion_force", "force_on_object", "strain", "clearance", "clearance_at", *BOOKED}


def test_the_work_s_derivative_is_that_of_its_integral():
    """Of shorter steps the booked work, and so its differences, are as exact as its derivative."""
    scene, key = rotating_finger(*np.linspace(-0.1016, 0.06, 25)), "object.pose.y"
    exact, value = gr.trace(scene).sensitivity(key).summary, numbers(scene)[key]
    step = 3e-4
    shifted = {n: gr.trace(replaced(scene, {key: value + n * step})).summary() for n in (-2, -1, 1, 2)}
    for name in ("work_in", "work_out"):
        near, far = (getattr(shifted[n], name) - getattr(shifted[-n], name) for n in (1, 2))
        assert exact[name] == pytest.approx((8 * near - far) / (12 * step), rel=1e-6)


def test_what_snaps_away_and_what_locks_have_reasons_instead_of_derivatives():
    climbing = Circle(radius=0.2).at(x=0.95, y=Q)
    scene = gr.Scene(finger=unit_finger(), object=climbing, motion=gr.Motion("q", (-0.25, 0.7)), theory="shear")
    snapped = gr.trace(scene).sensitivity("object.radius")
    assert snapped.summary["work_in"] is None and "snaps on the way" in snapped.reasons["dissipation"]
    rough = gr.trace(rotating_finger(-0.1016, -0.05, friction=SLIPPERY)).sensitivity("finger.length")
    assert rough.summary["locking_margin"] is None and "a contact on a face" in rough.reasons["locking_margin"]
    assert "the summary has none" in rough.reasons["retention_force"]
    smooth = gr.trace(micro_assembly(0.086, 0.07)).sensitivity("finger.length")
    assert smooth.summary["locking_margin"] == 0


def test_a_finger_that_is_passed_by_has_the_derivatives_of_its_least_distance():
    scene = gr.Scene(
        finger=TAPERED, object=Circle(radius=0.02).at(x=0.12 + Q, y=-0.05), motion=gr.Motion("q", (-0.05, 0.03))
    )
    scene = dataclasses.replace(scene, finger=TAPERED.at(angle=0.1), theory="bending")
    found = gr.trace(scene).sensitivity("object.radius")
    assert found.summary["clearance"] == pytest.approx(-1.0, rel=1e-6)
    assert found.summary["strain"] == found.summary["force_on_object"] == 0


def test_what_only_just_touches_has_derivatives_of_one_side():
    """When the hook has let go of the pin, this lies on the straight finger's face: 8.9 + 1.6 = 10.5 mm."""
    result = gr.trace(micro_assembly(0.086, 0.05))
    assert result.poses[-1].status == "free"
    last = result.sensitivity("object.pose.y").poses[-1]
    assert last.kind == "one-sided" and "only just touches" in last.reason


def test_margins_and_ratio_follow_from_the_peaks():
    tough = dataclasses.replace(PLASTIC, yield_strain=0.02)
    scene = PASSED["I"]
    scene = dataclasses.replace(scene, finger=dataclasses.replace(scene.finger, material=tough))
    result = gr.trace(scene)
    summary, found = result.summary(), result.sensitivities(["finger.thickness", "material.yield_strain"])
    by_thickness, by_limit = (found[key].summary for key in found)
    assert by_thickness["strain_margin"] == pytest.approx(-by_thickness["strain"] / 0.02)
    assert by_thickness["repeated_strain_margin"] == pytest.approx(-by_thickness["strain"] / 0.012)
    assert by_limit["strain_margin"] == pytest.approx(summary.strain / 0.02**2)
    assert by_limit["repeated_strain_margin"] == pytest.approx(summary.strain / (0.6 * 0.02**2))
    logarithmic = by_thickness["retention_force"] / summary.retention_force
    logarithmic -= by_thickness["insertion_force"] / summary.insertion_force
    assert by_thickness["retention_ratio"] == pytest.approx(summary.retention_ratio * logarithmic)


ELLIPTIC = gr.Scene(
    finger=Tapered(length=0.1778, base_thickness=0.030, tip_thickness=0.017, width=0.025, material=RUBBER),
    object=Ellipse(semi_axes=(0.0495, 0.0337)).at(x=0.1207, y=-0.0508, angle=-1.5708),
)


@pytest.mark.parametrize("key", ["finger.length", "finger.tip_thickness", "material.poisson_ratio", "object.pose.y"])
def test_derivatives_are_those_of_whole_solves_to_about_the_tolerance(key):
    exact, value = gr.solve(ELLIPTIC).sensitivity(key), numbers(ELLIPTIC)[key]
    step = 1e-3 * value
    there, back = (gr.solve(replaced(ELLIPTIC, {key: value + h})).pose for h in (step, -step))
    for name in ("energy", "force_on_object", "max_strain", "tip"):
        differences = (read(there, name) - read(back, name)) / (2 * step)
        error = np.linalg.norm(read(exact.pose, name) - differences) / np.linalg.norm(differences)
        assert error < 10 * ELLIPTIC.tolerance, name


def scaled(result, keys, name):
    """Sum of number times derivative over some keys."""
    found = result.sensitivities(keys)
    return sum(read(found[key].pose, name) * found[key].value for key in keys)


def test_moduli_scale_forces_and_lengths_their_square():
    result = gr.solve(ELLIPTIC)
    moduli = [key for key in numbers(ELLIPTIC) if key.endswith("_modulus")]
    lengths = [key for key in numbers(ELLIPTIC) if not key.startswith("material") and not key.endswith("angle")]
    for keys, power in ((moduli, 1), (lengths, 2)):
        force = np.array(result.force_on_object)
        np.testing.assert_allclose(scaled(result, keys, "force_on_object"), power * force, rtol=1e-7)
    np.testing.assert_allclose(scaled(result, lengths, "tip"), result.tip, rtol=1e-7)
    assert abs(scaled(result, lengths, "max_strain")) < 1e-7 * result.max_strain


def test_the_force_is_the_energys_derivative_by_the_objects_place():
    result = gr.solve(ELLIPTIC)
    slopes = [result.sensitivity(f"object.pose.{axis}").energy for axis in ("x", "y", "angle")]
    expected = [*(-f for f in result.force_on_object), -result.moment_on_object]
    np.testing.assert_allclose(slopes, expected, rtol=1e-6)  # to the discretisation's error
    for axis in ("x", "y"):
        moved = [np.array(result.sensitivity(f"{part}.pose.{axis}").force_on_object) for part in ("object", "finger")]
        np.testing.assert_allclose(moved[0], -moved[1], rtol=1e-12)


def test_a_uniform_finger_on_a_circle_is_a_line_on_a_circle_of_half_its_thickness_more():
    finger = unit_finger(0.06)
    scene = gr.Scene(finger=finger, object=Circle(radius=0.2).at(x=0.6, y=-0.15), theory="bending")
    result = gr.solve(scene)
    by_radius, by_thickness = result.sensitivity("object.radius"), result.sensitivity("finger.thickness")
    stiffer = 3 * result.energy / finger.thickness  # EI falls with w^3
    assert by_thickness.energy == pytest.approx(by_radius.energy / 2 + stiffer, rel=1e-9)


def test_where_the_contacts_change_derivatives_are_one_sided_and_say_so():
    passing = gr.trace(micro_assembly(0.086, 0.068, 0.062))
    change = next(event for event in passing.events if event.kind == "change")
    at = gr.trace(micro_assembly(0.086, 0.068, change.parameter, 0.062)).sensitivity("object.radius").poses[2]
    assert at.kind == "one-sided"
    assert "end" in at.reason or "change" in at.reason
    sides = [
        gr.trace(micro_assembly(0.086, change.parameter + h)).sensitivity("object.radius").poses[1].motion_force
        for h in (1e-7, -1e-7)
    ]
    assert abs(sides[0] - sides[1]) > 0.1 * abs(sides[0])
    assert min(abs(at.motion_force - side) for side in sides) < 1e-3 * abs(at.motion_force)


def test_a_free_finger_moves_with_its_clamp_alone():
    scene = micro_assembly(0.086)
    result = gr.trace(dataclasses.replace(scene, finger=scene.finger.at(angle=0.001)))
    assert result.poses[0].status == "free"
    turned, longer = (result.sensitivity(key).pose for key in ("finger.pose.angle", "finger.length"))
    assert longer.force_on_object == (0, 0)
    np.testing.assert_allclose(turned.tip, [-0.057 * math.sin(0.001), 0.057 * math.cos(0.001)], rtol=1e-12)
    np.testing.assert_allclose(longer.tip, [math.cos(0.001), math.sin(0.001)], rtol=1e-12)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(("kind", "name"), [(Polygon, "vertices"), (Spline, "points")])
def test_moved_turned_and_swollen_points_move_turn_and_swell_their_outline(kind, name, sense):
    body = kind(**{name: UNEVEN[::sense]})
    points = np.random.default_rng(3).uniform(-0.03, 0.03, (40, 2))
    g, gradient, hessian = body.evaluate(points, 2)
    known = {f"{name}[{i}][{d}]": UNEVEN[::sense][i][d] for i in range(len(UNEVEN)) for d in (0, 1)}
    rates = object_rates(body, known)
    moved, corners = rates.at(points), rates.corners(body.corners)
    along = np.array(list(known.values())).reshape(-1, 2)
    fields = {
        "moved": (np.array([[1.0, 0.0]] * len(UNEVEN)), np.array([1.0, 0.0]) + 0 * points, 0.0),
        "turned": (along @ [[0.0, 1.0], [-1.0, 0.0]], points @ [[0.0, 1.0], [-1.0, 0.0]], gradient @ [[0, 1], [-1, 0]]),
        "swollen": (along, points, 0.0),
    }
    for how, (velocities, carried, turned) in fields.items():
        weights = velocities.ravel()
        swelling = g if how == "swollen" else 0.0
        expected = -(gradient * carried).sum(axis=1) + swelling
        np.testing.assert_allclose(weights @ moved[0], expected, atol=1e-12, err_msg=how)
        slope = turned - (hessian @ carried[:, :, None])[:, :, 0]
        np.testing.assert_allclose(weights @ moved[1], slope @ [1, 1j], atol=1e-9, err_msg=how)
        if kind is Polygon:
            at = [int(np.argmin(np.abs(along @ [1, 1j] - corner))) for corner in body.corners @ [1, 1j]]
            np.testing.assert_allclose(weights @ corners, (velocities @ [1, 1j])[at], atol=1e-12, err_msg=how)


def test_at_a_snap_derivatives_are_refused_and_so_are_those_of_a_peak_that_it_decides():
    climbing = Circle(radius=0.2).at(x=0.95, y=Q)  # the tip's corner slides up its side until a fold at 0.645569
    scene = gr.Scene(finger=unit_finger(), object=climbing, motion=gr.Motion("q", (-0.25, 0.2, 0.7)), theory="shear")
    snap = next(event for event in gr.trace(scene).events if event.kind == "snap")
    motion = gr.Motion("q", (-0.25, 0.2, snap.parameter - 5e-8, 0.7))
    found = gr.trace(dataclasses.replace(scene, motion=motion)).sensitivity("object.radius")
    assert [pose.kind for pose in found.poses] == ["exact", "exact", "none", "exact"]
    assert "the finger snaps at 0.64556" in found.poses[2].reason and found.poses[2].energy is None
    assert found.summary["force_on_object"] is None and found.summary["insertion_force"] > 0


SQUARE = Polygon(vertices=((-0.02, -0.02), (0.02, -0.02), (0.02, 0.02), (-0.02, 0.02)))
BITE = Polygon(vertices=((0.0, -0.01), (0.06, -0.02), (0.06, 0.02), (0.0, 0.01), (0.01, 0.0)))
MADE = {
    "union": Union(parts=(SQUARE.at(angle=0.1), Circle(radius=0.012).at(x=0.02, y=0.01))),
    "intersection": Intersection(parts=(Circle(radius=0.03), Circle(radius=0.03).at(x=0.02), HalfPlane().at(y=0.01))),
    "difference": Difference(parts=(Circle(radius=0.05), BITE)),
    "grown": Grown(part=SQUARE.at(x=0.01, angle=0.2), distance=0.003),
    "grown difference": Grown(
        part=Difference(parts=(SQUARE, Ellipse(semi_axes=(0.03, 0.02)).at(x=0.03, angle=0.4))), distance=0.002
    ),
}


@pytest.mark.parametrize("which", MADE)
def test_an_object_of_objects_has_derivatives_by_the_numbers_of_its_parts(which):
    body = MADE[which]
    scene = gr.Scene(finger=TAPERED, object=body)
    own = {key: v for key, v in numbers(scene).items() if key.startswith(("object.part", "object.distance"))}
    rates = object_rates(body, {key.removeprefix("object."): value for key, value in own.items()})
    outline, some = np.concatenate(body.outline(tolerance=1e-4)), np.random.default_rng(0)
    points = outline[some.integers(0, len(outline), 40)] + some.normal(0, 1e-3, (40, 2))
    exact = rates.at(points), rates.corners(body.corners)
    assert len(own) >= 11
    for i, (key, value) in enumerate(own.items()):
        step = 1e-4 if key.endswith("angle") else 3e-6
        ends = [placed(replaced(scene, {key: value + h}).object).body for h in (step, -step)]
        g, slope = (
            np.subtract(*each) / (2 * step) for each in zip(*(e.evaluate(points, 1) for e in ends), strict=True)
        )
        off = np.abs(exact[0][0][i] - g), np.abs(exact[0][1][i] - slope @ [1, 1j]) / (1 + np.abs(slope).max())
        assert max(np.sort(each)[:-3].max() for each in off) < 1e-4, key  # but at points that lie between two parts
        corners = [min(end.corners, key=lambda q: math.dist(q, p)) - p for p in body.corners for end in ends]
        moved = np.reshape(corners, (-1, 2, 2)) @ [1, 1j]
        np.testing.assert_allclose(exact[1][i], (moved[:, 0] - moved[:, 1]) / (2 * step), atol=1e-4, err_msg=key)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Chip(FeatureSurface):
    """A square that writes no rates of its pieces."""

    side: gr.Positive

    def pieces(self):
        """Write four edges."""
        corners = self.side / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        return np.stack([corners, np.roll(corners, -1, axis=0) - corners], axis=1)


def test_what_has_no_derivatives_by_its_own_numbers_has_those_of_its_pose_and_its_other_parts():
    both = Union(parts=(Chip(side=0.04), Circle(radius=0.01)))
    result = gr.solve(dataclasses.replace(ELLIPTIC, object=both.at(x=0.12, y=-0.03, angle=0.5)))
    found = result.sensitivities()
    slopes = [found[f"object.pose.{axis}"].energy for axis in ("x", "y", "angle")]
    expected = [*(-f for f in result.force_on_object), -result.moment_on_object]
    np.testing.assert_allclose(slopes, expected, rtol=1e-4)  # on the square's corner
    assert "object.parts[1].radius" in found and "object.parts[0].side" not in found
    np.testing.assert_allclose(
        found["object.parts[0].pose.x"].energy,
        -np.cos(0.5) * result.force_on_object[0] - np.sin(0.5) * result.force_on_object[1],
        rtol=1e-4,
    )
    with pytest.raises(NotOpenError, match="Chip must be an ImplicitSurface, a FeatureSurface that writes"):
        result.sensitivity("object.parts[0].side")


def test_a_pose_without_an_answer_has_no_derivative_and_says_why():
    scene = micro_assembly(0.086, 0.06, friction=gr.Friction(coefficient=3.0))
    result = gr.trace(scene)
    assert result.poses[1].status == "locked"
    found = result.sensitivity("finger.thickness").poses[1]
    assert found.kind == "none"
    assert found.reason == result.poses[1].reason
    assert found.energy is None


def test_two_loads_on_one_section_have_no_derivative_by_the_place_of_one():
    loads = (Moment(moment=0.02, s=0.06), Force(force=(0.0, 0.5), s=0.06))
    result = gr.trace(rotating_finger(-0.1016, loads=loads))
    with pytest.raises(ValueError, match=r"a load must act on the tip .* away from it, kinks and other loads"):
        result.sensitivity("loads[1].s")
    assert result.sensitivity("loads[1].force[1]").energy
    assert set(numbers(result.scene)) - set(result.sensitivities()) == {"loads[0].s", "loads[1].s"}


def test_what_has_no_derivative_is_refused():
    result = gr.solve(ELLIPTIC)
    with pytest.raises(LookupError, match=r"unknown number 'finger\.tip_thicknes'"):
        result.sensitivity("finger.tip_thicknes")
    with pytest.raises(ValueError, match=r"friction\.coefficient must be a number that the scene has"):
        result.sensitivity("friction.coefficient")
    with pytest.raises(ValueError, match="equilibria are never written or pickled"):
        pickle.loads(pickle.dumps(result)).sensitivity("finger.length")
    published = gr.Friction(coefficient=0.1, model="published", sense="tipward")
    with pytest.raises(ValueError, match="model of friction must be 'coulomb'"):
        gr.solve(dataclasses.replace(ELLIPTIC, friction=published)).sensitivity("finger.length")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Deaf(gr.Finger):
    """A finger whose formula takes no symbols."""

    thickness: gr.Positive

    def w(self, s):
        """Write a thickness that is rounded to a micrometre."""
        return math.floor(self.thickness * 1e6) / 1e6


def test_a_plugin_that_sympy_cannot_differentiate_is_named():
    finger = Deaf(length=0.1, thickness=0.004, width=0.01, material=PLASTIC)
    scene = gr.Scene(finger=finger, object=Circle(radius=0.01).at(x=0.06, y=-0.009))
    with pytest.raises(NotOpenError, match=r"Deaf must be written so that its formulas take sympy's symbols"):
        gr.solve(scene).sensitivity("finger.thickness")
