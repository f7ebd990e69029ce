"""A face that lies flush on a straight edge, with shear: the pressure decays over sqrt(EI / GA) behind lift-off.

On the flat gamma = -psi (from the flat's direction), so that EI psi'' = GA psi: psi, moment, shear force and pressure
all fall as exp(-x / l), l = sqrt(EI / GA). Where the face lifts off at a, no force is concentrated: gamma and the
moment go on, M(a) = P l with P the shear force of the free part. Its end has the flat's slope and height there:

    P (a^2 / 2 + l a + l^2) / EI = slope,   P (a^3 / 3 + l a^2 / 2 + l^2 a) / EI = height at a.
"""

from __future__ import annotations

import numpy as np
import pytest

import gripper as gr
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import HalfPlane, Polygon

THICKNESS = 0.06
MATERIAL = gr.Material(youngs_modulus=12 / THICKNESS**3, poisson_ratio=0.3)  # EI = 1


def finger(thickness: float = THICKNESS) -> Uniform:
    return Uniform(length=1.0, thickness=thickness, width=1.0, material=MATERIAL)


DECAY = float(np.sqrt(1.0 / (MATERIAL.shear_coefficient * MATERIAL.G * THICKNESS)))


def wall(lift_off: float, slope: float) -> gr.Placed:
    """On which the finger lies flush from about ``lift_off`` on (without shear: exactly, for small slopes)."""
    return HalfPlane().at(y=-THICKNESS / 2 - lift_off * slope / 3, angle=slope)


def posed(body: gr.Placed, tolerance: float = 1e-4, thickness: float = THICKNESS) -> gr.PoseResult:
    scene = gr.Scene(finger=finger(thickness), object=body, theory="shear", tolerance=tolerance)
    pose = gr.solve(scene).poses[0]
    assert pose.status == "contact", pose.reason
    return pose


@pytest.mark.parametrize("lift_off", [0.9, 0.7, 0.6, 0.4])
def test_a_flush_finger_has_the_closed_form_s_force_and_lift_off(lift_off: float) -> None:
    slope, decay = 1e-3, DECAY
    contact = posed(wall(lift_off, slope)).contacts[0]
    lift_off -= 0.75 * THICKNESS * slope  # points of the face lie w/2 (sin psi, -cos psi) off the axis
    roots = np.roots([1 / 6, decay / 2 - lift_off / 6, -lift_off * decay / 3, -lift_off * decay**2 / 3])
    a = float(roots.real.max())
    force = slope / (a**2 / 2 + decay * a + decay**2)
    behind = np.exp(-(1 - a) / decay)  # what the tip changes
    assert contact.normal_force == pytest.approx(force, rel=2e-5 + behind**2)
    assert contact.extent == (pytest.approx(a, abs=2e-5 + decay * behind**2), 1.0)
    assert contact.s == pytest.approx(a + decay, abs=2e-3 * decay + decay * behind)


@pytest.mark.parametrize("lift_off", [0.97, 0.9, 0.6, 0.4])
def test_resultant_and_extent_of_a_flush_contact_do_not_depend_on_the_discretisation(lift_off: float) -> None:
    poses = [posed(wall(lift_off, 0.05), tolerance) for tolerance in (1e-2, 1e-3, 1e-4, 1e-6)]
    first = poses[-1].contacts[0]
    for pose in poses:
        assert len(pose.contacts) == 1
        assert pose.error is not None and pose.error.discretisation < 1e-5
        assert pose.contacts[0].normal_force == pytest.approx(first.normal_force, rel=1e-5)
        assert pose.contacts[0].extent == pytest.approx(first.extent, abs=1e-5)
        assert pose.contacts[0].s == pytest.approx(first.s, abs=1e-3)
        assert pose.iterations < 150


def test_the_edge_of_a_block_carries_a_flush_finger_as_a_wall_does_up_to_its_corner() -> None:
    half, place = 0.35, {"x": 0.5, "y": -0.017, "angle": 0.045}
    block = Polygon(vertices=((-half, -0.3), (half, -0.3), (half, 0.0), (-half, 0.0)))
    edge, flat = posed(block.at(**place)), posed(HalfPlane().at(**place))
    assert len(edge.contacts) == 1
    one, other = edge.contacts[0], flat.contacts[0]
    assert one.normal_force == pytest.approx(other.normal_force, rel=1e-5)
    assert one.extent[0] == pytest.approx(other.extent[0], abs=1e-5)
    corner = np.array(place["x"] + 1j * place["y"] + half * np.exp(1j * place["angle"]))
    ends = np.interp(one.extent[1], np.linspace(0, 1, len(edge.shape.lower)), edge.shape.lower[:, 0])
    assert ends == pytest.approx(corner.real, abs=2e-3)
    assert other.extent[1] == 1.0


def test_the_force_of_a_flush_finger_changes_with_its_thickness_as_its_sensitivity_says() -> None:
    body, h = wall(0.6, 0.05), 1e-5
    scene = gr.Scene(finger=finger(), object=body, theory="shear")
    exact = gr.solve(scene).sensitivity("finger.thickness").force_on_object
    thick, thin = (np.array(posed(body, thickness=THICKNESS + step).force_on_object) for step in (h, -h))
    assert np.ravel(exact) == pytest.approx((thick - thin) / (2 * h), rel=1e-5)


@pytest.mark.parametrize(("lift_off", "slope"), [(0.1, 0.01), (0.1, 0.02), (0.2, 0.05)])
def test_a_finger_that_lies_flush_from_near_its_clamp_on_is_answered(lift_off: float, slope: float) -> None:
    """What a pressure cut off too soon leaves would lift the long rest of the finger off the wall, and sink it in."""
    pose = posed(wall(lift_off, slope), 1e-3)
    (contact,) = pose.contacts
    a = contact.extent[0]
    force = slope / (a**2 / 2 + DECAY * a + DECAY**2)
    assert contact.normal_force == pytest.approx(force, rel=2 * slope)
    assert contact.extent[1] == pytest.approx(1.0)
