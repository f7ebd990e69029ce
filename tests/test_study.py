"""The paper's scheme as published does what is known of it, and costs are measured as they say (tests/reference)."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import get_args

import numpy as np
import pytest
from scipy.optimize import approx_fprime

import gripper as gr
from gripper import scenefile
from gripper.study.cost import repeated, single_pose
from gripper.study.published import PublishedProblem, PublishedResult, Shear, solve_as_published

ROOT = Path(__file__).parents[1]
BEAM = json.loads((ROOT / "tests/reference/beam.json").read_text())
ROTATING = scenefile.read(ROOT / "gallery/rotating_finger.toml")
ASSEMBLY = scenefile.read(ROOT / "gallery/micro_assembly.toml")
CASES = [
    (ROTATING, 0.0508, "none", BEAM["rotating_finger"]["poses"]["0.0508"]["bending, mu = 0"]),
    (ROTATING, 0.0508, "element", BEAM["rotating_finger"]["poses"]["0.0508"]["shear, mu = 0"]),
    (ROTATING, -0.0254, "none", BEAM["rotating_finger"]["poses"]["-0.0254"]["bending, mu = 0"]),
    (ROTATING, -0.0254, "element", BEAM["rotating_finger"]["poses"]["-0.0254"]["shear, mu = 0"]),
    (ASSEMBLY, 0.06781, "none", BEAM["micro_assembly"]["poses"]["0.06781"]["mu = 0"]),
    (ASSEMBLY, 0.064, "none", BEAM["micro_assembly"]["poses"]["0.064"]["mu = 0"]),
]
NAMES = ["bending", "shear", "bending, deep", "shear, deep", "jaw", "jaw's apex"]
ELLIPSE = BEAM["rotating_finger"]["poses"]


def error(force: tuple[float, float], reference: dict) -> float:
    expected = np.array(reference["force_on_object"])
    return float(np.linalg.norm(force - expected) / np.linalg.norm(expected))


@cache
def published(case: int, N: int = 90) -> PublishedResult:
    scene, parameter, shear, _ = CASES[case]
    return solve_as_published(scene, parameter, N=N, shear=shear)


@pytest.mark.parametrize("shear", get_args(Shear))
@pytest.mark.parametrize(("scene", "parameter"), [(ROTATING, 0.0508), (ASSEMBLY, 0.064)], ids=["face", "jaw"])
def test_the_published_scheme_s_exact_gradients_are_those_of_differences(
    scene: gr.Scene, parameter: float, shear: Shear
) -> None:
    problem = PublishedProblem(scene, parameter, 9, shear)
    x = np.random.default_rng(1).normal(scale=0.2, size=problem.size)
    assert problem.energy(x)[1] == pytest.approx(approx_fprime(x, lambda x: problem.energy(x)[0]), abs=1e-5)
    assert problem.gap_gradients(x) == pytest.approx(approx_fprime(x, problem.gaps), abs=1e-6)


@pytest.mark.parametrize("case", range(len(CASES)), ids=NAMES)
def test_the_published_scheme_s_force_is_right_to_four_percent_and_its_energy_to_two_thousandths(case: int) -> None:
    reference, result = CASES[case][3], published(case)
    assert result.success
    assert error(result.force_on_object, reference) < 0.04
    assert result.energy == pytest.approx(reference["energy"], rel=2e-3)


@pytest.mark.parametrize("case", range(len(CASES)), ids=NAMES)
def test_the_clamp_s_moment_gives_the_same_force_up_to_the_nodes_spacing(case: int) -> None:
    # the moment is read half an element beyond the clamp, and the force may be shared by neighbouring nodes
    assert error(published(case).moment_force, CASES[case][3]) < 0.05


def test_contact_at_nodes_alone_does_not_converge_regularly() -> None:
    errors = [error(published(0, N=N).force_on_object, CASES[0][3]) for N in (30, 45, 60, 90)]
    assert max(errors[1:]) > 0.01
    assert sorted(errors, reverse=True) != errors


def test_the_published_scheme_needs_iterations_in_proportion_to_its_nodes() -> None:
    for N in (30, 60, 90):
        assert published(0, N=N).iterations == pytest.approx(1.1 * N, rel=0.15)


def test_differences_lead_to_the_same_answer_as_exact_gradients() -> None:
    exact, differences = (
        solve_as_published(ROTATING, 0.0508, N=20, shear="element", gradients=way) for way in ("exact", "differences")
    )
    assert differences.force_on_object == pytest.approx(exact.force_on_object, rel=2e-3)
    assert differences.evaluations > 20 * exact.evaluations


def test_the_averaged_shear_collapses_and_slsqp_calls_it_success() -> None:
    """A zig-zag of the shear angle costs no energy and shortens the finger until it hardly touches."""
    reference = ELLIPSE["-0.0254"]["shear, mu = 0"]
    result = solve_as_published(ROTATING, -0.0254, N=90, shear="averaged")
    assert result.success
    assert np.hypot(*result.force_on_object) < 0.01 * reference["normal_force"]
    assert result.energy < 0.03 * reference["energy"]


@pytest.mark.parametrize("N", [11, 20, 45])
def test_with_the_first_shear_angle_free_no_force_is_left_at_any_resolution(N: int) -> None:
    result = solve_as_published(ROTATING, -0.0254, N=N, shear="averaged_free")
    assert result.success
    assert np.hypot(*result.force_on_object) < 1e-4  # of 15.8 N


def test_from_the_straight_finger_the_published_scheme_ends_on_the_wrong_side_and_calls_it_success() -> None:
    straight, arc = (
        solve_as_published(ROTATING, -0.0508, N=60, shear="none", start=way) for way in ("straight", "arc")
    )
    assert straight.success
    assert straight.energy < 0.8 * arc.energy
    assert np.dot(straight.force_on_object, arc.force_on_object) < 0
    right = gr.solve(single_pose(replace(ROTATING, theory="bending"), -0.0508))
    assert arc.energy == pytest.approx(right.energy, rel=2e-3)


def test_a_free_pose_has_no_force() -> None:
    result = solve_as_published(ROTATING, 0.2, N=20)
    assert result.success
    assert result.energy == pytest.approx(0, abs=1e-12)
    assert result.force_on_object == pytest.approx((0, 0), abs=1e-12)
    assert result.moment_force == (0, 0)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"N": 1}, "N must be at least 2"),
        ({"shear": "nodal"}, "shear must be one of none, averaged, averaged_free, element; got 'nodal'"),
        ({"gradients": "some"}, "gradients must be one of differences, exact"),
        ({"start": "bent"}, "start must be one of straight, arc"),
        ({"parameter": None}, "parameter must be given"),
        ({"scene": replace(ROTATING, approach=(0.0, -1.0))}, "approach must come from below"),
    ],
)
def test_the_published_scheme_says_which_argument_is_wrong(wrong: dict, words: str) -> None:
    arguments = {"scene": ROTATING, "parameter": 0.0508, "N": 10} | wrong
    with pytest.raises(ValueError, match=words):
        solve_as_published(arguments.pop("scene"), arguments.pop("parameter"), **arguments)


def test_a_single_pose_is_the_motion_s_pose() -> None:
    scene = single_pose(ROTATING, -0.0254)
    assert scene.motion is None
    assert scene.finger.pose.angle == pytest.approx(np.deg2rad(102 + 236.22 * 0.0254))
    assert (scene.object.pose.x, scene.object.pose.y) == pytest.approx((-0.0254, 0.12065))
    alone = solve_as_published(scene, N=20)
    assert alone.force_on_object == pytest.approx(solve_as_published(ROTATING, -0.0254, N=20).force_on_object)


def test_a_call_is_repeated_after_one_warm_up() -> None:
    calls = iter(range(100))
    measured = repeated(lambda: next(calls), 5)
    assert measured.answers == (1, 2, 3, 4, 5)
    assert 0 <= measured.least <= measured.median <= max(measured.seconds)
    with pytest.raises(ValueError, match="repeats must be at least 1; got 0"):
        repeated(lambda: None, 0)


def cost_script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("cost", ROOT / "gallery/cost.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_cost_script_measures_and_writes_what_it_prints(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    two = replace(ROTATING, motion=gr.Motion("x_e", (-0.0254, 0.0508)))
    rows = cost_script().main(tmp_path, two, repeats=1)
    table = (tmp_path / "cost.csv").read_text().splitlines()
    assert table[0].split(",") == list(rows[0]._fields)
    assert len(table) == len(rows) + 1 == len(capsys.readouterr().out.splitlines()) == 25
    for row in rows:
        ours = row.what.endswith("gripper")
        assert row.force_error < (1e-4 if ours else 0.04), row
        assert 0 < row.cpu_ms_min <= row.cpu_ms_median, row
