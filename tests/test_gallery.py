"""The gallery's scripts run as they stand, and their numbers are the references' (tests/reference)."""

from __future__ import annotations

import importlib.util
import json
import math
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import pytest
from matplotlib.quiver import Quiver

from gripper import Motion, PoseResult, Result, Scene, solve, trace
from gripper.study.cases import maps, random
from gripper.study.robustness import Judged
from gripper.study.verdicts import verdicts
from gripper.testing import check_finger, check_object
from gripper.verify import verify
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Ellipse

ROOT = Path(__file__).parents[1]
OTHERS = (
    "cost",
    "error_against_time",
    "force_curves",
    "friction_models",
    "many_sides",
    "material_laws",
    "robustness",
    "optimal_hook",
    "constant_force",
    "designs_needed",
    "sensitivity_cost",
    "variants",
)
SCRIPTS = [
    p for p in sorted((ROOT / "gallery").glob("*.py")) if p.stem not in OTHERS
]  # the others have tests of their own, or are searches
BEAM = json.loads((ROOT / "tests/reference/beam.json").read_text())
EXACT = json.loads((ROOT / "tests/reference/exact.json").read_text())
FEM = json.loads((ROOT / "tests/reference/fem.json").read_text())
ROTATING = [("0.0508", "shear, mu = 0"), ("-0.0254", "shear, mu = 0")]
ASSEMBLY = [("0.064", "mu = 0")]  # the other pose of the reference, 0.06781, lies between two of the motion


def script(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


class Run(NamedTuple):
    """A script: its module, what its ``main`` gave, and the files that it wrote with their sizes."""

    module: ModuleType
    given: Any
    files: dict[str, int]

    @property
    def results(self) -> list[Result]:
        given = self.given
        if isinstance(given, Result):
            return [given]
        return list(given.values() if isinstance(given, dict) else given)


@cache
def run(name: str) -> Run:
    module = script(ROOT / "gallery" / f"{name}.py")
    with TemporaryDirectory() as folder:
        given = module.main(Path(folder, "made"))
        return Run(module, given, {path.name: path.stat().st_size for path in Path(folder, "made").iterdir()})


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
    ran = run(path.stem)
    assert not [pose for result in ran.results for pose in result.failed]
    assert f"{path.stem}.png" in ran.files
    assert all(size > 20_000 for size in ran.files.values())


@pytest.mark.parametrize(("place", "case"), ROTATING)
def test_the_rotating_finger_agrees_with_the_shooting_solution(place: str, case: str) -> None:
    reference = BEAM["rotating_finger"]["poses"][place][case]
    assert_agrees(at(run("rotating_finger").given, float(place)), reference, 0.1778, 1e-4)


@pytest.mark.parametrize(("place", "case"), ASSEMBLY)
def test_the_micro_assembly_agrees_with_the_shooting_solution(place: str, case: str) -> None:
    reference = BEAM["micro_assembly"]["poses"][place][case]
    assert_agrees(at(run("micro_assembly").given[0], float(place)), reference, 0.057, 1e-4)


def test_the_rotating_finger_agrees_with_finite_elements_of_the_beam_s_material_law() -> None:
    rows = FEM["rotating_finger"]["biot, mu = 0, 1296 elements"]
    for row in rows:
        pose, force = at(run("rotating_finger").given, row["x_e"]), np.array(row["force_on_object"])
        error = np.linalg.norm(pose.force_on_object_finger_frame - force) / np.linalg.norm(force)
        assert error < 0.006, f"{error:.2%} at x_e = {row['x_e']}"


def test_the_micro_assembly_agrees_with_finite_elements() -> None:
    rows = FEM["micro_assembly"]["rigid jaw, mu = 0, 4560 elements"]
    for row in (row for row in rows if row["x_o"] != 0.06781):  # that pose is figure 5's
        pose, force = at(run("micro_assembly").given[0], row["x_o"]), np.array(row["force_on_object"])
        assert pose.force_on_object_finger_frame == pytest.approx(force, abs=0.002 * max(np.linalg.norm(force), 1.0))


def test_the_rotating_finger_lets_go_where_the_reference_says() -> None:
    (release,) = (event for event in run("rotating_finger").given.events if event.kind == "release")
    assert release.parameter == pytest.approx(0.0694, abs=1e-4)


def test_the_micro_assembly_touches_where_the_reference_says_and_ends_free() -> None:
    result = run("micro_assembly").given[0]
    touch = next(event for event in result.events if event.kind == "touch")
    assert touch.parameter == pytest.approx(0.07756931, abs=1e-7)
    assert result.poses[-1].status == "free"


def test_figure_5_s_pose_agrees_with_the_shooting_solution() -> None:
    pose = run("micro_assembly").given[2].pose
    assert_agrees(pose, BEAM["micro_assembly"]["poses"]["0.06781"]["mu = 0"], 0.057, 1e-4)


def test_the_arrows_of_the_micro_assembly_s_two_fingers_keep_apart() -> None:
    ran = run("micro_assembly")
    figure = ran.given[1].filmstrip(ran.module.STAGES, mirror=ran.module.MIRROR)
    pairs = [[each for each in ax.collections if isinstance(each, Quiver)] for ax in figure.axes]
    heads = [[float(arrow.XY[0, 1] + arrow.V[0]) for arrow in pair] for pair in pairs if pair]
    assert len(heads) == 3
    assert all(above > 1e3 * ran.module.MIRROR[1] > below for above, below in heads)


def test_the_micro_assembly_with_friction_agrees_with_shooting_and_finite_elements_on_its_way_in() -> None:
    loop = run("micro_assembly").given[1]
    way_in = loop.poses[: len(loop.poses) // 2 + 1]
    known = BEAM["micro_assembly"]["poses"]["0.064"]["mu = 0.3"]
    pose = next(each for each in way_in if each.parameter == pytest.approx(0.064, abs=1e-9))
    assert pose.force_on_object_finger_frame == pytest.approx(known["force_on_object"], rel=1e-4)
    rows = [row for row in FEM["micro_assembly"]["rigid jaw, mu = 0.3, 4560 elements"] if row["x_o"] != 0.06781]
    assert len(rows) > 4
    for row in rows:
        each = next(each for each in way_in if each.parameter == pytest.approx(row["x_o"], abs=1e-9))
        force = np.array(row["force_on_object"])
        assert np.linalg.norm(each.force_on_object_finger_frame - force) < 0.004 * max(np.linalg.norm(force), 1.0)


def test_the_loop_of_the_micro_assembly_loses_what_it_takes_to_push_in_and_pull_off() -> None:
    loop = run("micro_assembly").given[1]
    place, force = (np.array([getattr(p, name) for p in loop.poses]) for name in ("parameter", "motion_force"))
    work = float(np.trapezoid(force, place))
    assert loop.loop.dissipation == pytest.approx(work, rel=0.02)  # 1 mm apart: trapezes see 2 % of the corners
    assert loop.loop.ratio > 0.9


def handbook() -> dict[str, float]:
    (given,) = (each for name, each in EXACT.items() if name.startswith("snap-fit handbook"))
    return given


def test_the_snap_hook_s_formulas_are_the_handbook_s() -> None:
    hook, known = run("snap_hook").module, handbook()
    assert hook.DEFLECTION_FORCE == pytest.approx(known["deflection force, N"], abs=0.05)
    assert hook.MATING_FORCE == pytest.approx(known["mating force, N"], abs=0.15)  # its 58.5 has the rounded 32.5 in it


def at_the_undercut(name: str) -> float:
    """The force that lifts the hook's tip by the undercut, in N."""
    ran = run("snap_hook")
    return -at(ran.given[name], ran.module.undercut).force_on_object[1]


def test_the_hook_lifted_on_its_axis_without_shear_has_the_exact_force_of_a_dead_load() -> None:
    """Its nose, 1 of 19 mm, is rigid: 6e-4 stiffer, which small deflections know too."""
    exact, hook = handbook()["large deflection, dead tip load, no shear: N"], run("snap_hook")
    assert at_the_undercut("bending") == pytest.approx(exact, rel=1e-3)
    first = hook.given["bending"].poses[1]
    stiffer = -first.force_on_object[1] / first.parameter * hook.module.undercut / hook.module.DEFLECTION_FORCE
    assert 1.0003 < stiffer < 1.001
    assert at_the_undercut("bending") / stiffer == pytest.approx(exact, rel=1e-4)


def test_large_deflection_and_shear_cancel_at_the_handbook_s_undercut() -> None:
    linear = handbook()["deflection force, N"]
    assert at_the_undercut("bending and shear") == pytest.approx(linear, rel=5e-3)
    assert at_the_undercut("bending") > 1.02 * linear
    first = run("snap_hook").given["bending and shear"].poses[1]
    assert -first.force_on_object[1] < 0.985 * linear * first.parameter / run("snap_hook").module.undercut


def test_the_real_ramp_needs_far_more_than_the_handbook_s_mating_force() -> None:
    assert run("snap_hook").given["mating"].loop.peak_insertion_force > 1.7 * handbook()["mating force, N"]


def test_on_the_real_ramp_the_hook_agrees_with_finite_elements() -> None:
    mating = run("snap_hook").given["mating"]
    scene = replace(mating.scene, motion=Motion("q", (0.0, 0.003)))
    (pose,) = verify(scene, [0.003], elements=(20, 2), laws=False).poses
    assert pose.force_difference < 0.006
    assert pose.mesh_error < 0.005
    assert pose.gripper.force == pytest.approx(at(mating, 0.003).force_on_object_finger_frame, rel=1e-6)


def test_friction_turns_the_ramp_of_the_hook_with_its_tip() -> None:
    hook, pose = run("snap_hook").module, at(run("snap_hook").given["mating"], 0.005)
    slope = math.tan(hook.lead + pose.tip_rotation)
    along, across = pose.force_on_object
    assert along / -across == pytest.approx((hook.mu + slope) / (1 - hook.mu * slope), rel=1e-9)


def exact_on_the_circle() -> float:
    """The force on the circle of the gallery's outlines, in N (EI = 1, L = 1 in the reference)."""
    (table,) = (each for name, each in EXACT.items() if name.startswith("uniform finger on a circle"))
    (row,) = (row for row in table["rows"] if row[:3] == [0.7, -0.2, 0])
    return row[table["columns"].index("N")] * run("outlines").module.EI / 0.1**2


@pytest.mark.parametrize(("name", "tolerance"), [("polygon", 0.05), ("spline", 5e-4)])
def test_outlines_through_points_of_a_circle_have_about_its_exact_force(name: str, tolerance: float) -> None:
    (contact,) = run("outlines").given[name].contacts
    assert contact.normal_force == pytest.approx(exact_on_the_circle(), rel=tolerance)


@pytest.mark.parametrize(("name", "number"), [("notch", 2), ("three pins", 3)])
def test_contacts_placed_by_linear_beam_theory_press_alike_where_deflections_are_small(name: str, number: int) -> None:
    outlines = run("outlines").module
    target = outlines.outlines(0.01)[name]
    contacts = solve(Scene(finger=outlines.finger, object=target, theory="bending")).contacts
    assert [contact.normal_force for contact in contacts] == pytest.approx([0.01] * number, rel=2e-4)


def test_error_against_time_finds_this_project_a_thousand_times_nearer_than_the_paper_s_scheme(tmp_path: Path) -> None:
    found = script(ROOT / "gallery/error_against_time.py").main(tmp_path, quick=True)
    assert (tmp_path / "error_against_time.png").stat().st_size > 50_000
    assert (tmp_path / "error_against_time.csv").read_text() == found.csv()
    best = {name: min(w.worst["force"] for w in found.works if w.method == name and w.worst) for name in METHODS}
    assert best["gripper"] < 1e-6 < 1e-3 < best["paper, shear cured, exact gradients"]
    published = next(work for work in found.works if work.method == "paper as published")
    assert published.unknowns == 16 and published.evaluations > 1000


METHODS = ("gripper", "paper, shear cured, exact gradients")


def test_robustness_judges_scenes_draws_them_and_goes_on_where_it_stopped(tmp_path: Path) -> None:
    robustness = script(ROOT / "gallery/robustness.py")
    lines = [case for case in maps() if case.family in ("shear stiffness", "scale")][::8]
    found = robustness.main(tmp_path, [*lines, *random(1)])
    assert [judged.verdict for judged in found] == ["solved"] * len(found)
    first = (tmp_path / "robustness.png").read_bytes()
    record = tmp_path / "robustness.csv"
    record.write_text(record.read_text().replace(",solved,", ",wrong,", 1))
    again = robustness.main(tmp_path, [*lines, *random(1)])
    assert [judged.verdict for judged in again].count("wrong") == 1  # read, not solved again
    assert (tmp_path / "robustness.png").read_bytes() != first


def test_the_map_of_a_verdict_has_its_value_across_and_every_scene_once() -> None:
    names = ["R/L = 1e-6", "R/L = 1e-2", "R/L = 1e1"]
    kinds = ["refused", "solved", "wrong"]
    found = [Judged("radius", name, True, kind, "", None, 0.2) for name, kind in zip(names, kinds, strict=True)]
    found += [Judged("flat", f"{n} sides", True, "solved", "", None, 0.1) for n in (3, 4)]
    radius, flat, key = verdicts(found).axes
    drawn = {float(x) for line in radius.lines for x in line.get_xdata()}
    assert (radius.get_xlabel(), radius.get_xscale(), drawn) == ("R/L", "log", {1e-6, 1e-2, 1e1})
    assert (flat.get_xlabel(), flat.get_xscale()) == ("scene", "linear")
    assert [text.get_text() for text in key.get_legend().get_texts()] == ["solved: 3", "refused: 1", "wrong: 1"]
    with pytest.raises(ValueError, match="found must hold at least one scene"):
        verdicts([])


def test_a_plugin_s_object_and_finger_are_the_built_in_ones_where_they_coincide() -> None:
    author = run("plugin_author").module
    egg = replace(author.scene.object, body=replace(author.scene.object.body, bluntness=0.0))
    own = replace(author.scene, object=egg, finger=replace(author.scene.finger, depth=0.0))
    finger = Uniform(length=0.15, thickness=0.02, width=0.025, material=author.rubber)
    built_in = replace(own, finger=finger, object=Ellipse(semi_axes=(0.04, 0.025)).at(**vars(own.object.pose)))
    last = [replace(each, motion=Motion("q", (-0.04, -0.02, 0.0))) for each in (own, built_in)]
    one, other = (trace(each).poses[-1] for each in last)
    assert one.force_on_object == pytest.approx(other.force_on_object, rel=1e-7)


def test_a_plugin_passes_every_check_of_the_kit() -> None:
    scene = run("plugin_author").module.scene
    check_object(scene.object.body)
    check_finger(scene.finger)


def test_a_polygon_of_many_sides_has_nearly_its_circle_s_energy(capsys: pytest.CaptureFixture[str]) -> None:
    rows = list(script(ROOT / "gallery" / "many_sides.py").main(count=1, sides=60, repeats=1))
    table = capsys.readouterr().out.splitlines()[1:]
    assert [line.split()[0] for line in table] == ["bending", "shear"] and len(rows) == 2
    assert all(float(line.split()[-1]) < 0.05 for line in table)
