"""Every installed plugin against every property that its kind promises."""

import dataclasses
from importlib.metadata import entry_points

import numpy as np
import pytest
import sympy

from gripper.fingers import Finger, Jaw, Material, S
from gripper.loads import Load
from gripper.objects import Object
from gripper.testing import FINGER_PROPERTIES, JAW_PROPERTIES, LOAD_PROPERTIES, OBJECT_PROPERTIES
from gripper.testing.contract import run
from gripper_plugins.objects import Circle, Ellipse, HalfPlane, Polygon

RUBBER = Material(youngs_modulus=4.8e6, poisson_ratio=0.4)
ELBOW = ((0.0, 0.0), (0.04, 0.0), (0.04, 0.01), (0.01, 0.01), (0.01, 0.03), (0.0, 0.03))
HEXAGON = tuple((0.05 * np.cos(a), 0.04 * np.sin(a)) for a in np.arange(6) * np.pi / 3)
BEAN = tuple((0.04 * np.cos(a), (0.02 + 0.012 * np.cos(2 * a)) * np.sin(a)) for a in np.arange(14) * np.pi / 7)
BLOCK = Polygon(vertices=((-0.05, -0.04), (0.05, -0.04), (0.05, 0.0), (-0.05, 0.0)))
Q = sympy.Symbol("q")
DIE = Circle(radius=0.015)
BEAM = {"length": 0.1, "width": 0.02, "material": RUBBER}

SAMPLES = {
    "gripper.objects": {
        "circle": [{"radius": 0.03}],
        "ellipse": [{"semi_axes": (0.05, 0.03)}, {"semi_axes": (0.01, 0.04)}],
        "conic": [
            {"coefficients": (1.0, 2.0, 0.5, 0.01, 0.02, -0.001)},
            {"coefficients": (1.0, -1.0, 0.3, 0.0, 0.01, -0.001)},
            {"coefficients": (1.0, -1.0, 0.3, 0.0, 0.01, 0.001)},
            {"coefficients": (1.0, 0.0, 0.0, 0.0, 0.1, 0.0)},
            {"coefficients": (0.0, 0.0, 0.0, 1.0, 2.0, 0.01)},
            {"coefficients": (1.0, 0.0, 0.0, 0.0, 0.0, -0.001)},
        ],
        "difference": [
            {"parts": (BLOCK, DIE)},
            {"parts": (Circle(radius=0.04), DIE.at(x=0.01))},
            {"parts": (HalfPlane(), DIE.at(y=0.005), BLOCK.at(x=0.08, y=0.01, angle=0.4))},
        ],
        "grown": [
            {"part": Polygon(vertices=ELBOW), "distance": 0.004},
            {"part": Ellipse(semi_axes=(0.04, 0.02)).at(x=0.01, angle=0.5), "distance": 0.01},
        ],
        "halfplane": [{}],
        "intersection": [
            {"parts": (Circle(radius=0.05).at(y=0.03), Ellipse(semi_axes=(0.05, 0.04)).at(y=-0.01, angle=0.3))},
            {"parts": (HalfPlane().at(angle=0.4), HalfPlane().at(angle=-0.5))},
        ],
        "superellipse": [
            {"semi_axes": (0.05, 0.03), "exponent": 4},
            {"semi_axes": (0.03, 0.03), "exponent": 2.5},
        ],
        "union": [
            {"parts": (BLOCK, DIE)},
            {"parts": (Circle(radius=0.02).at(x=-0.03), Ellipse(semi_axes=(0.02, 0.01)).at(x=0.03, angle=1.0))},
        ],
        "implicit": [
            {"expression": "(x/0.05)**4 + (y/0.03)**4 - 1", "extent": 0.07},
            {
                "expression": "sqrt(x**2 + y**2) - 0.03 - 0.004*cos(3*atan2(y, x))*exp(-1e-6/(x**2 + y**2))",
                "extent": 0.05,
            },
            {"expression": "max(abs(x), abs(y)) - 0.03", "extent": 0.05},
            {"expression": sympy.Symbol("x") ** 2 + 2 * sympy.Symbol("y") ** 2 - 0.001, "extent": 0.05},
        ],
        "polygon": [{"vertices": ELBOW}, {"vertices": HEXAGON}, {"vertices": HEXAGON[::-1]}],
        "spline": [{"points": BEAN}, {"points": HEXAGON}, {"points": BEAN[::-1]}],
    },
    "gripper.fingers": {
        "formula": [
            {**BEAM, "thickness": 0.01 + 0.002 * sympy.cos(60 * S)},
            {**BEAM, "thickness": sympy.Max(0.004, 0.01 - S / 10), "width": 0.01 + sympy.Abs(S - 0.03) / 5},
        ],
        "stepped": [
            {**BEAM, "stations": (0, 0.05, 0.05, 0.1), "thicknesses": (0.01, 0.008, 0.012, 0.006)},
            {**BEAM, "stations": (0, 0.02, 0.1), "thicknesses": (0.01, 0.01, 0.006)},
        ],
        "uniform": [{**BEAM, "thickness": 0.01}],
        "tapered": [
            {**BEAM, "base_thickness": 0.02, "tip_thickness": 0.005},
            {**BEAM, "base_thickness": 0.005, "tip_thickness": 0.02, "width": 0.01 + S / 10},
        ],
    },
    "gripper.jaws": {
        "triangle": [
            {"length": 0.019, "lead_angle": np.deg2rad(20), "return_angle": np.deg2rad(60)},
            {"length": 0.019, "lead_angle": 0.3, "return_angle": np.pi / 2, "side": "upper"},
            {"length": 0.019, "lead_angle": 0.3, "return_angle": 1.8},
        ],
        "polygon": [{"vertices": ELBOW}, {"vertices": ((0, -0.01), (0.01, -0.01), (0.0, -0.02))}],
    },
    "gripper.loads": {
        "following_force": [{"force": (0.0, 2.0)}, {"force": (-Q, 2 * Q), "s": 0.03, "offset": (0.01, -0.002)}],
        "force": [
            {"force": (0.5, -2.0)},
            {"force": (Q, 1.0 - Q**2), "s": 0.04, "offset": (0.01, 0.002), "frame": "finger"},
        ],
        "gravity": [{"density": 1200.0}, {"mass_per_length": 0.1 + S / 10, "acceleration": (9.81 * sympy.sin(Q), 0.0)}],
        "moment": [{"moment": -0.02}, {"moment": 0.1 * Q, "s": 0.05}],
        "tendon": [
            {"tension": 3.0, "offset": -0.004, "guides": (0.03, 0.1)},
            {"tension": Q, "offset": 0.002, "guides": (0.1,)},
        ],
    },
}
BAD = {
    "gripper.objects": {
        "circle": [("radius", 0.0), ("radius", np.inf), ("radius", "0.1")],
        "ellipse": [("semi_axes", (0.1, -0.1)), ("semi_axes", (0.1,)), ("semi_axes", (0.1, np.nan))],
        "conic": [("coefficients", (1, 1, 0, 0, 0, 1)), ("coefficients", (1, 1, 0, 0, 0)), ("coefficients", (0,) * 6)],
        "difference": [("parts", (DIE,)), ("parts", (DIE, BLOCK.at(y=0.02), DIE)), ("parts", (DIE, 3.0))],
        "grown": [("distance", 0.0), ("part", HalfPlane()), ("part", "circle")],
        "halfplane": [],
        "intersection": [("parts", (DIE, DIE.at(x=1.0))), ("parts", (DIE, DIE.at(x=sympy.Symbol("q"))))],
        "superellipse": [("semi_axes", (0.1, 0.0)), ("exponent", 1.5), ("exponent", np.nan)],
        "union": [("parts", ()), ("parts", (HalfPlane(), HalfPlane().at(angle=np.pi)))],
        "implicit": [("expression", "x**2 + z"), ("expression", "1"), ("extent", 0.0), ("extent", 0.02)],
        "polygon": [("vertices", ELBOW[:2]), ("vertices", (*ELBOW, (0.0, np.nan))), ("vertices", ((0, 0, 0),) * 3)],
        "spline": [("points", HEXAGON[:2]), ("points", (HEXAGON[0], HEXAGON[0], *HEXAGON[1:]))],
    },
    "gripper.fingers": {
        "formula": [("thickness", sympy.Symbol("q")), ("thickness", np.nan)],
        "stepped": [
            ("stations", (0, 0.05, 0.09)),
            ("stations", (0, 0.06, 0.05, 0.1)),
            ("stations", (0, 0.1)),
            ("thicknesses", (0.01, 0.0, 0.01, 0.01)),
            ("stations", (0, 0, 0.05, 0.1)),
        ],
        "uniform": [("thickness", 0.0), ("length", -1.0), ("width", "wide")],
        "tapered": [("tip_thickness", 0.0), ("base_thickness", np.inf), ("length", 0.0)],
    },
    "gripper.jaws": {
        "triangle": [
            ("length", 0.0),
            ("lead_angle", 0.0),
            ("return_angle", np.pi),
            ("lead_angle", 2.5),
            ("side", "left"),
        ],
        "polygon": [("vertices", ELBOW[:2]), ("vertices", ((0, 0), (2, 1), (2, 0), (0, 1.5)))],
    },
    "gripper.loads": {
        "following_force": [("s", 0.0), ("force", (1.0,)), ("force", (np.nan, 0.0))],
        "force": [("s", -0.1), ("force", (1.0, "down")), ("frame", "object")],
        "gravity": [("density", None), ("mass_per_length", 0.1), ("acceleration", (0.0, np.inf))],
        "moment": [("moment", np.inf), ("s", 0.0)],
        "tendon": [("tension", -1.0), ("guides", ()), ("guides", (0.05, 0.02)), ("offset", np.nan)],
    },
}
INSTALLED = [(entry.group, entry.name, entry) for group in SAMPLES for entry in entry_points(group=group)]


def parameters(kinds=tuple(SAMPLES)):
    """Every sample of every installed plugin of these kinds, by its constructor and its arguments."""
    for group, name, entry in INSTALLED:
        for i, arguments in enumerate(SAMPLES[group].get(name, []) if group in kinds else []):
            yield pytest.param(entry.load(), arguments, id=f"{name}-{entry.group.split('.')[1]}-{i}")


def made(kind):
    """Every sample of one kind, built once."""
    return [pytest.param(case.values[0](**case.values[1]), id=case.id) for case in parameters((f"gripper.{kind}",))]


every_plugin = pytest.mark.parametrize(("plugin", "arguments"), list(parameters()))
every_object = pytest.mark.parametrize("surface", made("objects"))
every_finger = pytest.mark.parametrize("finger", made("fingers"))
every_jaw = pytest.mark.parametrize("jaw", made("jaws"))
every_load = pytest.mark.parametrize("load", made("loads"))


@pytest.mark.parametrize(("group", "name", "entry"), INSTALLED)
def test_every_installed_plugin_has_samples_and_bad_values_here(group, name, entry):
    assert SAMPLES[group].get(name), f"give {group} {name} a sample"
    assert name in BAD[group], f"give {group} {name} bad values"
    assert issubclass(
        entry.load(), {"objects": Object, "fingers": Finger, "jaws": Jaw, "loads": Load}[group.split(".")[1]]
    )


@every_plugin
def test_a_plugin_takes_its_fields_by_name_only(plugin, arguments):
    with pytest.raises(TypeError):
        plugin(*(arguments or {"": 1}).values())


@pytest.mark.parametrize(
    ("entry", "arguments", "name", "value"),
    [
        pytest.param(entry, SAMPLES[group][plugin][0], name, value, id=f"{plugin}-{name}-{value}")
        for group, plugin, entry in INSTALLED
        for name, value in BAD[group].get(plugin, [])
    ],
)
def test_a_bad_value_is_an_error_that_names_the_argument(entry, arguments, name, value):
    with pytest.raises(ValueError, match=f"{name}|expression must hold known names"):
        entry.load()(**{**arguments, name: value})


@every_object
@pytest.mark.parametrize("check", OBJECT_PROPERTIES, ids=lambda check: check.__name__)
def test_an_object(surface, check):
    run(surface, (check,))


@every_object
def test_something_is_proved_of_every_object_s_derivatives(surface):
    assert surface.bounds(np.zeros((1, 2)), np.array([0.01])) is not None


@every_finger
@pytest.mark.parametrize("check", FINGER_PROPERTIES, ids=lambda check: check.__name__)
def test_a_finger(finger, check):
    run(finger, (check,))


@every_jaw
@pytest.mark.parametrize("check", JAW_PROPERTIES, ids=lambda check: check.__name__)
def test_a_jaw(jaw, check):
    run(jaw, (check,))


@every_load
@pytest.mark.parametrize("check", LOAD_PROPERTIES, ids=lambda check: check.__name__)
def test_a_load(load, check):
    run(load, (check,))


@every_finger
def test_a_finger_s_thickness_is_the_one_named_at_its_ends(finger):
    names = {field.name for field in dataclasses.fields(finger)}
    for name, s in (("thickness", 0.0), ("base_thickness", 0.0), ("tip_thickness", finger.length)):
        if name in names:
            named = float(sympy.sympify(getattr(finger, name)).subs(S, s))
            assert float(sympy.sympify(finger.w(S)).subs(S, s)) == pytest.approx(named)
