from __future__ import annotations

import ast
import json
import math
import subprocess
import sys
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path

import numpy as np
import pytest
import scenes
import sympy
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.polygon import Polygon
from hypothesis import given, settings
from hypothesis import strategies as st

import gripper as gr
import gripper.verify
from gripper.verify import verify
from gripper.verify.body import Body, positive, solve
from gripper.verify.elements import Elements
from gripper.verify.follow import Follower
from gripper.verify.material import LAWS, InvertedError, Law
from gripper.verify.mesh import build
from gripper.verify.motion import Frame, relative
from gripper.verify.run import Found, Model, assembled, run
from gripper.verify.touch import History

FEM = json.loads((scenes.REFERENCE / "fem.json").read_text())
EASY = gr.Material(youngs_modulus=1.0, poisson_ratio=0.3)
EITHER = pytest.mark.parametrize("law", list(LAWS))
RNG = np.random.default_rng(7)


def rotation(angle: float) -> np.ndarray:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def nothing() -> None:
    """No progress."""


# -- material laws


def gradients(count: int = 40) -> np.ndarray:
    return (np.eye(2).ravel() + RNG.uniform(-0.25, 0.25, (count, 4))).reshape(count, 4)


@EITHER
def test_a_law_is_its_energy_in_principal_stretches(law):
    given_law = Law.of(EASY, law)
    stretches = np.linalg.svd(gradients().reshape(-1, 2, 2), compute_uv=False)
    strain = {"svk": (stretches**2 - 1) / 2, "biot": stretches - 1, "hencky": np.log(stretches)}[law]
    e1, e2 = strain.T
    energy = (e1**2 + 2 * 0.3 * e1 * e2 + e2**2) / (2 * (1 - 0.3**2))
    RNG_STATE = np.random.default_rng(7)
    del RNG_STATE
    assert given_law.name == law
    assert energy.min() >= 0


@EITHER
@settings(max_examples=60, deadline=None)
@given(values=st.lists(st.floats(-0.3, 0.3), min_size=4, max_size=4))
def test_energy_stress_and_stiffness_of_a_law_belong_together(law, values):
    f = np.eye(2).ravel() + np.array(values)
    if np.linalg.det(f.reshape(2, 2)) < 0.2:
        return
    given_law = Law.of(EASY, law)
    stretches = np.linalg.svd(f.reshape(2, 2), compute_uv=False)
    e1, e2 = {"svk": (stretches**2 - 1) / 2, "biot": stretches - 1, "hencky": np.log(stretches)}[law]
    energy, stress, stiffness = given_law.respond(f[None])
    assert energy[0] == pytest.approx((e1**2 + 0.6 * e1 * e2 + e2**2) / 1.82, abs=1e-12)
    step = 1e-6
    ahead = [given_law.respond((f + step * axis)[None]) for axis in np.eye(4)]
    back = [given_law.respond((f - step * axis)[None]) for axis in np.eye(4)]
    slopes = [(a[0][0] - b[0][0]) / (2 * step) for a, b in zip(ahead, back, strict=True)]
    rows = [(a[1][0] - b[1][0]) / (2 * step) for a, b in zip(ahead, back, strict=True)]
    assert stress[0] == pytest.approx(slopes, abs=1e-8)
    assert stiffness[0] == pytest.approx(np.array(rows), abs=1e-7)
