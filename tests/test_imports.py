"""What a scene does not need is not imported: read from sys.modules of a process of its own."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = {
    "contourpy",
    "gripper.cli",
    "gripper.plot",
    "gripper.scenefile",
    "gripper.sensitivity",
    "gripper.testing",
    "gripper.verify",
    "hypothesis",
    "matplotlib",
    "pydantic",
    "rich",
    "scipy.integrate",
    "scipy.interpolate",
    "scipy.ndimage",
    "shapely",
    "typer",
}
SCENE = """
import gripper as gr
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle, Grown, HalfPlane, Implicit, Intersection, Polygon, Spline
steel = gr.Material(youngs_modulus=2e11, poisson_ratio=0.3)
finger = Uniform(length=0.1, thickness=0.002, width=0.01, material=steel)
gr.solve(gr.Scene(finger=finger, object={body}.at(x=0.06, y=-0.01)))
import sys
print(*sys.modules)
"""
BODIES = {
    "Circle(radius=0.02)": set(),
    "HalfPlane().at(angle=-0.5).body": set(),
    "Polygon(vertices=((-0.01, -0.01), (0.01, -0.01), (0.0, 0.01)))": {"shapely"},
    "Implicit(expression='x**4 + y**4 - 0.02**4', extent=0.03)": {"contourpy", "scipy.ndimage"},
}


@pytest.mark.parametrize("body", BODIES)
def test_solving_imports_what_the_object_needs_and_nothing_else(body: str) -> None:
    done = subprocess.run([sys.executable, "-c", SCENE.format(body=body)], capture_output=True, text=True, check=True)
    assert HEAVY & set(done.stdout.split()) <= BODIES[body]


def test_the_check_kit_needs_no_hypothesis_until_its_strategies_are_asked_for() -> None:
    code = "import gripper.testing, sys; sys.exit('hypothesis' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
