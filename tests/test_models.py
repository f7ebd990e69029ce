"""The ladder of models, from the handbook's formula to finite elements, against closed forms and reference files."""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from typer.testing import CliRunner

import gripper as gr
from gripper import scenefile
from gripper.cli import app
from gripper.statics.ladder import RUNGS
from gripper.study.line_model import as_line
from gripper.study.models import Ladder, models
from gripper.study.small import NoModelError, handbook, linear
from gripper_plugins.objects import Circle, HalfPlane
from tests.scenes import TAPERED, unit_finger

ROOT = Path(__file__).parents[1]
ASSEMBLY, ROTATING = ROOT / "gallery/micro_assembly.toml", ROOT / "gallery/rotating_finger.toml"
PLACE = 0.064
FEM = json.loads((ROOT / "tests/reference/fem.json").read_text())


def pressed(depth: float, x: float = 0.7, radius: float = 0.05, **options: object) -> gr.Scene:
    """A unit finger (EI = L = 1) that a small pin lifts by this much."""
    finger = unit_finger(**options)
    place = Circle(radius=radius).at(x=x, y=-radius - 0.03 + depth)
    return gr.Scene(finger=finger, object=place, theory="bending", tolerance=1e-8)


@pytest.mark.parametrize("x", [0.3, 0.7, 0.95])
def test_small_deflections_and_handbook_give_a_cantilever_s_force(x: float) -> None:
    """P = 3 E I y / a^3, here with E I = 1; the line of places is 1/200 fine."""
    for model in (handbook, linear):
        force = model(pressed(1e-3, x), None).force
        assert -force.imag == pytest.approx(3e-3 / x**3, rel=0.02)
        assert abs(force.real) < 0.15 * abs(force.imag)


def test_all_models_agree_where_deflections_are_small() -> None:
    scene = pressed(1e-3, radius=0.5)  # the line of places misses its top by 3e-6
    exact = gr.solve(scene).force_on_object
    for force in (handbook(scene).force, linear(scene).force):
        assert force.imag == pytest.approx(exact[1], rel=0.02)


def test_two_contacts_are_the_linear_beam_s_too() -> None:
    """A finger lifted by a flat bed touches at the bed's near end alone: it rises no steeper than straight beyond."""
    scene = gr.Scene(finger=unit_finger(), object=HalfPlane().at(x=0.0, y=-0.03), theory="bending")
    assert linear(scene).force == 0
    lifted = replace(scene, object=HalfPlane().at(x=1.0, y=-0.028, angle=0.02))
    force = -linear(lifted).force.imag
    assert force > 0


def test_a_tapered_finger_has_no_handbook_formula() -> None:
    with pytest.raises(NoModelError, match="uniform arm"):
        handbook(gr.Scene(finger=TAPERED, object=Circle(radius=0.01).at(x=0.1, y=-0.02)))


@pytest.mark.parametrize("theory", RUNGS)
def test_a_line_has_its_finger_s_stiffness_and_touches_half_a_thickness_later(theory: str) -> None:
    """Bending only, a uniform finger of thickness w on a circle R is a line on R + w / 2 (here of w / 10000)."""
    scene = replace(pressed(0.1, radius=0.25), theory=theory)
    line = as_line(scene)
    thicker = replace(line, object=Circle(radius=0.28).at(x=0.7, y=-0.25 - 0.03 + 0.1))
    one, other = gr.solve(scene).force_on_object, gr.solve(thicker).force_on_object
    assert math.dist(one, other) < (5e-4 if theory == "bending" else 1e-2) * math.hypot(*one)


def test_the_line_s_jaw_is_where_the_finger_has_it() -> None:
    scene = replace(scenefile.read(ASSEMBLY), theory="bending")
    scene = replace(scene, motion=gr.Motion("x_o", (0.077, 0.065)))
    for one, other in zip(gr.trace(scene).poses, gr.trace(as_line(scene)).poses, strict=True):
        assert one.force_on_object == pytest.approx(other.force_on_object, rel=1e-6)


@cache
def ladder() -> Ladder:
    return models(scenefile.read(ASSEMBLY), [PLACE], quick=True)


def test_every_model_is_there_and_those_of_large_deflections_agree_with_the_elements() -> None:
    found = {rung.model: rung.difference for rung in ladder().rungs}
    assert list(found) == ["handbook formula", "small deflections", "finger as a line", *RUNGS, "finite elements"]
    assert 0.03 < min(found["handbook formula"], found["small deflections"])
    assert max(found["handbook formula"], found["small deflections"]) < 0.25
    assert max(found[RUNGS[0]], found["finger as a line"]) < 0.005


def test_the_elements_are_those_of_the_reference() -> None:
    rows = FEM["micro_assembly"]["rigid jaw, mu = 0, 4560 elements"]
    expected = next(row["force_on_object"] for row in rows if row["x_o"] == PLACE)
    assert math.dist(ladder().rungs[-1].force, expected) < 0.005 * math.hypot(*expected)
    assert ladder().mesh_error < 0.01


def test_the_command_writes_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gripper.study.models.models", lambda *_, **__: ladder())
    done = CliRunner().invoke(app, ["study", str(ASSEMBLY), "--models", "-o", str(tmp_path), "--at", "0.065"])
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader(io.StringIO((tmp_path / "models.csv").read_text())))
    assert [row["model"] for row in rows] == [rung.model for rung in ladder().rungs]
    assert "finite elements" in done.output


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--models", "--robustness"], "must not stand together"),
        ([], "a scene must be given"),
        ([str(ASSEMBLY), "--robustness"], "a scene must be given"),
        ([str(ASSEMBLY), "--at", "0.06", "--at", "0.07"], "--at must be one pose"),
    ],
)
def test_options_that_do_not_fit_are_told(arguments: list[str], words: str) -> None:
    done = CliRunner().invoke(app, ["study", *arguments])
    assert done.exit_code == 2
    assert words in done.stderr
