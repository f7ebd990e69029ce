"""Scene files from strangers, through the command line: status 2, one line, soon, and nothing executed or written."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from gripper.cli import app

MATERIAL = '[material]\nyoungs_modulus = "2.6 GPa"\npoisson_ratio = 0.35\n'
FINGER = '[finger]\nprofile = "uniform"\nlength = "57 mm"\nthickness = "3.2 mm"\nwidth = "9.5 mm"\n'
MOTION = '[motion]\nparameter = "q"\nfrom = 0.086\nto = "50 mm"\nposes = 3\n'


def scene(surface='surface = "circle"\nradius = "8.9 mm"', *, x='"q"', y='"-10.5 mm"', motion=MOTION, more=""):
    return f"{MATERIAL}{FINGER}[object]\n{surface}\n[object.pose]\nx = {x}\ny = {y}\n{motion}{more}"


def implicit(expression, extent="0.02"):
    return scene(f'surface = "implicit"\nexpression = "{expression}"\nextent = {extent}')


def polygon(vertices):
    return scene(f'surface = "polygon"\nvertices = {vertices}')


def conic(coefficients):
    return scene(f'surface = "conic"\ncoefficients = {coefficients}')


def jaw(table):
    return scene(more=f"[finger.jaw]\n{table}\n")


def triangle(lead, back):
    return jaw(f'shape = "triangle"\nlength = "19 mm"\nlead_angle = "{lead}"\nreturn_angle = "{back}"')


GOOD = scene()
LARGEST = "must lie between -1e+30 and 1e+30, in SI units; got"

# what stands in the message after the file's name: the key, and the rule's beginning
TEXT = {
    "": "material, finger, object: must be given; got nothing",
    "a = \n" + GOOD: "line 1: must be TOML (",
    GOOD + GOOD: "must be TOML (",
    "[" * 100_000: "line 1: must be TOML (",
    "a = " + "[" * 100_000: "must be TOML with few levels of arrays and tables; got too many levels",
    "a." * 1_000_000 + "a = 1": "line 1: must be TOML with few dots in a name",
    "a." * 900 + "a = 1": "a: must be a known key",
    "\0": "line 1: must be TOML (",
    GOOD.replace("[motion]", "[[motion]]"): "motion: must be a table; got [",
    GOOD.replace("radius", "radus"): "object.radus: must be a known key: surface, pose, radius (did you",
    GOOD.replace("[motion]", "[moton]"): "moton: must be a known key: title, material",
    GOOD.replace("poses = 3\n", ""): "motion.poses: must be given; got parameter, from, to",
    GOOD.replace("poses = 3", "poses = true"): "motion.poses: must be a number",
    GOOD.replace("poses = 3", "poses = 1_000_000_000"): "motion.poses: must lie between 2 and 100000; got 1000000000",
    GOOD.replace("poses = 3", "poses = 1e300"): f"motion.poses: {LARGEST} 1e+300",
    GOOD.replace("poses = 3", "poses = -3"): "motion.poses: must lie between 2 and 100000; got -3",
    GOOD.replace("0.086", "nan"): "motion.from: must be a finite number; got nan",
    GOOD.replace("0.086", "-inf"): "motion.from: must be a finite number; got -inf",
    GOOD.replace('"57 mm"', "0"): "finger.length: must be a positive number, in m; got 0",
    GOOD.replace('"57 mm"', "-1"): "finger.length: must be a positive number",
    GOOD.replace('"57 mm"', "[57]"): "finger.length: must be a number, or an expression in a string; got [57]",
    GOOD.replace('"57 mm"', '"57 foo"'): "finger.length: must hold known names only, not 'foo'; known: pi, ",
    GOOD.replace('"57 mm"', '"57 mm mm"'): "finger.length: must have * between factors (only a number takes a unit",
    GOOD.replace('"57 mm"', '"1/0"'): "finger.length: must have a finite value: '/' divides by 0",
    GOOD.replace('"57 mm"', "\"__import__('os').system('touch executed')\""): "finger.length: must hold nothing but",
    GOOD.replace('"57 mm"', '"().__class__.__mro__"'): "finger.length: must hold nothing but numbers, names",
    GOOD.replace('"57 mm"', '"9**9**9**9"'): "finger.length: must have exponents between -100 and 100",
    GOOD.replace('"57 mm"', f'"{"(" * 10_000}1{")" * 10_000}"'): "finger.length: must be at most 2000 characters long",
    GOOD.replace('"57 mm"', '"1 if 2 else 0"'): "finger.length: must hold known names only, not 'if'",
    GOOD.replace('"57 mm"', "\"'a'*9999999\""): "finger.length: must hold nothing but numbers",
    GOOD.replace('"57 mm"', "1e300"): f"finger.length: {LARGEST} 1e+300",
    "title = [[]]\n" + GOOD: "title: must be a text; got [[]]",
    f'title = "{"long" * 1000}"\n' + GOOD: "title: must be at most 500 characters long; got 4000 characters",
    'title = "a\\u001b[31mb"\n' + GOOD: "title: must hold no control characters; got 'a\\x1b[31mb'",
    triangle("120 deg", "80 deg"): "finger.jaw: lead_angle and return_angle must add up to less than pi, in rad",
    triangle("0", "80 deg"): "finger.jaw.lead_angle: must lie between 0 and pi, in rad; got 0.0",
    triangle("20", "60"): "finger.jaw.lead_angle: must lie between 0 and pi, in rad; got 20.0",
    jaw('shape = "polygon"\nvertices = [[0, 0], [0.01, 0]]'): "finger.jaw.vertices: must hold at least 3 points",
    jaw('shape = "polygon"\nvertices = [[0, 0], [1, 0], [2, 0]]'): "finger.jaw.vertices: must enclose an area",
    polygon("[[0, 0], [0.01, 0.01], [0.01, 0], [0, 0.02]]"): "object.vertices: must not make an outline that meets",
    polygon("[[0, 0], [0.01, 0], [0.02, 0]]"): "object.vertices: must enclose an area, in m^2; got points on one line",
    polygon("[[0, 0], [0.01, 0], [0.01, 0], [0, 0.01]]"): "object.vertices: must not repeat a point",
    polygon("[[0, 0, 0], [1, 0, 0], [0, 1, 0]]"): "object.vertices[0]: must have 2 entries; got 3",
    polygon("[[nan, 0], [1, 0], [0, 1]]"): "object.vertices[0][0]: must be a finite number; got nan",
    conic("[0, 0, 0, 0, 0, 1]"): "object.coefficients: must not be constant",
    conic("[1, 1, 0, 0, 0, 1]"): "object.coefficients: must have an outline",
    conic("[-1, -1, 0, 0, 0, 1e-4]"): "object.coefficients: must be negative inside (change all signs)",
    conic("[1, -1, 0, 0, 0, 0]"): "object.coefficients: must have a gradient all along the outline",
    conic("[1e300, 1e300, 0, 0, 0, -1e300]"): f"object.coefficients[0]: {LARGEST} 1e+300",
}
"""Syntax and types: within a second."""

COMPILED = {
    implicit("3"): "object.expression: must depend on x and y, and on nothing else; got 3",
    implicit("0.01 - sqrt(x**2 + y**2)"): "object.expression: must make a g that is positive on the edge of its extent",
    implicit("1e-4 - x**2 - y**2"): "object.expression: must be negative inside (change all signs)",
    implicit("x**2 + y**4 + 1"): "object.expression: must make a g that is negative inside; got 1.0 or more, on a grid",
    implicit("x**4 + y**4 - 1"): "object.expression: must make a g that is positive on the edge of its extent",
    implicit("y - x**3"): "object.expression: must make a g that is positive on the edge of its extent",
    implicit("log(x)"): "object.expression: must be finite, with its derivatives, at (-0.02, -0.02); got log(x)",
    implicit("1/x"): "object.expression: must make a g that is positive on the edge of its extent",
    implicit("x**x**x**x**x - 0.1"): "object.expression: must be finite, with its derivatives",
    implicit("max(" + ", ".join(f"abs(x - {i})" for i in range(10)) + ")"): "object.expression: must make a g that is",
    implicit("+".join(f"x**{i % 90}*y**2" for i in range(150)) + "-1e-4"): "object.expression: must make a g that is",
    implicit("x**4 + y**4 - 1", "1e300"): f"object.extent: {LARGEST} 1e+300",
    GOOD.replace('"9.5 mm"', '"0.01 - s"'): "finger.width: must be positive along the finger, in m; got -",
    GOOD.replace('"9.5 mm"', '"1e-6 / s"'): "finger.width: must be positive along the finger, in m; got inf at s = 0.0",
    GOOD.replace('"9.5 mm"', '"log(s - 0.03)"'): "finger.width: must be positive along the finger, in m; got nan",
    GOOD.replace('"57 mm"', "1e-300"): "finger: must have a stiffness that a float can hold",
    GOOD.replace('"3.2 mm"', "1e-100"): "finger: must have a thickness of 1e-09 to 100 of its length; got 1.75439e-99",
    GOOD.replace('"3.2 mm"', "1e9"): "finger: must have a thickness of 1e-09 to 100 of its length",
    GOOD.replace('"2.6 GPa"', "1e-300"): "finger: must have a stiffness EI, EI/L and EI/L^2 that a float can hold",
    scene(x='"log(q - 1)"'): "object.pose.x: must be a finite number in every pose; got nan at q = 0.086",
    scene(x='"1 / (q - 0.086)"'): "object.pose.x: must be a finite number in every pose; got inf at q = 0.086",
    scene(x='"1e20 * q"'): "object.pose: must stay within 1e+09 finger lengths of the clamp",
    scene(motion=MOTION.replace("to", "to = 1e30\n#")): "object.pose: must stay within 1e+09 finger lengths",
    scene(x="0", y="0", motion=""): "object.pose: must leave the finger's clamp outside the object; got the clamp",
    scene(x='"1e-9 * q"', y="0"): "object.pose: must leave the finger's clamp outside the object; got the clamp",
    scene(more='[friction]\ncoefficient = "log(s - 1)"\n'): "friction.coefficient: must be at least 0; got nan",
    conic("[0, 0, 0, -0.3, 1, 0.01]").replace('"q"', '"1e-9 * q"', 1).replace('"-10.5 mm"', "0")
    + "[approach]\ndirection = [1, 0.3]\n": "approach.direction: must be one along which the object comes from where",
}
"""What shows when finger and object are compiled: within three seconds."""


def refused(text, folder, monkeypatch):
    """The message, and the CPU time that it took."""
    monkeypatch.chdir(folder)
    path = folder / "scene.toml"
    path.write_text(text)
    began = time.process_time()
    outcome = CliRunner().invoke(app, ["run", str(path), "-o", str(folder / "out")], catch_exceptions=False)
    seconds = time.process_time() - began
    assert (outcome.exit_code, outcome.stdout) == (2, "")
    assert list(folder.iterdir()) == [path]
    assert len(outcome.stderr.splitlines()) == 1
    assert len(outcome.stderr) < 600
    assert "; got " in outcome.stderr
    return outcome.stderr.removeprefix(f"{path}: "), seconds


def cases(table):
    return pytest.mark.parametrize(("text", "message"), table.items(), ids=[message[:50] for message in table.values()])


@cases(TEXT)
def test_bad_text_is_refused_within_a_second(tmp_path, monkeypatch, text, message):
    said, seconds = refused(text, tmp_path, monkeypatch)
    assert said.startswith(message) or (message in said and message.startswith("must be TOML"))
    assert seconds < 1


@cases(COMPILED)
def test_what_cannot_be_compiled_is_refused_within_three_seconds(tmp_path, monkeypatch, text, message):
    said, seconds = refused(text, tmp_path, monkeypatch)
    assert said.startswith(message)
    assert seconds < 3


def test_the_scene_that_these_are_made_of_is_good(tmp_path, monkeypatch):
    path = tmp_path / "scene.toml"
    path.write_text(GOOD)
    assert CliRunner().invoke(app, ["run", str(path), "-o", str(tmp_path / "out")]).exit_code == 0


@pytest.mark.parametrize("text", ["a = ", GOOD.replace("radius", "radus"), implicit("__import__('os').system('x')")])
def test_a_process_says_one_line_without_a_traceback(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    command = [sys.executable, "-W", "error", "-m", "gripper", "run", str(path)]
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert (run.returncode, run.stdout, len(run.stderr.splitlines())) == (2, "", 1)
    assert run.stderr.startswith(f"{path}: ")
    assert sorted(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("content", ["", "not a folder"])
def test_a_folder_as_scene_and_a_device_without_end_are_refused(tmp_path, content):
    scene_file = Path("/dev/zero") if content else tmp_path
    outcome = CliRunner().invoke(app, ["run", str(scene_file), "-o", str(tmp_path / "out")])
    assert (outcome.exit_code, outcome.stdout, len(outcome.stderr.splitlines())) == (2, "", 1)
    assert not (tmp_path / "out").exists()
