"""Segments are cut where the stiffness varies by decades or within a narrow place, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from scipy.integrate import quad

import gripper as gr
from gripper.beam.grading import graded
from gripper.beam.sections import sections
from gripper.fingers import S
from gripper_plugins.fingers import Formula, Tapered, Uniform
from gripper_plugins.objects import Circle
from tests.scenes import unit_finger

MATERIAL = unit_finger().material
DEPTH = 1e-4


def wedge(ratio: float) -> Tapered:
    """A finger of unit length whose tip is that many times as thick as its base."""
    tip = min(0.05, 0.05 * ratio)
    return Tapered(length=1.0, width=1.0, base_thickness=tip / ratio, tip_thickness=tip, material=MATERIAL)


@pytest.mark.parametrize(
    "finger", [unit_finger(), Uniform(length=2, thickness=0.1, width=1, material=MATERIAL), wedge(0.4)]
)
def test_a_finger_whose_stiffness_varies_little_is_not_cut(finger: gr.Finger) -> None:
    assert sections(finger).cuts == ()


@pytest.mark.parametrize("ratio", [0.03, 30.0, 1000.0])
def test_a_wedge_bends_as_the_integral_of_its_compliance_says(ratio: float) -> None:
    """Unit load at s: deflection there = int (s - sigma)^2 / EI (Castigliano), for small deflections."""
    finger, place = wedge(ratio), 0.7
    half = (finger.base_thickness + place * (finger.tip_thickness - finger.base_thickness)) / 2
    scene = gr.Scene(finger=finger, object=Circle(radius=0.1).at(x=place, y=-half - 0.1 + DEPTH), theory="bending")
    pose = gr.solve(scene).poses[0]
    assert pose.reason is None

    def thickness(s: float) -> float:
        return finger.base_thickness + s * (finger.tip_thickness - finger.base_thickness)

    stiffness = MATERIAL.bending_modulus / 12
    touched = pose.contacts[0].s
    knees = [10.0**-power for power in range(1, 5)]
    flexibility = quad(lambda s: (touched - s) ** 2 / (stiffness * thickness(s) ** 3), 0, touched, points=knees)[0]
    inclined = np.sqrt(
        1 + ((finger.tip_thickness - finger.base_thickness) / 2) ** 2
    )  # the face, against the circle's top
    depth = DEPTH + 0.1 * (inclined - 1)
    assert -pose.force_on_object[1] == pytest.approx(depth / flexibility, rel=2e-3)


def test_a_narrow_hinge_is_resolved() -> None:
    hinge = Formula(
        length=1.0, thickness=0.05 - 0.03 * sympy.exp(-(((S - 0.3) / 0.03) ** 2)), width=1.0, material=MATERIAL
    )
    scene = gr.Scene(finger=hinge, object=Circle(radius=0.1).at(x=0.7, y=-0.075), theory="bending", tolerance=1e-6)
    pose = gr.solve(scene).poses[0]
    assert pose.reason is None
    assert pose.error.discretisation < 1e-6


def test_cuts_halve_towards_where_the_compliance_is_concentrated() -> None:
    cuts = graded(lambda s: (1 + 999 * s) ** -3, (0.0, 1.0))
    assert all(cut == pytest.approx(2.0 ** np.round(np.log2(cut))) for cut in cuts)
    assert 2e-4 < min(cuts) < 2e-3
    assert max(cuts) < 0.1 or len(cuts) < 13
