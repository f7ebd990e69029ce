"""The numbers of a scene by their keys, as a scene file writes them: listed, read, replaced.

A key is the path of a scene file: ``finger.tip_thickness``, ``object.pose.y``, ``object.semi_axes[0]``,
``finger.jaw.lead_angle``, ``material.youngs_modulus``, ``friction.coefficient``. Where an expression stands (a pose in
the motion's parameter, a width in s), its number is its value where its symbols are 0, and another number shifts it by
a constant.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeAlias, get_args, get_origin

import sympy

from gripper.expression.dimensions import PURE, Dimension
from gripper.fields import Surface, dimension, field_types
from gripper.fingers import Material
from gripper.friction import Friction
from gripper.names import known_names
from gripper.pose import Placed, placed
from gripper.scene import Scene

Step: TypeAlias = str | int
Steps: TypeAlias = tuple[Step, ...]
Tree: TypeAlias = dict[Step, Any]

_TABLES = ("finger", "object", "friction", "loads")
"""Fields of a scene that hold a design's numbers; the others say how it is solved."""


def numbers(scene: Scene) -> dict[str, float]:
    """List every number of a scene's finger, material, object, poses, friction and loads: by key, in SI units.

    Whole numbers (a count of lobes) and expressions in x and y are none.
    """
    return dict(_numbers(scene))


@functools.lru_cache(maxsize=16)
def _numbers(scene: Scene) -> tuple[tuple[str, float], ...]:
    return tuple((_key(steps), value) for steps, value, _ in _leaves(scene))


def kind(scene: Scene, key: str) -> Dimension | None:
    """Tell what kind of quantity a number of a scene is; None where its plugin does not say.

    Raises
    ------
    LookupError
        The scene has no number of this key; lists the known ones.
    """
    _looked_up(scene, (key,))
    if key == "friction.coefficient":
        return PURE
    return next(kind for steps, _, kind in _leaves(scene) if _key(steps) == key)


def number(scene: Scene, key: str) -> float:
    """Read one number of a scene, in SI units.

    Raises
    ------
    LookupError
        The scene has no number of this key; lists the known ones.
    """
    return _looked_up(scene, (key,))[0]


def _looked_up(scene: Scene, keys: Iterable[str]) -> list[float]:
    known = numbers(scene)
    values = known if scene.friction else known | {"friction.coefficient": 0.0}
    for key in keys:
        if key not in values:
            raise LookupError(f"unknown number {key!r}; known: {known_names(key, known)}")
    return [values[key] for key in keys]


def replaced(scene: Scene, values: Mapping[str, float]) -> Scene:
    """Make the scene with other numbers, all replaced at once.

    Parameters
    ----------
    scene
        Left as it is.
    values
        New numbers by their keys, in SI units. ``friction.coefficient`` gives friction to a scene without.

    Raises
    ------
    LookupError
        The scene has no number of this key; lists the known ones.
    ValueError
        A number breaks the rule of its field.
    """
    _looked_up(scene, values)
    tree: Tree = {}
    for key, value in values.items():
        *way, last = _steps(key)
        branch = tree
        for step in way:
            branch = branch.setdefault(step, {})
        branch[last] = float(value)
    if "friction" in tree and scene.friction is None:
        scene = dataclasses.replace(scene, friction=Friction(coefficient=tree.pop("friction")["coefficient"]))
    changed: Scene = _grafted(_whole(scene), tree)
    return changed


def _whole(scene: Scene) -> Scene:
    """The scene with a pose for each part."""
    return dataclasses.replace(scene, finger=placed(scene.finger), object=placed(scene.object))


def _steps(key: str) -> Steps:
    """From a scene file's key to the way from a scene to the number."""
    steps: list[Step] = [int(part[1:-1]) if part[0] == "[" else part for part in re.findall(r"\[\d+\]|[^.\[\]]+", key)]
    if steps[0] == "material":
        return ("finger", "body", *steps)
    return (steps[0], "body", *steps[1:]) if steps[0] in ("finger", "object") and steps[1] != "pose" else tuple(steps)


def _key(steps: Steps) -> str:
    """From the way to a number to a scene file's key."""
    names = steps[2:] if steps[:3] == ("finger", "body", "material") else [step for step in steps if step != "body"]
    return "".join(f"[{name}]" if isinstance(name, int) else f".{name}" for name in names)[1:]


def _leaves(scene: Scene) -> Iterator[tuple[Steps, float, Dimension | None]]:
    """Ways to the numbers of a scene, their values, and what kind of quantity each is."""
    whole = _whole(scene)
    for name in _TABLES:
        yield from _numbers_of(getattr(whole, name, None), (name,))


def _numbers_of(value: Any, steps: Steps, annotation: Any = None) -> Iterator[tuple[Steps, float, Dimension | None]]:
    """Numbers of a field, and of the fields within."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        hints = {} if isinstance(value, Placed) else field_types(type(value))
        for field in dataclasses.fields(value):
            inner = value.G if isinstance(value, Material) and field.name == "shear_modulus" else None
            inner = getattr(value, field.name) if inner is None else inner
            yield from _numbers_of(inner, (*steps, field.name), hints.get(field.name))
    elif isinstance(value, tuple):
        for i, item in enumerate(value):
            yield from _numbers_of(item, (*steps, i), _entry(annotation, i))
    elif annotation not in (int, Surface) and (found := _constant(value)) is not None:
        yield steps, found, dimension(annotation)


def _entry(annotation: Any, i: int) -> Any:
    """The type of an entry of a tuple."""
    options = get_args(annotation) if type(None) in get_args(annotation) else (annotation,)
    inner = next((get_args(option) for option in options if get_origin(option) is tuple), ())
    return inner[0] if inner[1:] == (Ellipsis,) else inner[i] if i < len(inner) else None


def _constant(value: Any) -> float | None:
    """A number itself, an expression's value where its symbols are 0; None where there is none."""
    if isinstance(value, bool) or not isinstance(value, (int, float, sympy.Expr)):
        return None
    if isinstance(value, (int, float)):
        return float(value)
    found = value.subs(dict.fromkeys(value.free_symbols, 0.0)).evalf()
    return float(found) if found.is_real and math.isfinite(found) else None


def _grafted(value: Any, tree: Any) -> Any:
    """A field with the numbers of a tree in their places."""
    if not isinstance(tree, dict):
        return tree if not isinstance(value, sympy.Expr) else _shifted(value, tree)
    if isinstance(value, tuple):
        return tuple(_grafted(item, tree[i]) if i in tree else item for i, item in enumerate(value))
    if isinstance(value, Placed) and tree.keys() - {"pose", "body"}:  # a part of an object: keys do not name its body
        inner = {name: part for name, part in tree.items() if name != "pose"}
        tree = {name: part for name, part in tree.items() if name == "pose"} | {"body": inner}
    return dataclasses.replace(value, **{name: _grafted(getattr(value, name), part) for name, part in tree.items()})


def _shifted(expression: sympy.Expr, value: float) -> sympy.Expr:
    before = _constant(expression)
    return expression if before == value else expression + (value - (before or 0.0))
