"""gripper explain says what a scene needs, with numbers that are those of the solver and of the results."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from typer.testing import CliRunner

import gripper as gr
from gripper.cli import app
from gripper.explain import Decision, Explanation, explain
from tests.scenes import micro_assembly, rotating_finger

GALLERY = Path(__file__).parents[1] / "gallery"
SCENES = {"rotating finger": rotating_finger(-0.0254, 0.2), "jaw": micro_assembly(0.08, 0.065)}


@cache
def explained(name: str) -> Explanation:
    return explain(SCENES[name])


def decision(name: str, what: str) -> Decision:
    return next(found for found in explained(name).decisions if found.what.startswith(what))


@pytest.mark.parametrize(("name", "needed"), [("rotating finger", True), ("jaw", False)])
def test_shear_is_told_with_what_it_changes(name: str, needed: bool) -> None:
    found = decision(name, "shear")
    assert found.needed == needed
    forces = [
        max(math.hypot(*(p.force_on_object)) for p in gr.trace(replace(SCENES[name], theory=theory)).poses)
        for theory in ("bending", "shear")
    ]
    told = float(found.why.split(" by ")[1].split(" %")[0]) / 100
    assert told == pytest.approx(1 - forces[1] / forces[0], rel=0.15)


@pytest.mark.parametrize("name", list(SCENES))
def test_what_touches_is_constrained_and_what_does_not_is_left_out(name: str) -> None:
    touched = {contact.on for pose in gr.trace(SCENES[name]).poses for contact in pose.contacts}
    assert touched == {"rotating finger": {"lower"}, "jaw": {"jaw"}}[name]
    assert decision(name, "contact on the lower face").needed == ("lower" in touched)
    assert not decision(name, "contact on the upper face").needed
    assert not decision(name, "friction").needed
    assert "1 of 2 poses" in decision(name, "contact on the " + ("lower" if "lower" in touched else "jaw")).why


@pytest.mark.parametrize("name", list(SCENES))
def test_the_size_is_that_of_the_problem_that_slsqp_sees(name: str) -> None:
    touching = {"rotating finger": -0.0254, "jaw": 0.065}[name]
    problem = gr.assemble(SCENES[name], touching)
    expected = f"SLSQP sees {problem.size} unknowns and {len(problem.candidates)} constraint"
    assert explained(name).sizes[0].startswith(expected)
    assert problem.size <= 40


def test_solving_needs_no_drawing_no_command_line_and_no_other_optimiser() -> None:
    used, unused = explained("jaw").packages
    assert used == ("sympy", "numpy", "scipy")
    assert set(unused) >= {"matplotlib", "pydantic", "typer", "rich", "casadi"}


def test_friction_is_needed_where_it_is_asked_for() -> None:
    rough = replace(SCENES["jaw"], friction=gr.Friction(coefficient=0.1))
    assert next(found for found in explain(rough).decisions if found.what == "friction").needed


def test_the_stretch_of_the_axis_is_told_once_with_what_it_changes() -> None:
    scene = SCENES["rotating finger"]
    told = [found for found in explained("rotating finger").decisions if found.what.startswith("stretch")]
    assert [found.needed for found in told] == [False]
    forces = [
        math.hypot(*gr.trace(replace(scene, theory=theory)).poses[0].force_on_object) for theory in ("shear", "stretch")
    ]
    assert float(told[0].why.split(" by ")[1].split(" %")[0]) / 100 == pytest.approx(1 - forces[1] / forces[0], rel=0.3)


def test_a_shape_at_rest_and_a_law_are_needed_where_they_are_given() -> None:
    plain = {found.what: found for found in explained("jaw").decisions}
    assert not plain["shape at rest"].needed and not plain["material law"].needed
    assert plain["material law"].why.startswith("linear: ")
    assert len([name for name in plain if "law" in name]) == 1
    finger = SCENES["jaw"].finger
    bent = replace(SCENES["jaw"], finger=replace(finger, rest_curvature=-0.5))
    assert next(found for found in explain(bent).decisions if found.what == "shape at rest").needed


def test_a_scene_without_contact_says_that_nothing_touches() -> None:
    text = str(explain(rotating_finger(0.15, 0.2)))
    assert "nothing touches" in text
    assert "0 constraints (nothing is near)" in text
    assert "nothing touches at any pose: the least distance of finger and object is 0.03" in text


def test_the_command_prints_it_and_a_bad_scene_ends_with_status_2(tmp_path: Path) -> None:
    short = tmp_path / "short.toml"
    short.write_text((GALLERY / "micro_assembly.toml").read_text().replace("poses = 37", "poses = 2"))
    done = CliRunner().invoke(app, ["explain", str(short)])
    assert done.exit_code == 0, done.output
    for part in ("Micro-assembly finger", "SLSQP sees", "needed", "left out", "not needed for it: shapely"):
        assert part in done.output
    bad = tmp_path / "bad.toml"
    bad.write_text("title = 1")
    done = CliRunner().invoke(app, ["explain", str(bad)])
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith(f"{bad}: ")
