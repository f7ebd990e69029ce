"""A finger that is bent at rest: its own shape without load, the elastica from there under one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp

import gripper as gr
from gripper.beam.sections import sections
from gripper.fingers import S
from gripper.study.small import NoModelError, linear
from gripper.verify import verify
from gripper_plugins.objects.circle import Circle
from tests.scenes import Q, deepest_cut, follow, still, unit_finger

CURVATURES = {
    "arc": 0.9,
    "hook, upwards": 2.5 * S**2,
    "down, then up": -1.0 + 3.0 * S,
    "bent beyond a kink": sympy.Max(0, S - 0.4) * 3,
    "a step": sympy.Piecewise((0.8, S < 0.35), (-0.5, True)),
    "rolled up": sympy.Float(5.0),
}
named = pytest.mark.parametrize("name", CURVATURES)
THEORIES = ["bending", "shear", "stretch"]


def shape(curvature: object, s: float) -> tuple[complex, float]:
    """The axis and its angle at s, by quadrature of kappa0 alone."""
    value = sympy.lambdify([S], sympy.sympify(curvature), "math")
    at = solve_ivp(
        lambda s, y: [math.cos(y[2]), math.sin(y[2]), value(s)],
        (0, s),
        [0, 0, 0],
        rtol=1e-11,
        atol=1e-12,
        max_step=0.01,
    )
    x, y, psi = at.y[:, -1]
    return complex(x, y), psi


@named
def test_an_unloaded_finger_has_its_rest_shape_and_carries_nothing(name: str) -> None:
    finger = unit_finger(rest_curvature=CURVATURES[name])
    pose = gr.solve(gr.Scene(finger=finger, object=Circle(radius=0.05).at(x=-2.0, y=0.0))).poses[0]
    place, turn = shape(CURVATURES[name], 1.0)
    assert pose.status == "free" and pose.energy == pose.clamp_moment == pose.max_strain == 0
    assert complex(*pose.tip) == pytest.approx(place, abs=1e-6)
    assert pose.tip_rotation == pytest.approx(turn, abs=1e-6)


def test_an_arc_is_exact() -> None:
    k = 0.9
    pose = gr.solve(gr.Scene(finger=unit_finger(rest_curvature=k), object=Circle(radius=0.05).at(x=-2.0, y=0.0))).poses[
        0
    ]
    assert pose.tip == pytest.approx((math.sin(k) / k, (1 - math.cos(k)) / k), abs=1e-12)


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("k", [0.9, -0.6])
def test_it_is_touched_where_its_own_arc_is(k: float, theory: str) -> None:
    """A circle touches an arc where the centres lie a sum (or difference) of radii apart."""
    w, R, x = 0.06, 0.1, 0.35
    finger = unit_finger(w, rest_curvature=k)
    scene = gr.Scene(
        finger=finger,
        object=Circle(radius=R).at(x=x, y=Q),
        motion=gr.Motion("q", tuple(np.linspace(-0.6, 0.08, 9).tolist())),
        theory=theory,
    )
    far = 1 / k + w / 2 + R  # the lower face lies outside an arc that turns up, inside one that turns down
    touch = 1 / k - math.copysign(math.sqrt(far**2 - x**2), k)
    result = gr.trace(scene)
    first = result.events[0]
    assert (first.kind, first.parameter) == ("touch", pytest.approx(touch, abs=1e-7))
    assert result.poses[-1].status == "contact"


def pressed(name: str, theory: str = "bending", depth: float = 0.12, **options: object) -> gr.Scene:
    """A circle that is pushed into the middle of the lower face, along its normal there."""
    at, turn = shape(CURVATURES[name], 0.6)
    centre = at - 1j * (0.03 + 0.15 - depth) * np.exp(1j * turn)
    direction = (-math.sin(turn), math.cos(turn))
    finger = unit_finger(rest_curvature=CURVATURES[name])
    target = Circle(radius=0.15).at(x=centre.real, y=centre.imag)
    return gr.Scene(finger=finger, object=target, approach=direction, theory=theory, tolerance=1e-6, **options)


@named
def test_under_load_it_is_the_elastica_from_its_rest_shape(name: str) -> None:
    """psi' = kappa0 + m / EI, by SciPy from the clamp with the contact's force: it arrives at the contact."""
    scene = pressed(name)
    pose = gr.solve(scene).poses[0]
    assert pose.status == "contact", pose.reason
    (contact,) = pose.contacts
    force = contact.normal_force * complex(*contact.normal)
    value = sympy.lambdify([S], sympy.sympify(CURVATURES[name]), "math")
    point = complex(*contact.point)

    def rates(s: float, y: np.ndarray) -> list[float]:
        moment = ((point - complex(y[0], y[1])).conjugate() * force).imag
        return [math.cos(y[2]), math.sin(y[2]), value(s) + moment]

    *_, end = solve_ivp(rates, (0, contact.s), [0, 0, 0], rtol=1e-11, atol=1e-12, max_step=0.01).y.T
    face = complex(end[0], end[1]) - 0.03j * np.exp(1j * end[2])
    assert abs(face - point) < 1e-5
    assert contact.normal == pytest.approx((-math.sin(end[2]), math.cos(end[2])), abs=1e-5)
    curve = solve_ivp(rates, (0, contact.s), [0, 0, 0], rtol=1e-11, atol=1e-12, max_step=0.01, dense_output=True).sol
    stored = quad(lambda s: (rates(s, curve(s))[2] - value(s)) ** 2 / 2, 0, contact.s, limit=200, epsabs=1e-9)[0]
    assert pose.energy == pytest.approx(stored, rel=1e-5)


@pytest.mark.parametrize("theory", THEORIES)
@named
def test_the_object_feels_the_slope_of_the_energy_and_nothing_overlaps(name: str, theory: str) -> None:
    scene, h = pressed(name, theory), 1e-4
    (solved,) = follow(still(scene))
    pose = solved.result
    assert pose.status == "contact", pose.reason
    assert deepest_cut(scene, solved) <= 1e-6 and pose.checks.certificate == "proved"
    place = complex(scene.object.pose.x, scene.object.pose.y)
    ends = [place + h * step * complex(*scene.approach) for step in (1, -1)]
    energies = [gr.solve(replace(scene, object=scene.object.body.at(x=e.real, y=e.imag))).energy for e in ends]
    along = np.dot(pose.force_on_object, scene.approach)
    assert -along == pytest.approx((energies[0] - energies[1]) / (2 * h), rel=1e-4)


@pytest.mark.parametrize("a", [1e-3, 40.0])
def test_a_larger_one_is_flatter_and_a_mirrored_one_bends_the_other_way(a: float) -> None:
    scene = pressed("arc")
    pose, expected = scene.object.pose, gr.solve(scene).poses[0]
    finger = unit_finger(length=a, thickness=0.06 * a, width=a, rest_curvature=0.9 / a)
    finger = replace(finger, material=scene.finger.material)
    larger = replace(scene, finger=finger, object=Circle(radius=0.15 * a).at(x=a * pose.x, y=a * pose.y))
    assert gr.solve(larger).poses[0].force_on_object == pytest.approx(
        [f * a**2 for f in expected.force_on_object], 1e-7
    )
    other = unit_finger(rest_curvature=-0.9)
    way = (scene.approach[0], -scene.approach[1])
    mirrored = replace(scene, finger=other, object=scene.object.body.at(x=pose.x, y=-pose.y), approach=way)
    found = gr.solve(mirrored).poses[0]
    assert found.force_on_object == pytest.approx([expected.force_on_object[0], -expected.force_on_object[1]], 1e-8)
    assert (found.contacts[0].on, expected.contacts[0].on) == ("upper", "lower")


def test_friction_loses_what_is_put_in_and_not_stored() -> None:
    path = pressed("down, then up").object.pose
    target = Circle(radius=0.15).at(x=float(path.x) + Q, y=float(path.y))
    motion = gr.Motion("q", tuple(np.linspace(0.9, -0.05, 12).tolist()))
    finger = unit_finger(rest_curvature=CURVATURES["down, then up"])
    poses = gr.trace(gr.Scene(finger=finger, object=target, motion=motion, friction=gr.Friction(coefficient=0.2))).poses
    assert all(pose.status in ("free", "contact") for pose in poses), [pose.reason for pose in poses]
    assert poses[-1].dissipation > 0
    assert poses[-1].work == pytest.approx(poses[-1].dissipation + poses[-1].energy, rel=1e-4)


def test_none_and_0_are_the_straight_finger_at_no_cost() -> None:
    straight = unit_finger()
    assert sections(straight).rest is None and sections(unit_finger(rest_curvature=0)).rest is None
    scene = gr.Scene(finger=straight, object=Circle(radius=0.25).at(x=0.7, y=0.0))
    assert (
        gr.solve(scene).force_on_object
        == gr.solve(replace(scene, finger=unit_finger(rest_curvature=0.0))).force_on_object
    )
    assert "rest_curvature" not in gr.solve(scene).to_dict()["scene"]["finger"]
    written = gr.solve(replace(scene, finger=unit_finger(rest_curvature=0.2 * S))).to_dict()
    assert written["scene"]["finger"]["rest_curvature"] == "0.2*s"
    assert any("curvature of the section at rest" in note for note in written["model"]["not_modelled"])


def test_what_does_not_know_it_refuses_it() -> None:
    scene = replace(pressed("arc"), approach=(0.0, 1.0))
    with pytest.raises(ValueError, match=r"rest_curvature must be left out to be verified.*got 0\.9"):
        verify(scene, elements=(8, 2))
    with pytest.raises(NoModelError, match="straight at rest"):
        linear(scene)


@pytest.mark.parametrize(
    ("curvature", "rule"),
    [
        (1 / S, "rest_curvature must be bounded along the finger, with its slope"),
        (sympy.sqrt(S), "rest_curvature must be bounded along the finger, with its slope"),
        (40.0, "rest_curvature times half the thickness must stay below 1; got up to 1.2"),
        (math.inf, "rest_curvature must be a finite number or an expression in s"),
    ],
)
def test_a_rest_shape_that_cannot_be_is_refused(curvature: object, rule: str) -> None:
    with pytest.raises(ValueError, match=rule):
        sections(unit_finger(rest_curvature=curvature))
