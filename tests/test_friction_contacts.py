"""Friction at several contacts, at contacts that roll, and at the first touch."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import gripper as gr
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.polygon import PolygonJaw
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.halfplane import HalfPlane
from gripper_plugins.objects.intersection import Intersection
from gripper_plugins.objects.polygon import Polygon
from gripper_plugins.objects.union import Union
from tests.rubbing import balance, check_coulomb, force, off
from tests.scenes import TAPERED, Q, unit_finger

EDGE = PolygonJaw(vertices=((0, -0.03), (0, -0.13), (0.2, -0.13), (0.2, -0.03)))
BUMPS = Union(parts=(Circle(radius=0.02).at(x=-0.06), Circle(radius=0.02).at(x=0.06)))


def on_two_bumps(mu, values, drift=0.0, turn=0.045):
    """Two bumps under the jaw's rigid edge, which rise, drift and turn."""
    target = BUMPS.at(x=1.1 + drift * Q, y=-0.155 + 0.05 * Q, angle=turn * Q)
    friction = gr.Friction(coefficient=mu) if mu else None
    motion = gr.Motion("q", values)
    return gr.trace(
        gr.Scene(finger=unit_finger(jaw=EDGE), object=target, motion=motion, theory="bending", friction=friction)
    )


def kinds(result):
    return [event.kind for event in result.events]


# several contacts


def test_two_contacts_on_one_edge_come_and_go_one_by_one():
    """A step from bump to bump takes both: the edge leaves the first only once it lies on the second."""
    there = on_two_bumps(0.6708, (-0.2, 0.3, 0.8, 0.3, 0.1), drift=-0.0182)
    assert kinds(there)[:5] == ["touch", "touch", "release", "stick", "slip"]
    assert kinds(there)[5:] == ["touch", "release"]
    for pose in there.poses:
        check_coulomb(pose, lambda _: 0.6708)
    assert balance(there.poses).max() < 1e-4


def test_without_friction_two_contacts_on_one_edge_come_and_go_where_they_came():
    there = on_two_bumps(0, (-0.1, 0.3, 0.4, 0.3, 0.1))
    assert kinds(there) == ["touch", "touch", "release", "touch", "release"]
    places = [event.parameter for event in there.events[1:]]
    assert places[:2] == pytest.approx(places[:1:-1], abs=1e-8)


def test_of_two_that_stick_on_one_edge_one_lets_go_and_the_other_sticks_on():
    """With both stuck the finger cannot stretch: the ratio runs off within 1e-6 of the way, but not as far as -mu."""
    turned = on_two_bumps(0.5, (-0.1, 0.3, 0.32, 0.3199, 0.3197, 0.3199))
    assert kinds(turned) == ["touch", "touch", "stick", "release"]
    assert 0 < 0.32 - turned.events[3].parameter < 1e-6
    both, *one = turned.poses[2:]
    assert [contact.state for contact in both.contacts] == ["slip"] * 2
    assert [[contact.state for contact in pose.contacts] for pose in one] == [["stick"]] * 3
    assert off(one[2], one[0].force_on_object_finger_frame) < 1e-9
    assert balance(turned.poses).max() < 1e-3
    for pose in turned.poses:
        check_coulomb(pose, lambda _: 0.5)


@pytest.mark.parametrize("mu", [0, 0.4])
@pytest.mark.parametrize("turn", [1e-5, 0.045, -0.02])
def test_the_first_touch_is_that_of_the_higher_bump_however_little_it_is_higher(mu, turn):
    """Its top, 0.02 above a centre 0.06 aside, meets the straight finger's edge at y = -0.13."""
    where = brentq(lambda q: 0.05 * q - 0.005 + 0.06 * math.sin(abs(turn) * q), 0, 0.2)
    there = on_two_bumps(mu, (-0.2, 0.3), drift=0.02, turn=turn)
    assert kinds(there)[0] == "touch"
    assert there.events[0].parameter == pytest.approx(where, abs=1e-8)
    assert "several" not in str(there)


@pytest.mark.parametrize("mu", [0, 0.3])
def test_bumps_take_over_from_one_another_by_touch_and_release_however_soon(mu):
    """The way on which both touch is as short as the edge turns little; it is never a snap."""
    turns, shares = (1e-3, 1e-4, 1e-5), []
    for turn in turns:
        there = on_two_bumps(mu, (-0.2, 0.1, 0.3, 0.1), drift=0.02, turn=turn)
        assert [kind for kind in kinds(there) if kind in ("touch", "release", "snap", "change")] == [
            *("touch", "touch", "release", "touch", "release")
        ]
        first, second = (event.parameter for event in there.events[1:3])
        shares.append((second - first) / turn)
    assert shares == pytest.approx([shares[-1]] * 3, rel=0.05)


def test_where_friction_brings_the_second_bump_sooner_the_edge_takes_it():
    """Without friction it comes at q = 0.292 on the way there and goes at 0.292 on the way back."""
    there = on_two_bumps(0.7712, (-0.2, 0.1, 0.3, 0.4, 0.8, 0.3), drift=0.045, turn=0.0449)
    assert kinds(there) == ["touch", "touch", "release", "stick", "slip", "touch", "release"]
    assert there.events[1].parameter < 0.285
    assert balance(there.poses).max() < 1e-4


@pytest.mark.parametrize("mu", [0, 0.4])
def test_an_object_with_corners_is_met_at_its_round_side(mu):
    """The circle's top is at y = -0.035 + 0.1 q, the finger's lower face at -0.03."""
    side = HalfPlane().at(y=-0.05, angle=math.pi)
    lens = Intersection(parts=(Circle(radius=0.1), side)).at(x=0.7, y=-0.135 + 0.1 * Q, angle=0.3 * Q)
    friction = gr.Friction(coefficient=mu) if mu else None
    motion = gr.Motion("q", (-0.2, 0.1, 0.3))
    there = gr.trace(gr.Scene(finger=unit_finger(), object=lens, motion=motion, theory="bending", friction=friction))
    assert [event.kind for event in there.events] == ["touch"]
    assert there.events[0].parameter == pytest.approx(0.05, abs=1e-8)


MOTION = (-0.2, 0.1, 0.3, 0.4, 0.3, 0.1)


@settings(max_examples=4, deadline=None)
@given(mu=st.floats(0.05, 0.8), drift=st.floats(-0.1, 0.1), turn=st.floats(0.01, 0.1), bumps=st.sampled_from((2, 3)))
def test_several_contacts_in_any_motion_obey_coulomb_and_lose_what_work_leaves(mu, drift, turn, bumps):
    """There and back over two bumps, or three, and the same wherever the poses stand."""
    middle = (Circle(radius=0.02).at(y=-0.001),) if bumps == 3 else ()
    target = Union(parts=(*BUMPS.parts, *middle)).at(x=1.1 + drift * Q, y=-0.155 + 0.05 * Q, angle=turn * Q)

    def traced(values):
        scene = gr.Scene(
            finger=unit_finger(jaw=EDGE),
            object=target,
            motion=gr.Motion("q", values),
            theory="bending",
            friction=gr.Friction(coefficient=mu),
        )
        return gr.trace(scene).poses

    poses = traced(MOTION)
    for pose in poses:
        assert pose.status in ("free", "contact"), pose.reason
        check_coulomb(pose, lambda _: mu)
    assert balance(poses).max(initial=0.0) < 1e-3
    coarse = traced((-0.2, 0.4, 0.1))
    for pose, same in ((coarse[1], poses[3]), (coarse[2], poses[5])):
        assert np.linalg.norm(force(pose) - force(same)) < 5e-4 * max(np.linalg.norm(force(same)), 1e-2)


def test_contacts_on_the_finger_and_on_the_jaw_have_a_coefficient_each():
    """The jaw hangs over one pin while another presses the finger from below."""
    pins = Union(parts=(Circle(radius=0.05).at(y=-0.03), Circle(radius=0.02).at(x=0.6)))
    target = pins.at(x=0.5 + 0.02 * Q, y=-0.15 + 0.05 * Q)
    friction = gr.Friction(coefficient={"finger": 0.2, "jaw": 0.4})
    motion = gr.Motion("q", (-0.2, 2.0, 2.7, 2.8, 2.9, 3.0, 3.1, 3.3, 2.9))
    scene = gr.Scene(finger=unit_finger(jaw=EDGE), object=target, motion=motion, theory="bending", friction=friction)
    poses = gr.trace(scene).poses
    assert ["jaw", "lower"] in [sorted(contact.on for contact in pose.contacts) for pose in poses]
    for pose in poses:
        check_coulomb(pose, lambda contact: 0.4 if contact.on == "jaw" else 0.2)
    assert balance(poses).max() < 1e-3


def test_the_published_friction_refuses_two_contacts():
    target = BUMPS.at(x=1.1, y=-0.155 + 0.05 * 0.3, angle=0.0135)
    friction = gr.Friction(coefficient=0.3, model="published", sense="baseward")
    pose = gr.solve(gr.Scene(finger=unit_finger(jaw=EDGE), object=target, theory="bending", friction=friction)).poses[0]
    assert pose.status == "failed"
    assert "takes one contact; here are 2" in pose.reason


# contacts that roll


@pytest.mark.parametrize(
    ("thickness", "length", "lead", "back", "depth"),
    [(0.0053, 0.0156, 42.5, 41.5, 0.0002), (0.0051, 0.0134, 20.2, 87.9, 0.0025)],
)
def test_what_snaps_lose_is_booked(thickness, length, lead, back, depth):
    """A block over a hook: off its lead face onto its top, and off its top, the finger falls."""
    jaw = Triangle(length=length, lead_angle=np.radians(lead), return_angle=np.radians(back))
    material = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
    hook = Uniform(length=0.057, thickness=thickness, width=0.0095, material=material, jaw=jaw)
    block = Polygon(vertices=((0, 0), (0.015, 0), (0.015, -0.015), (0, -0.015))).at(x=Q, y=-thickness / 2 - depth)
    motion = gr.Motion("q", tuple(np.linspace(0.077, 0.041, 19).tolist()))
    result = gr.trace(gr.Scene(finger=hook, object=block, motion=motion, friction=gr.Friction(coefficient=0.3)))
    assert [event.kind for event in result.events].count("snap") == 2 and not result.failed
    assert balance(result.poses).max() < 1e-3
    last = result.poses[-1]
    assert last.status == "free" and last.dissipation == pytest.approx(last.work, rel=1e-3)


def test_a_wheel_that_rolls_along_the_finger_loses_next_to_nothing():
    """Its rim passes as fast as it moves on: what is left is the slip of a face that bends."""

    def along(turning):
        target = Circle(radius=0.1).at(x=0.4 + 0.3 * Q, y=-0.051 + 0.02 * Q, angle=turning * 3 * Q)
        friction = gr.Friction(coefficient=0.5)
        motion = gr.Motion("q", (0.0, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0))
        finger = unit_finger(0.002)
        return gr.trace(
            gr.Scene(finger=finger, object=target, motion=motion, theory="bending", friction=friction)
        ).poses

    rolling, dragged = along(1), along(0)
    for poses in (rolling, dragged):
        assert poses[-1].contacts[0].s - poses[0].contacts[0].s > 0.29
        assert balance(poses).max() < 1e-3
    assert 0 <= rolling[-1].dissipation < 0.01 * dragged[-1].dissipation


# the first touch


@pytest.mark.parametrize("mu", [0.3, 0.05])
def test_a_first_touch_sticks_where_its_ratio_stays_within_mu(mu):
    """Loads N and T = rho N, at the depth h below s = a: v = N a^3 / 3 + T h a^2 / 2, u = h (N a^2 / 2 + T h a)."""
    h, a, rho, radius = 0.05, 0.5, 0.1, 0.1
    slope = h * (a / 2 + rho * h) / (a * a / 3 + rho * h * a / 2)  # u / v that needs the ratio rho
    target = Circle(radius=radius).at(x=a + slope * 0.1 * Q, y=-h - radius + 0.1 * Q)
    motion = gr.Motion("q", (-0.1, 1e-4, 1e-3))
    friction = gr.Friction(coefficient=mu)
    result = gr.trace(
        gr.Scene(finger=unit_finger(2 * h), object=target, motion=motion, theory="bending", friction=friction)
    )
    _, first, second = (pose for pose in result.poses)
    if mu > rho:
        assert [pose.contacts[0].state for pose in (first, second)] == ["stick", "stick"]
        assert -first.contacts[0].tangential_force / first.contacts[0].normal_force == pytest.approx(rho, rel=2e-2)
        assert second.dissipation <= 1e-9 * second.energy
    else:
        assert [pose.contacts[0].state for pose in (first, second)] == ["slip", "slip"]
    assert balance(result.poses).max() < 1e-3


# along the finger


def test_stick_ends_at_the_coefficient_of_the_place_where_the_contact_is():
    """Mu is 0.3 at s = 0.5, where it touches first: there the contact sticks, and moves to where mu is larger."""
    s = sympy.Symbol("s")
    h, a, radius = 0.05, 0.5, 0.1

    def pressed(friction):
        target = Circle(radius=radius).at(x=a + 0.0149 * Q, y=-h - radius + 0.1 * Q)
        motion = gr.Motion("q", (-0.1, 0.3))
        scene = gr.Scene(finger=unit_finger(2 * h), object=target, motion=motion, theory="bending", friction=friction)
        return gr.trace(scene)

    graded, slipped = pressed(gr.Friction(coefficient=0.6 - 0.6 * s)), []
    for result in (graded, pressed(gr.Friction(coefficient=0.3))):
        slipped.append(next(event.parameter for event in result.events if event.kind == "slip"))
    contact = graded.poses[-1].contacts[0]
    ratio = abs(contact.tangential_force) / contact.normal_force
    assert ratio == pytest.approx(0.6 - 0.6 * contact.s, rel=1e-8)
    assert slipped[0] > 1.0001 * slipped[1]
    assert balance(graded.poses).max() < 1e-3


@pytest.mark.parametrize("coefficient", [None, 0.2])
def test_of_two_bumps_under_a_face_the_lower_one_hides_none_however_long_the_step(coefficient):
    """Between two samples of the face a gap may have two minima; an object is never passed for one that is free."""
    bumps = Union(parts=(Circle(radius=0.014).at(x=-0.008), Circle(radius=0.014).at(x=0.008)))
    friction = gr.Friction(coefficient=coefficient) if coefficient else None
    ends = []
    for poses in (2, 9):
        motion = gr.Motion("q", np.linspace(-0.06, -0.025, poses))
        scene = gr.Scene(finger=TAPERED, object=bumps.at(x=0.12, y=Q, angle=0.4), motion=motion, theory="shear")
        ends.append(gr.trace(replace(scene, friction=friction)).poses[-1])
    for end in ends:
        (contact,) = end.contacts  # of the bump that is further out, and higher: below it by its radius
        higher = np.array((0.12, -0.025)) + 0.008 * np.array((math.cos(0.4), math.sin(0.4)))
        assert math.dist(contact.point, higher) == pytest.approx(0.014, abs=1e-6)
        assert end.min_gap > -1e-6 * TAPERED.length
    assert ends[0].force_on_object == pytest.approx(ends[1].force_on_object, rel=1e-6)


# what is rigid sticks as one


@pytest.mark.parametrize(
    ("mu", "height", "drift", "turn", "told"),
    [
        (0.8, 0.0005, -0.03, 0.05, ["touch", "touch", "stick", "release"]),
        (0.8, 0.0015, 0.08, 0.03, ["touch", "touch", "release", "stick", "touch", "release"]),
    ],
)
def test_a_bump_that_comes_where_none_may_slip_makes_all_stick_to_the_jaw(mu, height, drift, turn, told):
    """On a rigid jaw no contact slips while another sticks: the one takes over from the other, stuck; it is no snap."""
    bumps = Union(parts=(*(Circle(radius=0.02).at(x=x) for x in (-0.07, 0.07)), Circle(radius=0.02).at(y=height)))
    target = bumps.at(x=1.1 + drift * Q, y=-0.155 + 0.05 * Q, angle=turn * Q)
    motion = gr.Motion("q", (-0.2, 0.3, 0.6, 0.8, 0.6, 0.3))
    friction = gr.Friction(coefficient=mu)
    scene = gr.Scene(finger=unit_finger(jaw=EDGE), object=target, motion=motion, theory="bending", friction=friction)
    there = gr.trace(scene)
    assert kinds(there)[: len(told)] == told and "snap" not in kinds(there)
    for pose in there.poses:
        check_coulomb(pose, lambda _: mu)
    assert balance(there.poses).max() < 1e-3


@pytest.mark.parametrize("parts", [1, 2])
def test_where_two_bumps_turn_the_motion_both_stick_however_long_the_first_step_back_is(parts):
    """Ratios run from mu to -mu within 1e-6 of the way: neither bump lets go before."""
    values = (-0.2, 0.3, 0.6, 0.8, *np.linspace(0.8, 0.6, parts + 1)[1:])
    there = on_two_bumps(0.133, values, drift=0.0545, turn=0.0568)
    assert len(there.poses[3].contacts) == 2
    assert "snap" not in kinds(there)
    for pose in there.poses:
        check_coulomb(pose, lambda _: 0.133)
    assert balance(there.poses).max() < 1e-3


def test_work_of_a_pin_that_slips_off_a_corner_is_booked_however_steeply_its_force_falls():
    """A pin as small as the steps passes from edge to edge over corners, and off the last of them."""
    jaw = PolygonJaw(vertices=((0, -0.03), (0.05, -0.11), (0.17, -0.1), (0.25, -0.05), (0.28, -0.03)))
    pin = Circle(radius=0.02).at(x=1.45 - 0.4 * Q, y=-0.105)
    motion = gr.Motion("q", tuple(np.linspace(0, 1.4, 9).tolist()))
    friction = gr.Friction(coefficient=0.5)
    scene = gr.Scene(finger=unit_finger(jaw=jaw), object=pin, motion=motion, theory="bending", friction=friction)
    result = gr.trace(scene)
    assert "change" in kinds(result) and kinds(result)[-1] == "release"
    assert balance(result.poses).max() < 2e-4


@pytest.mark.parametrize("coefficient", [None, 0.48])
def test_the_first_of_two_pins_is_met_where_it_is_however_long_the_step(coefficient):
    """On a long stretch of the face the least sample may lie beside a crest: the first pin's top is behind that."""
    left, radius = -0.048305763, 0.0415080565
    pins = Union(parts=(Circle(radius=radius).at(x=left), Circle(radius=0.0462094).at(x=-left)))
    target = pins.at(x=0.65 - 0.108232067 * Q, y=0.1 * Q - 0.0998096678, angle=0.2032512424 * Q - 0.1759562457)
    friction = gr.Friction(coefficient=coefficient) if coefficient else None
    material = gr.Material(youngs_modulus=55e3, poisson_ratio=0.3)
    finger = Tapered(length=1.0, base_thickness=0.078, tip_thickness=0.048, width=1.0, material=material)
    scene = gr.Scene(finger=finger, object=target, motion=gr.Motion("q", (-0.2, 0.1, 0.3)))
    there = gr.trace(replace(scene, friction=friction))

    def room(q):
        """Between the straight face, y = -0.039 + 0.015 s, and the left pin."""
        centre = complex(0.65 - 0.108232067 * q, 0.1 * q - 0.0998096678)
        centre += left * complex(np.exp(1j * (0.2032512424 * q - 0.1759562457)))
        return (-0.039 + 0.015 * centre.real - centre.imag) / math.hypot(1, 0.015) - radius

    assert kinds(there) == ["touch"] and not there.failed
    assert there.events[0].parameter == pytest.approx(brentq(room, 0.1, 0.3), abs=1e-8)
