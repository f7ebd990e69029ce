"""The finger's sections: what the profile says, dimensionless."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import gripper as gr
from gripper.beam.sections import sections
from gripper.fields import Positive
from gripper.fingers import S as ARC
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from tests.scenes import RUBBER, STRAIGHT, TAPERED, unit_finger

S = np.linspace(0, 1, 41)


@dataclass(frozen=True, kw_only=True)
class Wavy(gr.Finger):
    """A thickness that no Gauss rule integrates exactly."""

    thickness: Positive

    def w(self, s: sympy.Expr) -> sympy.Expr:
        return self.thickness * (1 + sympy.sin(7 * s / self.length) / 3)


WAVY = Wavy(length=0.3, thickness=0.02, width=0.01, material=RUBBER)


def test_the_thickness_of_a_tapered_finger_falls_evenly() -> None:
    thickness = sections(TAPERED).thickness(S) * TAPERED.length
    assert thickness == pytest.approx(0.030 + (0.017 - 0.030) * S)


@pytest.mark.parametrize("finger", [STRAIGHT, TAPERED, WAVY, replace(WAVY, width=ARC / 50 + 0.01)], ids=str)
def test_the_stiffnesses_are_those_of_rectangles(finger: gr.Finger) -> None:
    scales, s = sections(finger), S * finger.length
    w = scales.thickness(S) * finger.length
    b = np.array([float(finger.b(sympy.Float(value))) for value in s])
    E, G, nu = finger.material.youngs_modulus, finger.material.G, finger.material.poisson_ratio
    assert scales.EI(S) * scales.bending_stiffness == pytest.approx(E * b * w**3 / 12)
    rigidity = scales.GA(S) * scales.force_scale
    assert rigidity == pytest.approx((5 + 5 * nu) / (6 + 5 * nu) * G * b * w)
    assert scales.EI(np.zeros(1)) == pytest.approx(1.0)


def test_plane_strain_stiffens_bending_by_the_square_of_poisson_s_ratio_and_shear_not_at_all() -> None:
    strained = replace(TAPERED, material=replace(RUBBER, plane="strain"))
    assert sections(strained).bending_stiffness == pytest.approx(sections(TAPERED).bending_stiffness / (1 - 0.4**2))
    rigidity = [sections(finger).GA(S) * sections(finger).force_scale for finger in (strained, TAPERED)]
    assert rigidity[0] == pytest.approx(rigidity[1])


@settings(deadline=None, max_examples=12)
@given(factor=st.floats(1e-9, 1e9), stiffer=st.floats(1e-9, 1e9))
def test_sections_do_not_depend_on_the_unit_of_length_or_force(factor: float, stiffer: float) -> None:
    plastic = gr.Material(youngs_modulus=stiffer, poisson_ratio=0.35)
    first = Tapered(length=1.0, base_thickness=0.1, tip_thickness=0.05, width=0.2, material=plastic)
    lengths = {name: getattr(first, name) * factor for name in ("length", "base_thickness", "tip_thickness", "width")}
    other = replace(first, **lengths)
    for name in ("thickness", "EI", "GA"):
        assert getattr(sections(other), name)(S) == pytest.approx(getattr(sections(first), name)(S), rel=1e-12)
    assert sections(other).force_scale == pytest.approx(sections(first).force_scale * factor**2, rel=1e-12)
    assert sections(other).energy_scale == pytest.approx(sections(first).energy_scale * factor**3, rel=1e-12)


@pytest.mark.parametrize("finger", [STRAIGHT, TAPERED, WAVY], ids=str)
def test_the_profile_s_slopes_are_its_derivatives_and_its_bounds_hold(finger: gr.Finger) -> None:
    scales, h = sections(finger), 1e-5
    inner = S[1:-1]
    w, slope, curvature = (np.broadcast_to(value, inner.shape) for value in scales.profile(inner))
    up, down = scales.thickness(inner + h), scales.thickness(inner - h)
    assert w == pytest.approx(scales.thickness(inner))
    assert slope == pytest.approx((up - down) / (2 * h), abs=1e-8)
    assert curvature == pytest.approx((up - 2 * w + down) / h**2, abs=1e-4)
    for values, bound in zip((w, slope, curvature), scales.thickness_bounds, strict=True):
        assert np.abs(values).max() <= bound <= np.abs(values).max() * 2 + 1e-9


def test_a_finger_is_compiled_once() -> None:
    assert sections(unit_finger()) is sections(unit_finger())


@pytest.mark.parametrize(
    ("finger", "word"),
    [
        (Uniform(length=1.0, thickness=0.1, width=0.1 - ARC, material=RUBBER), "width"),
        (Wavy(length=1.0, thickness=0.1, width=0.1 + sympy.log(ARC), material=RUBBER), "width"),
    ],
    ids=["negative", "not finite"],
)
def test_a_profile_that_is_not_positive_everywhere_is_refused_by_name(finger: gr.Finger, word: str) -> None:
    with pytest.raises(ValueError, match=f"{word} must be positive along the finger, in m; got .* at s ="):
        sections(finger)
