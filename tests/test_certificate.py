"""The survey of the whole outline: no penetration hides from it, and its bounds hold."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import gripper as gr
from gripper.assemble import setting
from gripper.beam.axis import Axis
from gripper.beam.strains import Beam
from gripper.contact.obstacle import Frame, Obstacle
from gripper.statics.certificate import Survey, survey
from gripper.statics.equilibrium import Setting, State
from gripper.statics.sampling import DEPTH
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.implicit import Implicit
from gripper_plugins.objects.polygon import Polygon
from gripper_plugins.objects.spline import Spline
from tests.scenes import TAPERED, deepest_within, unit_finger
from tests.test_outline import BLADE, BLOCK

BODIES = {
    "circle": Circle(radius=0.1),
    "ellipse": Ellipse(semi_axes=(0.2, 0.06)),
    "superellipse": Implicit(expression="(x/0.12)**4 + (y/0.08)**4 - 1", extent=0.3),
    "polygon": Polygon(vertices=((-0.1, -0.1), (0.12, -0.07), (0.02, 0.11))),
    "needle": Polygon(vertices=((-0.0005, -0.3), (0.0005, -0.3), (0.0, 0.1))),
    "spline": Spline(points=((0.1, 0.0), (0.0, 0.07), (-0.1, 0.0), (0.0, -0.1))),
}
FINGERS = {"plain": unit_finger(), "tapered": TAPERED, "blade": unit_finger(jaw=BLADE), "block": unit_finger(jaw=BLOCK)}
seeds = st.integers(0, 2**32 - 1)
CHORDS = 5e-7  # of L: what two polygons lie off the curves that they are drawn of


@cache
def fixed(finger: str, body: str, theory: str = "shear") -> Setting:
    return setting(gr.Scene(finger=FINGERS[finger], object=BODIES[body], theory=theory))


def deflected(finger: str, body: str, seed: int, size: float = 1.0) -> tuple[Setting, State]:
    found, random = fixed(finger, body), np.random.default_rng(seed)
    beam = Beam(found.sections, (0.0, 0.45, 1.0), 4, ("shear", "stretch")[seed % 2])
    modes = np.tile(np.arange(beam.modes), beam.segments * beam.fields)
    return found, State(beam, size * random.normal(size=beam.size) / 3.0 ** (modes + 1))


def rings(found: Setting, state: State) -> list[np.ndarray]:
    """Finger and jaw as closed rings of points, x + iy by L."""
    axis, u = Axis.of(state.beam, state.z), np.linspace(0, 1, 1501)
    segment = state.beam.segment_of(u + 1e-12 * np.sign(0.5 - u))
    lower, upper = (found.outline.trace(axis, np.full(u.size, face), u, segment)[0] for face in (0, 1))
    out = [np.concatenate([lower, upper[::-1]])]
    if found.outline.jaw is not None:
        end, psi, *_ = axis.values(np.ones(1), np.array([state.beam.segments - 1]))
        out.append(end + found.outline.jaw * np.exp(1j * psi))
    return out


def drawn(found: Setting, obstacle: Obstacle) -> np.ndarray:
    """The ring that the object draws of itself, x + iy by L."""
    (line,) = found.body.outline(tolerance=1e-7 * found.sections.length)
    return obstacle.place(line[:-1, 0] + 1j * line[:-1, 1])


def polygon(ring: np.ndarray) -> shapely.Polygon:
    return shapely.Polygon(np.column_stack([ring.real, ring.imag]))


def grazing(found: Setting, state: State, random: np.random.Generator) -> tuple[Obstacle, complex]:
    """The object where it just leaves the finger along a random direction, and that direction."""
    bodies = shapely.union_all([polygon(ring).buffer(0) for ring in rings(found, state)])
    place = random.uniform(0.2, 1.1) - 0.5j * random.uniform(-0.2, 0.2)
    away = np.exp(1j * random.uniform(0, 2 * np.pi))
    frame = Frame(place, random.uniform(-np.pi, np.pi), 0j, 0.0)
    target = polygon(drawn(found, found.obstacle(frame)))
    shapely.prepare(bodies)
    low, high = 0.0, 3.0
    for _ in range(40):
        middle = (low + high) / 2
        moved = shapely.affinity.translate(target, (middle * away).real, (middle * away).imag)
        low, high = (middle, high) if bodies.intersects(moved) else (low, middle)
    return found.obstacle(replace(frame, origin=place + high * away)), away


fingers, bodies = st.sampled_from(list(FINGERS)), st.sampled_from(list(BODIES))


@given(finger=fingers, body=bodies, seed=seeds, size=st.floats(-8, -1))
@settings(deadline=None, max_examples=60)
def test_no_penetration_hides_in_an_outline_that_is_called_clear(
    finger: str, body: str, seed: int, size: float
) -> None:
    found, state = deflected(finger, body, seed)
    obstacle, away = grazing(found, state, np.random.default_rng(seed))
    inside = found.obstacle(replace(obstacle.frame, origin=obstacle.frame.origin - 10**size * away))
    report, ring = survey(found, inside, state), drawn(found, inside)
    deepest = max(deepest_within(body, ring, closed=i > 0) for i, body in enumerate(rings(found, state)))
    if report.clear:
        assert deepest <= report.penetration_bound + CHORDS
    if deepest > DEPTH + CHORDS:
        assert report.deepest and report.min_gap < -DEPTH


@given(finger=fingers, body=bodies, seed=seeds, size=st.floats(-4, -1))
@settings(deadline=None, max_examples=60)
def test_a_finger_that_is_clear_by_little_is_called_clear(finger: str, body: str, seed: int, size: float) -> None:
    """No false alarm: refinement ends where nothing overlaps."""
    found, state = deflected(finger, body, seed)
    obstacle, away = grazing(found, state, np.random.default_rng(seed))
    outside = found.obstacle(replace(obstacle.frame, origin=obstacle.frame.origin + 10**size * away))
    ring = polygon(drawn(found, outside))
    if min(ring.distance(polygon(body).buffer(0)) for body in rings(found, state)) > 1e-5:
        report = survey(found, outside, state)
        assert report.clear and report.penetration_bound <= DEPTH


@pytest.mark.parametrize("body", ["circle", "ellipse", "superellipse", "polygon", "needle", "spline"])
def test_what_is_known_of_the_plugins_surfaces_is_proved(body: str) -> None:
    found, state = deflected("blade", body, 3)
    report = survey(found, grazing(found, state, np.random.default_rng(0))[0], state)
    assert report.proved


def test_a_surface_without_enclosures_is_said_to_be_sampled() -> None:
    body = Implicit(expression="sqrt(x**2 + y**2) - 0.1*(1 + 0.2*cos(3*atan2(y, x)))", extent=0.3)
    scene = gr.Scene(finger=unit_finger(), object=body)
    found = setting(scene)
    state = State(beam := found.beam((), 3), np.zeros(beam.size))
    report = survey(found, found.obstacle(Frame(0.5 - 0.2j, 0.3, 0j, 0.0)), state)
    assert report.proved is (body.bounds(np.array([[0.1, 0.1]]), np.array([0.01])) is not None)


def straight(finger: str, body: str, origin: complex, angle: float = 0.0) -> Survey:
    found = fixed(finger, body)
    beam = found.beam((), 3)
    return survey(found, found.obstacle(Frame(origin, angle, 0j, 0.0)), State(beam, np.zeros(beam.size)))


@pytest.mark.parametrize("place", [0.05, 0.3137, 0.7719, 0.999])
@pytest.mark.parametrize("face", [-1, 1])
def test_a_needle_that_fits_between_all_samples_is_found(place: float, face: int) -> None:
    """Its tip is 1e-3 wide and sinks 1e-3 into the face."""
    tip = complex(place, face * (0.03 - 1e-3))
    report = straight("plain", "needle", tip - 0.1j * np.exp(0.5j * np.pi * (1 + face)), 0.5 * np.pi * (1 + face))
    assert not report.clear


@pytest.mark.parametrize(
    ("finger", "origin", "on"),
    [
        ("plain", 1.0999 + 0j, "tip"),
        ("plain", 0.5 - 0.1299j, "lower"),
        ("plain", 0.5 + 0.1299j, "upper"),
        ("block", 1.2999 + 0j, "jaw"),
        ("block", 1.1 - 0.1999j, "jaw"),
        ("blade", 1.25 + 0.03j, "jaw"),
    ],
)
def test_every_part_of_the_outline_is_surveyed(finger: str, origin: complex, on: str) -> None:
    report = straight(finger, "circle", origin)
    assert not report.clear
    pieces = {fixed(finger, "circle").outline.pieces[piece].on for piece, _ in report.deepest}
    assert on in pieces


def test_an_object_within_the_finger_is_engulfed_though_the_outline_is_clear() -> None:
    small = Circle(radius=0.01)
    found = setting(gr.Scene(finger=unit_finger(), object=small))
    state = State(beam := found.beam((), 3), np.zeros(beam.size))
    report = survey(found, found.obstacle(Frame(0.5 + 0j, 0.0, 0j, 0.0)), state)
    assert report.penetration_bound == 0 and report.min_gap > 0
    assert report.engulfed and not report.clear


@pytest.mark.parametrize("place", [0.05, 0.3, 0.9, 0.95, 0.98])
def test_a_small_object_is_engulfed_wherever_in_the_finger_it_is(place: float) -> None:
    fixed = setting(gr.Scene(finger=unit_finger(0.12), object=Circle(radius=0.006)))
    beam = fixed.beam((), 4)
    report = survey(fixed, fixed.obstacle(Frame(complex(place, 0.0), 0.0, 0j, 0.0)), State(beam, np.zeros(beam.size)))
    assert report.engulfed and not report.clear


@pytest.mark.parametrize("place", [0.2, 0.93, 0.957, 0.99])
def test_the_clearance_of_a_small_object_is_its_distance(place: float) -> None:
    """Between two samples of the lower face, and nearer to one of the end face."""
    for away in (0.002, 0.006, 0.03):
        pose = gr.solve(gr.Scene(finger=unit_finger(0.12), object=Circle(radius=0.006).at(x=place, y=-0.066 - away)))
        assert pose.poses[0].min_gap == pytest.approx(away, abs=1e-9)


def test_an_object_within_the_jaw_is_engulfed_too() -> None:
    small = Circle(radius=0.01)
    found = setting(gr.Scene(finger=unit_finger(jaw=BLOCK), object=small))
    state = State(beam := found.beam((), 3), np.zeros(beam.size))
    report = survey(found, found.obstacle(Frame(1.1 + 0.05j, 0.0, 0j, 0.0)), state)
    assert report.engulfed and not report.clear


def test_a_clear_finger_knows_its_least_gap() -> None:
    report = straight("plain", "circle", 0.5 - 0.18j)
    assert report.clear and report.proved
    assert report.min_gap == pytest.approx(0.05, rel=0.3)  # g / |grad g| at samples, not yet the distance
