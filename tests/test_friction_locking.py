"""Locking, how many answers Coulomb's law leaves, and how far a tangent is from singular."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gripper as gr
from gripper.contact.grip import Grip
from gripper.motion.others import answers, compliance
from gripper.statics.newton import settle
from gripper_plugins.objects.circle import Circle
from tests.scenes import Q, follow, micro_assembly, rotating_finger, unit_finger

SLIPPERY = gr.Friction(coefficient=0.2)


# locking


def test_a_hook_of_much_friction_locks_and_says_from_which_coefficient_on():
    values = (0.05, 0.052, 0.053)
    loose = gr.trace(micro_assembly(*values, friction=gr.Friction(coefficient=0.7)))
    assert {p.status for p in loose.poses} == {"free", "contact"}
    held = gr.trace(micro_assembly(*values, 0.05, friction=gr.Friction(coefficient=0.9)))
    assert [p.status for p in held.poses] == ["free", "locked", "locked", "free"]
    locked = held.poses[1]
    assert "0.814" in locked.reason
    assert locked.force_on_object is None


def test_a_pose_locks_at_a_coefficient_that_does_not_depend_on_the_one_asked_for():
    def pose(mu):
        friction = gr.Friction(coefficient=mu, sense="tipward")
        target = Circle(radius=0.25).at(x=0.55, y=0.0)
        return gr.solve(gr.Scene(finger=unit_finger(), object=target, theory="bending", friction=friction)).poses[0]

    assert pose(2.6).status == "contact"
    for mu in (2.8, 5):
        locked = pose(mu)
        assert locked.status == "locked"
        assert "the limiting one 2.70" in locked.reason


# how many answers

THICK, AT, RADIUS = 0.2, 0.3, 0.15


def jamming(mu, drift):
    """A circle presses a thick finger from below at AT, drifts along it, and withdraws beyond the straight finger.

    N, and rho N along the face at the depth w/2, move the contact by N (a^3 / 3 - rho w a^2 / 4) / EI (a cantilever and
    its end moment): from rho = 4 a / 3 w on any force pulls the finger on to the object.
    """
    y = -THICK / 2 - RADIUS - 0.002 + 0.016 * Q * (1 - Q)
    target = Circle(radius=RADIUS).at(x=AT + drift * Q, y=y)
    motion = gr.Motion("q", (0.0, 0.3, 0.5, 0.8, 0.9, 1.0))
    friction = gr.Friction(coefficient=mu)
    return gr.trace(
        gr.Scene(finger=unit_finger(THICK), object=target, motion=motion, theory="bending", friction=friction)
    )


def test_a_finger_that_friction_may_jam_is_said_to_have_a_free_solution_too():
    jammed = jamming(3.0, -0.02)
    touched = next(event.parameter for event in jammed.events if event.kind == "touch")
    at = AT - 0.02 * touched
    assert [pose.status for pose in jammed.poses] == ["free", *["locked"] * 5]
    limit = float(jammed.poses[1].reason.split()[-1])
    assert limit == pytest.approx(4 * at / (3 * THICK), rel=2e-3)
    others = [pose.checks.other_solutions for pose in jammed.poses]
    assert others[:-2] == [(), (), (), ()]  # the object reaches the straight finger until q = 0.854
    assert others[-2:] == [("free",), ("free",)]
    assert "more than one solution at 2 poses, 4 to 5: the finger might also be free" in str(jammed)
    assert jammed.to_dict()["poses"][-1]["checks"]["other_solutions"] == ["free"]


@pytest.mark.parametrize(("mu", "drift"), [(1.7, -0.02), (3.0, 0.02)])
def test_below_the_limit_or_against_the_other_sense_the_answer_is_the_only_one(mu, drift):
    free = jamming(mu, drift)
    assert [pose.status for pose in free.poses] == ["free", *["contact"] * 3, "free", "free"]
    assert [pose.checks.other_solutions for pose in free.poses] == [()] * 6


def test_two_contacts_have_as_many_answers_as_their_compliance_allows():
    one, swapped = np.eye(2), np.array([[1.0, 2.0], [2.0, 1.0]])  # no P-matrix: its determinant is negative
    assert answers(np.array([0.3, 1.0]), one) == [(False, False)]
    assert answers(np.array([-0.3, 1.0]), one) == [(True, False)]
    assert answers(np.array([-1.0, -1.0]), swapped) == [(False, True), (True, False), (True, True)]
    assert answers(np.array([1.0]), np.array([[-1.0]])) == [(False,), (True,)]
    assert answers(np.array([-1.0]), np.array([[-1.0]])) == []


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=6, max_size=6), st.lists(st.floats(-1, 1), min_size=2, max_size=2))
def test_with_a_positive_definite_compliance_there_is_always_one_answer(entries, velocities):
    root = np.array(entries[:4]).reshape(2, 2)
    skew = entries[4] * np.array([[0.0, 1.0], [-1.0, 0.0]])
    found = answers(np.array(velocities), root @ root.T + 0.1 * np.eye(2) + skew)
    assert len(found) == 1 or min(abs(v) for v in velocities) < 1e-3


def test_the_compliance_is_what_a_change_of_ratio_moves():
    *_, last = follow(rotating_finger(-0.1016, 0.0, friction=SLIPPERY))
    equilibrium, state = last.equilibrium, last.equilibrium.state
    law, steps = state.sites[0].grip.law, []
    for ratio in (0.199, 0.201):
        held = (dataclasses.replace(state.sites[0], grip=Grip(law, ratio=-state.sites[0].grip.sense * ratio)),)
        found = settle(last.setting, equilibrium.obstacle, dataclasses.replace(state, sites=held), state.beam.order)
        anchor, now = equilibrium.linear.rubbing.anchors[0], found.linear.rubbing.anchors[0]
        along = float(now.weights @ ((now.points - anchor.points) * anchor.tangents.conj()).real)
        steps.append(along - float(now.weights @ ((now.u - anchor.u) * (now.stretches + anchor.stretches) / 2)))
    slope = (steps[1] - steps[0]) / -0.002 * state.sites[0].grip.sense
    assert compliance(equilibrium, [0])[0, 0] == pytest.approx(slope, rel=1e-2)


def test_the_singularity_becomes_the_stability_as_friction_vanishes_and_falls_towards_locking():
    def checks(friction):
        scene = gr.Scene(
            finger=unit_finger(), object=Circle(radius=0.25).at(x=0.55, y=0.0), theory="bending", friction=friction
        )
        return gr.solve(scene).pose.checks

    stability = checks(None).stability
    little = checks(gr.Friction(coefficient=1e-6, sense="tipward"))
    assert little.singularity == pytest.approx(stability, rel=1e-5)
    assert little.stability is None
    near = [checks(gr.Friction(coefficient=mu, sense="tipward")).singularity for mu in (0.5, 1.5, 2.5, 2.69)]
    assert all(a > b > 0 for a, b in itertools.pairwise(near))
    assert near[-1] < 0.2 * near[0]
