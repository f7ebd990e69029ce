"""The outline: where its points are, exact derivatives, which pieces and corners there are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gripper.beam.axis import Axis
from gripper.beam.sections import sections
from gripper.beam.strains import Beam
from gripper.contact.outline import LOWER, UPPER, Outline
from gripper.contact.stations import stations
from gripper_plugins.jaws.polygon import PolygonJaw
from gripper_plugins.jaws.triangle import Triangle
from tests.scenes import STRAIGHT, TAPERED, unit_finger

BLOCK = PolygonJaw(vertices=((-0.01, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.01, 0.1)))
BLADE = Triangle(length=0.2, lead_angle=0.4, return_angle=1.2, side="upper")
FINGERS = {
    "tapered": TAPERED,
    "hook": STRAIGHT,
    "blade above": unit_finger(jaw=BLADE),
    "block over the end": unit_finger(jaw=BLOCK),
    "block, clockwise": unit_finger(jaw=replace(BLOCK, vertices=BLOCK.vertices[::-1])),
}
OUTLINES = {name: Outline(sections(finger)) for name, finger in FINGERS.items()}
outlines = st.sampled_from(list(OUTLINES.values()))
seeds = st.integers(0, 2**32 - 1)
H = 1e-6


def beam_of(outline: Outline, theory: str = "shear") -> Beam:
    return Beam(outline.sections, (0.0, 0.6, 1.0), 4, theory)


def somewhere(outline: Outline, seed: int) -> tuple[Beam, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A beam, its unknowns, and one place on every piece and corner of the outline, away from breaks."""
    random = np.random.default_rng(seed)
    beam = beam_of(outline, ("bending", "shear", "stretch")[seed % 3])
    modes = np.tile(np.arange(beam.modes), beam.segments * beam.fields)
    z = random.normal(size=beam.size) / 4.0 ** (modes + 1)  # as smooth as a finger: the axis is then its own integral
    lengths = [piece.length for piece in outline.pieces] + [0.0] * len(outline.corners)
    u = random.uniform(0.1, 0.9, len(lengths)) * lengths
    piece = np.arange(len(lengths))
    segment = np.where(piece <= UPPER, beam.segment_of(u), beam.segments - 1)
    return beam, z, piece, u, segment


@given(outline=outlines, seed=seeds)
@settings(deadline=None)
def test_every_point_belongs_to_its_section_which_turns_by_psi(outline: Outline, seed: int) -> None:
    beam, z, piece, u, segment = somewhere(outline, seed)
    axis = Axis.of(beam, z)
    points, _, kappa = outline.trace(axis, piece, u, segment)
    s = np.where(piece <= UPPER, u, 1.0)
    position, psi, _, curvature = axis.values(s, segment)
    local = (points - position) * np.exp(-1j * psi)
    half = outline.sections.thickness(s) / 2
    assert local[LOWER] == pytest.approx(-1j * half[LOWER])
    assert local[UPPER] == pytest.approx(1j * half[UPPER])
    rigid = piece > UPPER
    assert kappa == pytest.approx(np.where(rigid, 0, curvature))
    straight = outline.trace(Axis.of(beam, 0 * z), piece, u, segment)[0]
    assert local[rigid] == pytest.approx(straight[rigid] - 1)  # moved rigidly with the end section


@given(outline=outlines, seed=seeds)
@settings(deadline=None)
def test_stations_are_the_trace_and_its_exact_derivatives_along_the_piece(outline: Outline, seed: int) -> None:
    beam, z, piece, u, segment = somewhere(outline, seed)
    axis = Axis.of(beam, z)
    found = stations(outline, axis, piece, u, segment)
    points, tangents, _ = outline.trace(axis, piece, u, segment)
    assert found.points == pytest.approx(points, abs=1e-13)
    assert found.tangents == pytest.approx(tangents, abs=1e-13)
    up, down = (outline.trace(axis, piece, u + h, segment) for h in (H, -H))
    assert found.tangents == pytest.approx((up[0] - down[0]) / (2 * H), abs=2e-8)
    assert found.curvatures == pytest.approx((up[1] - down[1]) / (2 * H), abs=2e-6)


@given(outline=outlines, seed=seeds)
@settings(deadline=None)
def test_points_and_tangents_have_exact_gradients_in_the_unknowns(outline: Outline, seed: int) -> None:
    beam, z, piece, u, segment = somewhere(outline, seed)
    direction = np.random.default_rng(seed).normal(size=z.size)
    direction /= np.linalg.norm(direction)
    found = stations(outline, Axis.of(beam, z), piece, u, segment)
    up, down = (outline.trace(Axis.of(beam, z + h * direction), piece, u, segment) for h in (H, -H))
    assert found.gradients @ direction == pytest.approx((up[0] - down[0]) / (2 * H), abs=1e-8)
    assert found.tangent_gradients @ direction == pytest.approx((up[1] - down[1]) / (2 * H), abs=1e-7)


@given(outline=outlines, seed=seeds)
@settings(deadline=None)
def test_the_second_derivative_in_the_unknowns_is_exact(outline: Outline, seed: int) -> None:
    beam, z, piece, u, segment = somewhere(outline, seed)
    random = np.random.default_rng(seed)
    forces = random.normal(size=len(u)) + 1j * random.normal(size=len(u))
    direction = random.normal(size=z.size) / np.sqrt(z.size)

    def pull(z: np.ndarray) -> np.ndarray:
        return (forces.conj() @ stations(outline, Axis.of(beam, z), piece, u, segment).gradients).real

    axis = Axis.of(beam, z)
    hessian = stations(outline, axis, piece, u, segment).second_derivative(axis, forces)
    assert hessian == pytest.approx(hessian.T, abs=1e-13)
    change = (pull(z + H * direction) - pull(z - H * direction)) / (2 * H)
    assert hessian @ direction == pytest.approx(change, abs=1e-7)


@pytest.mark.parametrize(
    ("name", "pieces", "corners"),
    [
        ("tapered", {"lower": 1, "upper": 1, "tip": 1}, {"tip": 2}),
        ("hook", {"lower": 1, "upper": 1, "tip": 1, "jaw": 3}, {"tip": 1, "jaw": 3}),
        ("blade above", {"lower": 1, "upper": 1, "tip": 1, "jaw": 3}, {"tip": 1, "jaw": 3}),
        ("block over the end", {"lower": 1, "upper": 1, "jaw": 4}, {"jaw": 4}),
    ],
)
def test_what_lies_within_the_jaw_is_no_part_of_the_outline(name: str, pieces: dict, corners: dict) -> None:
    outline = OUTLINES[name]
    found = [piece.on for piece in outline.pieces]
    assert {on: found.count(on) for on in found} == pieces
    found = [corner.on for corner in outline.corners]
    assert {on: found.count(on) for on in found} == corners


def test_the_free_corner_of_a_finger_with_a_hook_below_is_the_upper_one() -> None:
    hook, blade = OUTLINES["hook"], OUTLINES["blade above"]
    assert hook.tip_corner(LOWER) is None and hook.tip_corner(UPPER) is not None
    assert blade.tip_corner(UPPER) is None and blade.tip_corner(LOWER) is not None
    (corner,) = (corner for corner in hook.corners if corner.on == "tip")
    assert corner.point == pytest.approx(0.5j * 0.0032 / 0.057)


def test_the_sense_of_the_jaw_s_vertices_changes_its_arc_length_and_nothing_else() -> None:
    one, other = OUTLINES["block over the end"], OUTLINES["block, clockwise"]
    beam, z, *_ = somewhere(one, 5)
    for finger, outline in ((FINGERS["block over the end"], one), (FINGERS["block, clockwise"], other)):
        vertices = np.array([complex(x, y) for x, y in finger.jaw.vertices])
        before = np.concatenate([[0], np.cumsum(np.abs(np.diff(vertices)))])
        axis = Axis.of(beam, 0 * z)
        places = {}
        for number, piece in enumerate(outline.pieces):
            if piece.on == "jaw":
                at, half = np.array([number]), np.array([piece.length / 2])
                point = outline.trace(axis, at, half, np.array([beam.segments - 1]))[0][0]
                places[float(outline.place(number, half)[1][0])] = point - 1
        ends = np.append(vertices, vertices[:1])
        for i, start in enumerate(before):
            middle = start + abs(ends[i + 1] - ends[i]) / 2
            nearest = min(places, key=lambda place: abs(place - middle))
            assert nearest == pytest.approx(middle)
            assert places[nearest] == pytest.approx((ends[i] + ends[i + 1]) / 2)


def test_a_place_on_the_end_face_is_named_s_equal_to_the_length() -> None:
    outline = OUTLINES["tapered"]
    assert outline.place(2, np.array([0.01, 0.02])) == ("tip", pytest.approx(np.ones(2)))
    assert outline.place(outline.corner_piece(0), np.zeros(1)) == ("tip", pytest.approx(np.ones(1)))
    assert outline.place(LOWER, np.array([0.3])) == ("lower", pytest.approx([0.3]))


def test_the_hook_is_the_triangle_of_the_scene_file_s_contract() -> None:
    w, length, lead, back = 0.0032, 0.019, math.radians(20), math.radians(60)
    h = length / (1 / math.tan(lead) + 1 / math.tan(back))
    corners = np.array([-0.5j * w, h / math.tan(back) - 1j * (w / 2 + h), length - 0.5j * w]) / 0.057
    assert sorted(OUTLINES["hook"].jaw, key=lambda p: p.real) == pytest.approx(sorted(corners, key=lambda p: p.real))
