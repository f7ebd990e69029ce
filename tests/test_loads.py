import dataclasses
import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
import sympy
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text
from scipy.integrate import solve_bvp

import gripper as gr
from gripper.assemble import setting
from gripper.beam.axis import Axis
from gripper.contact.obstacle import Stage
from gripper.scenefile import dumps, loads
from gripper.statics.acting import Acting
from gripper.verify import verify
from gripper_plugins.fingers import Tapered, Uniform
from gripper_plugins.loads import FollowingForce, Force, Gravity, Moment, Tendon
from gripper_plugins.objects import Circle

EXACT = json.loads(Path(__file__).with_name("reference").joinpath("exact.json").read_text())
CANTILEVER = next(table["rows"] for name, table in EXACT.items() if "Mattiasson" in name)
SHEARED = next(table["rows"] for name, table in EXACT.items() if "Batista" in name)
W, FAR = 0.05, Circle(radius=0.1).at(x=0.0, y=-30.0)
UNIT = Uniform(
    length=1.0, thickness=W, width=W**-3, material=gr.Material(youngs_modulus=12.0, poisson_ratio=0.0)
)  # EI = 1
Q = sympy.Symbol("q")
RUBBER = gr.Material(youngs_modulus=4.8e6, poisson_ratio=0.4)
TAPER = Tapered(length=0.1778, base_thickness=0.030, tip_thickness=0.017, width=0.025, material=RUBBER)
GUIDES = (0.06, 0.15)
EACH = {
    "force": Force(force=(0.3 * Q, -2 * Q), s=0.11, offset=(0.01, -0.004)),
    "following": FollowingForce(force=(0.5 * Q, -2 * Q), offset=(0.0, 0.006)),
    "moment": Moment(moment=-0.1 * Q, s=0.07),
    "gravity": Gravity(density=2e4, acceleration=(2 * Q, -9.81 * Q)),
    "tendon": Tendon(tension=12 * Q, offset=-0.012, guides=GUIDES),
}
every_load = pytest.mark.parametrize("load", EACH.values(), ids=EACH)
every_potential = pytest.mark.parametrize(
    "load", [v for k, v in EACH.items() if k != "following"], ids=lambda v: type(v).__name__
)


def alone(*acting, finger=UNIT, **options):
    """The only pose of a finger that nothing touches."""
    result = gr.solve(gr.Scene(finger=finger, object=FAR, loads=acting, **{"theory": "bending", **options}))
    return result.poses[0]


@pytest.mark.parametrize("row", CANTILEVER, ids=lambda row: f"P = {row[0]:g}")
def test_a_dead_tip_load_bends_a_scene_s_finger_as_elliptic_integrals_say(row):
    load, w, u, slope, curvature = row
    text = dumps(gr.Scene(finger=UNIT, object=FAR, theory="bending", tolerance=1e-8))
    pose = gr.solve(loads(text + f'\n[[loads]]\ntype = "force"\nforce = [0, {load}]\n')).poses[0]
    assert pose.status == "free" and pose.force_on_object == (0, 0)
    assert (*pose.tip, pose.tip_rotation) == pytest.approx((1 - u, w, slope), abs=5e-9)
    assert pose.clamp_moment == pytest.approx(curvature, rel=1e-7)
    assert pose.max_strain == pytest.approx(curvature * W / 2, rel=1e-7)
    assert pose.error.discretisation < 1e-8


@pytest.mark.parametrize("row", SHEARED, ids=lambda row: f"GA = {row[0]:g}")
def test_with_shear_it_is_the_inextensible_solution_of_the_reference(row):
    stiff, _, _, short, high = row  # EI = 10, P = 10: scaled by 10
    poisson = 0.0
    shear = stiff / 10 / (5 / 6 * W**-2)
    material = gr.Material(youngs_modulus=12.0, poisson_ratio=poisson, shear_modulus=shear)
    pose = alone(
        Force(force=(0, 1)), finger=dataclasses.replace(UNIT, material=material), theory="shear", tolerance=1e-8
    )
    assert (1 - pose.tip[0], pose.tip[1]) == pytest.approx((short, high), abs=2e-8)


@pytest.mark.parametrize("theory", ["bending", "shear", "stretch"])
def test_an_end_moment_of_2_pi_EI_over_L_closes_the_circle(theory):
    pose = alone(Moment(moment=2 * math.pi), theory=theory)
    assert pose.tip == pytest.approx((0, 0), abs=1e-12)
    assert pose.tip_rotation == pytest.approx(2 * math.pi, rel=1e-12)
    assert pose.max_strain == pytest.approx(math.pi * W, rel=1e-12)


def test_small_deflections_add_up():
    acting = Force(force=(0, 1e-4), s=0.6), Moment(moment=-2e-4), Gravity(mass_per_length=1e-5), Force(force=(0, -1e-4))
    together, each = alone(*acting), [alone(one) for one in acting]
    assert together.tip[1] == pytest.approx(sum(pose.tip[1] for pose in each), rel=1e-6)
    assert together.tip_rotation == pytest.approx(sum(pose.tip_rotation for pose in each), rel=1e-6)


def test_own_weight_bends_by_q_L4_over_8_EI():
    density = 1e-6
    pose = alone(Gravity(density=density, acceleration=(0.0, -9.81)))
    weight = 9.81 * density * W * W**-3
    assert pose.tip[1] == pytest.approx(-weight / 8, rel=1e-6)
    assert pose.clamp_moment == pytest.approx(-weight / 2, rel=1e-6)
    only = pose.loads[0]
    assert (only.point[0], only.force[1], only.moment) == pytest.approx((0.5, -weight, 0.0), rel=1e-6, abs=1e-9)


def test_a_base_that_yields_adds_F_L2_over_k():
    stiff, force = 0.7, 1e-5
    soft = dataclasses.replace(UNIT, base=gr.Base(rotational_stiffness=stiff))
    pose = alone(Force(force=(0, force)), finger=soft)
    assert pose.tip[1] == pytest.approx(force / 3 + force / stiff, rel=1e-6)
    assert pose.energy == pytest.approx(force * pose.tip[1] / 2, rel=1e-6)


def elastica(force, follows, stiff):
    """Axis, angle and curvature at the tip by collocation: EI = L = 1, a tip force (dead, or turning with the tip)."""

    def slopes(s, y, p):
        fx, fy = direction(p[0])
        return np.array([np.cos(y[2]), np.sin(y[2]), y[3], -(np.cos(y[2]) * fy - np.sin(y[2]) * fx)])

    def direction(angle):
        turn = angle if follows else 0.0
        return (force[0] * np.cos(turn) - force[1] * np.sin(turn), force[0] * np.sin(turn) + force[1] * np.cos(turn))

    def ends(a, b, p):
        return np.array([a[0], a[1], a[2] - a[3] / stiff, b[3], b[2] - p[0]])

    s = np.linspace(0, 1, 41)
    start = np.array([s, 0.3 * s**2, 0.6 * s, 0.6 * (1 - s)])
    found = solve_bvp(slopes, ends, s, start, p=[0.6], tol=1e-10, max_nodes=50_000)
    assert found.success
    return found.y[:, -1]


@pytest.mark.parametrize("follows", [False, True], ids=["dead", "following"])
@pytest.mark.parametrize("stiff", [np.inf, 3.0], ids=["clamped", "base"])
@pytest.mark.parametrize("force", [(0.0, 1.5), (-0.8, 2.0)], ids=str)
def test_tip_forces_agree_with_collocation_of_the_elastica(follows, stiff, force):
    base = None if np.isinf(stiff) else gr.Base(rotational_stiffness=stiff)
    load = FollowingForce(force=force) if follows else Force(force=force)
    pose = alone(load, finger=dataclasses.replace(UNIT, base=base), tolerance=1e-8)
    assert (*pose.tip, pose.tip_rotation) == pytest.approx(elastica(force, follows, stiff)[:3], abs=1e-7)
    assert (pose.checks.stability is None) == follows and (pose.checks.singularity is None) != follows


def touched(force, centre, radius):
    """Contact force and its s by collocation: EI = L = 1, dead tip force, axis on a circle, both parts on [0, 1]."""

    def slopes(t, y, p):
        s, normal = p
        first, last = y[:4], y[4:]
        beyond = force + normal * np.array([-math.sin(angle[0]), math.cos(angle[0])])
        return np.vstack([s * course(first, beyond), (1 - s) * course(last, force)])

    def course(y, beyond):
        return np.array([np.cos(y[2]), np.sin(y[2]), y[3], -(np.cos(y[2]) * beyond[1] - np.sin(y[2]) * beyond[0])])

    def ends(a, b, p):
        away, along = b[:2] - centre, np.array([math.cos(b[2]), math.sin(b[2])])
        return np.concatenate([a[:3], b[:4] - a[4:], [b[7], np.hypot(*away) - radius, away @ along]])

    angle, force = [0.3], np.asarray(force)
    t = np.linspace(0, 1, 31)
    start = np.array([0.7 * t, 0.1 * t**2, 0.3 * t, 0.4 * (1 - t), 0.7 + 0.3 * t, 0.1 + 0.1 * t, 0.3 + 0 * t, 0 * t])
    guess = [0.7, 2.0]
    for _ in range(60):  # the normal's direction is that at the contact: held, solved, taken anew
        found = solve_bvp(slopes, ends, t, start, p=guess, tol=1e-9, max_nodes=50_000)
        assert found.success
        moved, angle[0] = abs(found.y[2, -1] - angle[0]), float(found.y[2, -1])
        start, guess, t = found.y, found.p, found.x
        if moved < 1e-10:
            break
    return found.p


def test_a_contact_beside_a_dead_tip_force_agrees_with_collocation():
    force, centre, radius = (0.2, -1.0), (0.7, -0.15), 0.25
    scene = gr.Scene(
        finger=UNIT,
        object=Circle(radius=radius).at(x=centre[0], y=centre[1]),
        theory="bending",
        tolerance=1e-7,
        loads=(Force(force=force),),
    )
    pose = gr.solve(scene).poses[0]
    s, normal = touched(force, centre, radius + W / 2)
    assert len(pose.contacts) == 1
    assert pose.contacts[0].s == pytest.approx(s, abs=1e-6)
    assert pose.contacts[0].normal_force == pytest.approx(normal, rel=1e-6)


@pytest.mark.parametrize("stiff", [np.inf, 1.5], ids=["clamped", "base"])
def test_a_column_is_refused_from_its_buckling_load_on(stiff):
    # clamped pi^2 / 4; on a spring beta tan(beta) = k L / EI, P = beta^2 EI / L^2 (Timoshenko & Gere, section 2.3)
    low, high = 0.1, math.pi / 2 - 1e-9
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if middle * math.tan(middle) < stiff else (low, middle)
    critical = math.pi**2 / 4 if np.isinf(stiff) else low**2
    finger = UNIT if np.isinf(stiff) else dataclasses.replace(UNIT, base=gr.Base(rotational_stiffness=stiff))
    below = alone(Force(force=(-0.999 * critical, 0)), finger=finger, theory="bending", tolerance=1e-8)
    assert below.status == "free" and 0 < below.checks.stability < 2e-3
    beyond = alone(Force(force=(-1.001 * critical, 0)), finger=finger)
    assert beyond.status == "failed" and "the loads alone have no stable equilibrium beyond 99.9 %" in beyond.reason


def at_rest(load, values, reach=0.75, theory="shear"):
    """A finger and a circle at rest that it touches once the load has grown to a part of it (None: far away)."""
    if reach is None:
        motion = gr.Motion("q", values)
        return gr.trace(gr.Scene(finger=TAPER, object=FAR, theory=theory, loads=(load,), motion=motion))
    bent = alone(scaled(load, reach), finger=TAPER, theory=theory).shape.lower
    near = int(np.argmin(np.abs(bent[:, 0] - 0.13)))
    away = np.array([bent[near + 1, 1] - bent[near - 1, 1], bent[near - 1, 0] - bent[near + 1, 0]])
    place = bent[near] + 0.02 * away / np.hypot(*away)
    target = Circle(radius=0.02).at(x=place[0], y=place[1])
    return gr.trace(gr.Scene(finger=TAPER, object=target, theory=theory, loads=(load,), motion=gr.Motion("q", values)))


def scaled(load, part):
    """The load where the motion's parameter has this value."""
    values = {field.name: getattr(load, field.name) for field in dataclasses.fields(load)}

    def at(value):
        if isinstance(value, tuple):
            return tuple(map(at, value))
        return float(value.subs(Q, part)) if isinstance(value, sympy.Expr) else value

    return dataclasses.replace(load, **{name: at(value) for name, value in values.items()})


@every_potential
@pytest.mark.parametrize("reach", [None, 0.5], ids=["free", "contact"])
def test_what_is_stored_changes_by_the_load_s_work(load, reach):
    values = (0.0, 0.9, 0.95, 1.0, 1.05, 1.1)
    *_, first, second, third, fourth, last = at_rest(load, values, reach).poses
    assert {pose.status for pose in (first, last)} == {"contact" if reach else "free"}
    stored = [pose.energy + pose.load_energy for pose in (first, second, third, fourth, last)]
    # at rest d(V + U)/dq is the explicit part, U / q of a load that is proportional to q; five points
    rate = (stored[0] - 8 * stored[1] + 8 * stored[3] - stored[4]) / (12 * 0.05)
    assert rate == pytest.approx(third.load_energy, rel=1e-5)


@every_load
def test_a_load_that_grows_touches_and_lets_go_at_the_same_place(load):
    result = at_rest(load, (0.0, 0.5, 1.0, 0.5, 0.0))
    assert [pose.status for pose in result.poses] == ["free", "free", "contact", "free", "free"]
    touch, release = result.events
    assert (touch.kind, release.kind) == ("touch", "release")
    assert touch.parameter == pytest.approx(0.75, rel=1e-2)
    assert release.parameter == pytest.approx(touch.parameter, rel=1e-4)  # the scene's tolerance


@every_load
@pytest.mark.parametrize("theory", ["bending", "shear", "stretch"])
def test_generalised_forces_have_the_derivatives_that_they_give(load, theory):
    finger = dataclasses.replace(TAPER, base=gr.Base(rotational_stiffness=3.0)).at(angle=0.3 * Q)
    motion = gr.Motion("q", (0.0, 1.0))
    fixed = setting(gr.Scene(finger=finger, object=FAR, loads=(load,), motion=motion), theory)
    beam = fixed.beam((), 3)
    z = 0.3 * np.random.default_rng(1).standard_normal(beam.size) / np.sqrt(beam.size)

    def push(z, q=1.0, pace=0.0):
        return Acting(fixed.loads, Stage(q, 0.3 * q, pace, 0.3 * pace)).push(Axis.of(beam, z))

    here, step = push(z, 1.0, 1.0), 1e-5
    ways = step * np.eye(beam.size)
    slopes = np.column_stack([(push(z + way).force - push(z - way).force) / (2 * step) for way in ways])
    assert here.slopes == pytest.approx(slopes, abs=1e-7 * np.abs(slopes).max())
    rates = (push(z, 1.0 + step).force - push(z, 1.0 - step).force) / (2 * step)
    assert here.rates == pytest.approx(rates, abs=1e-7 * np.abs(rates).max())
    if here.conservative:
        gradient = [(push(z + way).potential - push(z - way).potential) / (2 * step) for way in ways]
        assert -here.force == pytest.approx(gradient, abs=1e-7 * np.abs(here.force).max())
    assert here.conservative == np.allclose(here.slopes, here.slopes.T, atol=1e-9 * np.abs(slopes).max())


def test_a_channel_of_many_guides_bends_by_tension_times_offset():
    off = []
    for count in (2, 4):
        guides = tuple((i + 1) / count for i in range(count))
        off.append(alone(Tendon(tension=0.5, offset=0.04, guides=guides)).tip_rotation / 0.02 - 1)
    assert off[0] == pytest.approx(4 * off[1], rel=0.05)  # the guides' own error falls with the square of their number
    assert abs(off[1]) < 5e-3


def test_a_load_of_nothing_changes_nothing():
    target = Circle(radius=0.02).at(x=0.13, y=-0.02)
    none, some = (
        gr.solve(gr.Scene(finger=TAPER, object=target, theory="stretch", loads=acting)).poses[0]
        for acting in ((), (Force(force=(0, 0)), Moment(moment=0)))
    )
    assert some.force_on_object == pytest.approx(none.force_on_object, rel=1e-8)
    assert (some.energy, some.max_strain) == pytest.approx((none.energy, none.max_strain), rel=1e-9)
    assert none.loads == () and "loads" not in none.to_dict() and "load_energy" not in none.to_dict()


def test_the_world_s_axes_stay_when_the_clamp_turns():
    turn = 0.7
    force = complex(0.4, -1.5)
    turned = force * complex(math.cos(turn), -math.sin(turn))
    world = alone(Force(force=(force.real, force.imag)), finger=UNIT.at(angle=turn))
    own = alone(Force(force=(turned.real, turned.imag), frame="finger"))
    assert world.tip_rotation == pytest.approx(own.tip_rotation, rel=1e-10)
    assert world.loads[0].force == pytest.approx((force.real, force.imag), rel=1e-10)
    assert complex(*world.tip) == pytest.approx(complex(*own.tip) * complex(math.cos(turn), math.sin(turn)), rel=1e-10)


def test_a_finger_turned_in_its_weight_sags_as_at_rest():
    finger = TAPER.at(angle=Q)
    weight = Gravity(density=1e4)
    target = Circle(radius=0.02).at(x=3.0)
    motion = gr.Motion.between("q", -1.0, 1.0, 5)
    moved = gr.trace(gr.Scene(finger=finger, object=target, theory="shear", loads=(weight,), motion=motion))
    for pose in moved.poses:
        still = gr.Scene(finger=TAPER.at(angle=pose.parameter), object=target, theory="shear", loads=(weight,))
        assert pose.tip == pytest.approx(gr.solve(still).poses[0].tip, rel=1e-9)


@pytest.mark.parametrize("base", [None, gr.Base(rotational_stiffness=8.0)], ids=["clamped", "base"])
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_work_put_in_is_stored_or_lost(mu, base):
    acting = Gravity(density=2e4), Force(force=(0.5, -1.0), s=0.1)
    finger, target = dataclasses.replace(TAPER, base=base), Circle(radius=0.02).at(x=0.13, y=Q)
    motion = gr.Motion("q", (-0.2, -0.035, -0.02))
    friction = gr.Friction(coefficient=mu) if mu else None
    scene = gr.Scene(finger=finger, object=target, theory="bending", loads=acting, motion=motion, friction=friction)
    result = gr.trace(scene)
    first, *_, last = result.poses
    stored = last.energy + last.load_energy - first.energy - first.load_energy
    summary = result.summary()
    assert last.status == "contact" and stored > 0
    assert summary.work_in - summary.work_out - summary.dissipation == pytest.approx(stored, rel=1e-4)
    assert (summary.dissipation > 1e-3 * stored) == (mu > 0)


def test_the_base_turns_by_its_moment_over_its_stiffness():
    target = Circle(radius=0.02).at(x=0.13, y=-0.02)
    stiff, soft = (
        gr.solve(gr.Scene(finger=dataclasses.replace(TAPER, base=base), object=target, theory="shear"))
        for base in (None, gr.Base(rotational_stiffness=3.0))
    )
    angle = math.atan2(*(soft.pose.shape.upper[0] - soft.pose.shape.lower[0])[::-1]) - math.pi / 2
    assert angle == pytest.approx(soft.clamp_moment / 3.0, rel=1e-6)
    assert np.hypot(*soft.force_on_object) < np.hypot(*stiff.force_on_object)
    rigid = dataclasses.replace(TAPER, base=gr.Base(rotational_stiffness=1e9))
    same = gr.solve(gr.Scene(finger=rigid, object=target, theory="shear"))
    assert same.force_on_object == pytest.approx(stiff.force_on_object, rel=1e-6)


def test_scenes_with_loads_and_a_base_survive_their_file():
    finger = dataclasses.replace(TAPER, base=gr.Base(rotational_stiffness=3.0))
    scene = gr.Scene(finger=finger, object=FAR, loads=tuple(EACH.values()), motion=gr.Motion("q", (0.0, 1.0)))
    back = loads(dumps(scene))
    assert dumps(loads(dumps(back))) == dumps(back)
    assert back.finger.body.base == finger.base
    assert [type(load) for load in back.loads] == [type(load) for load in scene.loads]
    for was, now in itertools.zip_longest(scene.loads, back.loads):
        for field in dataclasses.fields(was):
            pair = [getattr(load, field.name) for load in (was, now)]
            assert pair[0] == pair[1] or sympy.sympify(pair[0] != pair[1])


def test_what_does_not_go_together_is_refused():
    rough = gr.Friction(coefficient=0.2)
    scene = gr.Scene(finger=UNIT, object=FAR, motion=gr.Motion("q", (0.0, 1.0)), friction=rough)
    for load in (FollowingForce(force=(0, 1)), Force(force=(0, Q))):
        with pytest.raises(ValueError, match="loads must have a potential that stays as it is along the motion"):
            gr.trace(dataclasses.replace(scene, loads=(load,)))
    with pytest.raises(ValueError, match=r"s must lie above 0 and up to the finger's length 1\.0, in m; got 1\.5"):
        alone(Force(force=(0, 1), s=1.5))
    with pytest.raises(ValueError, match=r"loads must depend on no symbol \(no motion\); got 'q'"):
        alone(Force(force=(0, Q)))
    with pytest.raises(ValueError, match=r"loads must be instances of gripper\.loads\.Load; got 3"):
        gr.Scene(finger=UNIT, object=FAR, loads=(3,))


@pytest.mark.parametrize("law", ["neo_hookean", "secant"])
def test_a_law_of_its_own_goes_with_loads_and_a_base(law):
    table = ((0.1, 4.6e5), (0.2, 8.6e5), (0.4, 14e5)) if law == "secant" else None
    material = dataclasses.replace(RUBBER, law=law, table=table)
    finger = dataclasses.replace(TAPER, material=material, base=gr.Base(rotational_stiffness=8.0))
    acting = Force(force=(-Q, -4 * Q)), Gravity(density=1150.0, acceleration=(0.0, -9.81 * Q))
    values = (0.0, 0.9, 0.95, 1.0, 1.05, 1.1)
    target = Circle(radius=0.02).at(x=0.13, y=-0.055)
    motion = gr.Motion("q", values)
    result = gr.trace(gr.Scene(finger=finger, object=target, theory="shear", loads=acting, motion=motion))
    *_, first, second, third, fourth, last = result.poses
    assert {pose.status for pose in (first, last)} == {"contact"}
    stored = [pose.energy + pose.load_energy for pose in (first, second, third, fourth, last)]
    rate = (stored[0] - 8 * stored[1] + 8 * stored[3] - stored[4]) / (12 * 0.05)
    assert rate == pytest.approx(third.load_energy, rel=1e-5)


def test_a_drawing_shows_what_loads_the_finger():
    acting = Force(force=(0, -1), s=0.6), Moment(moment=-0.5), Gravity(mass_per_length=0.01), Moment(moment=0)
    result = gr.solve(
        gr.Scene(finger=UNIT, object=Circle(radius=0.1).at(x=0.8, y=-1.0), theory="bending", loads=acting)
    )
    figure = result.plot()
    arrows = [patch for patch in figure.axes[0].patches if isinstance(patch, FancyArrowPatch)]
    assert len(arrows) == 3  # none for a moment of 0
    assert "load (not to scale)" in [text.get_text() for text in figure.findobj(Text)]
    bare = gr.solve(gr.Scene(finger=UNIT, object=FAR, theory="bending")).plot()
    assert not [patch for patch in bare.axes[0].patches if isinstance(patch, FancyArrowPatch)]


def test_the_summary_knows_the_strain_of_a_finger_that_nothing_touches():
    motion = gr.Motion("q", (0.0, 1.0, 0.5))
    moved = gr.trace(gr.Scene(finger=UNIT, object=FAR, theory="bending", loads=(Moment(moment=Q),), motion=motion))
    assert moved.summary().strain == pytest.approx(W / 2, rel=1e-9)
    still = gr.solve(gr.Scene(finger=UNIT, object=FAR, theory="bending", loads=(Moment(moment=1.0),)))
    assert still.summary().strain == pytest.approx(W / 2, rel=1e-9)


def test_what_does_not_know_loads_or_a_base_refuses_them():
    soft = dataclasses.replace(UNIT, base=gr.Base(rotational_stiffness=3.0))
    for words, finger, acting in (("loads", UNIT, (Force(force=(0, 1)),)), ("base", soft, ())):
        scene = gr.Scene(finger=finger, object=FAR, theory="shear", loads=acting)
        with pytest.raises(ValueError, match=f"{words} must be left out to be verified"):
            verify(scene)
