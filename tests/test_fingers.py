import math

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from gripper.fingers import Material, S
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.polygon import PolygonJaw
from gripper_plugins.jaws.triangle import Triangle

NYLON = {"youngs_modulus": 2.6e9, "poisson_ratio": 0.35}
LENGTHS = st.floats(1e-3, 1.0)
ANGLES = st.floats(0.05, 3.0)


def value(expression, s):
    return float(sympy.sympify(expression).subs(S, s))


@given(st.floats(1e3, 1e12), st.floats(-0.9, 0.5))
def test_a_shear_modulus_that_is_not_given_is_the_isotropic_one(youngs_modulus, poisson_ratio):
    material = Material(youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio)
    assert pytest.approx(youngs_modulus / (2 * (1 + poisson_ratio))) == material.G
    assert Material(youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio, shear_modulus=5.0).G == 5.0


def test_plane_strain_stiffens_bending_by_1_over_1_minus_nu_squared():
    stress, strain = (Material(**NYLON, plane=plane) for plane in ("stress", "strain"))
    assert stress.bending_modulus == 2.6e9
    assert strain.bending_modulus == pytest.approx(2.6e9 / (1 - 0.35**2))


def test_the_shear_coefficient_of_a_rectangle_is_5_6_without_lateral_contraction():
    """Kaneko's (5 + 5 nu) / (6 + 5 nu)."""
    assert Material(youngs_modulus=1.0, poisson_ratio=0.0).shear_coefficient == pytest.approx(5 / 6)
    assert Material(youngs_modulus=1.0, poisson_ratio=0.5).shear_coefficient == pytest.approx(15 / 17)


@pytest.mark.parametrize(
    ("name", "bad"),
    [("youngs_modulus", 0.0), ("poisson_ratio", 0.6), ("poisson_ratio", -1.0), ("plane", "sideways")],
)
def test_a_material_that_cannot_be_is_refused_by_name(name, bad):
    with pytest.raises(ValueError, match=name):
        Material(**{**NYLON, name: bad})


@given(LENGTHS, LENGTHS, LENGTHS, st.floats(0, 1))
def test_a_taper_is_linear_between_its_ends_and_uniform_where_they_are_equal(length, base, tip, share):
    common = {"length": length, "width": 0.01, "material": Material(**NYLON)}
    tapered = Tapered(**common, base_thickness=base, tip_thickness=tip)
    assert value(tapered.w(S), share * length) == pytest.approx((1 - share) * base + share * tip)
    even = Tapered(**common, base_thickness=base, tip_thickness=base)
    assert value(even.w(S), share * length) == value(Uniform(**common, thickness=base).w(S), share * length)


def test_a_width_is_a_number_or_an_expression_of_s():
    common = {"length": 0.1, "thickness": 0.01, "material": Material(**NYLON)}
    assert value(Uniform(**common, width=0.02).b(S), 0.05) == 0.02
    assert value(Uniform(**common, width=0.02 + S / 10).b(S), 0.05) == pytest.approx(0.025)


@given(LENGTHS, ANGLES, ANGLES, st.floats(0, 0.1))
def test_a_triangle_has_its_angles_and_its_length_and_stands_on_the_finger_s_face(length, lead, back, thickness):
    if lead + back >= math.pi - 0.05:
        return
    lower = np.array(Triangle(length=length, lead_angle=lead, return_angle=back).polygon(thickness))
    heel, point, end = lower
    assert heel == pytest.approx([0, -thickness / 2])
    assert end == pytest.approx([length, -thickness / 2])
    assert math.atan2(heel[1] - point[1], point[0] - heel[0]) == pytest.approx(back)
    assert math.atan2(end[1] - point[1], end[0] - point[0]) == pytest.approx(lead)
    upper = np.array(Triangle(length=length, lead_angle=lead, return_angle=back, side="upper").polygon(thickness))
    assert upper == pytest.approx(lower * [1, -1])


@pytest.mark.parametrize(("lead", "back"), [(0.0, 1.0), (1.0, 0.0), (1.6, 1.6), (-0.3, 1.0)])
def test_angles_that_make_no_triangle_are_refused(lead, back):
    with pytest.raises(ValueError, match=r"lead_angle|return_angle"):
        Triangle(length=0.01, lead_angle=lead, return_angle=back)


def test_a_jaw_of_any_shape_keeps_its_vertices_whatever_the_finger():
    vertices = ((0.0, -0.005), (0.01, -0.005), (0.0, -0.02))
    jaw = PolygonJaw(vertices=vertices)
    assert jaw.polygon(0.01) == jaw.polygon(0.5) == vertices
