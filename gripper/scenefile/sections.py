"""The tables of a scene file, one function each, and the scene that they make."""

from __future__ import annotations

import unicodedata
from dataclasses import replace
from typing import Any, get_args

import sympy

from gripper.beam.sections import check_width
from gripper.expression import Names, is_name, is_reserved, written_kind
from gripper.expression.dimensions import METRE, PURE, RADIAN, Dimension
from gripper.fields import Finite
from gripper.fingers import Base, Finger, Jaw, Material
from gripper.friction import Friction, Model, Sense
from gripper.loads import Load
from gripper.objects import Object
from gripper.pose import Placed, Pose
from gripper.registry import OWN, OWN_PLUGINS, PluginError, installed, load, record_of
from gripper.scene import MOST_POSES, Motion, Scene, Theory
from gripper.scenefile.checks import check_whole
from gripper.scenefile.design import read_limits, read_material, read_pair, read_tolerances
from gripper.scenefile.place import (
    Place,
    SceneFileError,
    Table,
    as_table,
    check_given,
    check_keys,
    shown,
)
from gripper.scenefile.tables import build
from gripper.scenefile.values import converted, read_count, read_expression, read_number

_KEYS = (
    "title",
    "material",
    "finger",
    "object",
    "motion",
    "approach",
    "friction",
    "loads",
    "solver",
    "limits",
    "tolerance",
    "optimize",  # of a design file: gripper.scenefile.optimize reads it, other commands pass over it
)
_SOLVER_FIELDS = {key: f"solver.{key}" for key in ("theory", "tolerance", "theory_tolerance")}
_SCENE_FIELDS = (
    _SOLVER_FIELDS
    | {"approach": "approach.direction"}
    | {key: f"friction.{key}" for key in ("coefficient", "model", "sense")}
    | {"friction": "friction"}
)
_SPAN = ("from", "to", "poses")
LONGEST_TITLE = 500
"""Characters."""
_DEEPEST = 8  # objects within objects


def scene(tables: Table, place: Place) -> Scene:
    """Make the scene of a file's tables."""
    check_keys(tables, _KEYS, place)
    check_given(tables, ("material", "finger", "object"), place)
    as_table(tables.get("optimize", {}), place.at("optimize"))
    motion = _motion(*_section(tables, "motion", place)) if "motion" in tables else None
    names = {motion.parameter: _kind_of_motion(tables["motion"], place.at("motion"))} if motion else {}
    material = read_material(tables["material"], place.at("material"))
    finger = _finger(tables["finger"], place.at("finger"), material, names)
    target = _object(*_section(tables, "object", place), names)
    optional = _approach(*_section(tables, "approach", place)) | _solver(*_section(tables, "solver", place))
    optional |= _friction(*_section(tables, "friction", place))
    if "loads" in tables:
        optional["loads"] = _loads(tables["loads"], place.at("loads"), names)
    if "limits" in tables:
        optional["limits"] = read_limits(tables["limits"], place.at("limits"), *names.values())
    optional["title"] = _title(tables, place)
    try:
        made = Scene(finger=finger, object=target, motion=motion, **optional)
    except ValueError as error:
        raise place.broken(error, _SCENE_FIELDS) from None
    check_whole(made, place)
    if "tolerance" not in tables:
        return made
    return replace(made, tolerances=read_tolerances(tables["tolerance"], place.at("tolerance"), made))


def _section(tables: Table, key: str, place: Place) -> tuple[Table, Place]:
    """Give a table, empty where it is left out, and its place."""
    return as_table(tables.get(key, {}), place.at(key)), place.at(key)


def _title(tables: Table, place: Place) -> str:
    title = tables.get("title", "")
    if not isinstance(title, str):
        raise place.at("title").error("must be a text", shown(title))
    if len(title) > LONGEST_TITLE:
        raise place.at("title").error(f"must be at most {LONGEST_TITLE} characters long", f"{len(title)} characters")
    if any(unicodedata.category(letter) == "Cc" and letter not in "\t\n\r" for letter in title):
        raise place.at("title").error("must hold no control characters", shown(title))
    return title


def _choice(table: Table, key: str, choices: tuple[str, ...], place: Place) -> Any:
    """Read a key that is one of a few words; None where it is left out."""
    value = table.get(key)
    if key in table and value not in choices:
        raise place.at(key).error(f"must be one of {', '.join(choices)}", shown(value))
    return value


def _plugin(group: str, key: str, table: Table, place: Place) -> type[Any]:
    """Load the plugin that a table names."""
    name = table.get(key)
    if not isinstance(name, str):
        known = ", ".join(dict.fromkeys(record.name for record in installed(group)))
        raise place.at(key).error(f"must be one of {known}", shown(name) if key in table else "nothing")
    try:
        return load(group, name)
    except LookupError as error:
        rule = str(error.args[0]).partition("; ")[2].replace("known: ", "must be one of ", 1)
        raise place.at(key).error(rule, shown(name)) from error
    except PluginError as error:
        raise place.at(key).error(f"must be a plugin that works ({error})", shown(name)) from error


def _finger(value: Any, place: Place, material: Material, names: Names) -> Placed[Finger]:
    if isinstance(value, list):
        raise place.error("must be one table, [finger] (several fingers are not built yet)", f"{len(value)} of them")
    table = as_table(value, place)
    cls: type[Finger] = _plugin("gripper.fingers", "profile", table, place)
    jaw = _jaw(*_section(table, "jaw", place)) if "jaw" in table else None
    base = build(Base, *_section(table, "base", place)) if "base" in table else None
    pose = _pose(*_section(table, "pose", place), names)
    made = {"material": material, "jaw": jaw, "base": base}
    built = build(cls, table, place, made, ("profile", "pose", "jaw", "base"))
    if cls.b is Finger.b:  # the width is the scene's, not the plugin's
        try:
            check_width(built)
        except ValueError as error:
            raise place.broken(error, {"width": "width"}) from None
    return Placed(_sound(built, place), pose)


def _jaw(table: Table, place: Place) -> Jaw:
    cls: type[Jaw] = _plugin("gripper.jaws", "shape", table, place)
    return _sound(build(cls, table, place, other=("shape",)), place)


def _loads(value: Any, place: Place, names: Names) -> tuple[Load, ...]:
    if not isinstance(value, list):
        raise place.error("must be an array of tables, [[loads]]", shown(value))
    found = []
    for i, item in enumerate(value):
        table, at = as_table(item, place.entry(i)), place.entry(i)
        cls: type[Load] = _plugin("gripper.loads", "type", table, at)
        found.append(_sound(build(cls, table, at, other=("type",), names=names), at))
    return tuple(found)


def _object(table: Table, place: Place, names: Names, depth: int = 0) -> Placed[Object]:
    if depth > _DEEPEST:
        raise place.error(f"must lie within at most {_DEEPEST} other objects", "more")
    cls: type[Object] = _plugin("gripper.objects", "surface", table, place)
    pose = _pose(*_section(table, "pose", place), names)

    def nest(_: str, value: Any, at: Place) -> Placed[Object]:
        return _object(as_table(value, at), at, (), depth + 1)

    return Placed(_sound(build(cls, table, place, other=("surface", "pose"), nest=nest), place), pose)


def _sound(instance: Any, place: Place) -> Any:
    """Refuse a stranger's plugin whose instance breaks what the solver relies on; this project's are tested."""
    cls = type(instance)
    record = None if cls.__module__.partition(".")[0] == OWN_PLUGINS else record_of(cls)
    if record is None or record.distribution == OWN:
        return instance
    from gripper.testing import ContractError, quick_check

    try:
        quick_check(instance)
    except ContractError as error:
        raise place.error(f"must keep what its kind promises ({error})", type(instance).__name__) from error
    return instance


def _pose(table: Table, place: Place, names: Names) -> Pose:
    check_keys(table, ("x", "y", "angle"), place)
    kinds = {"x": METRE, "y": METRE, "angle": RADIAN}
    return Pose(**{key: read_expression(value, names, place.at(key), kinds[key]) for key, value in table.items()})


def rebuilt(cls: type[Any], table: Table, made: Table, names: Names = ()) -> Any:
    """Make an instance of a plugin from its own table, as a scene file's; fields ``made`` are given."""

    def nest(_: str, value: Any, at: Place) -> Placed[Object]:
        return _object(as_table(value, at), at, ())

    return build(cls, table, Place("scene", "table"), made, nest=nest, names=names)


def _motion(table: Table, place: Place) -> Motion:
    check_keys(table, ("parameter", *_SPAN, "values", "back"), place)
    check_given(table, ("parameter", "values") if "values" in table else ("parameter", *_SPAN), place)
    if "values" in table and not table.keys().isdisjoint(_SPAN):
        raise place.error("must have either values, or from, to and poses", ", ".join(table))
    parameter, back = table["parameter"], table.get("back", False)
    if not (isinstance(parameter, str) and is_name(parameter) and not is_reserved(parameter)):
        rule = "must be a name of letters, digits and _, and no unit, function, pi, x, y or s"
        raise place.at("parameter").error(rule, shown(parameter))
    if not isinstance(back, bool):
        raise place.at("back").error("must be true or false", shown(back))
    try:
        if "values" in table:
            values = converted(tuple[float, ...], table["values"], place.at("values"))
            return Motion(parameter, values + values[-2::-1] if back else values)
        start, stop = (read_number(table[key], place.at(key)) for key in ("from", "to"))
        poses = read_count(table["poses"], place.at("poses"))
        if 2 * poses > MOST_POSES and back:
            raise place.at("poses").error(f"must be at most {MOST_POSES // 2} with back = true", str(poses))
        return Motion.between(parameter, start, stop, poses, back=back)
    except SceneFileError:
        raise
    except ValueError as error:
        raise place.broken(error, {key: key for key in table}) from None


def _kind_of_motion(table: Table, place: Place) -> Dimension | None:
    """Tell what kind of quantity the parameter is, where units are written; refuse values of several kinds."""
    values = table.get("values", [])
    texts = {f"values[{i}]": value for i, value in enumerate(values)} | {key: table.get(key) for key in ("from", "to")}
    kinds = {key: kind for key, text in texts.items() if isinstance(text, str) and (kind := written_kind(text))}
    first = next(iter(kinds.values()), None)
    for key, kind in kinds.items():
        if kind != first:
            raise place.at(key).error(f"must be {first}, as the values before it", f"{shown(texts[key])}, {kind.word}")
    return first


def _approach(table: Table, place: Place) -> Table:
    check_keys(table, ("direction",), place)
    return {"approach": converted(tuple[Finite, Finite], table["direction"], place.at("direction"))} if table else {}


def _solver(table: Table, place: Place) -> Table:
    check_keys(table, ("theory", "tolerance", "theory_tolerance"), place)
    _choice(table, "theory", get_args(Theory), place)
    numbers = {key: read_number(table[key], place.at(key), PURE) for key in table if key.endswith("tolerance")}
    return table | numbers


def _friction(table: Table, place: Place) -> Table:
    if not table:
        return {}
    check_keys(table, ("coefficient", "pair", "model", "sense"), place)
    if "pair" in table:
        if "coefficient" in table:
            raise place.error("must have either coefficient or pair", ", ".join(table))
        table = {key: value for key, value in table.items() if key != "pair"} | {
            "coefficient": read_pair(table["pair"], place.at("pair"))
        }
    check_given(table, ("coefficient",), place)
    _choice(table, "model", get_args(Model), place)
    _choice(table, "sense", get_args(Sense), place)
    coefficient = _coefficient(table["coefficient"], place.at("coefficient"))
    try:
        return {"friction": Friction(**(table | {"coefficient": coefficient}))}
    except ValueError as error:
        raise place.broken(error, {key: key for key in table}) from None


def _coefficient(value: Any, place: Place) -> float | sympy.Expr | Table:
    if not isinstance(value, dict):
        return read_expression(value, ("s",), place, PURE)
    check_keys(value, ("finger", "jaw"), place)
    check_given(value, ("finger", "jaw"), place)
    finger = read_expression(value["finger"], ("s",), place.at("finger"), PURE)
    return {"finger": finger, "jaw": read_number(value["jaw"], place.at("jaw"), PURE)}
