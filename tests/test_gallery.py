"""The gallery's scripts run as they stand, and their numbers are the references' (tests/reference)."""

from __future__ import annotations

import importlib.util
import json
import math
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

import numpy as np
import pytest

from gripper import PoseResult, Result

ROOT = Path(__file__).parents[1]
SCRIPTS = [
    p for p in sorted((ROOT / "gallery").glob("*.py")) if p.stem not in ("cost", "force_curves")
]  # these have tests of their own
BEAM = json.loads((ROOT / "tests/reference/beam.json").read_text())
FEM = json.loads((ROOT / "tests/reference/fem.json").read_text())
ROTATING = [("0.0508", "shear, mu = 0"), ("-0.0254", "shear, mu = 0")]
ASSEMBLY = [("0.064", "mu = 0")]  # the other pose of the reference, 0.06781, lies between two of the motion


def script(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def run(name: str) -> tuple[Result, dict[str, int]]:
    """The script's result, and the files that it wrote with their sizes."""
    with TemporaryDirectory() as folder:
        result = script(ROOT / "gallery" / f"{name}.py").main(folder)
        return result, {path.name: path.stat().st_size for path in Path(folder).iterdir()}


def at(result: Result, parameter: float) -> PoseResult:
    (pose,) = (each for each in result.poses if each.parameter == pytest.approx(parameter, abs=1e-9))
    return pose


def assert_agrees(pose: PoseResult, reference: dict, length: float, tolerance: float) -> None:
    """The discretisation error asked for is 1e-4 of the force."""
    force = np.array(reference["force_on_object"])
    assert np.linalg.norm(pose.force_on_object_finger_frame - force) <= tolerance * np.linalg.norm(force)
    assert pose.clamp_moment == pytest.approx(reference["clamp_moment"], rel=tolerance)
    assert pose.energy == pytest.approx(reference["energy"], rel=tolerance)
    assert pose.tip_rotation == pytest.approx(reference["tip_x_y_rotation"][2], rel=tolerance)
    assert math.hypot(*pose.tip) == pytest.approx(
        math.hypot(*reference["tip_x_y_rotation"][:2]), abs=tolerance * length
    )


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_every_script_of_the_gallery_answers_every_pose_and_draws(path: Path) -> None:
    result, files = run(path.stem)
    assert not result.failed
    assert f"{path.stem}.png" in files
    assert all(size > 20_000 for size in files.values())


@pytest.mark.parametrize(("place", "case"), ROTATING)
def test_the_rotating_finger_agrees_with_the_shooting_solution(place: str, case: str) -> None:
    reference = BEAM["rotating_finger"]["poses"][place][case]
    assert_agrees(at(run("rotating_finger")[0], float(place)), reference, 0.1778, 1e-4)


@pytest.mark.parametrize(("place", "case"), ASSEMBLY)
def test_the_micro_assembly_agrees_with_the_shooting_solution(place: str, case: str) -> None:
    reference = BEAM["micro_assembly"]["poses"][place][case]
    assert_agrees(at(run("micro_assembly")[0], float(place)), reference, 0.057, 1e-4)


def test_the_rotating_finger_agrees_with_finite_elements_of_the_beam_s_material_law() -> None:
    rows = FEM["rotating_finger"]["biot, mu = 0, 1296 elements"]
    for row in rows:
        pose, force = at(run("rotating_finger")[0], row["x_e"]), np.array(row["force_on_object"])
        error = np.linalg.norm(pose.force_on_object_finger_frame - force) / np.linalg.norm(force)
        assert error < 0.006, f"{error:.2%} at x_e = {row['x_e']}"


def test_the_micro_assembly_agrees_with_finite_elements() -> None:
    rows = FEM["micro_assembly"]["rigid jaw, mu = 0, 4560 elements"]
    for row in (row for row in rows if row["x_o"] != 0.06781):
        pose, force = at(run("micro_assembly")[0], row["x_o"]), np.array(row["force_on_object"])
        assert pose.force_on_object_finger_frame == pytest.approx(force, abs=0.002 * max(np.linalg.norm(force), 1.0))


def test_the_rotating_finger_lets_go_where_the_reference_says() -> None:
    (release,) = (event for event in run("rotating_finger")[0].events if event.kind == "release")
    assert release.parameter == pytest.approx(0.0694, abs=1e-4)


def test_the_micro_assembly_touches_where_the_reference_says_and_ends_free() -> None:
    result = run("micro_assembly")[0]
    touch = next(event for event in result.events if event.kind == "touch")
    assert touch.parameter == pytest.approx(0.07756931, abs=1e-7)
    assert result.poses[-1].status == "free"
