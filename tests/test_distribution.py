"""A stranger's plugins, installed as a real distribution in a fresh environment; broken ones, named and survived."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from tests.distribution import environment, wheel

BENCH = '''
from dataclasses import dataclass

import gripper as gr
import sympy


@dataclass(frozen=True, kw_only=True)
class Egg(gr.ImplicitSurface):
    """A circle that is wider below: x^2 + y^2 (1 + y/2R)^2 = R^2."""

    radius: gr.Positive

    def g(self, x, y):
        r = self.radius
        return (x**2 * (1 + y / (4 * r)) ** 2 + y**2 - r**2) / (2 * r)

    def half_size(self):
        return 1.6 * self.radius


@dataclass(frozen=True, kw_only=True)
class Waisted(gr.Finger):
    """A finger that is thinnest in the middle."""

    thickness: gr.Positive

    def w(self, s):
        return self.thickness * (1 + sympy.cos(2 * sympy.pi * s / self.length) / 4)


@dataclass(frozen=True, kw_only=True)
class Wedge(gr.Jaw):
    """A wedge below the tip."""

    length: gr.Positive
    height: gr.Positive

    def polygon(self, thickness):
        face = -thickness / 2
        return ((0.0, face), (self.length / 3, face - self.height), (self.length, face))
'''
BROKEN = '''
from dataclasses import dataclass

import gripper as gr
import numpy as np
import sympy
from gripper_plugins.objects import Circle


@dataclass(frozen=True, kw_only=True)
class Bodiless(gr.ImplicitSurface):
    radius: gr.Positive


@dataclass(frozen=True, kw_only=True)
class Nan(Circle):
    def evaluate(self, points, order=2):
        values = super().evaluate(points, order)
        values[0][points[:, 0] > 0] = np.nan
        return values


@dataclass(frozen=True, kw_only=True)
class Jump(Circle):
    def evaluate(self, points, order=2):
        values = super().evaluate(points, order)
        values[0][points[:, 1] > 0] += 0.1 * self.radius
        return values


@dataclass(frozen=True, kw_only=True)
class Raises(Circle):
    def evaluate(self, points, order=2):
        raise ZeroDivisionError("no such thing")


@dataclass(frozen=True, kw_only=True)
class Late(Circle):
    """Sound at first sight: it fails in the solver."""

    def evaluate(self, points, order=2):
        if np.abs(points).max(initial=0.0) > 300 * self.radius:
            raise OSError("sensor lost")
        return super().evaluate(points, order)


@dataclass(frozen=True, kw_only=True)
class Hollow(gr.Finger):
    def w(self, s):
        return sympy.sin(s)


@dataclass(frozen=True, kw_only=True)
class Torn(gr.Finger):
    def w(self, s):
        return sympy.Piecewise((0.003, s < 0.03), (0.002, True))


@dataclass(frozen=True, kw_only=True)
class Knot(gr.Jaw):
    def polygon(self, thickness):
        return ((0, 0), (0.01, 0.01), (0.01, 0), (0, 0.01))
'''
ENTRIES = """
[gripper.objects]
egg = bench:Egg
[gripper.fingers]
waisted = bench:Waisted
[gripper.jaws]
wedge = bench:Wedge
"""
BROKEN_ENTRIES = """
[gripper.objects]
crash = crash:Anything
bodiless = broken:Bodiless
nan = broken:Nan
jump = broken:Jump
raises = broken:Raises
late = broken:Late
[gripper.fingers]
hollow = broken:Hollow
torn = broken:Torn
[gripper.jaws]
knot = broken:Knot
"""
SCENE = """
[material]
youngs_modulus = "2.6 GPa"
poisson_ratio = 0.35
[finger]
profile = "waisted"
length = "57 mm"
thickness = "3.2 mm"
width = "9.5 mm"
[finger.jaw]
shape = "wedge"
length = "19 mm"
height = "4 mm"
[object]
surface = "egg"
radius = "8.9 mm"
pose = { x = "45 mm", y = "-8 mm" }
"""


@pytest.fixture(scope="module")
def fresh(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of a fresh environment in which two strangers' distributions are installed."""
    folder = tmp_path_factory.mktemp("fresh")
    good = wheel(folder, "gripper-bench", ENTRIES, bench=BENCH)
    bad = wheel(folder, "gripper-broken", BROKEN_ENTRIES, broken=BROKEN, crash="1 / 0")
    return environment(folder / "venv", good, bad)


def run(python: Path, *arguments: str) -> subprocess.CompletedProcess:
    """Run that Python, in the folder about its environment."""
    command = [str(python), *arguments]
    return subprocess.run(command, cwd=python.parents[2], capture_output=True, text=True, timeout=300)


def test_a_scene_of_a_stranger_s_object_finger_and_jaw_runs(fresh: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    done = run(fresh, "-m", "gripper", "run", str(tmp_path / "scene.toml"), "-o", str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    (pose,) = result["poses"]
    assert pose["status"] == "contact" and pose["checks"]["certificate"] == "proved"
    assert [result["scene"][key][name] for key, name in (("object", "surface"), ("finger", "profile"))] == [
        "egg",
        "waisted",
    ]


def test_the_list_says_of_each_plugin_whose_it_is_and_why_it_cannot_be_loaded(fresh: Path) -> None:
    done = run(fresh, "-m", "gripper", "plugins")
    assert done.returncode == 0 and not done.stderr
    rows = {line.split()[1]: line for line in done.stdout.splitlines()[1:]}
    assert "gripper-bench 1.2" in rows["egg"] and rows["egg"].rstrip().endswith("ok")
    assert "gripper-broken 1.2" in rows["crash"] and "its import fails with ZeroDivisionError" in rows["crash"]
    assert "gripper-broken 1.2" in rows["bodiless"] and "it must write g" in rows["bodiless"]
    assert rows["circle"].rstrip().endswith("ok")


OBJECT = '[object]\nsurface = "egg"\n'
REFUSED = {
    "crash": (OBJECT, '[object]\nsurface = "crash"\n', "its import fails with ZeroDivisionError"),
    "bodiless": (OBJECT, '[object]\nsurface = "bodiless"\n', "it must write g"),
    "nan": (OBJECT, '[object]\nsurface = "nan"\n', "must have g finite everywhere"),
    "jump": (OBJECT, '[object]\nsurface = "jump"\n', "must have a continuous g; got a jump"),
    "raises": (OBJECT, '[object]\nsurface = "raises"\n', "no such thing"),
    "late": (OBJECT, '[object]\nsurface = "late"\n', "sensor lost"),
    "hollow": ('"waisted"', '"hollow"', "must have a positive thickness w(s), in m; got"),
    "torn": (
        '"waisted"',
        '"torn"',
        "must have a continuous thickness w(s), in m (a step is a steep flank); got a jump",
    ),
    "knot": ('"wedge"', '"knot"', "must write a polygon that does not meet itself"),
}


EACH = """
import contextlib, io, json, sys
from gripper.cli import app
said = {}
for scene in sys.argv[1:]:
    stream = io.StringIO()
    with contextlib.redirect_stderr(stream):
        try:
            app(["run", scene, "-o", scene + ".out"])
        except SystemExit as done:
            said[scene] = done.code, stream.getvalue()
print(json.dumps(said))
"""
"""Runs scene after scene in one process: a broken plugin must not take the next scene down."""


def test_a_width_that_is_wrong_is_the_scene_s_not_the_plugin_s(fresh: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE.replace('width = "9.5 mm"', 'width = "-9.5 mm"'))
    done = run(fresh, "-m", "gripper", "run", str(tmp_path / "scene.toml"), "-o", str(tmp_path / "out"))
    assert done.returncode == 2
    assert "finger.width: must be positive along the finger, in m; got -0.0095 at s = 0.0" in done.stderr
    assert "gripper-bench" not in done.stderr


def broken(name: str) -> str:
    one, other, _ = REFUSED[name]
    text = SCENE.replace(one, other)
    if name in ("hollow", "torn"):
        text = text.replace('thickness = "3.2 mm"\n', "")
    return text.replace('length = "19 mm"\nheight = "4 mm"\n', "") if name == "knot" else text


@pytest.fixture(scope="module")
def said(fresh: Path) -> dict[str, tuple[int, str]]:
    """Exit status and message of each scene with a broken plugin, and of a sound one after them."""
    scenes = {name: broken(name) for name in REFUSED} | {"sound": SCENE}
    for name, text in scenes.items():
        (fresh.parents[2] / name).write_text(text)
    done = run(fresh, "-c", EACH, *scenes)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.parametrize("name", REFUSED)
def test_a_broken_plugin_is_named_with_its_distribution_in_one_message(
    fresh: Path, said: dict[str, tuple[int, str]], name: str
) -> None:
    status, message = said[name]
    assert status == 2, message
    assert "Traceback" not in message and len(message.splitlines()) == 1
    assert REFUSED[name][2] in message
    assert "gripper-broken 1.2" in message
    assert not (fresh.parents[2] / f"{name}.out").exists()


CHECK = """
import gripper as gr
from broken import Torn
from gripper.testing import check_finger
check_finger(Torn(length=0.06, width=0.01, material=gr.Material(youngs_modulus=1e9, poisson_ratio=0.3)))
"""


def test_the_check_kit_names_plugin_and_distribution(fresh: Path) -> None:
    message = run(fresh, "-c", CHECK).stderr.splitlines()[-1]
    assert "finger 'torn' of gripper-broken 1.2 (broken:Torn): Torn(length=0.06" in message
    assert message.endswith(
        "must have a continuous thickness w(s), in m (a step is a steep flank); got a jump of 0.001 at s = 0.03"
    )


def test_a_sound_scene_after_broken_ones_has_its_answer(said: dict[str, tuple[int, str]]) -> None:
    assert said["sound"] == [0, ""]
