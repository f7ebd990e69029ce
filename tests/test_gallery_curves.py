"""The force curves of the gallery: numbers of every line of every figure, from elsewhere (tests/reference)."""

from __future__ import annotations

import json
import math
from functools import cache

import pytest
from scipy.optimize import brentq

from gripper.plot import sticks
from gripper.study.beside import beside_elements
from tests import scenes
from tests.test_gallery import ROOT, script

BEAM = json.loads((scenes.REFERENCE / "beam.json").read_text())
FEM = json.loads((scenes.REFERENCE / "fem.json").read_text())
SCRIPT = script(ROOT / "gallery" / "force_curves.py")
COARSE = (27, 3)  # elements; the script's own have an eighth of their error


@cache
def rotating(mu):
    return SCRIPT.rotating(mu, poses=8, found=3, mesh=COARSE)  # every 25.4 mm, as the reference


@cache
def assembly(mu):
    return SCRIPT.assembly(mu, poses=16, found=3, mesh=COARSE)  # every 2 mm


def force(result, place):
    (pose,) = (each for each in result.poses if each.parameter == pytest.approx(place, abs=1e-9))
    return pose.force_on_object_finger_frame


def assert_close(found, expected, within):
    assert math.dist(found, expected) <= within * math.hypot(*expected)


@pytest.mark.parametrize("theory", ["shear", "bending"])
@pytest.mark.parametrize("place", [0.0508, -0.0254])
def test_the_curves_of_figure_8_pass_through_the_shooting_solution(theory, place):
    expected = BEAM["rotating_finger"]["poses"][str(place)][f"{theory}, mu = 0"]["force_on_object"]
    assert_close(force(rotating(0.0).results[theory], place), expected, 1e-4)


def test_the_finger_as_a_line_lets_go_where_its_straight_axis_touches_the_ellipse():
    def apart(x):
        turn = math.radians(102 - 236.22 * x)
        size = math.hypot(0.04953 * math.sin(turn), 0.033655 * math.cos(turn))
        return x * math.sin(turn) - 0.12065 * math.cos(turn) - size

    (release,) = (each for each in rotating(0.0).results["bending, finger as a line"].events if each.kind == "release")
    assert release.parameter == pytest.approx(brentq(apart, 0.04, 0.06), abs=2e-5)


def test_the_finite_elements_of_figure_8_are_the_reference_and_close_to_shear_alone():
    curves = rotating(0.0)
    rows = {row["x_e"]: row["force_on_object"] for row in FEM["rotating_finger"]["svk, mu = 0, 5184 elements"]}
    first = curves.elements.poses[0]
    assert_close(first.elements.force, rows[-0.1016], 0.003)
    differences = [math.dist(force(each, -0.1016), rows[-0.1016]) for each in curves.results.values()]
    assert [d / math.hypot(*rows[-0.1016]) for d in differences] == pytest.approx([0.0083, 0.044, 0.24], rel=0.1)


def test_figure_9_marks_where_the_contact_sticks():
    ((begin, end),) = sticks(rotating(0.2).results["shear"])
    assert (begin, end) == pytest.approx((0.0477, 0.05051), abs=2e-5)  # beam.json, rising
    rows = {
        row["x_e"]: row["force_on_object"] for row in FEM["rotating_finger"]["svk, mu = 0.2, x_e rising, 1296 elements"]
    }
    assert_close(rotating(0.2).elements.poses[0].elements.force, rows[-0.1016], 0.003)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_figures_3_and_4_are_the_reference_and_the_finite_elements(mu):
    curves = assembly(mu)
    rows = FEM["micro_assembly"][f"rigid jaw, mu = {mu:g}, 4560 elements"]
    for row in (row for row in rows if row["x_o"] in (0.076, 0.072, 0.064, 0.062)):
        assert_close(force(curves.results["bending"], row["x_o"]), row["force_on_object"], 0.004)
    held = curves.elements.poses[1]
    assert held.parameter == pytest.approx(0.065)
    assert held.force_difference < 0.004


def test_every_figure_has_both_components_in_newtons_over_millimetres():
    for curves, name in ((rotating(0.2), "x_e (mm)"), (assembly(0.3), "x_o (mm)")):
        left, right = curves.figure.axes
        assert (left.get_xlabel(), right.get_xlabel()) == (name, name)
        assert [ax.get_ylabel()[-10:] for ax in (left, right)] == ["long x (N)", "long y (N)"]
        assert [line.get_label() for line in left.lines] == [*curves.results, "finite elements"]


def test_elements_stand_beside_at_least_one_model():
    with pytest.raises(ValueError, match="scenes must hold at least one scene; got none"):
        beside_elements({}, [0.0])
