"""The judges of robustness find what is wrong when something is, and a small study of scenes comes out right."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from typer.testing import CliRunner

import gripper as gr
from gripper.cli import app
from gripper.study import oracles
from gripper.study.cases import Body, Case, case, circle, maps, random, uniform
from gripper.study.robustness import Judged, judge, read, study, summary, unlike

PLAIN = case("plain", "pin", uniform(0.05), circle(0.1), 0.7, 0.1)


@cache
def lines() -> list[Case]:
    return list(maps())


@cache
def solved() -> gr.Result:
    return gr.trace(PLAIN.moving((0.0, 0.5, 0.99, 0.995, 1.0)))


@pytest.mark.parametrize("index", range(0, 12))
def test_random_scenes_are_solved_and_no_judge_objects(index: int) -> None:
    wanted = list(random(24))[2 * index]
    judged = judge(wanted, descend=index % 6 == 0)
    assert judged.verdict == "solved", judged


MENDED = (
    "place: s/L = 0.02",  # the first touch near the clamp: predicted with a segment of its own
    "place: s/L = 0.05",
    "radius: R/L = 1e-6",  # thinner than what lies between two samples of the outline
    "radius: R/L = 1e-4",
    "taper: tip/base = 1e+03",  # all curvature within a thousandth of the finger
    "random: 0/3",  # narrower than the patch that Newton finds: a place of its own all the same
)


@pytest.mark.parametrize("key", MENDED)
def test_what_was_once_refused_or_wrong_is_solved(key: str) -> None:
    wanted = next(each for each in (*lines(), *random(4)) if each.key == key)
    judged = judge(wanted)
    assert judged.verdict == "solved", judged


def test_scenes_are_the_same_however_many_are_asked_for() -> None:
    assert list(random(3, seed=7)) == list(random(9, seed=7))[:3]
    assert list(random(1, seed=7)) != list(random(1, seed=8))


def test_every_map_has_scenes_with_names_of_their_own() -> None:
    keys = [wanted.key for wanted in (*lines(), *random(5))]
    assert len(set(keys)) == len(keys) > 100
    families = {"shear stiffness", "slenderness", "taper", "place", "radius", "indentation", "wrapping", "corner"}
    assert {wanted.family for wanted in lines()} == families | {"flat", "head-on", "scale"}


def test_a_finger_drawn_through_the_object_overlaps() -> None:
    right = solved().poses[-1]
    assert oracles.overlap(PLAIN, right, 1.0) is None
    straight = replace(right, shape=solved().poses[0].shape)
    assert "overlap" in oracles.overlap(PLAIN, straight, 1.0)


def test_a_force_that_is_not_the_energy_s_slope_is_told() -> None:
    poses = solved().poses[-3:]
    assert oracles.energy_slope(poses, 0.01) is None
    wrong = [replace(pose, motion_force=1.01 * pose.motion_force) for pose in poses]
    assert "energy" in oracles.energy_slope(wrong, 0.01)


def test_another_branch_is_told_by_its_force() -> None:
    right = solved().poses[-1]
    assert oracles.other_steps(right, right) is None
    assert "branch" in oracles.other_steps(right, replace(right, force_on_object=(0.0, 1.0)))


def test_a_strut_that_buckles_without_a_word_is_told() -> None:
    strut = next(wanted for wanted in lines() if wanted.family == "head-on")
    assert "undecided" in oracles.undecided(strut, solved())
    assert oracles.undecided(PLAIN, solved()) is None
    silent = replace(solved(), events=())
    assert oracles.undecided(strut, silent) is None  # never touched


@pytest.mark.parametrize("body", [circle(0.1), Body("ellipse", (0.2, 0.1, 0.5))], ids=["circle", "ellipse"])
@pytest.mark.parametrize("theory", ["bending", "shear"])
def test_a_chain_that_descends_ends_where_the_solver_does(body: Body, theory: str) -> None:
    wanted = case("chain", "links", uniform(0.1), body, 0.7, 0.2, theory=theory)
    result = gr.trace(wanted.moving((0.0, 1.0)))
    assert oracles.descent(wanted, result) is None
    pose = result.poses[-1]
    mirrored = replace(pose.shape, axis=pose.shape.axis * (1, -1))
    below = replace(pose, energy=2 * pose.energy, shape=mirrored)
    assert "descent" in oracles.descent(wanted, replace(result, poses=(*result.poses[:-1], below)))


def test_a_scene_that_presses_on_the_clamp_is_not_built_to_have_an_equilibrium() -> None:
    assert PLAIN.built
    assert not case("clamp", "wide", uniform(0.05), circle(2.0), 0.3, 0.1).built


def test_units_change_nothing() -> None:
    family = [wanted for wanted in lines() if wanted.family == "scale"]
    assert unlike(judge(wanted) for wanted in family[::3]) < 1e-6


def test_a_study_goes_on_where_it_stopped_and_counts_its_scenes(tmp_path: Path) -> None:
    record = tmp_path / "robustness.csv"
    first = study([PLAIN], record)
    marked = record.read_text().replace(",solved,", ",refused,")
    record.write_text(marked)
    again = study([PLAIN, *random(1)], record)
    assert [judged.verdict for judged in first] == ["solved"]
    assert [judged.verdict for judged in again] == ["refused", "solved"]  # the first is read, not solved again
    assert read(record) == again
    text = summary(again)
    assert "| plain | 1 | 0 | 1 | 0 |" in text
    assert "1 of 2 scenes built" in text
    assert f"below {100 * (1 - math.sqrt(0.05)):.2g} %" in text


def test_a_wrong_scene_is_counted_and_ends_the_command_with_status_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def wrong(wanted: Case, **_: object) -> Judged:
        return Judged(wanted.family, wanted.name, True, "wrong", "overlap", None, 0.1)

    monkeypatch.setattr("gripper.study.robustness.judge", wrong)
    done = CliRunner().invoke(app, ["study", "--robustness", "--quick", "--scenes", "2", "-o", str(tmp_path)])
    assert done.exit_code == 1
    assert "wrong: overlap" in done.output
    assert (tmp_path / "robustness.csv").exists()
