"""What a scene does not need is not imported: read from sys.modules of a process of its own."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import gripper

HEAVY = {
    "contourpy",
    "gripper.bands",
    "gripper.cli",
    "gripper.optimize",
    "gripper.plot",
    "gripper.scenefile",
    "gripper.sensitivity",
    "gripper.study",
    "gripper.sweep",
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
COMMAND = """
import sys
from gripper.__main__ import main
sys.argv = ["gripper", "run", {scene!r}, "-o", {folder!r}]
try:
    main()
finally:
    print(*sys.modules)
"""
INTERRUPTED = """
import signal, sys
class Finder:
    def find_spec(self, name, *_):
        if name == {module!r}:
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Finder())
from gripper.__main__ import main
sys.argv = ["gripper", "plugins"]
main()
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


def test_the_package_alone_imports_nothing_that_takes_time() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "import gripper, sys; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    assert not {"numpy", "sympy", "scipy", "gripper.scene"} & set(done.stdout.split())


def test_a_scene_that_is_no_toml_is_refused_before_anything_that_takes_time_is_imported(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text('title = "open\n')
    code = COMMAND.format(scene=str(scene), folder=str(tmp_path / "out"))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2 and "must be TOML" in done.stderr
    assert not {"numpy", "sympy", "scipy", "gripper.scene"} & set(done.stdout.split())


@pytest.mark.parametrize("module", ["typer", "gripper.cli.run", "gripper.registry"])
def test_ctrl_c_while_a_command_is_still_imported_leaves_no_traceback(module: str) -> None:
    done = subprocess.run([sys.executable, "-c", INTERRUPTED.format(module=module)], capture_output=True, text=True)
    assert done.returncode == 130
    assert "Traceback" not in done.stderr and len(done.stderr.strip().splitlines()) <= 1


def test_every_public_name_is_where_the_stub_says_and_no_module_takes_its_place() -> None:
    stub = ast.parse(Path(gripper.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    lines = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    assert len(lines) > 30
    for line in lines:
        name = line.names[0].name
        module = __import__(str(line.module), fromlist=[name])  # gripper.solve, say, whose function has its name
        assert getattr(gripper, name) is getattr(module, name)
        assert name in dir(gripper) and name in gripper.__all__
    with pytest.raises(AttributeError, match="has no attribute 'slove'"):
        _ = gripper.slove  # type: ignore[attr-defined]


RUBBING = {
    *(f"gripper.contact.{name}" for name in ("grip", "law", "rubbing")),
    "gripper.statics.holds",
    *(f"gripper.motion.{name}" for name in ("frictional", "holding", "ledger", "locking", "others", "peaks", "work")),
}
MOTION = """
import sympy
import gripper as gr
from gripper_plugins.fingers import Uniform
from gripper_plugins.jaws import Triangle
from gripper_plugins.objects import Circle
q = sympy.Symbol("q")
plastic = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
jaw = Triangle(length=0.019, lead_angle=0.35, return_angle=1.05)
finger = Uniform(length=0.057, thickness=0.0032, width=0.0095, material=plastic, jaw=jaw)
pin, motion = Circle(radius=0.0089).at(x=q, y=-0.0105), gr.Motion("q", (0.086, 0.064, 0.07))
result = gr.trace(gr.Scene(finger=finger, object=pin, motion=motion, theory="bending", friction={friction}))
print(result.summary(), [pose.status for pose in result.poses])
import sys
print(*sys.modules)
"""


@pytest.mark.parametrize("friction", ["None", "gr.Friction(coefficient=0)", "gr.Friction(coefficient=0.3)"])
def test_no_module_of_friction_is_read_where_there_is_none(friction: str) -> None:
    code = MOTION.format(friction=friction)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "'contact'" in done.stdout
    assert RUBBING & set(done.stdout.split()) == (RUBBING if "0.3" in friction else set())
