"""A face that lies on a flat with friction: where the force acts, and the way over corners, down, and back.

Bending, small deflections (Euler, Bernoulli): beyond the place a where it lifts off the finger is straight, the force N
there turns it by N a^2 / 2 EI, and friction T, half a thickness below the axis, by T (w / 2) a / EI, but only where it
bends the face towards the flat. Where it would bend it away the pressure p spreads along the flat: no moment there
means p' = -p / h, h = mu w / 2, and no moment of normal force and friction together at a.
"""

import numpy as np
import pytest
import sympy

import gripper as gr
from gallery.outlines import EI, finger, outlines
from gripper_plugins.objects import Polygon

HALF, TILT = 0.003, 2e-3  # half the thickness in m; of the flat, small
Q = sympy.Symbol("q")


def pushed(body: gr.Placed, mu: float, ups: list[float], aside: float = 0.0) -> gr.Result:
    """Up by these heights, aside by a part of them, and back."""
    pose = body.pose
    placed = body.body.at(x=pose.x + aside * Q, y=pose.y + Q, angle=pose.angle)
    motion = gr.Motion("q", (*ups, *ups[-2::-1]))
    return gr.trace(
        gr.Scene(finger=finger, object=placed, theory="bending", friction=gr.Friction(coefficient=mu), motion=motion)
    )


def dragged(rise: float, lever: float, nodes: int = 240) -> tuple[float, float]:
    """Force and its place by complementarity: nodes that press, friction's moment -lever N at each, no penetration."""
    s = np.linspace(0.05, 0.09, nodes)
    x, beyond = np.minimum.outer(s, s), np.maximum(np.subtract.outer(s, s), 0.0)  # at i by a force at j
    bent = (s * x**2 / 2 - x**3 / 6 + s**2 / 2 * beyond - lever * (x**2 / 2 + s * beyond)) / EI
    flat, pressing, force = rise + TILT * (s - 0.055), np.zeros(nodes, dtype=bool), np.zeros(nodes)
    for _ in range(2 * nodes):  # the worst one comes or goes
        force[:] = 0.0
        force[pressing] = np.linalg.solve(bent[np.ix_(pressing, pressing)], flat[pressing])
        gap = bent @ force - flat
        wrong = np.where(pressing, -force / max(force.max(), 1e-9), -gap / 1e-6)
        if wrong.max() < 1e-9:
            break
        pressing[np.argmax(wrong)] ^= True
    return float(force.sum()), float(force @ s / force.sum())


def lawful(result: gr.Result, mu: float) -> None:
    """Nothing snaps or fails; Coulomb's law and the balance of work hold at every pose, and nothing penetrates."""
    assert {pose.status for pose in result.poses} <= {"free", "contact"}
    assert all(event.kind != "snap" for event in result.events)
    for pose in result.poses:
        assert pose.checks.penetration_bound < 1e-7
        assert all(abs(c.tangential_force) <= mu * c.normal_force * (1 + 1e-8) for c in pose.contacts)
        spent = pose.energy + pose.dissipation
        assert pose.work == pytest.approx(spent, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.6])
def test_friction_bends_a_face_that_lies_on_a_flat_only_towards_it(mu, aside=0.2):
    flat = Polygon(vertices=((-0.04, 0), (0.04, 0), (0.04, -0.02), (-0.04, -0.02))).at(x=0.055, y=-HALF, angle=TILT)
    result = pushed(flat, mu, [i * 6e-6 for i in range(-16, 12)], aside)
    lawful(result, mu)
    seen = set()
    for pose in result.poses:
        if [contact.extent[0] > 0.02 and contact.extent[1] < 0.09 for contact in pose.contacts] != [True]:
            continue  # at one of the corners
        (contact,) = pose.contacts
        friction = -contact.tangential_force  # on the finger, towards its tip
        turned = contact.normal_force * contact.s**2 / 2 + max(friction, 0.0) * HALF * contact.s
        assert turned / EI == pytest.approx(TILT, rel=2e-3)
        seen.add(np.sign(friction))
        if friction < 0 and mu > 0.5:
            force, place = dragged(pose.parameter * (1 - TILT * aside), mu * HALF)
            assert contact.normal_force == pytest.approx(force, rel=2e-3)
            assert contact.point[0] == pytest.approx(place, abs=5e-5)
    assert seen == {-1.0, 1.0}


def test_a_notch_is_pushed_over_its_edges_and_back_without_a_snap():
    there = [-0.012 + 0.001 * i for i in range(13)]
    result = pushed(outlines(10.0)["notch"], 0.2, there)
    lawful(result, 0.2)
    assert max(len(pose.contacts) for pose in result.poses) == 2
