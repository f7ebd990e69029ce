"""The exact KKT system: what it solves, its Jacobian, its tangent, and where it refuses."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gripper as gr
from gripper.beam.axis import Axis
from gripper.beam.strains import Beam
from gripper.contact.kinematics import Kinematics
from gripper.contact.linear import linearise
from gripper.contact.site import Site
from gripper.motion.branch import pointed as settled_as_points
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, carried_matrix, kkt_step
from gripper.statics.newton import polished, settle
from gripper.statics.patches import fit_patches
from gripper.statics.steps import advanced
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.polygon import Polygon
from tests.scenes import Q, Solved, follow, micro_assembly, rotating_finger, unit_finger

WEDGE = Polygon(vertices=((-0.2, -0.3), (0.2, -0.3), (0.02, 0.0)))


def wedge(place: float, theory: str) -> gr.Scene:
    """The object's corner from below, on the face."""
    finger = unit_finger(0.03)
    motion = gr.Motion("q", (place,))
    return gr.Scene(finger=finger, object=WEDGE.at(x=0.7, y=Q), motion=motion, theory=theory, tolerance=1e-8)


SCENES = {
    "tangent": lambda q=0.0: rotating_finger(-0.0254 + q, theory="bending", tolerance=1e-8),
    "patch": lambda q=0.0: rotating_finger(-0.0254 + q, tolerance=1e-8),
    "tip corner": lambda q=0.0: rotating_finger(-0.1524 + q, theory="bending", tolerance=1e-8),
    "jaw edge": lambda q=0.0: micro_assembly(0.06781 + q, tolerance=1e-8),
    "jaw corner": lambda q=0.0: micro_assembly(0.060 + q, tolerance=1e-8),
    "vertex, bending": lambda q=0.0: wedge(0.1 + q, "bending"),
    "vertex, shear": lambda q=0.0: wedge(0.1 + q, "shear"),
    "patch, stretch": lambda q=0.0: rotating_finger(-0.0254 + q, theory="stretch", tolerance=1e-8),
    "vertex, stretch": lambda q=0.0: wedge(0.1 + q, "stretch"),
}
names = pytest.mark.parametrize("name", SCENES)


@cache
def solved(name: str) -> Solved:
    """Falling to the tip's corner: the branch of the references."""
    scene = SCENES[name]()
    if name == "tip corner":
        scene = replace(scene, motion=gr.Motion("q", (0.127, *scene.motion.values)))
    *_, last = follow(scene)
    assert last.result.status == "contact", last.result.reason
    return last


def residual(equilibrium: Equilibrium, state: State) -> tuple[np.ndarray, object]:
    setting = OUTLINES[id(equilibrium)]
    lin = linearise(state.beam, state.z, setting.outline, equilibrium.obstacle, state.sites, state.multipliers)
    return np.concatenate([state.z - lin.gradients.T @ state.multipliers, lin.values, lin.residuals]), lin


OUTLINES: dict[int, Setting] = {}


def known(name: str) -> tuple[Setting, Equilibrium]:
    found = solved(name)
    OUTLINES[id(found.equilibrium)] = found.setting
    return found.setting, found.equilibrium


@names
def test_an_equilibrium_that_is_to_be_differentiated_satisfies_its_equations_to_1e_10(name: str) -> None:
    setting, found = known(name)
    equilibrium = polished(setting, found)  # a pose is settled as far as its tolerance asks
    OUTLINES[id(equilibrium)] = setting
    left, _ = residual(equilibrium, equilibrium.state)
    assert np.abs(left).max() < 1e-10 * np.linalg.norm(equilibrium.state.z)


@names
def test_the_kkt_matrix_is_the_jacobian_of_the_equations(name: str) -> None:
    _, equilibrium = known(name)
    state, matrix, h = equilibrium.state, equilibrium.matrix(), 1e-7
    sizes = np.cumsum([len(state.z), len(state.multipliers)])
    random = np.random.default_rng(0)
    for _ in range(6):
        direction = random.normal(size=matrix.shape[1])
        direction /= np.linalg.norm(direction)
        parts = np.split(direction, sizes)
        ends = [residual(equilibrium, state.moved(*(h * sign * part for part in parts)))[0] for sign in (1, -1)]
        difference = (ends[0] - ends[1]) / (2 * h)
        scale = max(1.0, np.abs(difference).max())
        assert matrix @ direction == pytest.approx(difference, abs=2e-5 * scale)


@names
def test_newton_s_step_solves_the_linearised_equations(name: str) -> None:
    _, equilibrium = known(name)
    random = np.random.default_rng(1)
    state = equilibrium.state.moved(
        1e-3 * random.normal(size=len(equilibrium.state.z)),
        1e-3 * random.normal(size=len(equilibrium.state.multipliers)),
        1e-5 * random.normal(size=len(equilibrium.state.places)),
    )
    left, lin = residual(equilibrium, state)
    step = np.concatenate(kkt_step(state, lin))
    matrix = carried_matrix(state, lin)
    assert matrix @ step == pytest.approx(-left, abs=1e-10 * max(1.0, np.abs(matrix).max() * np.abs(step).max()))


def test_newton_s_step_carries_the_kink_at_a_point_in_shear_along_with_it() -> None:
    """Steps that held the segments still would shrink to a fifth each."""
    setting, equilibrium = known("patch")
    state, sizes = settled_as_points(setting, equilibrium, 4).state, []
    state = advanced(setting, state, (0 * state.z, 0 * state.multipliers, np.array([0.02])))
    for _ in range(3):
        lin = linearise(state.beam, state.z, setting.outline, equilibrium.obstacle, state.sites, state.multipliers)
        step = kkt_step(state, lin)
        sizes.append(abs(float(step[2][0])))
        state = advanced(setting, state, step)
    assert sizes[2] < 0.02 * sizes[1]


@names
@given(seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=5, derandomize=True)
def test_newton_returns_from_a_disturbed_start_in_a_few_steps(name: str, seed: int) -> None:
    setting, equilibrium = known(name)
    state, random = equilibrium.state, np.random.default_rng(seed)
    size = 0.02 * np.linalg.norm(state.z) / np.sqrt(len(state.z))
    start = state.moved(size * random.normal(size=len(state.z)), 0.02 * state.multipliers, 0 * state.places)
    again = settle(setting, equilibrium.obstacle, start, state.beam.order)
    assert again.iterations <= 8
    assert abs(again.force - equilibrium.force) < 1e-8 * abs(equilibrium.force)  # segments end within 1e-7 of contacts
    assert again.state.energy == pytest.approx(equilibrium.state.energy, rel=1e-8)


@names
def test_the_equilibrium_does_not_depend_on_the_segments_it_started_from(name: str) -> None:
    setting, equilibrium = known(name)
    old = equilibrium.state
    beam = Beam(setting.sections, (0.0, 0.35, 0.5, 1.0), old.beam.order, setting.theory)
    start = replace(old, beam=beam, z=beam.project(old.beam, old.z))
    again = settle(setting, equilibrium.obstacle, start, old.beam.order)
    assert again.state.beam.breaks == pytest.approx(old.beam.breaks, abs=1e-7)
    assert abs(again.force - equilibrium.force) < 1e-8 * abs(equilibrium.force)


@names
def test_the_tangent_is_the_rate_of_the_equilibrium_along_the_motion(name: str) -> None:
    setting, equilibrium = known(name)
    scene, q = SCENES[name](), solved(name).result.parameter
    kinematics, h = Kinematics(scene, setting.sections.length), 1e-5
    dz, dmultipliers, dplaces = equilibrium.tangent()
    ends = []
    for step in (h, -h):
        predicted = equilibrium.state.moved(step * dz, step * dmultipliers, step * dplaces)
        frame = kinematics.frame(q + step)
        ends.append(settle(setting, setting.obstacle(frame), predicted, equilibrium.state.beam.order))
    high, low = ends
    # the tangent holds the segments still, whose ends move with the contacts: a predictor, not a sensitivity
    rate = (high.state.multipliers - low.state.multipliers) / (2 * h)
    assert dmultipliers == pytest.approx(rate, rel=5e-3, abs=5e-3 * np.abs(rate).max())
    assert dplaces == pytest.approx((high.state.places - low.state.places) / (2 * h), rel=5e-3, abs=5e-3)
    energy = (high.state.energy - low.state.energy) / (2 * h)
    assert equilibrium.state.z @ dz == pytest.approx(energy, rel=1e-5)


def test_a_state_on_other_segments_has_the_same_shape() -> None:
    setting, equilibrium = known("patch")
    state = equilibrium.state
    finer = Beam(setting.sections, tuple(np.union1d(state.beam.breaks, [0.2, 0.8])), state.beam.order, "shear")
    other, s = state.on(finer), np.linspace(0, 1, 9)
    one, two = (Axis.of(each.beam, each.z).values(s, each.beam.segment_of(s))[0] for each in (state, other))
    assert two == pytest.approx(one, abs=1e-9)
    assert other.energy == pytest.approx(state.energy, rel=1e-9)


def test_segments_end_at_contacts_but_never_twice_at_one_place() -> None:
    setting, _ = known("patch")
    sites = (Site("tangent", 0, (0.4,)), Site("tangent", 1, (0.4 + 1e-10,)), Site("patch", 0, (0.7, 0.75)))
    assert setting.beam(sites, 3).breaks == pytest.approx((0.0, 0.4, 0.7, 0.75, 1.0))
    assert setting.beam((Site("tangent", 0, (1 - 1e-10,)),), 3).breaks == (0.0, 1.0)
    assert setting.beam((Site("corner", 3, ()), Site("tangent", 2, (0.05,))), 3).breaks == (0.0, 1.0)


def test_two_contacts_at_one_place_are_refused_as_parallel_or_leave_newton_without_an_end() -> None:
    setting, equilibrium = known("tangent")
    state = equilibrium.state
    twice = replace(state, sites=state.sites * 2, multipliers=np.tile(state.multipliers / 2, 2))
    twice = twice.moved(0.01 * state.z, 0 * twice.multipliers, 0 * twice.places)
    lin = linearise(twice.beam, twice.z, setting.outline, equilibrium.obstacle, twice.sites, twice.multipliers)
    matrix = replace(equilibrium, state=twice, linear=lin).matrix()
    assert np.linalg.cond(matrix) > 1e12
    with pytest.raises(NoEquilibriumError):
        kkt_step(replace(twice, multipliers=0 * twice.multipliers), _zeroed(lin))


def _zeroed(lin: object) -> object:
    """The same with constraints that are parallel to the last bit."""
    gradients = np.tile(lin.gradients[:1], (2, 1))
    return replace(lin, gradients=gradients, value_slopes=0 * lin.value_slopes, load_slopes=0 * lin.load_slopes)


def test_an_object_out_of_reach_leaves_newton_without_an_equilibrium() -> None:
    finger = unit_finger()
    scene = gr.Scene(finger=finger, object=Circle(radius=0.1).at(x=0.6, y=-0.3), motion=gr.Motion("q", (0.0,)))
    (free,) = follow(scene)
    far = free.setting.obstacle(replace(free.equilibrium.obstacle.frame, origin=3 + 3j))
    start = State(free.equilibrium.state.beam, free.equilibrium.state.z, (Site("tangent", 0, (0.5,)),), np.ones(1))
    with pytest.raises(NoEquilibriumError, match=r"did not converge|diverged|singular"):
        settle(free.setting, far, start, 4)


@pytest.mark.parametrize("x_e", [0.0508, 0.0254, -0.0254, -0.0762])
def test_a_point_foresees_the_width_of_its_patch_also_where_g_is_no_distance(x_e: float) -> None:
    """On the ellipse |grad g| goes from 1 to 1.5: a width that forgets it is 1.42 times too wide at x_e = 0.0318."""
    *_, solved = follow(rotating_finger(0.127, x_e))
    patch = solved.equilibrium.state.sites[0]
    pointed = settled_as_points(solved.setting, solved.equilibrium, solved.equilibrium.state.beam.order)
    foreseen = fit_patches(solved.setting, pointed)[0]
    assert (patch.kind, foreseen.kind) == ("patch", "patch")
    width = patch.place[1] - patch.place[0]
    assert foreseen.place == pytest.approx(patch.place, abs=0.01 * width)
