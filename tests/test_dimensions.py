"""A unit that is written must be right; numbers without units are SI, whatever they are of."""

import copy
import dataclasses
import functools
import math
import re

import pytest
import sympy

import gripper as gr
from gripper.describe import describe
from gripper.expression import number, parse
from gripper.expression.dimensions import METRE, NEWTON, PASCAL, PURE, RADIAN, unit
from gripper.fields import Surface, dimension, field_types
from gripper.parameters import kind, numbers
from gripper.registry import GROUPS, OWN, installed, load
from gripper.scenefile import SceneFileError, loads
from gripper.scenefile.toml import written
from gripper_plugins.fingers import Stepped
from gripper_plugins.jaws import Triangle
from gripper_plugins.loads import Force, Gravity, Moment, Tendon
from gripper_plugins.objects import Difference, Ellipse, Grown, Polygon, Superellipse

FITTING = [
    ("0.057", METRE),
    ("2*0.0285", METRE),
    ("57 mm", METRE),
    ("2 mm + 0.001", METRE),
    ("0.05 * sin(20 deg)", METRE),
    ("50 mm * 20 deg", METRE),  # an arc
    ("10 N / (2 N/mm)", METRE),
    ("sqrt((3 mm)**2 + (4 mm)**2)", METRE),
    ("max(1 mm, 2 mm, 0.1)", METRE),
    ("3 mm * (1 - s/57 mm)", METRE),
    ("3 mm * (1 - s/0.057)", METRE),
    ("0.003 - 0.01*s", METRE),
    ("8 - 100*s", unit("1/m")),
    ("1 / 20 mm", unit("1/m")),
    ("102 deg - 236.22 deg * q", RADIAN),
    ("atan2(1 mm, 2 mm) + 3 deg", RADIAN),
    ("10 mm / 5 mm", RADIAN),
    ("5 N / mm**2 + 1 MPa", PASCAL),
    ("8 N*m", unit("N*m/rad")),
    ("8 N*m/rad", unit("N*m/rad")),
    ("3 J", unit("N*m")),
    ("1150 kg/m**3", unit("kg/m**3")),
    ("tan(10 deg)", PURE),
    ("1 mm / 2 mm", PURE),
]
REFUSED = [
    ("57 N", METRE, "a length, in m; got '57 N', a force"),
    ("2*57 N", METRE, "a length, in m; got '2*57 N', a force"),
    ("20 deg", METRE, "a length, in m; got '20 deg', an angle"),
    ("57 N * (1 - s/57 mm)", METRE, "a length, in m; got"),
    ("2 mm + 3 N", METRE, "take like with like, not a length with a force (character 6); got '2 mm + 3 N'"),
    ("min(1, 2 mm, 3 kPa)", METRE, "take like with like, not a length with a stress"),
    ("sin(3 mm)", METRE, "give sin an angle, not a length"),
    ("exp(3 deg)", METRE, "give exp a number without unit, not an angle"),
    ("2**(3 mm)", METRE, "have an exponent without unit, not a length"),
    ("sqrt(4 mm)", METRE, "a quantity in m**1/2"),
    ("(2 mm)**2", METRE, "an area"),
    ("3 mm", RADIAN, "an angle, in rad; got '3 mm', a length"),
    ("8 N", unit("N*m/rad"), "a stiffness, in N*m/rad; got '8 N', a force"),
    ("9.81 N", unit("m/s**2"), "an acceleration, in m/s**2; got '9.81 N', a force"),
    ("0.3 mm", PURE, "a number without unit; got '0.3 mm', a length"),
    ("2 N / mm**3", PASCAL, "a stress, in Pa; got"),
]


@pytest.mark.parametrize(("text", "of"), FITTING)
def test_a_unit_that_fits_changes_nothing_of_the_value(text, of):
    assert parse(text, ("s", "q"), of) == parse(text, ("s", "q"))


@pytest.mark.parametrize(("text", "of", "said"), REFUSED)
def test_a_unit_of_another_quantity_is_refused_with_both(text, of, said):
    with pytest.raises(ValueError, match="expression must ") as error:
        parse(text, ("s",), of)
    assert said in str(error.value)


def test_a_parameter_whose_values_have_a_unit_is_of_that_kind():
    assert parse("q - 0.01", {"q": METRE}, METRE)
    assert parse("20 deg * q", {"q": METRE}, RADIAN)  # a coefficient's own units are seldom written
    assert parse("q / 50 mm + 10 deg", {"q": METRE}, RADIAN)  # an arc over its radius
    assert parse("q / 0.05", {"q": METRE}, RADIAN)
    for text, of in (("q", METRE), ("-q + 3", METRE), ("q + 2 mm", METRE), ("q", RADIAN)):
        with pytest.raises(ValueError, match=r"must .* a force"):
            parse(text, {"q": NEWTON}, of)


POWERS = {"N/m": (0, 1, -2, 0), "kg/m**3": (-3, 1, 0, 0), "1/m": (-1, 0, 0, 0)}


@pytest.mark.parametrize("text", POWERS)
def test_a_unit_in_text_is_powers_of_si(text):
    assert unit(text) == POWERS[text]
    assert number(f"2 {text}" if text[0] != "1" else "2 / 1 m", unit(text)) == 2


@pytest.mark.parametrize("text", ["", "m m", "/m", "furlong", "m**x", "m*"])
def test_what_is_no_unit_is_refused_with_the_known_ones(text):
    with pytest.raises(ValueError, match=r"unit must be a product of known ones.*; got"):
        unit(text)


def test_every_number_of_every_plugin_of_this_project_says_what_it_is_of():
    classes = [load(group, r.name) for group in GROUPS for r in installed(group) if r.distribution == OWN]
    silent = []
    for cls in (*classes, gr.Material, gr.Base, gr.Pose, gr.Coefficients):
        for name, annotation in field_types(cls).items():
            if "float" in str(annotation) and annotation is not Surface and dimension(annotation) is None:
                silent.append(f"{cls.__name__}.{name}")
    assert silent == ["Conic.coefficients"]  # each of another unit, whose common factor is free


q = sympy.Symbol("q", real=True)
STEEL = gr.Material(
    youngs_modulus=2.1e11,
    poisson_ratio=0.3,
    shear_modulus=8e10,
    yield_strain=0.002,
    repeated_strain=0.001,
    law="secant",
    table=((0.001, 2e8), (0.002, 3.9e8)),
)
EVERYTHING = gr.Scene(
    finger=Stepped(
        length=0.1,
        width=0.01,
        stations=(0, 0.05, 0.1),
        thicknesses=(0.002, 0.002, 0.001),
        material=STEEL,
        base=gr.Base(rotational_stiffness=5.0),
        rest_curvature=0.5,
        jaw=Triangle(length=0.01, lead_angle=0.4, return_angle=1.0),
    ).at(x=0.0, y=0.0, angle=0.1),
    object=Difference(
        parts=(
            Ellipse(semi_axes=(0.02, 0.01)),
            Superellipse(semi_axes=(0.002, 0.001), exponent=3).at(x=0.018, angle=0.1),
            Grown(part=Polygon(vertices=((-0.004, 0.02), (0.0, 0.008), (0.004, 0.02))), distance=0.001),
        )
    ).at(x=0.05, y=-0.02 + q),
    motion=gr.Motion("q", (0.0, 0.001)),
    friction=gr.Friction(coefficient={"finger": 0.2, "jaw": 0.3}),
    loads=(
        Force(force=(1.0, 2.0), s=0.08, offset=(0.0, 0.001)),
        Moment(moment=0.1),
        Gravity(density=7800.0),
        Tendon(tension=3.0, offset=0.001, guides=(0.03, 0.06)),
    ),
)
TABLES, NUMBERS = describe(EVERYTHING), numbers(EVERYTHING)


def at(key):
    """The way to a number in a scene file's tables."""
    return [int(part) if part.isdigit() else part for part in re.findall(r"[^.\[\]]+", key)]


@pytest.mark.parametrize("key", NUMBERS)
def test_every_number_of_a_scene_file_refuses_the_unit_of_another_quantity(key):
    of = kind(EVERYTHING, key)
    assert of is not None
    wrong, word = ("57 N", "a force") if of == METRE else ("57 mm", "a length")
    tables = copy.deepcopy(TABLES)
    *way, last = at(key)
    functools.reduce(lambda table, step: table[step], way, tables)[last] = wrong
    with pytest.raises(SceneFileError) as refusal:
        loads(written(tables), "scene.toml")
    assert str(refusal.value) == f"scene.toml: {key}: must be {of}; got {wrong!r}, {word}"


def test_a_scene_with_units_is_the_scene_without():
    tables = copy.deepcopy(TABLES)
    for key, value in NUMBERS.items():
        *way, last = at(key)
        table = functools.reduce(lambda table, step: table[step], way, tables)
        name = kind(EVERYTHING, key).unit
        if isinstance(table[last], float) and name and "s**2" not in name and name != "1/m":
            table[last] = f"{value!r} {name}"
    assert "7800.0 kg/m**3" in written(tables) and "5.0 N*m/rad" in written(tables)
    assert loads(written(tables)) == loads(written(TABLES))


def test_values_of_a_motion_are_of_one_kind():
    tables = copy.deepcopy(TABLES)
    tables["motion"] = {"parameter": "q", "from": "0 mm", "to": "1 N", "poses": 2}
    with pytest.raises(SceneFileError, match=r"motion\.to: must be a length, in m, as .*; got '1 N', a force"):
        loads(written(tables))
    tables["motion"]["to"] = "1 N"
    tables["motion"]["from"] = "0.1 N"
    with pytest.raises(SceneFileError, match=r"object\.pose\.y: must be a length, in m; got .*, a force"):
        loads(written(tables))


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"limits": {"max_strain": "2 mm"}}, "limits.max_strain: must be a number without unit; got '2 mm', a length"),
        ({"limits": {"max_insertion_force": "6 mm"}}, "limits.max_insertion_force: must be a force, in N"),
        (
            {"tolerance": {"finger.length": "1 N"}},
            "tolerance.finger.length: must be a length, in m; got '1 N', a force",
        ),
        ({"solver": {"tolerance": "1 mm"}}, "solver.tolerance: must be a number without unit; got '1 mm', a length"),
    ],
)
def test_limits_tolerances_and_the_solver_take_their_own_units_only(table, said):
    with pytest.raises(SceneFileError, match=re.escape(said)):
        loads(written(TABLES | table))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Bowl(gr.ImplicitSurface):
    """What an author writes: one word a field."""

    radius: gr.Length
    tilt: gr.Angle = 0.0
    free: gr.Positive = 1.0

    def g(self, x, y):
        return (x**2 + y**2 - self.radius**2) / (2 * self.radius)


def test_a_plugin_names_the_kind_of_a_field_by_its_type():
    assert [dimension(annotation) for annotation in field_types(Bowl).values()] == [METRE, RADIAN, None]
    scene = gr.Scene(finger=EVERYTHING.finger, object=Bowl(radius=0.1))
    assert kind(scene, "object.radius") == METRE
    assert kind(scene, "object.free") is None
    with pytest.raises(ValueError, match="radius must be a positive number, in m; got -1"):
        Bowl(radius=-1)
    assert math.isclose(number("20 deg", dimension(gr.Angle)), math.radians(20))
