"""The NCO problem of a scene, as SciPy takes it: only what the scene needs, with exact derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import NonlinearConstraint, minimize

import gripper as gr
from gripper.beam.axis import Axis
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.polygon import Polygon
from tests.scenes import STRAIGHT, TAPERED, micro_assembly, rotating_finger, unit_finger

ROUND = Circle(radius=0.25)
WEDGE = Polygon(vertices=((-0.2, -0.3), (0.2, -0.3), (0.02, 0.0)))
SCENES = {
    "circle, bending": gr.Scene(finger=unit_finger(), object=ROUND.at(x=0.7, y=0.0), theory="bending"),
    "circle, shear": gr.Scene(finger=unit_finger(0.12), object=ROUND.at(x=0.6, y=-0.1), theory="shear"),
    "ellipse, shear": gr.Scene(
        finger=TAPERED, object=Ellipse(semi_axes=(0.05, 0.034)).at(x=0.12, y=-0.02, angle=0.4), theory="shear"
    ),
    "tip corner": gr.Scene(finger=unit_finger(), object=ROUND.at(x=1.1, y=-0.15), theory="bending"),
    "hook": micro_assembly(0.062),
    "wedge": gr.Scene(finger=unit_finger(0.03), object=WEDGE.at(x=0.7, y=0.05), theory="bending"),
}
named = pytest.mark.parametrize("name", SCENES)
H = 1e-6


def first_pose(scene: gr.Scene) -> gr.PoseResult:
    return (gr.trace(scene) if scene.motion else gr.solve(scene)).poses[0]


def exact(problem: gr.Problem) -> object:
    """The same problem for trust-constr, with every Hessian."""
    x0, unit, length = problem.x0, problem.energy_unit, problem.setting.sections.length
    scale = length * problem.gap_scale
    constraint = NonlinearConstraint(
        lambda x: problem.gaps(x) / scale,
        0.0,
        np.inf,
        jac=lambda x: problem.gap_gradients(x) / scale,
        hess=lambda x, weights: problem.gap_hessian(x, weights / scale),
    )
    return minimize(
        lambda x: problem.energy(x) / unit,
        x0,
        jac=lambda x: problem.energy_gradient(x) / unit,
        hess=lambda x: problem.energy_hessian(x) / unit,
        method="trust-constr",
        constraints=[constraint],
        options={"gtol": 1e-9, "xtol": 1e-12, "barrier_tol": 1e-10, "maxiter": 500},
    )


@named
def test_scipy_solves_an_assembled_problem_as_it_stands(name: str) -> None:
    scene = SCENES[name]
    problem = gr.assemble(scene)
    answer = minimize(**problem.scipy())
    assert answer.success, answer.message
    length = problem.setting.sections.length
    assert problem.gaps(answer.x).min() > -1e-8 * length
    expected = first_pose(scene)
    assert problem.energy(answer.x) == pytest.approx(expected.energy, rel=5e-3)  # no segment ends at the contact yet


@named
def test_the_multipliers_give_the_force_on_the_object(name: str) -> None:
    scene = SCENES[name]
    problem = gr.assemble(scene)
    answer = minimize(**problem.scipy())
    force = problem.forces(answer.x, answer.multipliers).sum(axis=0)
    expected = np.array(first_pose(scene).force_on_object_finger_frame)
    assert np.linalg.norm(force - expected) < 5e-3 * np.linalg.norm(expected)


@named
def test_another_solver_with_exact_hessians_finds_the_same_energy(name: str) -> None:
    problem = gr.assemble(SCENES[name])
    slsqp, other = minimize(**problem.scipy()), exact(problem)
    assert other.constr_violation < 1e-8
    assert problem.energy(other.x) == pytest.approx(problem.energy(slsqp.x), rel=1e-5)


@named
def test_the_start_is_free_and_lies_on_the_side_that_the_object_leaves(name: str) -> None:
    problem = gr.assemble(SCENES[name])
    assert problem.gaps(problem.x0).min() >= 0
    assert problem.energy(problem.x0) > 0
    tip = problem.state(problem.x0)
    end = Axis.of(tip.beam, tip.z).values(np.ones(1), np.array([tip.beam.segments - 1]))[0][0]
    assert end.imag > 0  # the object comes from below


@named
def test_the_energy_is_half_the_square_of_the_unknowns_in_joules(name: str) -> None:
    problem = gr.assemble(SCENES[name])
    x = np.random.default_rng(0).normal(size=problem.size)
    assert problem.energy(x) == pytest.approx(problem.energy_unit * x @ x / 2)
    state = problem.state(x)
    assert problem.energy(x) == pytest.approx(state.energy * problem.setting.sections.energy_scale)
    assert problem.energy_gradient(x) == pytest.approx(problem.energy_hessian(x) @ x)


@named
@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=10)
def test_the_gaps_have_exact_gradients_and_hessians(name: str, seed: int) -> None:
    """Also where a place of least gap moves with the unknowns, and where it is held at the end of its stretch."""
    problem, random = PROBLEMS[name], np.random.default_rng(seed)
    modes = np.tile(np.arange(problem.beam.modes), problem.beam.segments * problem.beam.fields)
    x = problem.x0 * random.uniform(0.5, 1.2) + 0.1 * random.normal(size=problem.size) / 4.0 ** (modes + 1)
    direction = random.normal(size=problem.size) / 4.0**modes
    direction /= np.linalg.norm(direction)
    weights = random.normal(size=len(problem.candidates))
    high, low = x + H * direction, x - H * direction
    kinds = [[(s.kind, s.piece) for s in problem.sites(end)] for end in (high, low)]
    places = [np.array([s.middle if s.place else 0.0 for s in problem.sites(end)]) for end in (high, low)]
    if kinds[0] != kinds[1] or np.abs(places[0] - places[1]).max() > 1e-3:
        return  # two minima of a stretch change rank: a kink
    scale = problem.setting.sections.length * problem.gap_scale
    change = (problem.gaps(high) - problem.gaps(low)) / (2 * H)
    assert problem.gap_gradients(x) @ direction / scale == pytest.approx(change / scale, abs=1e-5)
    ends = [weights @ problem.gap_gradients(end) for end in (high, low)]
    change = (ends[0] - ends[1]) / (2 * H)
    hessian = problem.gap_hessian(x, weights)
    tolerance = 1e-4 * max(1.0, np.abs(change / scale).max())
    assert hessian @ direction / scale == pytest.approx(change / scale, abs=tolerance)


PROBLEMS = {name: gr.assemble(scene) for name, scene in SCENES.items()}


def absent(scene: gr.Scene) -> str:
    return " | ".join(part.what for part in gr.assemble(scene).left_out)


def test_what_a_scene_does_not_need_is_left_out_and_named_with_its_reason() -> None:
    plain = SCENES["circle, bending"]
    assert all(part.what and part.why for part in gr.assemble(plain).left_out)
    for word in ("friction", "shear", "stretch", "jaw"):
        assert word in absent(plain)
    assert "shear" not in absent(replace(plain, theory="shear"))
    assert "stretch" in absent(replace(plain, theory="shear")) and "stretch" not in absent(
        replace(plain, theory="stretch")
    )
    assert "jaw" not in absent(replace(plain, finger=STRAIGHT))
    assert gr.solve(plain).model.left_out == gr.assemble(plain).left_out


def test_each_theory_has_its_fields_unknowns_and_no_more() -> None:
    scene = SCENES["circle, shear"]
    sizes = [gr.assemble(replace(scene, theory=theory)).size for theory in ("bending", "shear", "stretch")]
    assert sizes == [sizes[0], 2 * sizes[0], 3 * sizes[0]]


def test_an_object_out_of_reach_leaves_a_problem_without_constraints() -> None:
    problem = gr.assemble(gr.Scene(finger=unit_finger(), object=ROUND.at(x=0.5, y=-1.0)))
    assert problem.candidates == ()
    answer = minimize(**problem.scipy())
    assert answer.success and problem.energy(answer.x) == 0


def test_few_unknowns_and_constraints_reach_scipy() -> None:
    for problem in PROBLEMS.values():
        assert problem.size <= 60
        assert len(problem.candidates) <= 20


def test_the_parameter_chooses_the_pose_of_a_motion() -> None:
    scene = rotating_finger(-0.0254, 0.0508)
    assert (gr.assemble(scene).x0 == gr.assemble(scene, -0.0254).x0).all()
    energies = []
    for q in scene.motion.values:
        problem = gr.assemble(scene, q)
        energies.append(problem.energy(minimize(**problem.scipy()).x))
    assert energies == pytest.approx([0.3074976311, 0.01609935184], rel=5e-3)  # tests/reference/beam.json


def test_a_parameter_without_a_motion_is_refused() -> None:
    with pytest.raises(ValueError, match=r"parameter must be None in a scene without motion; got 0\.3"):
        gr.assemble(SCENES["circle, bending"], 0.3)


def test_the_problem_is_scaled_so_that_units_do_not_reach_scipy() -> None:
    scene = SCENES["circle, bending"]
    finger = replace(unit_finger(), length=1e-6, thickness=0.06e-6, width=1e-6)
    tiny = gr.Scene(finger=finger, object=Circle(radius=0.25e-6).at(x=0.7e-6, y=0.0), theory="bending")
    answers = [minimize(**gr.assemble(each).scipy()) for each in (scene, tiny)]
    assert answers[1].x == pytest.approx(answers[0].x, abs=1e-7)
    assert answers[1].nit == answers[0].nit
