"""Optimisation: optima that are known, limits that are kept, what is refused, and the command."""

from __future__ import annotations

import json
import signal

import numpy as np
import pytest
import sympy
from typer.testing import CliRunner

import gripper as gr
from gallery import constant_force, optimal_hook
from gripper.cli import app
from gripper.limits import Limits
from gripper.optimize import Interrupted
from gripper.optimize.evaluation import Evaluator
from gripper.optimize.goal import Goal
from gripper.optimize.scale import Scale
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
    assert best.evaluations == len(best.history) < 8


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


def test_limits_that_cannot_be_kept_end_with_a_verdict_and_the_design_that_violates_them_least():
    """Both forces go with the same factor where only the thickness is free: the least violation is their middle."""
    limits = {"max_insertion_force": 1.0, "min_retention_force": 4.0}
    best = gr.optimize(SNAP, {"finger.thickness": (0.002, 0.005)}, minimize="strain", limits=limits, starts=1)
    assert not best.kept
    over, under = best.verdicts
    assert over.excess == pytest.approx(under.excess, rel=1e-3)
    assert over.excess == min(trial.violation for trial in best.history)
    said = str(best)
    assert f"max_insertion_force 1: NOT KEPT: {over.value:.5g}, {100 * (over.value - 1):.3g} % too large" in said
    assert f"min_retention_force 4: NOT KEPT: {under.value:.5g}, {100 * (1 - under.value / 4):.3g} % too small" in said
    assert "NO DESIGN WAS FOUND THAT KEEPS ALL LIMITS: this one violates them least" in said
    assert "no design near keeps all limits" in best.message


def test_a_search_that_is_interrupted_holds_the_best_design_so_far_and_every_one_tried():
    def stop(done, best):
        if done == 3:
            raise KeyboardInterrupt

    limits = {"min_retention_force": 2.0}
    with pytest.raises(Interrupted, match="3 designs are solved") as caught:
        gr.optimize(
            SNAP, {"finger.thickness": (0.002, 0.005)}, minimize="insertion_force", limits=limits, progress=stop
        )
    found = caught.value.optimum
    assert found.evaluations == 3
    assert found.kept and found.objective == min(t.objective for t in found.history if t.violation < 1e-4)
    assert found.result.summary().insertion_force == found.objective


def test_gradients_are_those_of_central_differences():
    free = {"finger.thickness": (0.002, 0.005), "object.pose.y": (-0.012, -0.009)}
    limits = Limits({"max_strain": 0.01, "min_retention_ratio": 2.0, "max_insertion_force": 1.0})
    scale, x, found = Scale.of(free), np.array([0.4, 0.6]), {}
    for gradients in ("exact", "central"):
        evaluator = Evaluator(SNAP, scale, Goal("maximize", "retention_force"), limits, gradients)
        found[gradients], _ = evaluator.at(x)
        assert len(evaluator.history) == (1 if gradients == "exact" else 5)
    assert found["exact"].slopes == pytest.approx(found["central"].slopes, rel=1e-3, abs=1e-3)
    assert found["exact"].slopes.shape == (1 + 8 + 1 + 8, 2)
    assert (np.abs(found["exact"].slopes).max(axis=0) > 0.1).all()


def test_a_free_number_counts_by_ratios_where_it_is_positive_and_by_differences_where_it_is_not():
    scale = Scale.of({"finger.thickness": (0.001, 0.016), "finger.pose.y": (-0.02, 0.06), "finger.length": (1.0, 1.1)})
    assert scale.values(np.full(3, 0.5)) == pytest.approx([0.004, 0.02, 1.05])
    assert scale.place(scale.values(np.array([0.1, 0.9, 0.3]))) == pytest.approx([0.1, 0.9, 0.3])
    assert scale.place(np.array([1.0, -1.0, 1.2])) == pytest.approx([1.0, 0.0, 1.0])
    step = 1e-6
    rates = (scale.values(np.full(3, 0.5 + step)) - scale.values(np.full(3, 0.5 - step))) / (2 * step)
    assert scale.slopes(np.full(3, 0.5)) == pytest.approx(rates)


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
    judged = CliRunner().invoke(app, ["check", str(tmp_path / "hook.toml")])  # other commands read the same file
    assert (judged.exit_code, "limits kept: 0 of 1" in judged.output) == (1, True)


def test_an_interrupted_command_writes_the_history_and_the_best_design_so_far(tmp_path):
    (tmp_path / "hook.toml").write_text(DESIGN.replace("starts = 1", "starts = 1000"))
    before = signal.signal(signal.SIGPROF, signal.default_int_handler)  # as Ctrl-C, after CPU time instead of a key
    signal.setitimer(signal.ITIMER_PROF, 2.5)
    try:
        ran = CliRunner().invoke(app, ["optimize", str(tmp_path / "hook.toml"), "-o", str(tmp_path / "out")])
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
    assert ran.exit_code == 130, ran.output
    history = (tmp_path / "out" / "history.csv").read_text().splitlines()
    assert f"interrupted: {len(history) - 1} designs are solved; the best of them is written" in ran.output
    assert (tmp_path / "out" / "best.toml").exists() and (tmp_path / "out" / "result.json").exists()


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


def test_the_gallerys_profile_presses_with_an_almost_constant_force():
    thicknesses = (0.006, 0.045, 0.022486, 0.045, 0.023365)  # what gallery/constant_force.py finds
    found = {f"finger.thicknesses[{i}]": value for i, value in enumerate(thicknesses)}
    found |= {"finger.pose.x": 0.02466, "finger.pose.y": 0.010545}
    goal = Goal("flatten", "force_on_object")
    assert goal.value(gr.trace(constant_force.scene)) == pytest.approx(0.237, abs=1e-3)
    assert goal.value(gr.trace(replaced(constant_force.scene, found))) == pytest.approx(0.0302, abs=3e-4)
