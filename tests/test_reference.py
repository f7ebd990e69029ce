"""Both examples of the paper against the independent solution (tests/reference/beam.json), and against their energy."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy

import gripper as gr
from tests.scenes import BEAM, FALLING, RISING, Q, deepest_cut, follow, micro_assembly, rotating_finger

ROTATING = BEAM["rotating_finger"]["poses"]
ASSEMBLY = BEAM["micro_assembly"]["poses"]
CASES = [
    *((start, theory, place) for theory in ("bending", "shear") for start, place in ((RISING[0], "-0.0254"),)),
    *((start, theory, place) for theory in ("bending", "shear") for start, place in ((RISING[0], "0.0508"),)),
    *((FALLING[0], theory, place) for theory in ("bending", "shear") for place in ROTATING if place != "0.05588"),
]


def poses(scene: gr.Scene) -> list[gr.PoseResult]:
    result = gr.trace(scene)
    assert not result.failed, result.failed[0].reason
    return list(result.poses)


@cache
def rotated(start: float, place: float, theory: str, tolerance: float = 1e-4) -> gr.PoseResult:
    return poses(rotating_finger(start, place, theory=theory, tolerance=tolerance))[-1]


@cache
def assembled(place: float, tolerance: float = 1e-4) -> gr.PoseResult:
    return poses(micro_assembly(0.086, place, tolerance=tolerance))[-1]


def assert_agrees(pose: gr.PoseResult, reference: dict, length: float) -> None:
    force = np.array(reference["force_on_object"])
    assert np.linalg.norm(pose.force_on_object_finger_frame - force) <= 1e-4 * np.linalg.norm(force)
    assert pose.energy == pytest.approx(reference["energy"], rel=1e-5)
    assert pose.clamp_moment == pytest.approx(reference["clamp_moment"], rel=1e-4)
    assert pose.tip_rotation == pytest.approx(reference["tip_x_y_rotation"][2], rel=1e-4)
    assert math.hypot(*pose.tip) == pytest.approx(math.hypot(*reference["tip_x_y_rotation"][:2]), abs=1e-4 * length)
    (contact,) = pose.contacts
    assert contact.normal_force == pytest.approx(reference["normal_force"], rel=1e-4)
    if "s_c" in reference:
        assert contact.s == pytest.approx(reference["s_c"], abs=1e-3 * length)


@pytest.mark.parametrize(("start", "theory", "place"), CASES)
def test_the_rotating_finger_agrees_with_the_independent_solution(start: float, theory: str, place: str) -> None:
    pose = rotated(start, float(place.split()[0]), theory)
    assert_agrees(pose, ROTATING[place][f"{theory}, mu = 0"], 0.1778)
    (contact,) = pose.contacts
    x_e = pose.parameter
    turn = np.exp(-1j * (math.radians(102) - math.radians(236.22) * x_e))  # to the finger frame
    point = complex(*contact.point) * turn
    assert abs(point - complex(*ROTATING[place][f"{theory}, mu = 0"]["contact_point"])) < 1e-3 * 0.1778
    assert contact.on == ("tip" if "corner" in place else "lower")


@pytest.mark.parametrize("place", ASSEMBLY)
def test_the_micro_assembly_agrees_with_the_independent_solution(place: str) -> None:
    pose, reference = assembled(float(place)), ASSEMBLY[place]["mu = 0"]
    assert_agrees(pose, reference, 0.057)
    (contact,) = pose.contacts
    assert contact.on == "jaw"
    assert np.hypot(*np.subtract(contact.point, reference["contact_point"])) < 1e-3 * 0.057


@pytest.mark.parametrize(("start", "theory", "place"), CASES)
def test_at_a_tight_tolerance_the_rotating_finger_agrees_to_the_reference_s_own_accuracy(
    start: float, theory: str, place: str
) -> None:
    pose = rotated(start, float(place.split()[0]), theory, 1e-8)
    force = np.array(ROTATING[place][f"{theory}, mu = 0"]["force_on_object"])
    assert np.linalg.norm(pose.force_on_object_finger_frame - force) <= 1e-8 * np.linalg.norm(force)


def test_the_pin_touches_the_jaw_where_the_reference_says() -> None:
    events = gr.trace(micro_assembly(0.086, 0.07)).events
    assert [event.kind for event in events] == ["touch"]
    assert events[0].parameter == pytest.approx(0.07756931, abs=1e-8)


@pytest.mark.parametrize("middle", [0.064, 0.068])
def test_the_pin_passes_from_the_lead_face_to_the_jaw_s_corner_and_lets_go_behind_it(middle: float) -> None:
    events = gr.trace(micro_assembly(0.086, middle, 0.05)).events
    assert [event.kind for event in events] == ["touch", "change", "change", "release"]
    assert 0.064 < events[1].parameter < 0.06781  # between the reference's lead face and apex
    assert events[3].parameter == pytest.approx(0.0518616, abs=1e-6)  # off the return face, however long the steps


@pytest.mark.parametrize("theory", ["bending", "shear"])
def test_the_ellipse_touches_where_it_is_released(theory: str) -> None:
    released = gr.trace(rotating_finger(0.0, 0.0762, theory=theory)).events
    touched = gr.trace(rotating_finger(0.127, 0.0, theory=theory)).events
    assert [event.kind for event in released] == ["release"]
    assert [event.kind for event in touched] == ["touch"]
    assert released[0].parameter == pytest.approx(0.0694, abs=5e-5)
    assert touched[0].parameter == pytest.approx(released[0].parameter, abs=1e-9)


@pytest.mark.parametrize("theory", ["bending", "shear"])
def test_the_ellipse_passes_on_to_the_tip_s_corner_where_the_reference_says(theory: str) -> None:
    events = gr.trace(rotating_finger(*FALLING, theory=theory)).events
    assert [event.kind for event in events] == ["touch", "change"]
    assert events[1].parameter == pytest.approx(-0.139, abs=1e-3)


# ---- How good the error estimate is.

ESTIMATED = {
    **{
        f"rotating finger, {theory}, at {place}": lambda tolerance, theory=theory, place=place: rotated(
            FALLING[0], place, theory, tolerance
        )
        for theory in ("bending", "shear")
        for place in (0.06, 0.0508, -0.0254, -0.1016, -0.1524)
    },
    **{
        f"micro assembly at {place}": lambda tolerance, place=place: assembled(place, tolerance)
        for place in (0.06781, 0.064, 0.056)
    },
}


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("name", ESTIMATED)
def test_the_error_estimate_is_of_the_size_of_the_error(name: str, tolerance: float) -> None:
    pose, fine = ESTIMATED[name](tolerance), ESTIMATED[name](1e-8)
    force, best = np.array(pose.force_on_object), np.array(fine.force_on_object)
    error = np.linalg.norm(force - best) / np.linalg.norm(best)
    assert error <= tolerance
    if error > 1e-7:
        assert 0.5 < pose.error.discretisation / error < 2


# ---- Virtual work: exact, and independent of how forces are found.

STENCIL = ((-2, 1 / 12), (-1, -8 / 12), (1, 8 / 12), (2, -1 / 12))
PLACES = [
    (micro_assembly, 0.07, 0.06781, 0.057),
    (micro_assembly, 0.07, 0.060, 0.057),
    (rotating_finger, RISING[0], -0.0254, 0.1778),
    (rotating_finger, -0.1, -0.1524, 0.1778),
]
located = pytest.mark.parametrize(
    ("example", "start", "place", "length"), PLACES, ids=[f"{f.__name__} at {q}" for f, _, q, _ in PLACES]
)
EXACTLY = {"tolerance": 1e-8}


def shifted(scene: gr.Scene, name: str, step: float) -> gr.Scene:
    """The object displaced in the world, by as much at every pose."""
    pose = scene.object.pose
    return replace(scene, object=replace(scene.object, pose=replace(pose, **{name: getattr(pose, name) + step})))


@located
def test_the_force_is_the_energy_s_slope_in_the_object_s_position(
    example: object, start: float, place: float, length: float
) -> None:
    scene = example(start, place, **EXACTLY)
    pose = poses(scene)[-1]
    force, arm = np.array(pose.force_on_object), np.linalg.norm(pose.force_on_object) * length
    h = 1e-3
    slopes = {}
    for name, step in (("x", h * length), ("y", h * length), ("angle", h)):
        energies = [weight * poses(shifted(scene, name, i * step))[-1].energy for i, weight in STENCIL]
        slopes[name] = sum(energies) / step
    assert force == pytest.approx((-slopes["x"], -slopes["y"]), rel=0, abs=1e-6 * np.linalg.norm(force))
    assert pose.moment_on_object == pytest.approx(-slopes["angle"], rel=0, abs=1e-6 * arm)


@located
def test_the_motion_force_is_the_energy_s_slope_along_the_motion(
    example: object, start: float, place: float, length: float
) -> None:
    h = 1e-3 * length
    *_, a, b, middle, c, d = poses(example(start, *(place + i * h for i in (-2, -1, 0, 1, 2)), **EXACTLY))
    slope = sum(weight * pose.energy for (_, weight), pose in zip(STENCIL, (a, b, c, d), strict=True)) / h
    size = np.linalg.norm(middle.force_on_object)
    assert middle.motion_force == pytest.approx(slope, rel=0, abs=1e-6 * max(size, abs(slope)))


def test_the_motion_force_counts_a_clamp_that_moves_and_turns() -> None:
    scene = micro_assembly(*(q / 1000 for q in (70, 60)), **EXACTLY)
    clamp = gr.Pose(x=0.3 * Q, y=0.01 * sympy.sin(40 * Q), angle=sympy.cos(30 * Q))
    turn, place = clamp.angle, (Q, -0.0105)
    x = clamp.x + sympy.cos(turn) * place[0] - sympy.sin(turn) * place[1]
    y = clamp.y + sympy.sin(turn) * place[0] + sympy.cos(turn) * place[1]
    moved = replace(
        scene,
        finger=scene.finger.at(x=clamp.x, y=clamp.y, angle=clamp.angle),
        object=scene.object.body.at(x=x, y=y, angle=turn),
    )
    for one, other in zip(poses(scene), poses(moved), strict=True):
        assert other.motion_force == pytest.approx(one.motion_force, rel=1e-8)
        assert other.energy == pytest.approx(one.energy, rel=1e-8)


# ---- Nothing lies within anything else.


@pytest.mark.parametrize(
    "scene",
    [
        micro_assembly(*np.linspace(0.086, 0.050, 37)),
        rotating_finger(*np.linspace(-0.1016, 0.2032, 49)),
        rotating_finger(*np.linspace(0.127, -0.1524, 49)),
        rotating_finger(*np.linspace(0.127, -0.1524, 49), theory="bending"),
    ],
    ids=["micro assembly", "rotating finger, rising", "falling", "falling, bending"],
)
def test_no_pose_of_the_examples_has_finger_and_object_in_each_other(scene: gr.Scene) -> None:
    for solved in follow(scene):
        assert solved.result.status in ("free", "contact"), solved.result.reason
        assert deepest_cut(scene, solved) <= 1e-6
        assert solved.result.checks.penetration_bound <= 1e-6 * solved.length
        assert solved.result.min_gap >= -1e-6 * solved.length
