"""Limits on the summary's numbers, and the command that judges a scene by them."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

import gripper as gr
from gripper import scenefile
from gripper.cli import app
from gripper.limits import LIMITS
from gripper.results.summary import QUANTITIES, Summary

MICRO = (
    (Path(__file__).parent.parent / "gallery" / "micro_assembly.toml").read_text().replace("poses = 37", "poses = 7")
)
KNOWN = Summary(insertion_force=3.0, insertion_force_at=0.07, strain=0.01, strain_at=0.06, poses=5, failed=0, locked=0)


def check(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return CliRunner().invoke(app, ["check", str(path)])


def test_every_quantity_has_a_largest_and_a_least_limit():
    assert len(LIMITS) == 2 * len(QUANTITIES)
    assert set(QUANTITIES) <= set(Summary.__dataclass_fields__)


@pytest.mark.parametrize(("name", "bound", "kept"), [("max_strain", 0.02, True), ("max_strain", 0.005, False)])
def test_a_limit_is_kept_up_to_its_bound(name, bound, kept):
    (verdict,) = gr.judged(gr.Limits({name: bound}), KNOWN)
    assert (verdict.passed, verdict.value, verdict.at) == (kept, 0.01, 0.06)


def test_at_the_bound_a_limit_is_kept_on_both_sides():
    assert all(v.passed for v in gr.judged(gr.Limits({"max_strain": 0.01, "min_strain": 0.01}), KNOWN))


def test_what_is_not_known_is_not_kept():
    (verdict,) = gr.judged(gr.Limits({"min_retention_force": 1.0}), KNOWN)
    assert not verdict.passed and verdict.reason == "not known: the motion does not come back (back = true)"
    failed = Summary(strain=0.01, poses=5, failed=2, locked=0)
    (verdict,) = gr.judged(gr.Limits({"max_strain": 0.02}), failed)
    assert not verdict.passed and verdict.reason == "not shown: 2 of 5 poses failed"


def test_a_finger_that_locks_in_keeps_any_least_retention_and_no_largest():
    locked = Summary(insertion_force=3.0, poses=5, failed=0, locked=1)
    limits = gr.Limits({"min_retention_force": 1e6, "max_retention_force": 1e6})
    assert [v.passed for v in gr.judged(limits, locked)] == [True, False]


def test_an_unknown_limit_lists_the_known_ones():
    with pytest.raises(LookupError, match=r"unknown limit 'max_force'; known: max_insertion_force.*"):
        gr.Limits({"max_force": 1.0})


def test_check_prints_each_limit_with_the_pose_that_decides_and_ends_with_0_or_1(tmp_path):
    limits = '[limits]\nmax_insertion_force = "6 N"\nmin_retention_force = 2\nmax_strain = 0.015\n'
    kept = check(tmp_path, MICRO + limits)
    assert (kept.exit_code, kept.stderr) == (0, "")
    lines = kept.stdout.splitlines()
    assert [line.split()[:2] for line in lines[:3]] == [
        ["pass", "max_insertion_force"],
        ["pass", "min_retention_force"],
        ["pass", "max_strain"],
    ]
    assert re.fullmatch(r"pass  max_insertion_force +6 N   2\.2484 N at x_o = 0\.0649053", lines[0])
    assert lines[3] == "limits kept: 3 of 3"
    broken = check(tmp_path, MICRO + limits.replace("6 N", "2 N"))
    assert broken.exit_code == 1
    assert broken.stdout.splitlines()[0].startswith("FAIL  max_insertion_force")
    assert broken.stdout.splitlines()[-1] == "limits kept: 2 of 3"


@pytest.mark.parametrize("text", [MICRO, MICRO + "[limits]\nmax_force = 3\n", "nonsense"])
def test_a_bad_scene_or_one_without_limits_ends_check_with_2_and_one_message(tmp_path, text):
    outcome = check(tmp_path, text)
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert len(outcome.stderr.splitlines()) == 1 and "must" in outcome.stderr


def test_limits_and_tolerances_are_written_and_read_back():
    text = MICRO + '[limits]\nmax_strain = 0.015\n[tolerance]\n"finger.length" = "0.1 mm"\nobject.pose.y = 1e-4\n'
    scene = scenefile.loads(text)
    assert scene.limits == gr.Limits({"max_strain": 0.015})
    assert scene.tolerances == gr.Tolerances({"finger.length": 1e-4, "object.pose.y": 1e-4})
    again = scenefile.loads(scenefile.dumps(scene))
    assert (again.limits, again.tolerances) == (scene.limits, scene.tolerances)
