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
from gripper.contact.kinematics import Kinematics
from gripper.contact.site import Site
from gripper.study.cost import single_pose
from gripper.study.diagram import diagram
from gripper.study.ipopt import Transcription
from gripper.study.methods import methods
from gripper.study.outcome import QUANTITIES, NoOutcomeError
from gripper.study.precision import SHIFTS, reference, study
from gripper.study.published import solve_as_published
from gripper.study.shooting import Shooting
from gripper.study.shot import NoReferenceError
from gripper.study.work import Work, WorkPrecision
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle, Polygon

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


@pytest.mark.parametrize("bent", [None, 2.0])
@pytest.mark.parametrize("theory", ["shear", "stretch"])
def test_shooting_and_this_project_agree_in_every_theory_and_for_fingers_bent_at_rest(
    theory: str, bent: float | None
) -> None:
    """Two ways that share the profile and g alone; 2 per m turns the finger of 0.18 m by 20 degrees."""
    scene = single_pose(replace(scenefile.read(ROTATING), theory=theory, tolerance=1e-9), -0.0254)
    finger = replace(scene.finger.body, rest_curvature=bent)
    scene = replace(scene, finger=replace(scene.finger, body=finger))
    (fine, coarse), scales = reference(scene), setting(scene).sections
    pose = gr.solve(scene).poses[0]
    force = complex(*pose.force_on_object_finger_frame) / scales.force_scale
    assert abs(force + fine.force) < 1e-9 * abs(force)
    assert pose.energy == pytest.approx(fine.energy * scales.energy_scale, rel=1e-9)
    assert abs(fine.force - coarse.force) < 1e-10 * abs(force)


def test_a_finger_flush_on_a_flat_has_no_reference_and_says_so() -> None:
    scene = single_pose(scenefile.read(ROTATING), 0.0)
    fixed = setting(scene)
    obstacle = fixed.obstacle(Kinematics(scene, fixed.sections.length).frame(0.0))
    with pytest.raises(NoReferenceError, match="flush"):
        Shooting(fixed, obstacle, (Site("tail", 0, (0.5, 1.0), modes=8),))


@pytest.mark.parametrize(
    ("path", "theory", "parameter"),
    [*((*case[:2], float(case[3])) for case in CASES[:3]), (ROTATING, "stretch", -0.0254)],
)
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


def test_no_error_is_told_below_ten_times_the_reference_s_own_uncertainty() -> None:
    found = quick()
    assert all(0 < found.floor[name] == 10 * found.uncertainty[name] < 1e-8 for name in QUANTITIES)
    exact = replace(found.works[0], median=dict.fromkeys(QUANTITIES, 1e-15), worst=dict.fromkeys(QUANTITIES, 1e-15))
    told = replace(found, works=(exact,))
    (row,) = csv.DictReader(io.StringIO(told.csv()))
    assert row["below_reference"] == " ".join(QUANTITIES)
    assert float(row["force_error_median"]) == pytest.approx(found.floor["force"], rel=1e-3)
    assert f"| <{found.floor['force']:.0e} |" in told.table()
    drawn = [line for line in diagram(told).axes[0].lines if line.get_marker() == "s" and len(line.get_xdata())]
    assert {x for line in drawn for x in line.get_xdata()} == {found.floor["force"]}


def test_a_point_that_failed_is_shown_with_its_reason() -> None:
    found = quick()
    gone = replace(found.works[0], failures=("no equilibrium",), warm_failure="no way", warm=None)
    told = replace(found, works=(gone, replace(gone, median={}, worst={}, cold=None)))
    half, none = csv.DictReader(io.StringIO(told.csv()))
    assert (half["failed"], half["why"]) == ("1", "no equilibrium; warm: no way")
    assert none["force_error_median"] == none["cold_ms"] == ""
    assert "(1 of 2 failed)" in told.table() and "| failed |" in told.table()
    crosses = [line for line in diagram(told).axes[0].lines if line.get_marker() == "x" and len(line.get_xdata())]
    assert len(crosses) == 2


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


@pytest.mark.parametrize("shear", [False, True])
@pytest.mark.parametrize(("path", "parameter"), [(ROTATING, 0.0508), (ASSEMBLY, 0.064)], ids=["face", "jaw"])
def test_ipopt_s_answer_to_the_paper_s_discrete_problem_is_slsqp_s(path: Path, parameter: float, shear: bool) -> None:
    """Solver against solver: one problem, two optimisers."""
    scene = single_pose(scenefile.read(path), parameter)
    slsqp = solve_as_published(scene, N=20, shear="element" if shear else "none", ftol=1e-14)
    transcription = Transcription(scene, 20, shear=shear)
    x, multipliers, iterations, evaluations = transcription.solve(transcription.problem.start("arc"))
    assert transcription.problem.energy(x)[0] == pytest.approx(transcription.problem.energy(slsqp.x)[0], rel=1e-6)
    force = transcription.problem.force_on_object(x, multipliers)
    assert abs(force - complex(*slsqp.force_on_object)) < 1e-4 * abs(force)
    assert 0 < iterations <= evaluations


def test_an_object_without_an_expression_is_none_for_ipopt() -> None:
    scene = single_pose(scenefile.read(ROTATING), 0.0508)
    square = Polygon(vertices=((-0.02, -0.02), (0.02, -0.02), (0.02, 0.02), (-0.02, 0.02)))
    with pytest.raises(NoOutcomeError, match=r"Polygon has no expression g\(x, y\)"):
        Transcription(replace(scene, object=square.at(x=0.05, y=0.12)), 8, shear=True)


def test_every_method_is_measured() -> None:
    solved = ["gripper, p = 0", "gripper", "CasADi/IPOPT, the paper's problem", "CasADi/IPOPT as a whole (model built)"]
    published = ["paper as published", "paper as published, exact gradients"]
    assert list(dict.fromkeys(work.method for work in quick().works)) == [*published, *solved]
    cured = ["paper, shear cured", "paper, shear cured, exact gradients"]
    with_shear = [method.name for method in methods(replace(scenefile.read(ASSEMBLY), theory="shear"))]
    assert with_shear == [*published, *cured, *solved]
    assert all(work.cold is not None and work.setup > 0 for work in quick().works)


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
