"""result.json and curve.csv are read by programs outside: every name in FORMATS is checked here, key by key."""

from __future__ import annotations

import csv
import io
import json
import math
import pickle
import subprocess
import sys
from dataclasses import replace
from importlib.metadata import version

import numpy as np
import pytest
import sympy

from gripper.expression import parse
from gripper.fingers import Finger, Material, S
from gripper.friction import Friction
from gripper.result import Checks, Contact, ErrorEstimate, Event, LeftOut, Model, PoseResult, Result, Shape
from gripper.results.report import MOST_ROWS
from gripper.scene import Motion, Scene
from gripper.solve import solve
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.ellipse import Ellipse
from tests.scenes import unit_finger

NUMBERS = [
    "force_on_object",
    "force_on_object_finger_frame",
    "moment_on_object",
    "motion_force",
    "clamp_moment",
    "energy",
    "tip",
    "tip_rotation",
    "max_strain",
    "max_strain_s",
    "min_gap",
]
POSE_KEYS = {"parameter", "status", "reason", *NUMBERS, "contacts", "checks", "error", "iterations", "seconds"}
COLUMNS = (
    "pose,x_e,status,force_on_object_x_N,force_on_object_y_N,motion_force,clamp_moment_Nm,energy_J,"
    "tip_x_m,tip_y_m,tip_rotation_rad,max_strain,min_gap_m,contacts"
)
RUBBER = Material(youngs_modulus=4.8e6, poisson_ratio=0.4)
FINGER = Tapered(length=0.1778, base_thickness=0.03, tip_thickness=0.017, width=0.025, material=RUBBER)
X_E = sympy.Symbol("x_e")


def scene(poses: int = 3, title: str = "A finger & an <ellipse>") -> Scene:
    body, target = FINGER, Ellipse(semi_axes=(0.0495, 0.0337))
    if poses == 1:
        return Scene(finger=body, object=target.at(x=0.12, y=-0.05), title=title)
    angle = math.radians(102) - 4.123 * X_E
    motion = Motion.between("x_e", -0.1, 0.2, poses)
    return Scene(finger=body.at(angle=angle), object=target.at(x=X_E, y=0.12), motion=motion, title=title)


def contact() -> Contact:
    return Contact(
        on="lower", s=0.116, extent=(0.1159, 0.1161), point=(0.1, 0.03), normal=(0.6, -0.8), normal_force=15.8
    )


def touching(parameter: float | None) -> PoseResult:
    return PoseResult(
        parameter=parameter,
        status="contact",
        force_on_object=(8.7, -13.2),
        force_on_object_finger_frame=(8.7, -13.2),
        moment_on_object=0.1,
        motion_force=None if parameter is None else 3.0,
        clamp_moment=1.75,
        energy=0.3,
        tip=(0.16, 0.07),
        tip_rotation=0.54,
        max_strain=0.06,
        min_gap=-1e-12,
        contacts=(contact(),),
        checks=Checks(
            stationarity=1e-13,
            force_balance=1e-14,
            moment_balance=1e-14,
            stability=0.9,
            penetration_bound=1e-9,
            certificate="proved",
        ),
        error=ErrorEstimate(discretisation=1e-6),
        iterations=9,
        seconds=0.004,
    )


def result(poses: int = 3, failed: tuple[int, ...] = (), title: str = "A finger & an <ellipse>") -> Result:
    given = scene(poses, title)
    places: tuple[float | None, ...] = given.motion.values if given.motion else (None,)
    answers = [
        PoseResult.failed(place, "did not converge: ask for a smaller step", 30, 0.1)
        if i in failed
        else touching(place)
        for i, place in enumerate(places)
    ]
    model = Model(
        theory="shear", left_out=(LeftOut(what="friction", why="coefficient is 0"),), not_modelled=("plane strain",)
    )
    return Result(scene=given, model=model, poses=tuple(answers), events=(Event(parameter=0.0694, kind="release"),))


def numbers_of(value: object) -> list[float]:
    if isinstance(value, dict):
        return [number for each in value.values() for number in numbers_of(each)]
    if isinstance(value, list):
        return [number for each in value for number in numbers_of(each)]
    return [value] if isinstance(value, float | int) and not isinstance(value, bool) else []


def test_to_dict_has_every_key_of_the_contract_and_no_other() -> None:
    written = result().to_dict()
    assert set(written) == {"schema", "title", "scene", "versions", "model", "poses", "events", "summary"}
    assert written["schema"] == 1
    assert written["versions"] == {name: version(name) for name in ("gripper", "numpy", "scipy", "sympy")}
    assert written["model"] == {
        "theory": "shear",
        "left_out": [{"what": "friction", "why": "coefficient is 0"}],
        "not_modelled": ["plane strain"],
        "warnings": [],
    }
    assert written["events"] == [{"parameter": 0.0694, "kind": "release", "detail": ""}]
    for pose in written["poses"]:
        assert set(pose) == POSE_KEYS
        assert set(pose["checks"]) == {
            "stationarity",
            "force_balance",
            "moment_balance",
            "stability",
            "penetration_bound",
            "certificate",
        }
        assert set(pose["error"]) == {"discretisation", "next_theory"}
        assert set(pose["contacts"][0]) == {
            "on",
            "s",
            "extent",
            "point",
            "normal",
            "normal_force",
            "tangential_force",
            "state",
        }
    assert written["poses"][0]["contacts"][0]["state"] == "frictionless"


@pytest.mark.parametrize("failed", [(), (1,), (0, 1, 2)])
def test_to_dict_survives_json_unchanged_and_holds_no_nan(failed: tuple[int, ...]) -> None:
    written = result(failed=failed).to_dict()
    assert json.loads(json.dumps(written, allow_nan=False)) == written
    assert all(math.isfinite(number) for number in numbers_of(written))


def test_a_failed_pose_has_no_number_but_its_place_and_the_effort_spent() -> None:
    pose = result(failed=(1,)).to_dict()["poses"][1]
    assert pose["status"] == "failed"
    assert "smaller step" in pose["reason"]
    assert all(pose[name] is None for name in NUMBERS)
    assert pose["contacts"] == []
    assert numbers_of({name: pose[name] for name in ("checks", "error")}) == []
    assert (pose["iterations"], pose["seconds"]) == (30, 0.1)


def test_a_failed_pose_must_say_why() -> None:
    with pytest.raises(ValueError, match="reason must say why"):
        PoseResult(parameter=0.0, status="failed")


@pytest.mark.parametrize("value", [math.nan, math.inf])
@pytest.mark.parametrize("name", ["energy", "force_on_object", "seconds"])
def test_no_number_that_is_not_finite_enters_a_result(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} must be finite"):
        replace(touching(0.0), **{name: (value, 0.0) if name == "force_on_object" else value})


def test_the_curve_has_the_columns_of_the_contract_and_empty_cells_where_a_pose_failed() -> None:
    text = result(failed=(1,)).curve_csv()
    assert text.splitlines()[0] == COLUMNS
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [row["pose"] for row in rows] == ["0", "1", "2"]
    assert float(rows[0]["force_on_object_y_N"]) == -13.2
    assert rows[0]["contacts"] == "1"
    filled = {name for name, cell in rows[1].items() if cell}
    assert filled == {"pose", "x_e", "status"}


def test_the_curve_of_a_scene_without_motion_has_the_same_columns() -> None:
    rows = list(csv.DictReader(io.StringIO(result(1).curve_csv())))
    assert list(rows[0]) == COLUMNS.replace("x_e", "parameter").split(",")
    assert rows[0]["parameter"] == rows[0]["motion_force"] == ""


def test_numbers_in_the_curve_keep_every_digit() -> None:
    exact = replace(touching(0.1), energy=1 / 3)
    text = replace(result(2), poses=(exact, exact)).curve_csv()
    assert float(next(csv.DictReader(io.StringIO(text)))["energy_J"]) == 1 / 3


def test_the_scene_is_described_by_the_tables_of_a_scene_file() -> None:
    written = result().to_dict()["scene"]
    assert written["material"] == {
        "youngs_modulus": 4.8e6,
        "poisson_ratio": 0.4,
        "shear_modulus": pytest.approx(4.8e6 / 2.8),
        "plane": "stress",
        "law": "linear",
    }
    assert written["finger"]["profile"] == "tapered"
    assert written["finger"]["base_thickness"] == 0.03
    assert written["object"]["surface"] == "ellipse"
    assert written["object"]["semi_axes"] == [0.0495, 0.0337]
    assert written["object"]["pose"] == {"x": "x_e", "y": 0.12, "angle": 0.0}
    assert written["motion"]["parameter"] == "x_e"
    assert written["motion"]["values"] == pytest.approx([-0.1, 0.05, 0.2])
    assert written["solver"] == {"theory": "auto", "tolerance": 1e-4, "theory_tolerance": 5e-3}


def test_the_pose_s_expression_keeps_every_digit() -> None:
    angle = result().to_dict()["scene"]["finger"]["pose"]["angle"]
    assert repr(math.radians(102)) in angle


def test_a_jaw_is_described_under_its_finger() -> None:
    jaw = Triangle(length=0.019, lead_angle=0.3, return_angle=1.0)
    hook = Uniform(length=0.057, thickness=0.0032, width=0.0095, material=RUBBER, jaw=jaw)
    given = Scene(finger=hook, object=Circle(radius=0.0089).at(y=-0.0105))
    written = replace(result(1), scene=given).to_dict()["scene"]["finger"]
    assert written["jaw"] == {
        "shape": "triangle",
        "length": 0.019,
        "lead_angle": 0.3,
        "return_angle": 1.0,
        "side": "lower",
    }


class Waisted(Finger):
    """A user's own class, registered nowhere."""

    def w(self, s: sympy.Expr) -> sympy.Expr:
        return 0.02 + sympy.Abs(s - 0.05) / 10


def test_an_unregistered_class_is_described_by_its_path_and_its_expressions_as_a_scene_file_writes_them() -> None:
    body = Waisted(length=0.1, width=sympy.Max(0.01, sympy.Abs(S - 0.5)), material=RUBBER)
    written = replace(result(1), scene=Scene(finger=body, object=Circle(radius=0.01))).to_dict()["scene"]["finger"]
    assert written["profile"].endswith(":Waisted")
    assert written["width"] == "max(0.01, abs(s - 0.5))"


@pytest.mark.parametrize(
    "written",
    [
        X_E / 3 - sympy.Float(0.1, 17) * sympy.sqrt(X_E),
        sympy.exp(1) ** X_E + sympy.pi,
        sympy.Max(X_E, 0.1) - sympy.Min(X_E, sympy.Rational(2, 3)) * sympy.Abs(X_E),
        sympy.atan2(X_E, 2) + sympy.log(X_E + 3) - sympy.sin(X_E) ** sympy.Rational(2, 3),
        1e-300 * X_E + 12345678901234567,
    ],
)
def test_a_described_expression_is_read_back_by_the_scene_file_s_parser(written: sympy.Expr) -> None:
    given = replace(scene(), finger=FINGER.at(angle=written))
    text = replace(result(), scene=given).to_dict()["scene"]["finger"]["pose"]["angle"]
    for value in (0.05, 0.7, 2.0):
        there, back = (
            float(expression.subs(dict.fromkeys(expression.free_symbols, value)))
            for expression in (written, parse(text, ["x_e"]))
        )
        assert back == pytest.approx(there, rel=1e-15)


def test_a_result_of_one_pose_gives_its_numbers_itself() -> None:
    one = result(1)
    assert one.force_on_object == one.poses[0].force_on_object
    assert one.contacts[0].s == 0.116
    assert (one.energy, one.clamp_moment, one.tip) == (0.3, 1.75, (0.16, 0.07))
    assert (one.max_strain, one.moment_on_object) == (0.06, 0.1)


@pytest.mark.parametrize("name", ["force_on_object", "contacts", "energy", "tip", "max_strain"])
def test_a_result_of_several_poses_says_to_name_one(name: str) -> None:
    with pytest.raises(ValueError, match=r"one pose \(of several use result\.poses\[i\]\); got 3"):
        getattr(result(), name)


@pytest.mark.parametrize("name", ["force_on_object", "contacts", "energy"])
def test_a_single_failed_pose_says_why_it_has_no_numbers(name: str) -> None:
    with pytest.raises(ValueError, match="did not converge"):
        getattr(result(1, failed=(0,)), name)


@pytest.mark.parametrize("poses", [1, 2, 20, 21, 49, 1000])
def test_the_text_fits_a_screen(poses: int) -> None:
    lines = str(result(poses)).splitlines()
    assert len(lines) <= 45
    assert max(map(len, lines)) <= 120


def test_the_text_of_one_pose_gives_contact_and_checks() -> None:
    text = str(result(1))
    for words in ("A finger & an <ellipse>", "theory: shear", "friction (coefficient is 0)", "lower, s = 0.116 m"):
        assert words in text
    assert "proved" in text


def test_the_text_of_a_long_motion_shows_the_ends_and_the_largest_force() -> None:
    long = result(100)
    poses = list(long.poses)
    poses[41] = replace(poses[41], force_on_object=(0.0, -99.0))
    text = str(replace(long, poses=tuple(poses)))
    firsts = [line.split()[0] for line in text.splitlines() if line.strip()]
    assert {"0", "41", "99"} <= set(firsts)
    shown = sum(first.isdecimal() for first in firsts)
    assert f"({shown} of 100 poses)" in text and shown <= MOST_ROWS
    assert "release at x_e = 0.0694" in text


def test_the_text_of_a_motion_has_its_headline_numbers_and_says_what_is_wrong_last() -> None:
    warned = replace(result(3, failed=(1,)), model=Model(theory="shear", warnings=("strains reach 0.2",)))
    lines = str(warned).splitlines()
    assert [line.split()[0] for line in lines if line.startswith(("strain ", "clearance ", "force on object "))]
    assert lines[-3] == "WARNING: strains reach 0.2"
    assert lines[-2] == "WARNING: 1 of 3 poses failed"


def test_the_text_says_how_many_events_are_not_shown_of_which_kinds_and_where_they_are() -> None:
    events = tuple(Event(parameter=0.001 * i, kind="slip" if i % 2 else "stick") for i in range(13))
    lines = str(replace(result(3), events=events)).splitlines()
    assert "... and 5 more, the last at x_e = 0.012 (3 stick, 2 slip): see result.events" in lines
    assert sum(line.startswith(("slip at", "stick at")) for line in lines) == 8


def test_the_text_gives_friction_and_its_coefficient() -> None:
    given = result(3)
    rough = replace(given, scene=replace(given.scene, friction=Friction(coefficient={"finger": 0.2, "jaw": 0.3})))
    assert "friction: coulomb, mu = 0.2 (jaw: 0.3)" in str(rough)


def test_the_text_warns_of_failed_poses() -> None:
    assert "WARNING: 1 of 3 poses failed" in str(result(failed=(1,)))
    assert "failed" in result(3, failed=(1,))._repr_html_()


def test_html_is_escaped() -> None:
    written = result(title="<script>alert(1)</script>")._repr_html_()
    assert "<script>" not in written
    assert "&lt;script&gt;" in written


def test_results_compare_and_pickle() -> None:
    assert result() == result() != result(failed=(0,))
    assert pickle.loads(pickle.dumps(result())) == result()


def test_a_shape_is_read_only_and_refuses_faces_of_other_lengths() -> None:
    axis = [(0.0, 0.0), (1.0, 0.0)]
    shape = Shape(axis=axis, lower=axis, upper=axis, strain=[0.0, 0.0])
    with pytest.raises(ValueError, match="read-only"):
        shape.axis[0, 0] = 1.0
    with pytest.raises(ValueError, match="lower must have shape"):
        Shape(axis=axis, lower=axis[:1], upper=axis, strain=[0.0, 0.0])


def test_numpy_s_numbers_become_plain_ones() -> None:
    pose = replace(touching(np.float64(0.5)), force_on_object=np.array([1.0, 2.0]), iterations=np.int64(3))
    assert pose.force_on_object == (1.0, 2.0)
    assert json.dumps(pose.to_dict())


def test_importing_the_results_does_not_load_matplotlib_or_pydantic() -> None:
    code = "import gripper.result, sys; sys.exit(bool({'matplotlib', 'pydantic', 'shapely'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_shape_that_is_drawn_when_it_is_asked_for_is_the_same_in_a_copy_from_another_process() -> None:
    result = solve(Scene(finger=unit_finger(), object=Circle(radius=0.25).at(x=0.7, y=-0.2)))
    copy = pickle.loads(pickle.dumps(result.poses[0]))
    shape = result.poses[0].shape
    assert np.array_equal(copy.shape.outline, shape.outline)
    assert np.array_equal(copy.shape.strain, shape.strain)
    assert shape.turning == pytest.approx(abs(result.poses[0].tip_rotation), rel=0.1)


def test_a_record_with_another_value_keeps_the_rest_and_checks_the_new_one() -> None:
    checks = Checks(stationarity=1e-9, stability=0.5)
    assert checks.but(stability=np.float64(0.25)) == Checks(stationarity=1e-9, stability=0.25)
    with pytest.raises(ValueError, match="stability must be finite"):
        checks.but(stability=float("nan"))
