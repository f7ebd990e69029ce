"""This project's friction beside the Tresca problems that SLSQP solves by itself."""

from __future__ import annotations

import csv
import dataclasses
import importlib.util
from pathlib import Path

import pytest

import gripper as gr
from gripper.study.tresca import Tresca
from gripper.study.tresca_cost import compared
from tests.scenes import follow, rotating_finger

SCRIPT = Path(__file__).parents[1] / "gallery" / "friction_models.py"
SPEC = importlib.util.spec_from_file_location("friction_models", SCRIPT)
MODULE = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(MODULE)


def test_behind_a_stick_tresca_problems_need_short_steps(tmp_path):
    """What does not depend on the steps is shown in tests/test_friction.py."""
    coarse, fine = MODULE.main(tmp_path, (6, 12))
    assert coarse.force_difference > 0.1  # it finds stick where slip has already turned
    assert fine.force_difference < 0.02
    assert 2 < fine.rounds < 7
    with (tmp_path / "friction_models.csv").open() as file:
        assert [float(value) for value in list(csv.reader(file))[1]] == pytest.approx(list(coarse))


def test_where_slip_does_not_turn_tresca_s_force_comes_nearer_with_the_spacing():
    def apart(parts):
        values = [0.0254 + 0.0127 * i / parts for i in range(parts + 1)]
        scene = rotating_finger(-0.1016, *values, theory="bending", friction=gr.Friction(coefficient=0.2))
        _, *solved = follow(scene)
        first, *rest = solved
        tresca = Tresca(first.setting, first.equilibrium)
        worst = 0.0
        for pose in rest:
            held, force = tresca.pose(pose.equilibrium.obstacle), complex(*pose.result.force_on_object_finger_frame)
            assert held.slip * first.equilibrium.state.sites[0].grip.sense > 0
            worst = max(worst, abs(held.force - force) / abs(force))
        return worst

    coarse, fine = apart(1), apart(4)
    assert coarse < 0.05
    assert fine < coarse / 3


def test_tresca_problems_take_one_contact_with_friction():
    *_, smooth = follow(rotating_finger(-0.1016, 0.0, theory="bending"))
    with pytest.raises(ValueError, match="start must have one contact"):
        Tresca(smooth.setting, smooth.equilibrium)


def test_a_comparison_with_tresca_problems_needs_a_way_to_its_first_pose():
    moving = MODULE.EXAMPLE
    still = dataclasses.replace(moving, finger=moving.finger.body, object=moving.object.body, motion=None)
    with pytest.raises(ValueError, match="scene must have a motion"):
        compared(still, (0.0254, 0.0381))
