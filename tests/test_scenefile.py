import dataclasses
import json
import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

import gripper as gr
from gripper.assemble import setting
from gripper.describe import describe as resolved
from gripper.fields import Point, Positive, Profile, Surface, check_fields
from gripper.fingers import S
from gripper.pose import Pose
from gripper.registry import installed, load
from gripper.scenefile import SceneFileError, dumps, loads, read
from gripper.scenefile.place import Place
from gripper.scenefile.tables import build
from gripper.scenefile.toml import written
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects import Circle, Difference, Ellipse, Grown, Polygon

GALLERY = Path(__file__).parent.parent / "gallery"

MATERIAL = """
[material]
youngs_modulus = "4.8 MPa"
poisson_ratio = 0.4
"""
FINGER = """
[finger]
profile = "uniform"
length = "57 mm"
thickness = "3.2 mm"
width = "9.5 mm"
"""
OBJECT = """
[object]
surface = "circle"
radius = "8.9 mm"
"""
POSE = """
[object.pose]
x = "q"
y = "-10.5 mm"
"""
MOTION = """
[motion]
parameter = "q"
from = 0.086
to = "50 mm"
poses = 37
"""
SCENE = MATERIAL + FINGER + OBJECT
MOVING = SCENE + POSE + MOTION


def with_key(text, header, line):
    """The scene with one more line in a table."""
    assert f"[{header}]\n" in text
    return text.replace(f"[{header}]\n", f"[{header}]\n{line}\n")


def without(text, *lines):
    for line in lines:
        assert line in text
        text = text.replace(line, "")
    return text


# the scene: what its message must say, beside the file's name
REFUSED = {
    # tables and keys
    MATERIAL: "finger, object: must be given; got material",
    "": "material, finger, object: must be given; got nothing",
    SCENE + "[grasp]\n": "grasp: must be a known key: title, material, ",
    SCENE + "[sover]\n": "did you mean 'solver'?",
    SCENE + "[limits]\nmax_force = 3\n": "limits.max_force: must be a known key: max_insertion_force",
    SCENE + "[limits]\n": "limits: must hold at least one of max_insertion_force",
    SCENE + "[limits]\nmax_strain = 'x'\n": "limits.max_strain: ",
    SCENE + "[[loads]]\nforce = 3\n": "loads[0].type: must be one of following_force, force, gravity, ",
    SCENE + "[loads]\ntype = 'force'\n": "loads: must be an array of tables, [[loads]]; got a table of type",
    SCENE + "[[loads]]\ntype = 'wind'\n": "loads[0].type: must be one of following_force, ",
    SCENE + "[[loads]]\ntype = 'force'\nforce = [0, 'q']\n": "loads[0].force[1]: must hold known names only, not 'q'",
    SCENE + "[[loads]]\ntype = 'force'\nforce = [0, 1]\ns = '58 mm'\n": "loads[0].s: must lie above 0 and up to",
    SCENE + "[[loads]]\ntype = 'gravity'\n": "loads[0]: density must be given, in kg/m^3, or else mass_per_length",
    SCENE
    + "[friction]\ncoefficient = 0.2\nsense = 'tipward'\n"
    + "[[loads]]\ntype = 'following_force'\nforce = [0, 1]\n": "loads: must have a potential that stays as it is",
    SCENE
    + "[tolerance]\nlength = 3\n": "tolerance.length: must be the key of a number (unknown number 'length'; known: ",
    SCENE + "[tolerance]\nfinger.length = 0\n": "tolerance.finger.length: must be a positive number, in m; got 0",
    SCENE + "[friction]\npair = ['POM', 'wood']\n": "friction.pair: must be a pair with a known coefficient",
    SCENE + "[friction]\npair = 'POM'\n": "friction.pair: must be two materials",
    SCENE + "[friction]\npair = ['POM', 'steel']\ncoefficient = 1\n": "friction: must have either coefficient or pair",
    "tolerance = 3\n" + SCENE: "the solver's is solver.tolerance",
    "title = 3\n" + SCENE: "title: must be a text; got 3",
    "material = 3\n" + FINGER + OBJECT: "material: must be a table; got 3",
    MATERIAL + FINGER.replace("[finger]", "[[finger]]") + OBJECT: "finger: must be one table, [finger]",
    SCENE + "[finger.base]\nx = 1\n": "finger.base.x: must be a known key: rotational_stiffness",
    SCENE + "[finger.base]\nrotational_stiffness = 0\n": "finger.base.rotational_stiffness: must be a positive number",
    with_key(SCENE, "object", "radus = 3"): "object.radus: must be a known key: surface, pose, radius",
    with_key(SCENE, "finger", "thicknes = 3"): "did you mean 'thickness'?",
    with_key(SCENE, "finger", "material = 3"): "finger.material: must be a known key: profile, pose, jaw, base, ",
    with_key(SCENE, "object", '"ra\\ndius" = 3'): "object.'ra\\ndius': must be a known key",
    without(SCENE, 'radius = "8.9 mm"'): "object.radius: must be given; got surface",
    without(SCENE, 'length = "57 mm"', 'width = "9.5 mm"'): "finger.length, finger.width: must be given; got profile",
    without(SCENE, 'surface = "circle"'): "object.surface: must be one of circle, conic, ",
    # plugins
    SCENE.replace('"circle"', '"cirle"'): "object.surface: must be one of circle, ",
    SCENE.replace('"circle"', "3"): "object.surface: must be one of circle, ",
    SCENE.replace('"uniform"', '"tapred"'): "did you mean 'tapered'?",
    SCENE + '[finger.jaw]\nshape = "hook"\n': "finger.jaw.shape: must be one of polygon, triangle",
    SCENE + "[finger.jaw]\n": "finger.jaw.shape: must be one of polygon, triangle; got nothing",
    SCENE
    + '[finger.jaw]\nshape = "triangle"\n': "finger.jaw.length, finger.jaw.lead_angle, finger.jaw.return_angle: must",
    SCENE + '[finger.jaw]\nshape = "triangle"\nlength = 1\nlead_angle = 1\nreturn_angle = 1\nside = "left"\n': (
        "finger.jaw.side: must be 'lower' or 'upper'; got 'left'"
    ),
    # numbers
    SCENE.replace('"8.9 mm"', "-1"): "object.radius: must be a positive number, in m; got -1.0",
    SCENE.replace('"8.9 mm"', "nan"): "object.radius: must be a finite number; got nan",
    SCENE.replace('"8.9 mm"', "-inf"): "object.radius: must be a finite number; got -inf",
    SCENE.replace('"8.9 mm"', "true"): "object.radius: must be a number, or an expression in a string; got true",
    SCENE.replace(
        '"8.9 mm"', "1979-05-27"
    ): "object.radius: must be a number, or an expression in a string; got 1979-05-27",
    SCENE.replace('"8.9 mm"', "[1]"): "object.radius: must be a number, or an expression in a string; got [1]",
    SCENE.replace(
        '"8.9 mm"', "{ a = 1 }"
    ): "object.radius: must be a number, or an expression in a string; got a table of a",
    SCENE.replace('"8.9 mm"', "1" + "0" * 400): "object.radius: must be a finite number; got 1000",
    SCENE.replace(
        '"8.9 mm"', "0x" + "f" * 8000
    ): "object.radius: must be a finite number; got one too long to show (int)",
    SCENE.replace('"8.9 mm"', '"8.9 mm mm"'): "object.radius: must have * between factors",
    SCENE.replace('"8.9 mm"', "\"__import__('os')\""): "object.radius: must hold nothing but numbers",
    SCENE.replace('"8.9 mm"', '"q"'): "object.radius: must hold known names only, not 'q'",
    SCENE.replace('"9.5 mm"', '"1 + x"'): "finger.width: must hold known names only, not 'x'; known: s, pi",
    SCENE.replace("= 0.4", "= 0.6"): "material.poisson_ratio: must lie above -1 and at most at 0.5; got 0.6",
    with_key(SCENE, "material", 'plane = "stres"'): "material.plane: must be 'stress' or 'strain'; got 'stres'",
    with_key(SCENE, "material", "plane = 3"): "material.plane: must be 'stress' or 'strain'; got 3",
    with_key(SCENE, "material", "yield_strain = 0"): "material.yield_strain: must be a positive number",
    MATERIAL
    + FINGER
    + '[object]\nsurface = "ellipse"\nsemi_axes = [1]\n': "object.semi_axes: must have 2 entries; got 1: [1]",
    MATERIAL
    + FINGER
    + '[object]\nsurface = "ellipse"\nsemi_axes = [1, "x"]\n': "object.semi_axes[1]: must hold known names",
    MATERIAL
    + FINGER
    + '[object]\nsurface = "ellipse"\nsemi_axes = [1, -1]\n': "object.semi_axes[1]: must be a positive",
    MATERIAL + FINGER + '[object]\nsurface = "ellipse"\nsemi_axes = 3\n': "object.semi_axes: must be an array; got 3",
    MATERIAL + FINGER + '[object]\nsurface = "implicit"\nexpression = 3\nextent = 1\n': (
        "object.expression: must be an expression in x and y, in a string; got 3"
    ),
    MATERIAL
    + FINGER
    + '[object]\nsurface = "implicit"\nexpression = "x + s"\nextent = 1\n': "not 's'; known: x, y, pi",
    # poses
    SCENE + POSE: "object.pose.x: must hold known names only, not 'q'",
    MOVING.replace('x = "q"', 'x = "p"'): "object.pose.x: must hold known names only, not 'p'; known: q, pi",
    MOVING.replace('x = "q"', 'x = "x"'): "object.pose.x: must hold known names only, not 'x'",
    MOVING.replace('x = "q"', "x = true"): "object.pose.x: must be a number",
    MOVING.replace('x = "q"', 'z = "q"'): "object.pose.z: must be a known key: x, y, angle",
    with_key(SCENE, "finger", "pose = 3"): "finger.pose: must be a table; got 3",
    # motion
    without(MOVING, "from = 0.086", "poses = 37"): "motion.from, motion.poses: must be given; got parameter, to",
    without(MOVING, 'parameter = "q"'): "motion.parameter: must be given",
    with_key(MOVING, "motion", "values = [1, 2]"): "motion: must have either values, or from, to and poses",
    with_key(
        MOVING, "motion", "step = 1"
    ): "motion.step: must be a known key: parameter, from, to, poses, values, back",
    with_key(MOVING, "motion", 'back = "yes"'): "motion.back: must be true or false; got 'yes'",
    with_key(MOVING.replace("= 37", "= 60000"), "motion", "back = true"): "motion.poses: must be at most 50000",
    MOVING.replace("= 37", "= 1000000000"): "motion.poses: must lie between 2 and 100000; got 1000000000",
    MOVING.replace("= 37", "= 1"): "motion.poses: must lie between 2 and 100000; got 1",
    MOVING.replace("= 37", "= 3.5"): "motion.poses: must be a whole number; got 3.5",
    MOVING.replace("= 37", "= true"): "motion.poses: must be a number",
    MOVING.replace('"50 mm"', "0.086"): "motion: from and to must be two different finite numbers",
    MOVING.replace('"50 mm"', "inf"): "motion.to: must be a finite number; got inf",
    MOVING.replace('"q"', '"mm"'): "motion.parameter: must be a name of letters",
    MOVING.replace('"q"', '"x"'): "motion.parameter: must be a name of letters",
    MOVING.replace('"q"', '"a b"'): "motion.parameter: must be a name of letters",
    MOVING.replace('"q"', "3"): "motion.parameter: must be a name of letters",
    SCENE + '[motion]\nparameter = "q"\nvalues = []\n': "motion.values: must hold 1 to 100000 poses; got 0",
    SCENE + '[motion]\nparameter = "q"\nvalues = 3\n': "motion.values: must be an array; got 3",
    SCENE
    + '[motion]\nparameter = "q"\nvalues = [1, "two"]\n': "motion.values[1]: must hold known names only, not 'two'",
    # approach, solver
    SCENE + "[approach]\ndirection = [0, 0]\n": "approach.direction: must be a direction other than (0, 0)",
    SCENE + "[approach]\ndirection = [0]\n": "approach.direction: must have 2 entries",
    SCENE + "[approach]\nfrom = [0, 1]\n": "approach.from: must be a known key: direction",
    SCENE + '[solver]\ntheory = "shera"\n': "solver.theory: must be one of auto, bending, shear, stretch; got 'shera'",
    SCENE + "[solver]\ntheory = []\n": "solver.theory: must be one of auto, bending, shear, stretch; got []",
    SCENE + "[solver]\ntolerance = 0.5\n": "solver.tolerance: must lie between 1e-12 and 0.1; got 0.5",
    SCENE + "[solver]\ntolerance = -1\n": "solver.tolerance: must be a positive number",
    # friction
    SCENE + "[friction]\ncoefficient = 0.2\n": "friction: must come with a motion, along which slip is found, or",
    SCENE
    + '[friction]\ncoefficient = "0.1 - 100 * s"\nsense = "tipward"\n': "friction.coefficient: must be at least 0; got",
    SCENE + "[friction]\ncoefficient = { finger = 0, jaw = -0.1 }\n": "friction.coefficient: must be at least 0",
    MOVING + '[friction]\ncoefficient = 0.2\nmodel = "published"\n': "friction.sense: must be 'tipward' or 'baseward'",
    SCENE + "[friction]\ncoefficient = { finger = 0 }\n": "friction.coefficient.jaw: must be given; got finger",
    SCENE
    + "[friction]\ncoefficient = { finger = 0, jaw = 0, peg = 1 }\n": "friction.coefficient.peg: must be a known key",
    SCENE + "[friction]\ncoefficient = -0.1\n": "friction.coefficient: must be at least 0; got -0.1",
    SCENE + "[friction]\ncoefficient = true\n": "friction.coefficient: must be a number",
    SCENE + '[friction]\nmodel = "coulomb"\n': "friction.coefficient: must be given",
    SCENE + '[friction]\ncoefficient = 0\nmodel = "viscous"\n': "friction.model: must be one of coulomb, published",
    SCENE + '[friction]\ncoefficient = 0\nsense = "up"\n': "friction.sense: must be one of tipward, baseward; got 'up'",
    MOVING + '[friction]\ncoefficient = 0.1\nsense = "tipward"\n': "friction.sense: must be left out",
    # TOML
    SCENE + "a = \n": "line 15: must be TOML (",
    SCENE + '"open = 3': "line 15: must be TOML (",
    SCENE + SCENE: "must be TOML (",
    SCENE.replace('"8.9 mm"', "[{" + "a." * 900 + "a = 1}]"): "object.radius: must be a number",
    "a = " + "[" * 20_000: "must be TOML with few levels",
    "a = 1" + "0" * 5000: "must be TOML (",
}


def message_of(text):
    with pytest.raises(SceneFileError) as refusal:
        loads(text, "bad.toml")
    return str(refusal.value)


@pytest.mark.parametrize(
    "text", REFUSED, ids=[str(i) + " " + message[:40] for i, message in enumerate(REFUSED.values())]
)
def test_a_bad_scene_is_refused_in_one_line_with_file_key_rule_and_value(text):
    message = message_of(text)
    assert REFUSED[text] in message
    assert message.startswith("bad.toml: ")
    assert "; got " in message
    assert len(message.splitlines()) == 1
    assert len(message) < 600


def test_no_message_of_pydantic_reaches_the_user():
    for message in map(message_of, REFUSED):
        assert not any(word in message for word in ("Input should", "validation error", "pydantic", "Value error"))


NOTCHED = """
[object]
surface = "difference"
pose = {x = "40 mm", y = "-2 mm"}
[[object.parts]]
surface = "grown"
part = {surface = "polygon", vertices = [["-8 mm", "-8 mm"], ["8 mm", "-8 mm"], [0.008, 0], [-0.008, 0]]}
distance = "1 mm"
[[object.parts]]
surface = "circle"
radius = "2 mm"
pose = {y = "1 mm", angle = "10 deg"}
"""


def test_objects_within_objects_are_tables_within_tables():
    read, angle = loads(MATERIAL + FINGER + NOTCHED), math.radians(10)
    corners = ((-0.008, -0.008), (0.008, -0.008), (0.008, 0.0), (-0.008, 0.0))
    block = Grown(part=Polygon(vertices=corners), distance=0.001)
    assert read.object.body == Difference(parts=(block, Circle(radius=0.002).at(y=0.001, angle=angle)))
    assert read.object.pose == Pose(x=0.04, y=-0.002)
    assert loads(dumps(read)).object == read.object


@pytest.mark.parametrize(
    ("one", "other", "message"),
    [
        ('radius = "2 mm"', "radius = -1", "object.parts[1].radius: must be a positive number"),
        ('radius = "2 mm"', "radus = 1", "object.parts[1].radus: must be a known key: surface, pose, radius"),
        ('surface = "circle"', 'surface = "circel"', "object.parts[1].surface: must be one of circle"),
        ('pose = {y = "1 mm"', 'pose = {y = "q"', "object.parts[1].pose.y: must hold known names only"),
        ('distance = "1 mm"', "distance = 0", "object.parts[0].distance: must be a positive number"),
        ('surface = "polygon", ', "", "object.parts[0].part.surface: must be one of circle"),
    ],
)
def test_a_bad_object_within_an_object_is_named_by_its_place(one, other, message):
    assert one in NOTCHED
    assert message in message_of(MATERIAL + FINGER + NOTCHED.replace(one, other))


def test_objects_within_objects_have_an_end():
    inner = '{surface = "circle", radius = 1}'
    for _ in range(10):
        inner = f'{{surface = "grown", distance = 1, part = {inner}}}'
    text = MATERIAL + FINGER + f'[object]\nsurface = "grown"\ndistance = 1\npart = {inner}\n'
    assert "must lie within at most 8 other objects" in message_of(text)


def test_the_rotating_finger_of_the_gallery_has_the_papers_numbers():
    scene = read(GALLERY / "rotating_finger.toml")
    finger, target = scene.finger, scene.object
    assert isinstance(finger.body, Tapered)
    assert (finger.body.length, finger.body.base_thickness, finger.body.tip_thickness) == (0.1778, 0.030, 0.017)
    assert finger.body.width == 0.025
    material = finger.body.material
    assert (material.youngs_modulus, material.shear_modulus, material.poisson_ratio) == (4.8e6, 1.71e6, 0.4)
    assert target.body == Ellipse(semi_axes=(0.04953, 0.033655))
    x_e = sympy.Symbol("x_e", real=True)
    assert target.pose == Pose(x=x_e, y=0.12065)
    for value, degrees in ((-0.1016, 126.0), (0.2032, 54.0)):
        assert math.degrees(finger.pose.angle.subs(x_e, value)) == pytest.approx(degrees, abs=1e-3)
    assert scene.motion.parameter == "x_e"
    assert len(scene.motion.values) == 49
    assert (scene.motion.values[0], scene.motion.values[-1]) == (-0.1016, 0.2032)
    assert (scene.theory, scene.tolerance, scene.approach) == ("shear", 1e-4, (0.0, 1.0))


def test_the_micro_assembly_of_the_gallery_has_the_papers_numbers():
    scene = read(GALLERY / "micro_assembly.toml")
    finger = scene.finger.body
    assert isinstance(finger, Uniform)
    assert (finger.length, finger.thickness, finger.width) == (0.057, 0.0032, 0.0095)
    assert (finger.material.youngs_modulus, finger.material.shear_modulus) == (2.6e9, None)
    assert finger.jaw == Triangle(length=0.019, lead_angle=math.radians(20), return_angle=math.radians(60))
    assert scene.object.body == Circle(radius=0.0089)
    assert scene.object.pose.y == -0.0105
    assert scene.finger.pose == Pose()
    assert (len(scene.motion.values), scene.motion.values[0], scene.motion.values[-1]) == (37, 0.086, 0.05)
    assert scene.theory == "bending"


def test_text_and_number_make_the_same_scene():
    assert loads(SCENE) == loads(SCENE.replace('"8.9 mm"', "0.0089").replace('"4.8 MPa"', "4800000"))


def test_a_motion_lists_its_values_in_the_order_given_and_returns_the_same_way():
    listed = SCENE + POSE + '[motion]\nparameter = "q"\nvalues = [3, "1 mm", 2]\n'
    assert loads(listed).motion.values == (3.0, 0.001, 2.0)
    assert loads(listed + "back = true\n").motion.values == (3.0, 0.001, 2.0, 0.001, 3.0)
    spaced = loads(MOVING.replace("= 37", '= "3"') + "back = true\n").motion.values
    assert spaced == pytest.approx((0.086, 0.068, 0.05, 0.068, 0.086))


def test_a_profile_may_depend_on_s_and_a_surface_on_x_and_y():
    surface = '[object]\nsurface = "implicit"\nexpression = "(x**2 + 2*y**2 - (20 mm)**2) / 40 mm"\nextent = "50 mm"\n'
    scene = loads(MATERIAL + FINGER.replace('"9.5 mm"', '"9 mm + s / 100"') + surface)
    s, x, y = (sympy.Symbol(name, real=True) for name in "sxy")
    assert sympy.simplify(scene.finger.body.width - (0.009 + 0.01 * s)) == 0
    assert scene.object.body.expression.free_symbols == {x, y}


@pytest.mark.parametrize("coefficient", ["0", '"0"', '"0 * s"', "{ finger = 0, jaw = 0.0 }"])
def test_friction_of_nothing_is_no_friction(coefficient):
    scene = loads(SCENE + f"[friction]\ncoefficient = {coefficient}\n")
    assert scene.friction.absent
    assert setting(scene).friction is None


@pytest.mark.parametrize(
    "table",
    [
        'coefficient = 0.2\nsense = "tipward"',
        'coefficient = "0.1 + s"\nsense = "baseward"',
        'coefficient = { finger = "0.1 + 2 * s", jaw = 0.3 }\nsense = "baseward"\nmodel = "published"',
    ],
)
def test_friction_written_and_read_back_says_the_same(table):
    scene = loads(SCENE + f"[friction]\n{table}\n")
    again = loads(dumps(scene))
    assert again.friction == scene.friction
    assert resolved(again) == resolved(scene)


def test_the_yield_strain_and_the_approach_reach_the_scene():
    scene = loads(
        with_key(SCENE, "material", 'yield_strain = 0.3\nplane = "strain"') + "[approach]\ndirection = [1, 0]\n"
    )
    assert (scene.finger.body.material.yield_strain, scene.finger.body.material.plane) == (0.3, "strain")
    assert scene.approach == (1.0, 0.0)


@pytest.mark.parametrize("name", ["rotating_finger", "micro_assembly"])
def test_a_scene_written_and_read_back_says_the_same(name):
    scene = read(GALLERY / f"{name}.toml")
    again = loads(dumps(scene))
    assert resolved(again) == resolved(scene)
    assert loads(dumps(again)) == again
    assert json.loads(json.dumps(resolved(scene), allow_nan=False)) == resolved(scene)


@given(st.text(st.characters(exclude_categories=["Cs"])))
def test_any_text_is_written_as_toml_that_reads_back(text):
    tables = {"title": text, "nested": {"values": [1, 2.5e-7, 1e300, True], "deeper": {"text": text}}}
    assert tomllib.loads(written(tables)) == tables


def test_an_expression_is_written_in_the_grammar_that_reads_it():
    pose = '[object.pose]\nx = "max(q, 1 mm) + abs(q - 1/3) * atan2(q, 2)"\ny = "-q**2 + sqrt(q) / exp(q)"\n'
    scene = loads(SCENE + pose + MOTION)
    assert loads(dumps(scene)).object.pose == scene.object.pose


@pytest.mark.parametrize("content", [b"\xff\xfe", SCENE.encode("utf-16"), SCENE.encode() + b"# \xe9\n"])
def test_a_file_that_is_not_utf_8_is_refused_with_the_line(tmp_path, content):
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(SceneFileError, match=r"scene\.toml: must be UTF-8; got byte 0x.. in line"):
        read(path)


def test_a_byte_order_mark_is_no_error(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SCENE.encode())
    assert read(path) == loads(SCENE)


@pytest.mark.parametrize("name", ["missing.toml", ".", "nul\0l"])
def test_a_file_that_cannot_be_read_is_refused_by_its_name(tmp_path, name):
    with pytest.raises(SceneFileError, match="must be a file that can be read; got"):
        read(f"{tmp_path}/{name}")


def test_every_installed_plugin_says_which_keys_are_missing():
    templates = {
        "gripper.objects": MATERIAL + FINGER + '[object]\nsurface = "{name}"\n',
        "gripper.fingers": MATERIAL + OBJECT + '[finger]\nprofile = "{name}"\n',
        "gripper.jaws": SCENE + '[finger.jaw]\nshape = "{name}"\n',
        "gripper.loads": SCENE + '[[loads]]\ntype = "{name}"\n',
    }
    for group, template in templates.items():
        for record in installed(group):
            text = template.format(name=record.name)
            if record.name == "gravity":
                assert "must be given, in kg/m^3, or else" in message_of(text)
            elif any(field.default is dataclasses.MISSING for field in dataclasses.fields(load(group, record.name))):
                assert "must be given; got" in message_of(text)
            else:
                assert loads(text)


VALUES = st.one_of(
    st.sampled_from(
        ["1", "-1", "0", "nan", "true", '"q"', '"1 mm"', '"x"', "[]", "[1, 2]", "[[1, 2]]", "{}", '""', "1e308"]
    ),
    st.sampled_from(
        ["{ x = 1 }", '"circle"', '"triangle"', '"auto"', "1979-05-27", "9" * 30, '"1/0"', '["a", "b"]', "inf"]
    ),
)


@given(st.data())
def test_whatever_stands_for_a_value_is_a_scene_or_a_scene_file_error(data):
    lines = (MOVING + '[finger.jaw]\nshape = "triangle"\nlength = 1\nlead_angle = 1\nreturn_angle = 1\n').splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        i = data.draw(st.sampled_from([i for i, line in enumerate(lines) if " = " in line]))
        lines[i] = f"{lines[i].split(' = ')[0]} = {data.draw(VALUES)}"
    try:
        loads("\n".join(lines))
    except SceneFileError as error:
        assert len(str(error).splitlines()) == 1


@dataclass(frozen=True, kw_only=True)
class Sample:
    """Every sort of field that a plugin may have."""

    size: float
    profile: Profile = 1.0
    surface: Surface = S
    count: int = 1
    label: str = ""
    side: Literal["left", "right"] = "left"
    limit: Positive | None = None
    hollow: bool = False
    layers: int | None = None
    corners: tuple[Point, ...] = ()
    name_or_size: str | float = 0.0

    def __post_init__(self):
        check_fields(self)
        if self.count == 13:
            raise ZeroDivisionError("unlucky")
        if self.count == 14:
            raise ValueError("corners and count must differ; got 14")


def sample(**table):
    return build(Sample, {"size": 1} | table, Place("file.toml", "part"))


def test_fields_are_read_by_their_annotations():
    read = sample(
        size="2 mm",
        profile="1 mm",
        surface="x*y",
        count="2**3",
        label="2 mm",
        limit="3 kPa",
        hollow=True,
        corners=[["1 mm", 2], [3, "4 cm"]],
        name_or_size="2 mm",
    )
    x, y = sympy.Symbol("x", real=True), sympy.Symbol("y", real=True)
    assert read == Sample(
        size=0.002,
        profile=0.001,
        surface=x * y,
        count=8,
        label="2 mm",
        limit=3000.0,
        hollow=True,
        corners=((0.001, 2.0), (3.0, 0.04)),
        name_or_size="2 mm",
    )
    assert hash(read)
    assert sample(profile="s").profile == S


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"count": 1.5}, "file.toml: part.count: must be a whole number; got 1.5"),
        ({"count": True}, "part.count: must be a number, or an expression in a string; got true"),
        ({"label": 3}, "part.label: must be a valid string; got 3"),
        ({"hollow": "yes"}, "part.hollow: must be true or false; got 'yes'"),
        ({"side": "up"}, "part.side: must be 'left' or 'right'; got 'up'"),
        ({"limit": 0}, "part.limit: must be a positive number, in SI units; got 0.0"),
        ({"limit": "0 mm"}, "part.limit: must be a positive number"),
        ({"corners": [[1, 2], [3]]}, "part.corners[1]: must have 2 entries; got 1: [3]"),
        ({"corners": [[1, 2], [3, "4 foo"]]}, "part.corners[1][1]: must hold known names only, not 'foo'"),
        ({"corners": [[1, True]]}, "part.corners[0][1]: must be a number"),
        ({"name_or_size": []}, "part.name_or_size"),
        ({"count": 13}, "part: must be what Sample can be made of (it fails with ZeroDivisionError: unlucky)"),
        ({"count": 14}, "file.toml: part: corners and count must differ; got 14"),
        ({"layers": True}, "part.layers: must be a number"),
        ({"sise": 1}, "part.sise: must be a known key: size, profile, "),
    ],
)
def test_a_field_that_breaks_its_rule_is_named_with_its_place(table, message):
    with pytest.raises(SceneFileError) as refusal:
        sample(**table)
    assert message in str(refusal.value)
    assert "Input should" not in str(refusal.value)


@pytest.mark.parametrize("name", ["rotating_finger", "micro_assembly"])
def test_the_scene_of_a_result_is_read_back_as_it_was(tmp_path, name):
    scene = read(GALLERY / f"{name}.toml")
    path = tmp_path / "result.json"
    path.write_text(json.dumps({"schema": 1, "scene": resolved(scene), "poses": []}))
    assert read(path) == loads(dumps(scene))
    assert resolved(read(path)) == resolved(scene)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "must be JSON, as result.json is; got JSONDecodeError"),
        ("[" * 100_000, "must be JSON, as result.json is; got RecursionError"),
        ("[]", "scene: must be a table; got None"),
        ('{"scene": {"material": {"youngs_modulus": NaN}}}', "scene.finger, scene.object: must be given; got material"),
        ('{"scene": {"titel": ""}}', "scene.titel: must be a known key: title, "),
    ],
)
def test_a_result_without_a_scene_is_refused_by_its_key(tmp_path, text, message):
    path = tmp_path / "result.json"
    path.write_text(text)
    with pytest.raises(SceneFileError) as refusal:
        read(path)
    assert str(refusal.value).startswith(f"{path}: {message}")


def test_a_quantity_without_its_quotes_is_told_so():
    assert 'a quantity with a unit stands in quotes, as "60 mm"' in message_of(SCENE.replace('"8.9 mm"', "8.9 mm"))


def test_a_motion_that_moves_nothing_is_refused_and_in_python_a_warning():
    still = MOVING.replace('x = "q"', "x = 0.08")
    assert still != MOVING
    message = message_of(still)
    assert "motion.parameter: must stand in an expression of finger.pose, object.pose or a load" in message
    assert "got 'q', which stands in none" in message
    assert loads(still + "[[loads]]\ntype = 'force'\nforce = [0, '1 N/m * q']\n")
    scene = loads(MOVING)
    scene = dataclasses.replace(scene, object=dataclasses.replace(scene.object, pose=Pose(x=0.1, y=-0.1)))
    warning, *_ = gr.trace(scene).model.warnings
    assert warning == "the motion moves nothing: its parameter 'q' stands in no pose and in no load"
