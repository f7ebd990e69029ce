"""Error against run time: the reference is right where the answer is known; the study says what it measured."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import gripper as gr
from gripper import scenefile
from gripper.assemble import setting
from gripper.cli import app
from gripper.kinematics import Kinematics
from gripper.site import Site
from gripper.study.cost import single_pose
from gripper.study.outcome import QUANTITIES
from gripper.study.precision import SHIFTS, reference, study
from gripper.study.shooting import Shooting
from gripper.study.shot import NoReferenceError
from gripper.study.work import Work, WorkPrecision
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle

ROOT = Path(__file__).parents[1]
BEAM = json.loads((ROOT / "tests/reference/beam.json").read_text())
EXACT = json.loads((ROOT / "tests/reference/exact.json").read_text())
ROTATING, ASSEMBLY = ROOT / "gallery/rotating_finger.toml", ROOT / "gallery/micro_assembly.toml"
CASES = [  # contact at a point, over a patch, on the jaw's face and at its corner
    (ROTATING, "bending", "rotating_finger", "0.0508", "bending, mu = 0"),
    (ROTATING, "shear", "rotating_finger", "-0.0254", "shear, mu = 0"),
    (ASSEMBLY, "bending", "micro_assembly", "0.06781", "mu = 0"),
    (ASSEMBLY, "bending", "micro_assembly", "0.064", "mu = 0"),
]


@pytest.mark.parametrize(("path", "theory", "example", "parameter", "row"), CASES)
def test_shooting_gives_the_reference_files_digits(
    path: Path, theory: str, example: str, parameter: str, row: str
) -> None:
    known = BEAM[example]["poses"][parameter][row]
    scene = single_pose(replace(scenefile.read(path), theory=theory), float(parameter))
    fine, coarse = reference(scene)
    scales = setting(scene).sections
    force = complex(*known["force_on_object"])
    assert -fine.force * scales.force_scale == pytest.approx(force, rel=1e-9)
    assert fine.energy * scales.energy_scale == pytest.approx(known["energy"], rel=1e-9)
    assert abs(fine.axis[-1] * scales.length - complex(*known["tip_x_y_rotation"][:2])) < 1e-9 * scales.length
    assert abs(fine.force - coarse.force) < 1e-8 * abs(fine.force)


@pytest.mark.parametrize("row", [row for row in EXACT[next(k for k in EXACT if "circle" in k)]["rows"] if row[2] == 0])
def test_shooting_gives_the_exact_force_of_a_uniform_finger_on_a_circle(row: list[float]) -> None:
    x, y, _, N, *_, V = row
    material = gr.Material(youngs_modulus=12 / 0.06**3, poisson_ratio=0.3)
    finger = Uniform(length=1.0, thickness=0.06, width=1.0, material=material)
    fine, _ = reference(gr.Scene(finger=finger, object=Circle(radius=0.25).at(x=x, y=y), theory="bending"))
    assert abs(fine.force) == pytest.approx(N, rel=1e-7)  # the table's digits
    assert fine.energy == pytest.approx(V, rel=1e-6)


def test_a_finger_flush_on_a_flat_has_no_reference_and_says_so() -> None:
    scene = single_pose(scenefile.read(ROTATING), 0.0)
    fixed = setting(scene)
    obstacle = fixed.obstacle(Kinematics(scene, fixed.sections.length).frame(0.0))
    with pytest.raises(NoReferenceError, match="flush"):
        Shooting(fixed, obstacle, (Site("tail", 0, (0.5, 1.0), modes=8),))


@pytest.mark.parametrize(("path", "theory", "parameter"), [(*case[:2], float(case[3])) for case in CASES[:3]])
def test_the_error_estimate_is_the_error(path: Path, theory: str, parameter: float) -> None:
    """Between half and three times the distance from shooting, wherever that is above 1e-7."""
    scene = single_pose(replace(scenefile.read(path), theory=theory), parameter)
    exact, judged = reference(scene)[0].force, 0
    for tolerance in (1e-2, 1e-3, 1e-4):
        pose = gr.solve(replace(scene, tolerance=tolerance)).poses[0]
        force = complex(*pose.force_on_object_finger_frame) / setting(scene).sections.force_scale
        error = abs(force + exact) / abs(exact)
        assert error <= tolerance
        if error > 1e-7:
            judged += 1
            assert 0.5 < pose.error.discretisation / error < 3
    assert judged > 0


@cache
def quick() -> WorkPrecision:
    return study(scenefile.read(ASSEMBLY), 0.06781, quick=True)


def test_finer_points_of_this_project_are_better_and_all_within_what_they_ask() -> None:
    ours = [work for work in quick().works if work.method == "gripper"]
    for work in ours:
        assert not work.failures
        assert work.worst["force"] <= float(work.point.split(" = ")[1])
    assert ours[-1].worst["force"] <= ours[0].worst["force"]


def test_exact_gradients_change_the_paper_s_cost_but_not_its_answer() -> None:
    differences, exact = (
        study_of(name, "N = 16" if "exact" not in name else "N = 12")
        for name in ("paper as published", "paper as published, exact gradients")
    )
    assert differences.evaluations > 5 * exact.evaluations
    assert differences.worst["force"] < 0.1 > exact.worst["force"]


def study_of(method: str, point: str) -> Work:
    return next(work for work in quick().works if (work.method, work.point) == (method, point))


def test_every_point_has_times_work_and_errors_or_says_why_not() -> None:
    rows = list(csv.DictReader(io.StringIO(quick().csv())))
    assert len(rows) == len(quick().works)
    for row in rows:
        if row["failed"] == "0":
            assert float(row["cold_ms"]) > 0
            assert min(int(row[name]) for name in ("unknowns", "iterations", "evaluations")) > 0
            for name in QUANTITIES:
                assert 0 <= float(row[f"{name}_error_median"]) <= float(row[f"{name}_error_worst"])
        else:
            assert row["why"]


def test_a_pose_that_nothing_touches_has_nothing_to_compare() -> None:
    with pytest.raises(NoReferenceError, match="nothing touches"):
        study(scenefile.read(ROTATING), 0.2, quick=True)


def test_the_command_writes_what_it_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gripper.study.precision.study", lambda *_, **__: quick())
    done = CliRunner().invoke(app, ["study", str(ASSEMBLY), "-o", str(tmp_path), "--quick"])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "work_precision.csv").read_text() == quick().csv()
    assert (tmp_path / "work_precision.png").read_bytes().startswith(b"\x89PNG")
    assert "reference: shooting" in done.output


def test_a_bad_pose_ends_with_one_message_and_nothing_written(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["study", str(ROTATING), "-o", str(tmp_path / "out"), "--at", "0.2", "--quick"])
    assert done.exit_code == 1
    assert "nothing touches" in done.stderr
    assert not (tmp_path / "out").exists()


def test_shifts_cover_the_spacing_of_the_paper_s_nodes() -> None:
    assert np.allclose(np.diff(SHIFTS), 1 / 90 / len(SHIFTS), atol=2e-4)
