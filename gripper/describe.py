"""A scene as plain data in SI units, nested as a scene file: a result must say what it answers."""

from __future__ import annotations

import dataclasses
from typing import Any

import sympy
from sympy.printing.str import StrPrinter

from gripper.fingers import Base, Finger, Jaw, Material
from gripper.friction import Coefficients, Friction
from gripper.objects import Object
from gripper.pose import Placed, Pose, placed
from gripper.registry import record_of, scene_name
from gripper.scene import Motion, Scene


class _Printer(StrPrinter):  # type: ignore[misc]  # sympy is untyped
    """Expressions in the scene file's grammar, numbers with every digit (the names are sympy's hooks)."""

    def _print_Float(self, expr: sympy.Float) -> str:
        return repr(float(expr))

    def _print_Abs(self, expr: sympy.Abs) -> str:
        return f"abs({self._print(expr.args[0])})"

    def _print_Max(self, expr: sympy.Max) -> str:
        return f"max({', '.join(map(self._print, expr.args))})"

    def _print_Min(self, expr: sympy.Min) -> str:
        return f"min({', '.join(map(self._print, expr.args))})"

    def _print_Exp1(self, expr: sympy.Expr) -> str:
        return "exp(1)"


def _value(value: Any) -> Any:
    """Write a field as JSON and TOML can hold it: numbers as they are, expressions as text, tuples as lists."""
    if isinstance(value, sympy.Expr):
        return float(value) if value.is_number else _Printer().doprint(_floated(value))
    if isinstance(value, Object) or (isinstance(value, Placed) and isinstance(value.body, Object)):
        return _object(placed(value))
    if isinstance(value, Base):
        return _fields(value)
    return [_value(item) for item in value] if isinstance(value, (list, tuple)) else value


def _floated(expression: sympy.Expr) -> sympy.Expr:
    """An expression with the whole numbers that sympy has counted (x + x is 2*x) as the floats that a reader makes."""
    if expression.is_Integer and expression not in (-1, 0, 1):
        return sympy.Float(expression)
    if not expression.args or expression.is_Relational:
        return expression
    parts = [_floated(part) for part in expression.args]
    return expression.func(*parts[:1], *expression.args[1:]) if expression.is_Pow else expression.func(*parts)


def _fields(instance: Any, *but: str) -> dict[str, Any]:
    """Every field that is set, by its name."""
    names = (field.name for field in dataclasses.fields(instance) if field.name not in but)
    return {name: _value(getattr(instance, name)) for name in names if getattr(instance, name) is not None}


def _name(instance: Any) -> str:
    """Give the name under which the instance's class is registered, else where the class is."""
    cls = type(instance)
    record = record_of(cls)
    return scene_name(record) if record else f"{cls.__module__}:{cls.__qualname__}"


def _material(material: Material) -> dict[str, Any]:
    return _fields(material) | {"shear_modulus": material.G}


def _pose(pose: Pose) -> dict[str, Any]:
    return _fields(pose)


def _jaw(jaw: Jaw) -> dict[str, Any]:
    return {"shape": _name(jaw)} | _fields(jaw)


def _finger(finger: Finger, pose: Pose) -> dict[str, Any]:
    table = {"profile": _name(finger)} | _fields(finger, "material", "jaw") | {"pose": _pose(pose)}
    return table | ({"jaw": _jaw(finger.jaw)} if finger.jaw else {})


def _object(target: Placed[Object]) -> dict[str, Any]:
    return {"surface": _name(target.body)} | _fields(target.body) | {"pose": _pose(target.pose)}


def table(group: str, instance: Any) -> dict[str, Any]:
    """Write a plugin's own fields as a scene file's table holds them, without its name; a finger's without its jaw."""
    return _fields(instance, "material", "jaw") if group == "gripper.fingers" else _fields(instance)


def _motion(motion: Motion) -> dict[str, Any]:
    return {"parameter": motion.parameter, "values": list(motion.values)}


def _friction(friction: Friction) -> dict[str, Any]:
    mu = friction.coefficient
    return _fields(friction) | {"coefficient": _fields(mu) if isinstance(mu, Coefficients) else _value(mu)}


def describe(scene: Scene) -> dict[str, Any]:
    """Write the scene as nested plain data: a scene file's tables, SI units, expressions as text, defaults filled in.

    A plugin is given by its registered name, an unregistered class by ``module:class``.
    """
    finger, target = placed(scene.finger), placed(scene.object)
    tables: dict[str, Any] = {
        "title": scene.title,
        "material": _material(finger.body.material),
        "finger": _finger(finger.body, finger.pose),
        "object": _object(target),
        "approach": {"direction": list(scene.approach)},
        "solver": {
            "theory": scene.theory,
            "tolerance": scene.tolerance,
            "theory_tolerance": scene.theory_tolerance,
        },
    }
    if scene.friction:
        tables["friction"] = _friction(scene.friction)
    if scene.loads:
        tables |= {"loads": [{"type": _name(load)} | _fields(load) for load in scene.loads]}
    if scene.limits:
        tables["limits"] = dict(scene.limits.bounds)
    if scene.tolerances:
        tables["tolerance"] = dict(scene.tolerances.bands)
    return tables | ({"motion": _motion(scene.motion)} if scene.motion else {})
