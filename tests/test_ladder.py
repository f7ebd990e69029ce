"""The choice of the theory: what the next one would change is told from one pose, and results say where theory ends."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gripper as gr
from gripper.beam.sections import sections
from gripper.result import ErrorEstimate
from gripper.statics.ladder import RUNGS
from gripper.statics.validity import crosses, plane_difference, warnings
from gripper_plugins.objects import Circle
from tests.scenes import PLASTIC, RISING, micro_assembly, rotating_finger, unit_finger

LADDER = {
    "rotating finger": rotating_finger(-0.1016, -0.0254, 0.0508, theory="auto"),
    "jaw": micro_assembly(0.077, 0.065, 0.058, theory="auto"),
}
SCENES = list(LADDER)


@cache
def by(name: str, theory: str) -> gr.Result:
    scene = LADDER[name]
    loose = 1.0 if theory == "loose" else 5e-3
    return gr.trace(replace(scene, theory="auto" if theory == "loose" else theory, theory_tolerance=loose))


@pytest.mark.parametrize("name", SCENES)
def test_what_the_next_theory_would_change_is_told_to_a_twentieth_without_solving_it(name: str) -> None:
    for poor, rich in zip(by(name, "loose").poses, by(name, "shear").poses, strict=True):
        change = math.dist(poor.force_on_object, rich.force_on_object) / math.hypot(*poor.force_on_object)
        assert poor.error.next_theory == pytest.approx(change, rel=0.05)


@pytest.mark.parametrize("name", SCENES)
def test_auto_takes_the_cheapest_theory_that_suffices_for_every_pose(name: str) -> None:
    auto, loose = by(name, "auto"), by(name, "loose")
    assert loose.model.theory == RUNGS[0]
    change = max(pose.error.next_theory for pose in loose.poses)
    assert (auto.model.theory == RUNGS[0]) == (change <= auto.scene.theory_tolerance)
    same = by(name, auto.model.theory)
    for chosen, asked in zip(auto.poses, same.poses, strict=True):
        assert chosen.force_on_object == pytest.approx(asked.force_on_object, rel=1e-9)


def test_a_finger_that_stretches_much_is_given_the_theory_that_has_it() -> None:
    scene = gr.Scene(finger=unit_finger(0.15, material=PLASTIC), object=pin(0.7, 0.25, 0.15))
    shear, stretch = (gr.solve(replace(scene, theory=theory)) for theory in ("shear", "stretch"))
    change = math.dist(shear.force_on_object, stretch.force_on_object) / math.hypot(*shear.force_on_object)
    assert 1e-3 < change < 5e-3
    loose, strict = gr.solve(scene), gr.solve(replace(scene, theory_tolerance=1e-3))
    assert (loose.model.theory, strict.model.theory) == ("shear", "stretch")
    assert loose.poses[0].error.next_theory == pytest.approx(change, rel=0.05)
    assert strict.poses[0].error.next_theory is None
    assert strict.force_on_object == pytest.approx(stretch.force_on_object, rel=1e-9)


@pytest.mark.parametrize("name", SCENES)
def test_progress_never_goes_back_when_a_motion_starts_again(name: str) -> None:
    told: list[tuple[int, int]] = []
    gr.trace(LADDER[name], progress=lambda done, total: told.append((done, total)))
    assert told == [(1, 3), (2, 3), (3, 3)]


def test_a_single_pose_is_judged_as_a_motion_s_is() -> None:
    material = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
    for thickness, expected in ((0.01, RUNGS[0]), (0.15, "shear")):
        finger = unit_finger(thickness, material=material)
        scene = gr.Scene(finger=finger, object=pin(0.7, 0.05, thickness))
        result = gr.solve(scene)
        assert result.model.theory == expected
        change = result.poses[0].error.next_theory
        assert change is None or change <= scene.theory_tolerance
        written = result.to_dict()
        assert written["poses"][0]["error"]["next_theory"] == change
        assert ("shear strain" in [part["what"] for part in written["model"]["left_out"]]) == (expected == RUNGS[0])


def pin(x: float, depth: float, thickness: float, radius: float = 0.25) -> gr.Placed:
    return Circle(radius=radius).at(x=x, y=-radius - thickness / 2 + depth)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.4, 0.5])
def test_the_plane_states_differ_by_what_is_said(nu: float) -> None:
    forces = []
    for plane in ("stress", "strain"):
        material = gr.Material(youngs_modulus=1e6, poisson_ratio=nu, plane=plane)
        scene = gr.Scene(finger=unit_finger(0.02, material=material), object=pin(0.7, 0.05, 0.02), theory="bending")
        forces.append(math.hypot(*gr.solve(scene).force_on_object))
    larger = forces[1] / forces[0] - 1
    assert larger == pytest.approx(1 / (1 - nu**2) - 1, abs=1e-6)
    material = gr.Material(youngs_modulus=1e6, poisson_ratio=nu)
    assert plane_difference(material) == f"plane strain (forces up to {100 * larger:.2g} % larger)"
    assert "smaller" in plane_difference(replace(material, plane="strain"))


def test_the_examples_say_that_strains_are_large_only_where_elements_say_so() -> None:
    """Example II reaches strains of 0.10, where material laws lie 3 % apart (tests/reference/fem.json)."""
    assert gr.trace(micro_assembly(0.077, 0.065)).model.warnings == ()
    soft = gr.trace(rotating_finger(RISING[0]))
    assert soft.model.warnings == ()


def test_a_finger_bent_double_and_a_stout_one_say_so() -> None:
    thick = unit_finger(0.3, material=PLASTIC)
    result = gr.solve(gr.Scene(finger=thick, object=pin(0.8, 0.4, 0.3), theory="bending"))
    text = " ".join(result.model.warnings)
    assert "w / L is 0.3" in text
    assert "strains reach" in text
    assert f"WARNING: {result.model.warnings[0][:20]}" in str(result)


def test_folding_is_told_from_a_large_strain() -> None:
    pose = gr.solve(gr.Scene(finger=unit_finger(), object=pin(0.7, 0.05, 0.06), theory="bending")).poses[0]
    folded = warnings(sections(unit_finger()), [replace(pose, max_strain=0.9)], 1e-4)
    assert ["kappa w / 2 reaches 0.9" in text for text in folded] == [True]
    assert warnings(sections(unit_finger()), [replace(pose, max_strain=0.05)], 1e-4) == ()


def test_a_tolerance_that_is_not_met_is_told() -> None:
    pose = gr.solve(gr.Scene(finger=unit_finger(), object=pin(0.7, 0.05, 0.06), theory="bending")).poses[0]
    assert warnings(sections(unit_finger()), [pose], 1e-4) == ()
    off = replace(pose, error=ErrorEstimate(discretisation=3e-4))
    (told,) = warnings(sections(unit_finger()), [off, pose], 1e-4)
    assert told == "the tolerance of 1e-04 is not met at 1 poses: 3.0e-04 at worst"


@pytest.mark.parametrize("turn", [0.5, 3.0, 5.5, 6.9, 9.0])
def test_a_finger_crosses_itself_once_it_has_gone_round(turn: float) -> None:
    """An arc of total angle a crosses itself from 2 pi on; with thickness w as soon as its end meets its start."""
    s, thickness = np.linspace(0, 1, 81), 0.02
    normal = np.stack([-np.sin(turn * s), np.cos(turn * s)], axis=1)
    axis = np.stack([np.sin(turn * s), 1 - np.cos(turn * s)], axis=1) / turn
    outline = np.concatenate([axis - thickness / 2 * normal, (axis + thickness / 2 * normal)[::-1]])
    assert crosses(outline) == (turn > 2 * math.pi)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan])
def test_a_theory_tolerance_must_be_positive(value: float) -> None:
    with pytest.raises(ValueError, match="theory_tolerance must be a positive number"):
        rotating_finger(0.0, theory_tolerance=value)
