"""One pose: closed forms, invariances, grazing, and what cannot be answered."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gripper as gr
from gripper.assemble import setting
from gripper.contact.kinematics import Kinematics, Retreat
from gripper.motion.approach import approach, retreated
from gripper.motion.tracker import Tracker
from gripper.statics.answer import Answer
from gripper.study.cases import Case, random
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.polygon import Polygon
from tests.scenes import EXACT, Q, rotating_finger, unit_finger

TABLE = EXACT[
    "uniform finger on a circle, EI = 1, L = 1, no shear, w = 0.06, R = 0.25, centre (X0, Y0), approached from the -y "
    "side; T = m N on the FINGER, m > 0 towards the tip (on the object: baseward)"
]
NUMBERS = (
    "force_on_object",
    "force_on_object_finger_frame",
    "moment_on_object",
    "clamp_moment",
    "energy",
    "tip_rotation",
    "max_strain",
)


def answer(scene: gr.Scene) -> gr.PoseResult:
    (pose,) = gr.solve(scene).poses
    return pose


@pytest.mark.parametrize("row", [row for row in TABLE["rows"] if row[2] == 0], ids=lambda row: f"{row[:2]}")
def test_a_uniform_finger_on_a_circle_has_the_force_of_the_table(row: list[float]) -> None:
    x, y, _, normal, fx, fy, s, slope, energy = row
    scene = gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=x, y=y), theory="bending", tolerance=1e-6)
    pose = answer(scene)
    assert pose.force_on_object == pytest.approx((-fx, -fy), rel=1e-5, abs=1e-5 * normal)
    (contact,) = pose.contacts
    assert (contact.normal_force, contact.s) == pytest.approx((normal, s), rel=1e-5)
    assert contact.normal == pytest.approx((-math.sin(slope), math.cos(slope)), abs=1e-5)
    assert pose.energy == pytest.approx(energy, rel=1e-5)


# ---- Invariance: what a rigid motion, a mirror, a unit or a scale must not change.

HOOK = Triangle(length=0.2, lead_angle=math.radians(35), return_angle=math.radians(60))
SCENES = {
    "flank, bending": gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=0.0), theory="bending"),
    "flank, shear": gr.Scene(
        finger=Tapered(length=1.0, base_thickness=0.17, tip_thickness=0.1, width=1.0, material=unit_finger().material),
        object=Ellipse(semi_axes=(0.28, 0.19)).at(x=0.62, y=-0.12, angle=0.4),
        theory="shear",
    ),
    "tip corner": gr.Scene(finger=unit_finger(0.1), object=Circle(radius=0.25).at(x=1.1, y=-0.2), theory="shear"),
    "jaw": gr.Scene(finger=unit_finger(jaw=HOOK), object=Circle(radius=0.15).at(x=1.16, y=-0.2), theory="bending"),
    "wedge": gr.Scene(
        finger=unit_finger(0.04),
        object=Polygon(vertices=((-0.2, -0.3), (0.2, -0.3), (0.02, 0.0))).at(x=0.7, y=0.06),
        theory="shear",
    ),
}
SCENES["flank, stretch"] = replace(SCENES["flank, shear"], theory="stretch")
ANSWERS = {name: answer(scene) for name, scene in SCENES.items()}
named = pytest.mark.parametrize("name", SCENES)


def pose_of(scene: gr.Scene) -> tuple[float, float, float]:
    pose = scene.object.pose
    return float(pose.x), float(pose.y), float(pose.angle)


def assert_same(found: gr.PoseResult, expected: gr.PoseResult, scales: dict[str, float] | None = None) -> None:
    """All numbers of the finger's frame agree to 1e-8 of the largest of their kind, after undoing ``scales``."""
    scales = scales or {}
    for name in NUMBERS:
        if name == "force_on_object":
            continue
        value = np.array(getattr(expected, name)) * scales.get(name, 1.0)
        size = np.abs(value).max()
        if name == "moment_on_object":  # of a circle it is round-off
            size = np.linalg.norm(expected.force_on_object) * scales.get("moment_on_object", 1.0)
        assert np.array(getattr(found, name)) == pytest.approx(value, rel=0, abs=1e-8 * size + 1e-300), name
    assert [c.on for c in found.contacts] == [c.on for c in expected.contacts]
    for one, other in zip(found.contacts, expected.contacts, strict=True):
        length = scales.get("length", 1.0)
        assert (one.s, *one.extent) == pytest.approx((other.s * length, *(e * length for e in other.extent)), rel=1e-7)
        force = scales.get("force_on_object_finger_frame", 1.0)
        assert one.normal_force == pytest.approx(other.normal_force * force, rel=1e-8)


@named
def test_the_scenes_of_the_invariances_are_in_contact(name: str) -> None:
    assert ANSWERS[name].status == "contact", ANSWERS[name].reason
    assert ANSWERS[name].energy > 0


@named
@given(x=st.floats(-10, 10), y=st.floats(-10, 10), angle=st.floats(-7, 7))
@settings(deadline=None, max_examples=4, derandomize=True)
def test_moving_and_turning_the_whole_scene_changes_nothing_else(name: str, x: float, y: float, angle: float) -> None:
    scene, expected = SCENES[name], ANSWERS[name]
    xo, yo, turned = pose_of(scene)
    place = complex(x, y) + complex(xo, yo) * np.exp(1j * angle)
    moved = replace(
        scene,
        finger=scene.finger.at(x=x, y=y, angle=angle),
        object=scene.object.body.at(x=place.real, y=place.imag, angle=turned + angle),
    )
    found = answer(moved)
    assert_same(found, expected)
    turn = np.exp(1j * angle)
    force = complex(*expected.force_on_object) * turn
    assert abs(complex(*found.force_on_object) - force) < 1e-8 * abs(force)
    tip = complex(x, y) + complex(*expected.tip) * turn
    assert abs(complex(*found.tip) - tip) < 1e-7


MIRRORED_BODIES = {
    "flank, bending": lambda body: body,
    "flank, shear": lambda body: body,
    "tip corner": lambda body: body,
    "flank, stretch": lambda body: body,
    "jaw": lambda body: body,
    "wedge": lambda body: replace(body, vertices=tuple((x, -y) for x, y in body.vertices)),
}


@named
def test_the_mirrored_scene_has_the_mirrored_answer(name: str) -> None:
    scene, expected = SCENES[name], ANSWERS[name]
    x, y, angle = pose_of(scene)
    finger = scene.finger
    if finger.jaw is not None:
        finger = replace(finger, jaw=replace(finger.jaw, side="upper"))
    body = MIRRORED_BODIES[name](scene.object.body)
    found = answer(replace(scene, finger=finger, object=body.at(x=x, y=-y, angle=-angle), approach=(0.0, -1.0)))
    assert found.status == "contact", found.reason
    force, other = found.force_on_object, expected.force_on_object
    assert force == pytest.approx((other[0], -other[1]), rel=0, abs=1e-8 * math.hypot(*other))
    for number, sign in (("energy", 1), ("clamp_moment", -1), ("tip_rotation", -1), ("max_strain", 1)):
        assert getattr(found, number) == pytest.approx(sign * getattr(expected, number), rel=1e-8), number
    assert found.moment_on_object == pytest.approx(-expected.moment_on_object, rel=0, abs=1e-8 * math.hypot(*other))
    sides = {"lower": "upper", "upper": "lower"}
    assert [sides.get(c.on, c.on) for c in found.contacts] == [c.on for c in expected.contacts]


@named
@given(decades=st.floats(-4.7, 10.2))
@settings(deadline=None, max_examples=4, derandomize=True)
def test_a_stiffer_material_has_the_same_shape_and_as_much_more_force(name: str, decades: float) -> None:
    scene, expected, factor = SCENES[name], ANSWERS[name], 10**decades
    material = scene.finger.material
    stiffer = replace(material, youngs_modulus=material.youngs_modulus * factor, shear_modulus=material.G * factor)
    found = answer(replace(scene, finger=replace(scene.finger, material=stiffer)))
    proportional = dict.fromkeys(("force_on_object_finger_frame", "moment_on_object", "clamp_moment", "energy"), factor)
    assert_same(found, expected, proportional)


def scaled(scene: gr.Scene, a: float) -> gr.Scene:
    """Every length of a scene times a."""

    def times(value: object) -> object:
        return tuple(times(item) for item in value) if isinstance(value, tuple) else value * a

    def grown(part: object, *lengths: str) -> object:
        names = [name for name in lengths if name in part.__dataclass_fields__]
        return replace(part, **{name: times(getattr(part, name)) for name in names})

    finger = grown(scene.finger, "length", "thickness", "base_thickness", "tip_thickness", "width")
    if finger.jaw is not None:
        finger = replace(finger, jaw=grown(finger.jaw, "length"))
    x, y, angle = pose_of(scene)
    body = grown(scene.object.body, "radius", "semi_axes", "vertices")
    return replace(scene, finger=finger, object=body.at(x=a * x, y=a * y, angle=angle))


@named
@given(decades=st.floats(-9, 3))
@settings(deadline=None, max_examples=4, derandomize=True)
def test_a_larger_finger_has_the_same_shape_and_force_by_the_square(name: str, decades: float) -> None:
    scene, expected, a = SCENES[name], ANSWERS[name], 10**decades
    found = answer(scaled(scene, a))
    powers = {"force_on_object_finger_frame": 2, "moment_on_object": 3, "clamp_moment": 3, "energy": 3, "length": 1}
    assert_same(found, expected, {number: a**power for number, power in powers.items()})


@given(thickness=st.floats(0.02, 0.15), radius=st.floats(0.1, 0.4), depth=st.floats(0.01, 0.2), x=st.floats(0.4, 0.75))
@settings(deadline=None, max_examples=12, derandomize=True)
def test_a_thick_finger_on_a_circle_bends_like_a_line_on_a_larger_circle(
    thickness: float, radius: float, depth: float, x: float
) -> None:
    """PHYSICS 6: bending only, the finger of thickness w on a circle R is a line on R + w/2."""
    line, y = 1e-4, depth - radius - thickness / 2
    poses = []
    for w in (thickness, line):
        grown = Circle(radius=radius + thickness / 2 - w / 2).at(x=x, y=y)
        poses.append(answer(gr.Scene(finger=unit_finger(w), object=grown, theory="bending", tolerance=1e-8)))
    thick, thin = poses
    assert thick.force_on_object == pytest.approx(thin.force_on_object, rel=1e-6)
    assert thick.energy == pytest.approx(thin.energy, rel=1e-6)
    assert thick.contacts[0].s == pytest.approx(thin.contacts[0].s, rel=1e-6)


# ---- Grazing, and the sides from which an object may come.


@pytest.mark.parametrize("theory", ["bending", "shear", "stretch"])
@pytest.mark.parametrize("depth", [1e-3, 1e-5, 1e-6, 1e-7, 1e-8])
def test_force_and_gap_are_continuous_at_grazing(depth: float, theory: str) -> None:
    """A finger pushed by d at s = 1/2 resists with 24 EI d / L^3 (and a little less with shear)."""
    pose = answer(gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.5, y=-0.28 + depth), theory=theory))
    assert pose.status == "contact"
    assert -pose.force_on_object[1] == pytest.approx(24 * depth, rel=0.02)


@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-6, 1e-9])
def test_a_free_finger_is_straight_and_knows_its_distance(gap: float) -> None:
    pose = answer(gr.Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.5, y=-0.28 - gap)))
    assert pose.status == "free" and pose.contacts == () and pose.reason is None
    assert pose.force_on_object == (0, 0) and pose.energy == pose.clamp_moment == pose.tip_rotation == 0
    assert pose.min_gap == pytest.approx(gap, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-5, 0.0])
def test_the_distance_to_a_corner_between_samples_is_found(gap: float) -> None:
    wedge = Polygon(vertices=((0.4, -0.6), (0.4711, -0.03), (0.55, -0.6)))
    pose = answer(gr.Scene(finger=unit_finger(), object=wedge.at(y=-gap), theory="bending"))
    assert pose.min_gap == pytest.approx(gap, rel=1e-6, abs=1e-8)


@pytest.mark.parametrize(
    ("x", "y", "corner"), [(-2.0, 0.0, (0, 0.03)), (-0.5, 1.0, (0, 0.03)), (3.0, -2.0, (1, -0.03))]
)
def test_the_distance_to_an_object_far_away_is_right(x: float, y: float, corner: tuple[float, float]) -> None:
    pose = answer(gr.Scene(finger=unit_finger(), object=Circle(radius=0.05).at(x=x, y=y)))
    assert pose.min_gap == pytest.approx(math.dist((x, y), corner) - 0.05, rel=1e-9)


@pytest.mark.parametrize("depth", [1e-3, 1e-4])
def test_a_needle_touches_where_its_tip_does(depth: float) -> None:
    needle = Polygon(vertices=((-0.0005, -0.3), (0.0005, -0.3), (0.0, 0.0)))
    pose = answer(gr.Scene(finger=unit_finger(), object=needle.at(x=0.5, y=-0.03 + depth), theory="bending"))
    assert pose.status == "contact", pose.reason
    assert -pose.force_on_object[1] == pytest.approx(24 * depth, rel=0.02)


@pytest.mark.parametrize(("direction", "sign"), [((0.0, 1.0), 1), ((0.0, -2.0), -1), ((0.3, 1.0), 1)])
def test_the_approach_decides_on_which_side_of_the_object_the_finger_is(
    direction: tuple[float, float], sign: int
) -> None:
    scene = gr.Scene(finger=unit_finger(), object=Circle(radius=0.15).at(x=0.7, y=0.0), approach=direction)
    pose = answer(scene)
    assert pose.status == "contact", pose.reason
    assert math.copysign(1, pose.tip_rotation) == sign == math.copysign(1, pose.clamp_moment)
    assert pose.contacts[0].on == ("lower" if sign > 0 else "upper")


# ---- What cannot be answered.


def assert_failed(pose: gr.PoseResult) -> None:
    assert pose.status == "failed" and pose.reason
    for name in (*NUMBERS, "motion_force", "tip", "min_gap", "shape"):
        assert getattr(pose, name) is None, name
    assert pose.contacts == () and pose.checks.stationarity is None and pose.error.discretisation is None


def test_an_object_around_the_clamp_is_refused_with_the_remedy() -> None:
    """A trough so long that no retreat frees the finger."""
    trough = Polygon(vertices=((-1.0, -50.0), (0.3, -50.0), (0.3, 50.0), (-1.0, 50.0)))
    result = gr.solve(gr.Scene(finger=unit_finger(), object=trough))
    (pose,) = result.poses
    assert_failed(pose)
    assert "approach" in pose.reason and "retreat" in pose.reason
    with pytest.raises(ValueError, match="result must hold a pose with an answer; got "):
        _ = result.force_on_object


def test_an_object_that_comes_to_lie_on_the_clamp_fails_with_a_reason() -> None:
    pose = answer(gr.Scene(finger=unit_finger(), object=Circle(radius=0.3).at(x=0.0, y=0.0)))
    assert_failed(pose)


def test_a_motion_is_not_one_pose() -> None:
    scene = gr.Scene(finger=unit_finger(), object=Circle(radius=0.1).at(x=0.5, y=Q), motion=gr.Motion("q", (0.0, 1.0)))
    with pytest.raises(ValueError, match=r"scene must have no motion \(gripper.trace follows one\); got "):
        gr.solve(scene)


def test_the_result_says_what_was_solved_and_what_was_not() -> None:
    result = gr.solve(SCENES["flank, shear"])
    assert result.model.theory == "shear"
    assert "plane strain (forces up to 9.9 % larger)" in result.model.not_modelled  # 1 / (1 - 0.3^2)
    assert all(part.why for part in result.model.left_out)
    plain = gr.solve(replace(SCENES["flank, shear"], theory="bending"))
    assert plain.model.theory == "bending"
    assert plain.energy > result.energy  # bending alone is stiffer


def test_solving_twice_gives_the_same_answer_to_the_last_bit() -> None:
    again = answer(SCENES["flank, shear"])
    assert replace(again, seconds=0.0) == replace(ANSWERS["flank, shear"], seconds=0.0)


def test_a_tighter_tolerance_is_kept() -> None:
    for tolerance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10):
        pose = answer(replace(SCENES["flank, shear"], tolerance=tolerance))
        assert pose.error.discretisation <= tolerance


def test_a_uniform_finger_is_a_tapered_one_without_taper() -> None:
    material = unit_finger().material
    one = Uniform(length=1.0, thickness=0.1, width=0.5, material=material)
    other = Tapered(length=1.0, base_thickness=0.1, tip_thickness=0.1, width=0.5, material=material)
    place = Circle(radius=0.2).at(x=0.6, y=-0.1)
    assert_same(*(answer(gr.Scene(finger=finger, object=place)) for finger in (one, other)))


def ways(scene: gr.Scene, place: float) -> tuple[Answer, Answer]:
    """The pose of a motion leapt to, and gone to step by step, the object coming from below."""
    fixed = setting(scene)
    final = Kinematics(scene, fixed.sections.length).frame(place)
    path = Retreat(final, 1j)
    (free, start), _ = retreated(fixed, path, 4)
    walked = Tracker(fixed, path, free, 4, events=False, free=start).advance(0.0)
    return approach(fixed, final, (0.0, 1.0), 4)[0], walked


SMOOTH = [case for case in random(60, seed=11) if case.built and case.body.kind != "polygon"]


@pytest.mark.parametrize("case", SMOOTH[:12], ids=lambda case: case.name)
def test_a_pose_leapt_to_is_that_reached_step_by_step(case: Case) -> None:
    leapt, walked = (answer.verified.equilibrium for answer in ways(case.moving((0.0, 1.0)), 1.0))
    assert leapt.force == pytest.approx(walked.force, rel=1e-6, abs=1e-12)
    assert leapt.state.energy == pytest.approx(walked.state.energy, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("x_e", [-0.1016, -0.0254, 0.0127])
def test_the_rotating_finger_is_leapt_to_in_less_than_half_of_newton_s_steps(x_e: float) -> None:
    leapt, walked = ways(rotating_finger(x_e), x_e)
    assert leapt.iterations < walked.iterations / 2
    assert leapt.verified.equilibrium.force == pytest.approx(walked.verified.equilibrium.force, rel=1e-7)
