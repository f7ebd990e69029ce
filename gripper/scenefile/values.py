"""From what TOML gives to what a field asks for: text becomes numbers and expressions, arrays become tuples."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import UnionType
from typing import Annotated, Any, TypeAlias, Union, get_args, get_origin

import sympy

from gripper.expression import Names, number, parse
from gripper.expression.dimensions import PURE, Dimension
from gripper.fields import Nested, OfMotion, Variables
from gripper.scenefile.place import Place, shown

Nest: TypeAlias = Callable[[str, Any, Place], Any]
"""Makes a plugin of a group from a table at a place."""

LARGEST = 1e30
"""Magnitude of a number, in SI units: its square's square is still a float."""


def read_number(value: Any, place: Place, kind: Dimension | None = None) -> float:
    """Read a number, or an expression in a string, whose units must be those of a kind of quantity."""
    if isinstance(value, str):
        result = float(_computed(value, place, lambda text: number(text, kind)))
        return _bounded(result, value, place)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise place.error("must be a number, or an expression in a string", shown(value))
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise place.error("must be a finite number", shown(value))
    return _bounded(result, value, place)


def _bounded(number: float, value: Any, place: Place) -> float:
    if abs(number) > LARGEST:
        raise place.error(f"must lie between {-LARGEST:g} and {LARGEST:g}, in SI units", shown(value))
    return number


def read_count(value: Any, place: Place) -> int:
    """Read a whole number."""
    count = read_number(value, place, PURE)
    if not count.is_integer():
        raise place.error("must be a whole number", shown(value))
    return int(count)


def read_expression(value: Any, names: Names, place: Place, kind: Dimension | None = None) -> float | sympy.Expr:
    """Read a number, or an expression that may hold these symbols; a number where it holds none."""
    if not isinstance(value, str):
        return read_number(value, place)
    expression = _computed(value, place, lambda text: parse(text, names, kind))
    return expression if expression.free_symbols else _bounded(float(expression), value, place)


def _computed(text: str, place: Place, compute: Callable[[str], Any]) -> Any:
    try:
        return compute(text)
    except ValueError as error:
        raise place.broken(error) from None


def converted(annotation: Any, value: Any, place: Place, nest: Nest | None = None, names: Names = ()) -> Any:
    """Turn what TOML gave into what an annotation asks for: expressions, numbers and tuples of them.

    What is no number passes as it is: pydantic judges it. ``nest`` makes the plugins within a plugin; ``names`` are the
    motion's.
    """
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _annotated(arguments[0], arguments[1:], value, place, nest, names)
    if origin in (Union, UnionType):
        return _one_of(arguments, value, place, nest, names)
    if origin is tuple:
        return _tuple(arguments, value, place, nest, names)
    if annotation is float:
        return read_number(value, place)
    if annotation is bool and not isinstance(value, bool):  # pydantic takes "yes" and 1 too
        raise place.error("must be true or false", shown(value))
    return read_count(value, place) if annotation is int else value


def _annotated(plain: Any, metadata: tuple[Any, ...], value: Any, place: Place, nest: Nest | None, names: Names) -> Any:
    """Read what a type with metadata asks for."""

    def found(kind: type[Any]) -> Any:
        return next((item for item in reversed(metadata) if isinstance(item, kind)), None)

    nested, variables, kind = found(Nested), found(Variables), found(Dimension)
    if nested and nest:
        return nest(nested.group, value, place)
    if found(OfMotion):
        return read_expression(value, names, place, kind)
    if variables and float in get_args(plain):
        return read_expression(value, variables.names, place, kind)
    if variables:
        return _text(value, variables, place)
    return read_number(value, place, kind) if plain is float else converted(plain, value, place, nest, names)


def _text(value: Any, variables: Variables, place: Place) -> Any:
    if not isinstance(value, str):
        raise place.error(f"must be an expression in {' and '.join(variables.names)}, in a string", shown(value))
    return _computed(value, place, lambda text: parse(text, variables.names))


def _one_of(annotations: tuple[Any, ...], value: Any, place: Place, nest: Nest | None, names: Names) -> Any:
    if isinstance(value, str) and str in annotations:
        return value
    wanted = (tuple,) if isinstance(value, list) else (float, int)
    fitting = [item for item in annotations if item in wanted or get_origin(item) in wanted]
    annotated = [item for item in annotations if get_origin(item) is Annotated]
    return converted((fitting + annotated)[0], value, place, nest, names) if fitting or annotated else value


def _tuple(annotations: tuple[Any, ...], value: Any, place: Place, nest: Nest | None, names: Names) -> Any:
    if not isinstance(value, list):
        raise place.error("must be an array", shown(value))
    if len(annotations) == 2 and annotations[1] is Ellipsis:
        annotations = annotations[:1] * len(value)
    if len(annotations) != len(value):
        raise place.error(f"must have {len(annotations)} entries", f"{len(value)}: {shown(value)}")
    pairs = zip(annotations, value, strict=True)
    return tuple(converted(annotation, item, place.entry(i), nest, names) for i, (annotation, item) in enumerate(pairs))
