"""The heart: whatever the finger, the object and the way, an answer is proved right or failed with its reason."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import gripper as gr
from gripper.beam.axis import Axis
from gripper.contact.outline import UPPER
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.polygon import PolygonJaw
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.conic import Conic
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.implicit import Implicit
from gripper_plugins.objects.polygon import Polygon
from gripper_plugins.objects.spline import Spline
from tests.scenes import Q, Solved, deepest_cut, follow, still

NUMBERS = (
    "force_on_object",
    "motion_force",
    "moment_on_object",
    "clamp_moment",
    "energy",
    "tip",
    "max_strain",
    "min_gap",
)
SUITE = {
    "deadline": None,
    "derandomize": True,
    "suppress_health_check": [HealthCheck.too_slow, HealthCheck.filter_too_much],
}


def between(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers with few digits, evenly spread, so that a failing scene can be copied."""
    return st.integers(0, 1000).map(lambda i: round(low + (high - low) * i / 1000, 4))


materials = st.builds(gr.Material, youngs_modulus=st.just(1e6), poisson_ratio=between(0.2, 0.45))
jaws = st.one_of(
    st.none(),
    st.builds(
        Triangle,
        length=between(0.05, 0.4),
        lead_angle=between(0.3, 1.2),
        return_angle=between(0.5, 1.6),
        side=st.sampled_from(["lower", "upper"]),
    ),
    st.builds(
        lambda a, b: PolygonJaw(vertices=((-0.01, -b), (a, -b), (a, b), (-0.01, b))),
        between(0.05, 0.3),
        between(0.06, 0.2),
    ),
)


def fingers(jaws: st.SearchStrategy) -> st.SearchStrategy[gr.Finger]:
    """Thin to thick, L = 1."""
    common = {"length": st.just(1.0), "width": st.just(0.1), "material": materials, "jaw": jaws}
    return st.one_of(
        st.builds(Uniform, thickness=between(0.01, 0.2), **common),
        st.builds(Tapered, base_thickness=between(0.04, 0.2), tip_thickness=between(0.02, 0.15), **common),
    )


def star(radii: list[float], turn: float) -> tuple[tuple[float, float], ...]:
    """Points about the origin at equal angles."""
    angles = turn + 2 * np.pi * np.arange(len(radii)) / len(radii)
    return tuple((round(r * math.cos(a), 4), round(r * math.sin(a), 4)) for r, a in zip(radii, angles, strict=True))


sizes = between(0.05, 0.5)
ROUND = {
    "circle": st.builds(Circle, radius=sizes),
    "ellipse": st.builds(Ellipse, semi_axes=st.tuples(sizes, sizes)),
    "conic": st.builds(
        lambda a, b, c, r: Conic(coefficients=(a, b, c, 0.0, 0.0, -r * r)),
        between(0.5, 2), between(0.5, 2), between(-0.9, 0.9), sizes,
    ),
    "spline": st.builds(
        lambda radii, turn: Spline(points=star(radii, turn)),
        st.lists(between(0.15, 0.25), min_size=4, max_size=7),
        between(0, 6),
    ),
    "implicit": st.builds(
        lambda p, a, b: Implicit(expression=f"(x/{a})**{p} + (y/{b})**{p} - 1", extent=1.3 * max(a, b)),
        st.sampled_from([2, 4]), between(0.1, 0.4), between(0.1, 0.4),
    ),
}  # fmt: skip
POLYGONS = {
    "convex polygon": st.builds(
        lambda n, r, turn: Polygon(vertices=star([r] * n, turn)), st.integers(3, 7), sizes, between(0, 6)
    ),
    "polygon": st.builds(
        lambda radii, turn: Polygon(vertices=star(radii, turn)),
        st.lists(between(0.1, 0.3), min_size=3, max_size=6),
        between(0, 6),
    ),
}  # fmt: skip
PARABOLA = {"parabola": st.builds(lambda a: Conic(coefficients=(a, 0.0, 0.0, 0.0, 1.0, 0.0)), between(0.5, 8))}
EVERY = {**ROUND, **POLYGONS, **PARABOLA}


def highest(body: gr.Object, angle: float) -> complex:
    """The highest point of an object that is turned by an angle, in its own axes turned."""
    line = max(body.outline((-1.0, -1.0, 1.0, 1.0)), key=len)
    points = (line[:, 0] + 1j * line[:, 1]) * np.exp(1j * angle)
    return complex(points[np.argmax(points.imag)])


@st.composite
def scenes(draw: st.DrawFn, bodies: st.SearchStrategy, jaws: st.SearchStrategy, at: tuple, deep: tuple) -> gr.Scene:
    """The object's highest point ends ``deep`` above the straight lower face, at a place ``at`` of the finger."""
    finger, body = draw(fingers(jaws)), draw(bodies)
    unbounded = isinstance(body, Conic) and body.coefficients[1] == 0
    angle = draw(between(-0.3, 0.3) if unbounded else between(-3.14, 3.14))
    top = highest(body, angle)
    w = finger.thickness if isinstance(finger, Uniform) else finger.base_thickness
    x, y = round(draw(between(*at)) - top.real, 4), round(draw(between(*deep)) - w / 2 - top.imag, 4)
    return gr.Scene(
        finger=finger,
        object=body.at(x=x, y=y, angle=angle),
        theory=draw(st.sampled_from(["bending", "shear", "stretch"])),
    )


@st.composite
def motions(draw: st.DrawFn, bodies: st.SearchStrategy, poses: int = 5) -> gr.Scene:
    """From well below to some way into the finger, drifting and turning."""
    scene = draw(scenes(bodies, jaws, (0.2, 1.1), (-0.05, 0.4)))
    pose = scene.object.pose
    drift, turn = draw(between(-0.5, 0.5)), draw(between(-0.5, 0.5))
    body = scene.object.body.at(x=pose.x + drift * Q, y=pose.y + Q, angle=pose.angle + turn * Q)
    return replace(scene, object=body, motion=gr.Motion("q", tuple(np.linspace(-1.2, 0, poses).tolist())))


def assert_right(scene: gr.Scene, solved: Solved) -> None:
    """Everything that a pose with numbers must satisfy, from its own geometry and forces."""
    result = solved.result
    if result.status == "failed":
        assert result.reason
        assert all(getattr(result, name) is None for name in NUMBERS) and not result.contacts
        return
    assert result.status in ("free", "contact") and result.reason is None
    assert result.checks.penetration_bound <= 1e-6 * solved.length
    assert result.min_gap >= -1e-6 * solved.length
    assert deepest_cut(scene, solved) <= 1e-6
    assert result.checks.stability > 0
    assert result.energy >= 0
    assert result.error.discretisation <= scene.tolerance
    assert_forces(solved)
    if result.status == "contact":
        assert_along_normals(solved)
        assert_balanced(solved)


def assert_forces(solved: Solved) -> None:
    """The sum over the contacts is the force; nothing pulls; free means none."""
    result = solved.result
    total = sum((c.normal_force * complex(*c.normal) for c in result.contacts), 0j)
    size = sum(c.normal_force for c in result.contacts)
    assert all(contact.normal_force > 0 for contact in result.contacts)
    assert abs(total + complex(*result.force_on_object)) <= 1e-9 * size
    if result.status == "free":
        assert result.contacts == () and result.energy == pytest.approx(0, abs=1e-12)
    else:
        assert result.contacts and result.energy > 0


def assert_along_normals(solved: Solved) -> None:
    """Each force along grad g, out of the object; at its corner along the face's normal, within the corner's cone."""
    equilibrium, linear = solved.equilibrium, solved.equilibrium.linear
    places = zip(equilibrium.state.sites, linear.stations, linear.points, linear.forces, strict=True)
    for site, u, points, forces in places:
        if site.kind == "vertex":
            assert_in_cone(solved, site.piece, float(u[0]), complex(forces[0]), site.vertex)
            continue
        _, normals = equilibrium.obstacle.slope(points)
        loaded = np.abs(forces) > 1e-9 * np.abs(forces).max()
        directions = (normals.conj() * forces / (np.abs(normals) * np.abs(forces) + 1e-300))[loaded]
        assert np.abs(directions.imag).max() < 1e-8
        assert directions.real.min() > 0


def assert_in_cone(solved: Solved, piece: int, u: float, force: complex, vertex: int) -> None:
    state, obstacle = solved.equilibrium.state, solved.equilibrium.obstacle
    axis, direction = Axis.of(state.beam, state.z), force / abs(force)
    sides = {
        int(state.beam.segment_of(np.array([u + e]))[0]) if piece <= UPPER else state.beam.segments - 1
        for e in (-1e-6, 1e-6)
    }
    trace = solved.setting.outline.trace
    tangents = [complex(trace(axis, np.array([piece]), np.array([u]), np.array([side]))[1][0]) for side in sides]
    tangent = np.mean(tangents)
    assert abs((direction.conjugate() * tangent).real) < 1e-8 * abs(tangent)
    turn = np.exp(1j * obstacle.frame.angle)
    before, after = (complex(*normal) * turn for normal in solved.setting.body.corner_normals[vertex])
    assert (before.conjugate() * direction).imag > -1e-6 and (direction.conjugate() * after).imag > -1e-6


def assert_balanced(solved: Solved) -> None:
    """EI kappa at every section carries the moment of the forces beyond it (in the mean: fields are projections)."""
    result, state, linear = solved.result, solved.equilibrium.state, solved.equilibrium.linear
    sections, beam = solved.setting.sections, state.beam
    points, forces = np.concatenate(linear.points), np.concatenate(linear.forces)
    clamp = float((points.conj() * forces).imag.sum())
    size = np.abs(forces).sum()
    assert result.clamp_moment == pytest.approx(
        clamp * sections.energy_scale, rel=1e-9, abs=1e-9 * size * sections.energy_scale
    )
    gauss, segment = beam.gauss, beam.segment_of(beam.gauss)
    position, _, _, kappa = Axis.of(beam, state.z).values(gauss, segment)
    moment = np.zeros(gauss.size)
    for site, u, at, f in zip(state.sites, linear.stations, linear.points, linear.forces, strict=True):
        beyond = (u if site.piece <= UPPER else np.full(u.size, 2.0))[None, :] > gauss[:, None]
        moment += (beyond * ((at[None, :] - position[:, None]).conj() * f).imag).sum(axis=1)
    weights = np.repeat(beam.lengths, gauss.size // beam.segments) / sections.EI(gauss)
    missing = weights @ (sections.EI(gauss) * kappa - moment) ** 2
    assert missing <= 1e-3 * (weights @ moment**2) + 1e-10 * size**2  # about the relative error of the energy
    assert result.checks.moment_balance < 1e-3 and result.checks.force_balance < 1e-3
    assert result.checks.stationarity < 1e-8


moderate = {"jaws": st.none(), "at": (0.4, 0.7), "deep": (-0.02, 0.1)}


@given(scene=scenes(st.one_of(*ROUND.values()), **moderate))
@settings(max_examples=25, **SUITE)
def test_a_smooth_object_from_below_at_mid_finger_is_always_answered_rightly(scene: gr.Scene) -> None:
    (solved,) = follow(still(scene))
    assert_right(scene, solved)
    assert clamped(scene, solved) or solved.result.status != "failed", solved.result.reason


@given(scene=scenes(st.one_of(*POLYGONS.values()), **moderate))
@settings(max_examples=15, **SUITE)
def test_a_polygon_from_below_at_mid_finger_is_always_answered_rightly(scene: gr.Scene) -> None:
    (solved,) = follow(still(scene))
    assert_right(scene, solved)
    assert clamped(scene, solved) or solved.result.status != "failed", solved.result.reason


def clamped(scene: gr.Scene, solved: Solved) -> bool:
    """Whether the object comes near to the clamped end, where no finger could bend out of its way."""
    pose, body = scene.object.pose, scene.object.body
    line = max(body.outline(), key=len)
    points = (line[:, 0] + 1j * line[:, 1]) * np.exp(1j * float(pose.angle)) + complex(pose.x, pose.y)
    half = float(solved.setting.sections.thickness(np.zeros(1))[0]) / 2
    return bool((points.imag[points.real < 0.25] > -half).any())


@given(scene=scenes(st.one_of(*EVERY.values()), jaws=jaws, at=(0.15, 1.15), deep=(-0.05, 0.3)))
@settings(max_examples=12, **SUITE)
def test_any_pose_is_answered_rightly_or_failed_with_a_reason(scene: gr.Scene) -> None:
    (solved,) = follow(still(scene))
    assert_right(scene, solved)


@given(scene=motions(st.one_of(*EVERY.values())))
@settings(max_examples=12, **SUITE)
def test_any_motion_is_answered_rightly_or_failed_with_a_reason(scene: gr.Scene) -> None:
    for solved in follow(scene):
        assert_right(scene, solved)


@given(scene=scenes(st.one_of(*EVERY.values()), **moderate))
@settings(max_examples=12, **SUITE)
def test_the_other_side_of_the_finger_is_the_mirror_image(scene: gr.Scene) -> None:
    """The object turned about the finger's axis by half a turn out of the plane: forces mirrored."""
    body, pose = scene.object.body, scene.object.pose
    match body:
        case Polygon():
            body = replace(body, vertices=tuple((x, -y) for x, y in body.vertices))
        case Spline():
            body = replace(body, points=tuple((x, -y) for x, y in body.points))
        case Conic():
            b = body.coefficients
            body = replace(body, coefficients=(b[0], b[1], -b[2], b[3], -b[4], b[5]))
    mirrored = replace(scene, object=body.at(x=pose.x, y=-pose.y, angle=-pose.angle), approach=(0.0, -1.0))
    one, other = gr.solve(scene).poses[0], gr.solve(mirrored).poses[0]
    assert one.status == other.status
    if one.status == "contact":
        force = one.force_on_object
        assert other.force_on_object == pytest.approx((force[0], -force[1]), rel=0, abs=1e-6 * math.hypot(*force))
        assert other.energy == pytest.approx(one.energy, rel=1e-6)


@given(scene=scenes(st.one_of(*ROUND.values()), **moderate), more=between(0.001, 0.05))
@settings(max_examples=12, **SUITE)
def test_pushing_further_costs_energy(scene: gr.Scene, more: float) -> None:
    """On one branch an object that comes nearer never lowers the energy: its gaps are stricter."""
    pose = scene.object.pose
    deeper = replace(scene, object=scene.object.body.at(x=pose.x, y=pose.y + more, angle=pose.angle))
    one, other = gr.solve(scene).poses[0], gr.solve(deeper).poses[0]
    if one.status == other.status == "contact" and one.contacts[0].on == other.contacts[0].on == "lower":
        assert other.energy > one.energy
