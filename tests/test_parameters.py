import dataclasses
import math

import pytest
import sympy

import gripper as gr
from gripper.parameters import number, numbers, replaced
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.objects.polygon import Polygon
from tests import scenes

HOOKED = scenes.micro_assembly(0.08, 0.07, friction=gr.Friction(coefficient={"finger": 0.2, "jaw": 0.3}))
TURNING = scenes.rotating_finger(0.0, 0.05)
S = sympy.Symbol("s")
CORNERED = gr.Scene(
    finger=Uniform(length=0.1, thickness=0.004, width=0.01 + S / 10, material=scenes.PLASTIC),
    object=Polygon(vertices=((0, 0), (0.02, 0), (0, 0.02))).at(x=0.05, y=-0.03),
    friction=gr.Friction(coefficient=0.3 - S, sense="tipward"),
)
ALL = pytest.mark.parametrize("scene", [HOOKED, TURNING, CORNERED], ids=["hooked", "turning", "cornered"])


def test_the_keys_are_those_of_a_scene_file():
    assert numbers(HOOKED) == pytest.approx(
        {
            "finger.length": 0.057,
            "finger.width": 0.0095,
            "material.youngs_modulus": 2.6e9,
            "material.poisson_ratio": 0.35,
            "material.shear_modulus": 2.6e9 / 2.7,
            "finger.jaw.length": 0.019,
            "finger.jaw.lead_angle": math.radians(20),
            "finger.jaw.return_angle": math.radians(60),
            "finger.thickness": 0.0032,
            "finger.pose.x": 0.0,
            "finger.pose.y": 0.0,
            "finger.pose.angle": 0.0,
            "object.radius": 0.0089,
            "object.pose.x": 0.0,
            "object.pose.y": -0.0105,
            "object.pose.angle": 0.0,
            "friction.coefficient.finger": 0.2,
            "friction.coefficient.jaw": 0.3,
        }
    )


@ALL
def test_every_number_that_is_replaced_reads_back_and_moves_no_other(scene):
    before = numbers(scene)
    for key, value in before.items():
        wanted = 1.01 * value + 1e-4 * (value == 0)
        after = numbers(replaced(scene, {key: wanted}))
        assert after.pop(key) == pytest.approx(wanted, rel=1e-14)
        derived = ("material.shear_modulus",) if key.startswith("material.") and scene is not TURNING else ()
        assert all(after[other] == before[other] for other in after if other not in derived)


@ALL
def test_the_same_numbers_make_the_same_scene(scene):
    own = {key: value for key, value in numbers(scene).items() if key != "material.shear_modulus"}
    assert replaced(scene, own) == replaced(scene, {})


def test_the_shear_modulus_follows_youngs_modulus_until_it_is_given():
    free = replaced(HOOKED, {"material.youngs_modulus": 5.2e9})
    assert number(free, "material.shear_modulus") == pytest.approx(5.2e9 / 2.7)
    given = replaced(free, {"material.shear_modulus": 1e9})
    assert number(replaced(given, {"material.youngs_modulus": 2.6e9}), "material.shear_modulus") == 1e9


def test_a_pose_that_moves_is_shifted_by_a_constant():
    shifted = replaced(TURNING, {"finger.pose.angle": math.radians(103), "object.pose.x": 0.001})
    turn, place = (sympy.diff(e, scenes.Q) for e in (shifted.finger.pose.angle, shifted.object.pose.x))
    assert (float(turn), float(place)) == pytest.approx((-math.radians(236.22), 1.0))
    assert float(shifted.finger.pose.angle.subs(scenes.Q, 0.0)) == pytest.approx(math.radians(103), rel=1e-15)


def test_numbers_that_are_right_together_only_are_replaced_together():
    wide = {"finger.jaw.lead_angle": 1.7, "finger.jaw.return_angle": 0.5}
    narrow = {"finger.jaw.lead_angle": 0.5, "finger.jaw.return_angle": 1.7}
    swapped = replaced(replaced(HOOKED, wide), narrow)
    assert {key: number(swapped, key) for key in narrow} == narrow


def test_friction_is_given_to_a_scene_without():
    assert number(TURNING, "friction.coefficient") == 0
    assert replaced(TURNING, {"friction.coefficient": 0.2}).friction == gr.Friction(coefficient=0.2)


def test_an_expression_without_a_value_at_zero_has_no_number():
    scene = dataclasses.replace(TURNING, object=TURNING.object.body.at(x=sympy.log(scenes.Q), y=0.12))
    assert "object.pose.x" not in numbers(scene)
    assert number(scene, "object.pose.y") == 0.12


@pytest.mark.parametrize("key", ["finger.tip_thicknes", "", "finger", "object.semi_axes[2]", "solver.tolerance"])
def test_an_unknown_key_lists_the_known_ones(key):
    with pytest.raises(LookupError, match=r"unknown number '.*'; known: .*finger\.tip_thickness"):
        replaced(TURNING, {key: 1.0})


def test_a_number_that_breaks_its_rule_says_so():
    with pytest.raises(ValueError, match="tip_thickness must be a positive number, in m; got -1"):
        replaced(TURNING, {"finger.tip_thickness": -1.0})
