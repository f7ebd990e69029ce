"""Optimisation: optima that are known, limits that are kept, what is refused, and the command."""

from __future__ import annotations

import json

import numpy as np
import pytest
import sympy
from typer.testing import CliRunner

import gripper as gr
from gallery import optimal_hook
from gripper.cli import app
from gripper.optimize.goal import Goal
from gripper.parameters import numbers, replaced
from gripper.sensitivity.curves import curve
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.objects.circle import Circle
from tests.scenes import PIN, STRIP, micro_assembly, unit_finger

SNAP = micro_assembly(*np.linspace(0.086, 0.05, 7))


def test_the_softest_finger_within_a_retention_has_just_that_retention():
    limits = {"min_retention_force": 2.0, "max_strain": 0.02}
    best = gr.optimize(SNAP, {"finger.thickness": (0.002, 0.005)}, minimize="insertion_force", limits=limits, starts=1)
    thickness = numbers(SNAP)["finger.thickness"]
    softer = (2.0 / gr.trace(SNAP).summary().retention_force) ** (1 / 3) * thickness  # EI goes with w^3
    assert best.kept
    assert best.result.summary().retention_force == pytest.approx(2.0, rel=1e-3)
    assert best.values["finger.thickness"] == pytest.approx(softer, rel=0.02)  # the face moves by w / 2 too
    assert best.objective < best.objective_before
    assert best.evaluations == len(best.history) < 15


def test_the_least_strain_of_a_beam_on_a_pin_is_that_of_the_thinnest_within_a_force():
    """Bending: a pin that lifts a cantilever by d needs F ~ w^3 and leaves a strain ~ w: the force decides."""
    scene = gr.Scene(finger=unit_finger(0.04), object=Circle(radius=0.1).at(x=0.6, y=-0.1), theory="bending")
    known = gr.solve(scene).summary()
    limits = {"min_force_on_object": known.force_on_object / 2}
    best = gr.optimize(scene, {"finger.thickness": (0.02, 0.05)}, minimize="strain", limits=limits, starts=2)
    assert best.kept
    assert best.result.summary().force_on_object == pytest.approx(known.force_on_object / 2, rel=1e-3)
    assert {trial.start for trial in best.history} == {0, 1}


def test_a_flat_force_is_found_where_two_poses_can_have_the_same():
    q = sympy.Symbol("q")
    soft = gr.Material(youngs_modulus=4.8e6, poisson_ratio=0.4)
    finger = Uniform(length=0.18, thickness=0.02, width=0.025, material=soft).at()
    pin = Circle(radius=0.02).at(x=0.11 + q, y=-0.02)
    scene = gr.Scene(finger=finger, object=pin, motion=gr.Motion("q", (0.0, 0.01)), theory="bending")
    best = gr.optimize(scene, {"finger.pose.angle": (-0.2, 0.0)}, flatten="force_on_object", starts=1)
    values = curve(best.result, "force_on_object")
    assert best.objective == pytest.approx((values.max() - values.min()) / values.mean())
    assert best.objective < 0.85 * best.objective_before


def test_what_cannot_be_searched_is_refused():
    free = {"finger.thickness": (0.002, 0.005)}
    with pytest.raises(ValueError, match="one of minimize, maximize and flatten must be given; got 0"):
        gr.optimize(SNAP, free)
    with pytest.raises(LookupError, match="unknown quantity to minimize 'insertion'; known: insertion_force"):
        gr.optimize(SNAP, free, minimize="insertion")
    with pytest.raises(LookupError, match=r"unknown number 'finger\.thicknes'"):
        gr.optimize(SNAP, {"finger.thicknes": (0.002, 0.005)}, minimize="strain")
    with pytest.raises(ValueError, match=r"bounds of finger\.thickness must be two numbers, the first smaller"):
        gr.optimize(SNAP, {"finger.thickness": (0.005, 0.002)}, minimize="strain")
    with pytest.raises(ValueError, match="limits must be on insertion_force"):
        gr.optimize(SNAP, free, minimize="strain", limits={"max_work_in": 1.0})
    with pytest.raises(LookupError, match="unknown quantity to flatten 'retention_ratio'"):
        Goal("flatten", "retention_ratio")


DESIGN = f"""{STRIP}[finger.jaw]
shape = "triangle"
length = "19 mm"
lead_angle = "20 deg"
return_angle = "60 deg"
{PIN}[object.pose]
x = "x_o"
y = "-10.5 mm"
[motion]
parameter = "x_o"
from = 0.086
to = 0.050
poses = 7
[solver]
theory = "bending"
[limits]
max_insertion_force = "2 N"
[optimize]
maximize = "retention_force"
starts = 1
[optimize.free]
"finger.thickness" = ["2 mm", "5 mm"]
finger.jaw.return_angle = ["45 deg", "80 deg"]
"""


def test_the_command_writes_the_best_design_and_every_one_that_it_tried(tmp_path):
    (tmp_path / "hook.toml").write_text(DESIGN)
    ran = CliRunner().invoke(app, ["optimize", str(tmp_path / "hook.toml"), "-o", str(tmp_path / "out")])
    assert ran.exit_code == 0, ran.output
    assert "max_insertion_force 2: kept" in ran.output
    written = json.loads((tmp_path / "out" / "result.json").read_text())
    assert written["summary"]["insertion_force"] == pytest.approx(2.0, rel=1e-3)
    history = (tmp_path / "out" / "history.csv").read_text().splitlines()
    assert history[0] == "start,finger.thickness,finger.jaw.return_angle,retention_force,violation,reason"
    assert f"{len(history) - 1} designs solved" in ran.output
    assert (tmp_path / "out" / "best.toml").read_text().count("[finger.jaw]") == 1


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('maximize = "retention_force"', "", "one of minimize, maximize and flatten must be given"),
        ('"finger.thickness" = ["2 mm", "5 mm"]', '"finger.thickness" = ["5 mm", "2 mm"]', "the first smaller"),
        ('"finger.thickness"', '"finger.girth"', "unknown number 'finger.girth'"),
        ("starts = 1", "tries = 1", "tries: must be one of minimize"),
        ("[optimize.free]", "[optimize.released]", "released: must be one of minimize"),
    ],
)
def test_a_bad_design_is_one_message_and_exit_status_2(tmp_path, old, new, message):
    assert old in DESIGN
    (tmp_path / "bad.toml").write_text(DESIGN.replace(old, new))
    ran = CliRunner().invoke(app, ["optimize", str(tmp_path / "bad.toml"), "-o", str(tmp_path / "out")])
    assert ran.exit_code == 2
    assert message in ran.output
    assert "Traceback" not in ran.output
    assert not (tmp_path / "out").exists()
    assert len(ran.output.strip().splitlines()) == 1


def test_the_gallerys_hook_is_easier_to_close_and_holds_as_before():
    found = {
        "finger.thickness": 0.0052233,
        "finger.length": 0.061943,
        "finger.jaw.lead_angle": 0.069813,
        "finger.jaw.return_angle": 1.5359,
    }  # what gallery/optimal_hook.py finds
    before = gr.trace(optimal_hook.scene).summary()
    after = gr.trace(replaced(optimal_hook.scene, found)).summary()
    assert after.insertion_force < 0.5 * before.insertion_force
    assert after.retention_force == pytest.approx(2.5, rel=1e-3)
    assert after.retention_ratio > 2
    assert after.strain < 0.015
