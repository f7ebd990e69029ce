"""Every kind of contact, each beside what is known of it from elsewhere; and outlines that converge to one another."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gripper as gr
from gripper_plugins.fingers import Stepped
from gripper_plugins.jaws import Triangle
from gripper_plugins.objects import (
    Circle,
    Conic,
    Difference,
    Ellipse,
    Grown,
    HalfPlane,
    Implicit,
    Intersection,
    Polygon,
    Spline,
    Superellipse,
    Union,
)
from tests.scenes import STRAIGHT, Q, unit_finger

FINGER = unit_finger()  # EI = 1, L = 1
HALF = 0.03  # of its thickness
H = 2e-5  # step of differences
BLOCK = Polygon(vertices=((-0.1, -0.1), (0.1, -0.1), (0.1, 0.0), (-0.1, 0.0)))
NEEDLE = Polygon(vertices=((-0.0005, -0.3), (0.0005, -0.3), (0.0, 0.0)))
both_theories = pytest.mark.parametrize("theory", ["bending", "shear"])


def answer(body: gr.Object, x: float, y: float, angle: float = 0.0, **options: object) -> gr.PoseResult:
    """The pose of one object against the finger: in contact, proved, nothing penetrating."""
    options = {"finger": FINGER, "theory": "bending", **options}
    (pose,) = gr.solve(gr.Scene(object=body.at(x=x, y=y, angle=angle), **options)).poses
    assert pose.status == "contact", pose.reason
    assert pose.checks.certificate == "proved"
    assert pose.checks.penetration_bound <= 1e-6
    return pose


def assert_same(one: gr.PoseResult, other: gr.PoseResult, tolerance: float) -> None:
    size = math.hypot(*other.force_on_object)
    assert one.force_on_object == pytest.approx(other.force_on_object, rel=0, abs=tolerance * size)
    assert one.energy == pytest.approx(other.energy, rel=2 * tolerance)


# ---- Several contacts: pegs that push a beam by little, beside the cantilever's flexibilities s^2 (3 t - s) / 6 EI.


def pegged(forces: dict[float, float]) -> gr.PoseResult:
    """Pegs below (force > 0) and above (force < 0) the finger, where the linear beam asks for these forces."""
    places = np.array(list(forces))
    low, high = np.minimum.outer(places, places), np.maximum.outer(places, places)
    deflections = low**2 * (3 * high - low) / 6 @ np.array(list(forces.values()))
    sides = np.sign(list(forces.values()))
    pegs = [
        Circle(radius=0.02).at(x=s, y=float(d - side * (0.02 + HALF)))
        for s, d, side in zip(places.tolist(), deflections, sides, strict=True)
    ]
    body = Union(parts=tuple(pegs))
    return answer(body, 0.0, 0.0, approach=(-1.0, 0.0))


@pytest.mark.parametrize(
    "forces",
    [{0.3: 0.06, 0.9: 0.02}, {0.6: 0.04, 0.9: -0.02}, {0.3: 0.06, 0.6: -0.04, 0.9: 0.02}],
    ids=["two", "both faces", "three, on both faces"],
)
def test_separate_contacts_carry_the_forces_of_the_linear_beam(forces: dict[float, float]) -> None:
    contacts = pegged(forces).contacts
    assert [contact.on for contact in contacts] == ["lower" if force > 0 else "upper" for force in forces.values()]
    assert [contact.s for contact in contacts] == pytest.approx(list(forces), abs=1e-3)
    loads = [
        math.copysign(contact.normal_force, force) for contact, force in zip(contacts, forces.values(), strict=True)
    ]
    assert loads == pytest.approx(list(forces.values()), rel=6e-3)  # the slopes' square


# ---- A flat: where the finger comes to lie flush on a wall, and how long.


def on_a_wall(lift_off: float, slope: float = 0.02, **options: object) -> gr.PoseResult:
    """A wall on which the linear beam lies flush from ``lift_off`` to its tip: y = -s th / 3 below the face."""
    return answer(HalfPlane(), 0.0, -HALF - lift_off * slope / 3, slope, **options)


@pytest.mark.parametrize("lift_off", [0.9, 0.6, 0.4])
def test_a_finger_flush_on_a_wall_is_pushed_where_it_comes_to_lie_on_it(lift_off: float) -> None:
    """The linear cantilever of end slope th: F = 2 EI th / s^2, nothing beyond; off by th^2 and th w."""
    pose = on_a_wall(lift_off)
    assert math.hypot(*pose.force_on_object) == pytest.approx(2 * 0.02 / lift_off**2, rel=0.01)
    assert pose.contacts[0].extent[0] == pytest.approx(lift_off, rel=0.01)


@pytest.mark.parametrize("lift_off", [0.9, 0.6, 0.4])
def test_the_resultant_on_a_flat_does_not_depend_on_the_discretisation(lift_off: float) -> None:
    fine = on_a_wall(lift_off, tolerance=1e-8)
    for tolerance in (1e-4, 1e-5):
        pose = on_a_wall(lift_off, tolerance=tolerance)
        assert_same(pose, fine, tolerance)
        assert pose.contacts[0].extent == pytest.approx(fine.contacts[0].extent, rel=tolerance)


def test_with_shear_the_finger_is_pushed_over_a_length_that_ends_at_its_tip() -> None:
    """Before the linear beam's lift-off, by about the length over which shear decays, to the tip; nearly its force."""
    pose = on_a_wall(0.9, theory="shear")
    assert pose.contacts[0].extent[0] < 0.9 < pose.contacts[-1].extent[1] == 1
    stiff = on_a_wall(0.9)
    assert math.hypot(*pose.force_on_object) == pytest.approx(math.hypot(*stiff.force_on_object), rel=0.02)


# ---- Points: corners, needles, wires.


@both_theories
@pytest.mark.parametrize("angle", [0.5, math.pi / 4, 1.2])
def test_a_corner_pushes_like_a_needle_and_like_a_wire_in_its_place(angle: float, theory: str) -> None:
    corner = answer(
        Polygon(vertices=((0, 0), (-0.1, -0.1), (0, -0.2), (0.1, -0.1))), 0.6, 0.0, angle - 0.785, theory=theory
    )
    assert corner.contacts[0].on == "lower"
    assert_same(answer(NEEDLE, 0.6, 0.0, theory=theory), corner, 1e-7)
    wire = answer(Circle(radius=5e-4), 0.6, -5e-4, theory=theory)  # moves the force by its radius times the slope
    assert_same(wire, corner, 1e-3)


@both_theories
def test_the_tip_s_corner_slides_on_an_object_with_its_force_along_the_object_s_normal(theory: str) -> None:
    pose = answer(Circle(radius=0.25), 1.1, -0.2, theory=theory)
    (contact,) = pose.contacts
    assert contact.on == "tip" and contact.s == 1
    corner = complex(*pose.tip) - 1j * HALF * np.exp(1j * pose.tip_rotation)
    away = corner - complex(1.1, -0.2)
    assert abs(away) == pytest.approx(0.25, rel=1e-9)
    assert -complex(*pose.force_on_object) / contact.normal_force == pytest.approx(away / 0.25, rel=1e-9)


# ---- Concave objects.


def test_a_finger_across_a_fork_touches_only_the_prong_that_it_would_touch_alone() -> None:
    prong = ((0.2, -0.3), (0.25, -0.3), (0.25, 0.0), (0.2, 0.0))
    fork = ((-0.25, -0.3), *prong[1:], (0.2, -0.2), (-0.2, -0.2), (-0.2, 0.0), (-0.25, 0.0))
    assert_same(answer(Polygon(vertices=fork), 0.6, 0.0, 0.1), answer(Polygon(vertices=prong), 0.6, 0.0, 0.1), 1e-9)


@both_theories
def test_a_finger_over_a_bowl_lies_on_its_rim(theory: str) -> None:
    """The bowl is a block with a disc cut out; its rim is where the cut meets the top."""
    bowl = Difference(
        parts=(Polygon(vertices=((-0.4, -0.4), (0.4, -0.4), (0.4, 0.0), (-0.4, 0.0))), Circle(radius=0.5).at(y=0.35))
    )
    rim = math.sqrt(0.5**2 - 0.35**2)
    rims = np.abs(bowl.corners[:, 0])[np.abs(bowl.corners[:, 0]) < 0.399]
    assert rims == pytest.approx([rim, rim], abs=1e-9)
    pose = answer(bowl, 0.75, 0.02, 0.1, theory=theory)
    near_rim = complex(0.75, 0.02) - rim * np.exp(0.1j)
    assert complex(*pose.contacts[0].point) == pytest.approx(near_rim, abs=1e-9)


# ---- The jaw.


def test_a_pin_passes_lead_face_apex_and_return_face_and_ends_on_jaw_and_finger_together() -> None:
    """Example I, its pin 0.5 mm higher: snapped in, it is held between the return face and the finger."""
    pin = Circle(radius=0.0089).at(x=Q, y=-0.0100)
    scene = gr.Scene(
        finger=STRAIGHT, object=pin, motion=gr.Motion("q", (0.086, 0.07, 0.06, 0.0522, 0.050)), theory="bending"
    )
    result = gr.trace(scene)
    assert not result.failed
    details = [(event.kind, event.detail) for event in result.events]
    assert details == [
        ("touch", "jaw"),
        ("change", "jaw to corner of jaw"),
        ("change", "corner of jaw to jaw"),
        ("touch", "lower"),
        ("release", "jaw"),
    ]
    last = [event.parameter for event in result.events[-2:]]
    both = gr.Motion("q", (0.086, sum(last) / 2))
    pose = gr.trace(gr.Scene(finger=STRAIGHT, object=pin, motion=both, theory="bending")).poses[-1]
    assert pose.status == "contact", pose.reason
    assert [contact.on for contact in pose.contacts] == ["jaw", "lower"]
    for contact in pose.contacts:  # both on the pin, pushed along its radii
        radius = complex(*contact.point) - complex(pose.parameter, -0.01)
        assert abs(radius) == pytest.approx(0.0089, rel=1e-6)
        assert complex(*contact.normal) == pytest.approx(radius / abs(radius), abs=1e-6)


@pytest.mark.parametrize(
    ("thickness", "length", "lead", "back"),
    [(0.0054, 0.0181, 45.7, 58.3), (0.0026, 0.0128, 46.0, 55.0)],
)
def test_a_block_s_corners_pass_lead_face_and_return_face(
    thickness: float, length: float, lead: float, back: float
) -> None:
    """The object's corner on the return face lies behind the lead face's line: it is not in the jaw for that."""
    jaw = Triangle(length=length, lead_angle=math.radians(lead), return_angle=math.radians(back))
    finger = replace(STRAIGHT, thickness=thickness, jaw=jaw)
    block = Polygon(vertices=((0, 0), (0.015, 0), (0.015, -0.015), (0, -0.015))).at(x=Q, y=-thickness / 2 - 0.002)
    to_apex = length * math.tan(jaw.lead_angle) / (math.tan(jaw.lead_angle) + math.tan(jaw.return_angle))
    ways = (0.04, 0.004, -0.006, -0.016, -0.018, -0.04)  # from the unbent apex to the block's left end
    motion = gr.Motion("q", tuple(finger.length + to_apex + way for way in ways))
    free, lead_pose, top, *backs, gone = gr.trace(gr.Scene(finger=finger, object=block, motion=motion)).poses
    assert free.status == gone.status == "free"
    for pose, corner, sign in ((lead_pose, 0.0, 1), *((pose, 0.015, -1) for pose in backs)):
        assert pose.status == "contact", pose.reason
        (contact,) = pose.contacts
        assert contact.point == pytest.approx((pose.parameter + corner, -thickness / 2 - 0.002), abs=1e-9)
        assert sign * pose.force_on_object[0] > 0 > pose.force_on_object[1]
    assert top.force_on_object[0] == pytest.approx(0, abs=1e-9) and top.contacts[0].on == "jaw"


# ---- Nothing is jumped over.


def last(body: gr.Object, *values: float) -> gr.PoseResult:
    """The last pose of a motion from below the finger into it."""
    scene = gr.Scene(finger=FINGER, object=body.at(x=0.6, y=Q), motion=gr.Motion("q", values), theory="bending")
    return gr.trace(scene).poses[-1]


@pytest.mark.parametrize("body", [Circle(radius=0.01), NEEDLE], ids=["disc", "needle"])
def test_an_object_far_smaller_than_the_motion_s_step_is_not_jumped_over(body: gr.Object) -> None:
    one, many = last(body, -0.5, 0.1), last(body, *np.linspace(-0.5, 0.1, 13).tolist())
    assert one.status == "contact" and [contact.on for contact in one.contacts] == ["lower"]
    assert_same(one, many, 1e-7)


def test_a_wire_through_the_finger_is_never_called_free() -> None:
    """A five-hundredth of the finger's length across, and a step of two thirds of that length."""
    assert last(Circle(radius=0.001), -0.5, 0.2).status != "free"


# ---- One outline, written in several ways.


@cache
def on_ellipse(theory: str) -> gr.PoseResult:
    return answer(Ellipse(semi_axes=(0.2, 0.12)), 0.6, -0.08, 0.3, theory=theory)


A, B = 0.2, 0.12
SAME_ELLIPSE = {
    "conic": Conic(coefficients=(1 / A**2, 1 / B**2, 0, 0, 0, -1)),
    "implicit": Implicit(expression=f"(x/{A})**2 + (y/{B})**2 - 1", extent=0.3),
    "implicit cone": Implicit(expression=f"sqrt((x/{A})**2 + (y/{B})**2) - 1", extent=0.3),
    "superellipse": Superellipse(semi_axes=(A, B), exponent=2),
    "union with what it holds": Union(parts=(Ellipse(semi_axes=(A, B)), Circle(radius=0.05).at(x=0.02))),
    "intersection with what holds it": Intersection(parts=(Ellipse(semi_axes=(A, B)), Circle(radius=0.3))),
    "difference far from the contact": Difference(parts=(Ellipse(semi_axes=(A, B)), Circle(radius=0.05).at(y=-0.12))),
}


@both_theories
@pytest.mark.parametrize("name", SAME_ELLIPSE)
def test_one_ellipse_written_in_any_way_has_one_answer(name: str, theory: str) -> None:
    assert_same(answer(SAME_ELLIPSE[name], 0.6, -0.08, 0.3, theory=theory), on_ellipse(theory), 1e-8)


def test_grown_outlines_are_those_of_the_larger_bodies() -> None:
    large = answer(Circle(radius=0.2), 0.6, -0.1)
    assert_same(answer(Grown(part=Circle(radius=0.15), distance=0.05), 0.6, -0.1), large, 1e-8)
    point = Polygon(vertices=((0.0, 0.0), (-1e-7, -1e-7), (1e-7, -1e-7)))
    assert_same(answer(Grown(part=point, distance=0.2), 0.6, -0.1), large, 1e-5)


@pytest.mark.parametrize(
    ("conic", "polyline"),
    [
        ((4.0, 0, 0, 0, 1, 0), lambda x: -4 * x**2),
        ((1.0, -1.0, 0, 0, 0, 0.01), lambda x: -np.sqrt(x**2 + 0.01)),
    ],
    ids=["parabola", "a hyperbola's branch"],
)
def test_a_branch_without_bounds_pushes_like_the_polygon_along_it(conic: tuple[float, ...], polyline: object) -> None:
    x = np.linspace(-0.4, 0.4, 401)
    shift = float(polyline(0.0))
    vertices = [*zip(x.tolist(), polyline(x).tolist(), strict=True), (0.4, -2.0), (-0.4, -2.0)]
    body = Conic(coefficients=conic)
    if shift:  # the lower of two branches alone
        body = Intersection(parts=(body, HalfPlane()))
    one, other = answer(body, 0.6, -shift, 0.1), answer(Polygon(vertices=tuple(vertices)), 0.6, -shift, 0.1)
    assert one.energy == pytest.approx(other.energy, rel=5e-4)  # as the distance of the outlines
    assert_same(one, other, 5e-3)  # as the distance of the corners: the force is the energy's slope


# ---- Outlines that become one another.


def ring(n: int, turn: float = 0.0, a: float = 0.2, b: float = 0.2) -> tuple[tuple[float, float], ...]:
    angle = turn + 2 * np.pi * np.arange(n) / n
    return tuple(zip((a * np.cos(angle)).tolist(), (b * np.sin(angle)).tolist(), strict=True))


def test_a_polygon_of_n_sides_becomes_its_circle_as_n_to_the_minus_2() -> None:
    """The energy's largest error over a few turns, corner or edge ahead; the 500-gon is as near as that says."""
    energy = answer(Circle(radius=0.2), 0.6, -0.1).energy

    def error(n: int) -> float:
        turns = (2 * np.pi / n * np.array([0.0, 0.25, 0.5, 0.75])).tolist()
        return max(abs(answer(Polygon(vertices=ring(n, turn)), 0.6, -0.1).energy / energy - 1) for turn in turns)

    sides = np.array([32, 64, 128, 500])
    errors = np.array([error(n) for n in sides.tolist()])
    rate, _ = np.polyfit(np.log(sides), np.log(errors), 1)
    assert -rate == pytest.approx(2, abs=0.2)
    assert (errors * sides**2 < 20).all()


MANY = 2 * np.pi * np.arange(500) / 500


@both_theories
def test_a_polygon_of_500_sides_presses_like_its_circle(theory: str) -> None:
    """Its sides are as short as the stretch over which shear spreads a force."""
    sides = Polygon(vertices=tuple(map(tuple, (0.25 * np.column_stack([np.cos(MANY), np.sin(MANY)])).tolist())))
    assert_same(answer(sides, 0.7, -0.15, theory=theory), answer(Circle(radius=0.25), 0.7, -0.15, theory=theory), 5e-3)


# ---- A polygon rolls along a face: from corner to corner, over its sides, and with shear flush on one of them.

POSES = {  # radius, place and turn of a polygon of so many sides
    "a side between two corners": ("bending", 0.306, 0.636, -0.256, 0.946, 96),
    "flush beside a corner": ("shear", 0.1471, 0.4579, -0.0813, 0.514, 16),
    "flush beside a corner, over most of a side": ("shear", 0.3259, 0.577, -0.2392, 5.7099, 32),
    "flush from corner to corner": ("shear", 0.1494, 0.5934, -0.064, 5.6872, 32),
    "two of 500 corners": ("shear", 0.25, 0.6, -0.1, 0.0, 500),
}


@pytest.mark.parametrize("name", POSES)
def test_a_polygon_that_rolls_pushes_with_the_slope_of_the_energy(name: str) -> None:
    theory, radius, x, y, angle, n = POSES[name]
    body = Polygon(vertices=ring(n, a=radius, b=radius))

    def at(dx: float, dy: float) -> gr.PoseResult:
        return answer(body, x + dx, y + dy, angle, theory=theory, tolerance=1e-6)

    slope = [(at(-H, 0).energy - at(H, 0).energy) / (2 * H), (at(0, -H).energy - at(0, H).energy) / (2 * H)]
    assert at(0, 0).force_on_object == pytest.approx(slope, abs=2e-5)


@pytest.mark.parametrize("name", ["flush beside a corner", "flush beside a corner, over most of a side"])
def test_with_shear_the_force_falls_as_cosh_along_a_side_that_ends_in_a_corner(name: str) -> None:
    """Timoshenko's beam on a flat: GA gamma'' = gamma GA^2 / EI, gamma' = 0 at the end, where no moment is left."""
    theory, radius, x, y, angle, n = POSES[name]
    pose = answer(Polygon(vertices=ring(n, a=radius, b=radius)), x, y, angle, theory=theory)
    (contact,) = pose.contacts
    found = pose.kept.equilibrium
    length, shear = contact.extent[1] - contact.extent[0], float(found.state.beam.sections.GA(np.zeros(1))[0])
    corner = abs(complex(found.linear.forces[-1].sum()))
    assert corner * math.cosh(length * math.sqrt(shear)) == pytest.approx(contact.normal_force, rel=1e-2)


@both_theories
def test_a_500_gon_costs_at_most_4_times_its_circle_at_a_dozen_random_places(theory: str) -> None:
    """Function calls, which do not depend on what else the machine does; gallery/many_sides.py measures CPU time."""
    draw = np.random.default_rng(500).uniform
    for _ in range(12):
        radius, x, depth, angle = draw(0.08, 0.35), draw(0.35, 0.95), draw(0.01, 0.12), draw(0.0, 6.28)
        place = {"x": x, "y": depth - HALF - radius, "angle": angle}
        bodies = Circle(radius=radius), Polygon(vertices=ring(500, a=radius, b=radius))
        circle, polygon = (calls(gr.Scene(finger=FINGER, object=body.at(**place), theory=theory)) for body in bodies)
        assert polygon <= 4 * circle, place


def calls(scene: gr.Scene) -> int:
    """How many functions one more solution calls; the pose is answered."""
    gr.solve(scene)
    count = 0

    def note(frame: object, event: str, argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(note)
    try:
        result = gr.solve(scene)
    finally:
        sys.setprofile(None)
    assert not result.failed
    return count


@both_theories
def test_a_spline_through_an_ellipse_s_points_becomes_the_ellipse(theory: str) -> None:
    """Four times the points: a fifteenth of the force's error, and more."""
    exact = answer(Ellipse(semi_axes=(A, B)), 0.6, -0.08, 0.3, theory=theory, tolerance=1e-9)
    errors = []
    for n in (16, 64, 256):
        pose = answer(Spline(points=ring(n, a=A, b=B)), 0.6, -0.08, 0.3, theory=theory, tolerance=1e-9)
        errors.append(abs(complex(*pose.force_on_object) - complex(*exact.force_on_object)))
    assert errors[0] > 15 * errors[1] > 225 * errors[2]
    assert errors[2] < 1e-6 * math.hypot(*exact.force_on_object)


# ---- A finger with a step.


def test_a_stepped_finger_bends_by_the_flexibility_of_its_parts() -> None:
    """Point load at s: d = F (integral of (s - x)^2 / EI), EI = 1 up to the step at 1/2 and 8 times less beyond."""
    finger = Stepped(
        stations=(0, 0.5, 0.5, 1), thicknesses=(0.06, 0.06, 0.03, 0.03), length=1, width=1, material=FINGER.material
    )
    place, depth = 0.8, 1e-4
    flexibility = (place**3 - (place - 0.5) ** 3) / 3 + 8 * (place - 0.5) ** 3 / 3
    pose = answer(NEEDLE, place, -0.015 + depth, finger=finger)
    assert -pose.force_on_object[1] == pytest.approx(depth / flexibility, rel=2e-3)


@both_theories
def test_a_step_s_corner_rests_on_a_flat_like_a_needle_rests_on_the_finger(theory: str) -> None:
    """A finger that is thicker from 1/2 on touches a wall below it with that step's corner, or beyond."""
    steps = {"stations": (0, 0.5, 0.5, 0.6, 0.6, 1), "thicknesses": (0.05, 0.05, 0.08, 0.08, 0.05, 0.05)}
    finger = Stepped(**steps, length=1, width=1, material=FINGER.material)
    pose = answer(Circle(radius=0.2), 0.5, -0.15, finger=finger, theory=theory)
    (contact,) = pose.contacts
    assert 0.5 <= contact.s <= 0.502
    center = complex(*contact.point) - complex(0.5, -0.15)
    assert complex(*contact.normal) == pytest.approx(center / 0.2, abs=1e-6)


@pytest.mark.parametrize("poses", [2, 9, 41])
def test_a_face_goes_over_from_a_corner_to_the_arc_beside_it_where_it_has_the_arc_s_direction(poses: int) -> None:
    """Also where a pose just behind keeps the corner, by less than the penetration allowed."""
    lens = Difference(parts=(Circle(radius=0.11), Circle(radius=0.11).at(x=0.1, y=0.11)))
    corner = min(lens.corners, key=lambda place: place[0])
    placed = lens.at(x=0.67, y=Q)

    def moved(*values: float) -> gr.Result:
        return gr.trace(gr.Scene(finger=FINGER, object=placed, motion=gr.Motion("q", values), theory="bending"))

    touch, change = moved(*np.linspace(-0.2, -0.07, poses)).events
    assert (touch.kind, change.kind) == ("touch", "change")
    before, after = (moved(-0.2, change.parameter + step).poses[-1].contacts[0] for step in (-3e-3, 3e-3))
    assert before.point == pytest.approx((0.67 + corner[0], change.parameter - 3e-3 + corner[1]), abs=1e-7)
    away = np.subtract(after.point, (0.67, change.parameter + 3e-3))
    assert np.hypot(*away) == pytest.approx(0.11, abs=1e-7) and after.point[0] < before.point[0]
    directions = [math.atan2(*contact.normal) for contact in (before, after)]
    assert min(directions) - 1e-4 < math.atan2(*corner) < max(directions) + 1e-4
