"""Rules for a dataclass's fields, written once as types and checked once by the base classes.

A field annotated ``radius: Positive`` is checked when the instance is made, wherever it is made: in
Python, or by the scene file's reader. Plugins hold no check of their own for what a type can say. A type that names its
quantity (``radius: Length``) also refuses other units in scene files: ``Annotated[Positive, unit("N/m")]`` does so for
quantities without a name here.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable
from typing import Annotated, Any, get_args, get_type_hints

import sympy

from gripper.expression.dimensions import METRE, NEWTON, PASCAL, PURE, RADIAN, Dimension


@dataclasses.dataclass(frozen=True)
class Rule:
    """What a value must satisfy: the words of the error, and the test behind them."""

    words: str
    holds: Callable[[Any], bool]


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _is_profile(value: Any) -> bool:
    return _is_number(value) or isinstance(value, sympy.Expr)


@dataclasses.dataclass(frozen=True)
class Variables:
    """The names that an expression in this field may hold (for readers of text)."""

    names: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class OfMotion:
    """An expression in this field may hold the motion's parameter (for readers of text)."""


@dataclasses.dataclass(frozen=True)
class Nested:
    """A field that holds plugins of a group: a scene file writes each as a table of its own."""

    group: str


_SI = ", in SI units"
_POSITIVE = Rule(f"be a positive number{_SI}", lambda v: _is_number(v) and v > 0)
_FINITE = Rule(f"be a finite number{_SI}", _is_number)
Positive = Annotated[float, _POSITIVE]
"""A number above zero, of any unit."""
Finite = Annotated[float, _FINITE]
"""Any finite number, of any unit."""
Length = Annotated[Positive, METRE]
"""A length above zero, in m."""
Coordinate = Annotated[Finite, METRE]
"""A length of either sign, in m."""
Angle = Annotated[Finite, RADIAN]
"""An angle, in rad."""
Stress = Annotated[Positive, PASCAL]
"""A modulus or a stress above zero, in Pa."""
Ratio = Annotated[Positive, PURE]
"""A number above zero without unit."""
Expression = Annotated[float | sympy.Expr, Rule("be a finite number or an expression", _is_profile)]
"""A number or a sympy expression (a pose, in the motion's parameter)."""
Varying = Annotated[
    float | sympy.Expr, OfMotion(), Rule("be a finite number or an expression in the motion's parameter", _is_profile)
]
"""A number or a sympy expression in the motion's parameter, of any unit."""
VaryingForce = Annotated[Varying, NEWTON]
"""A force, in N, or a sympy expression of one in the motion's parameter."""
Profile = Annotated[
    float | sympy.Expr, Variables(("s",)), Rule("be a finite number or an expression in s", _is_profile)
]
"""A number or a sympy expression in the arc length s, of any unit."""
LengthProfile = Annotated[Profile, METRE]
"""A length, in m, or a sympy expression of one in the arc length s."""
Surface = Annotated[sympy.Expr, Variables(("x", "y")), Rule("be an expression in x and y", _is_profile)]
"""A sympy expression in x and y."""
Point = tuple[Coordinate, Coordinate]
"""A point (x, y), in m."""


@functools.cache
def field_types(cls: Any) -> dict[str, Any]:
    """Types of a dataclass's fields, with the rules that they carry, by field."""
    return get_type_hints(cls, include_extras=True)


def _metadata(annotation: Any) -> tuple[Any, ...]:
    return getattr(annotation, "__metadata__", ())


def dimension(annotation: Any) -> Dimension | None:
    """Tell the kind of quantity that a field's type names; None where it names none.

    Of several, as in ``tuple[Length, Length]`` and ``Length | None``: that of the first.
    """
    own = [item for item in _metadata(annotation) if isinstance(item, Dimension)]
    if own:
        return own[-1]  # the outermost
    within = (dimension(inner) for inner in get_args(annotation) if not isinstance(inner, Rule))
    return next((kind for kind in within if kind is not None), None)


def _check(name: str, annotation: Any, value: Any) -> None:
    for rule in (item for item in _metadata(annotation) if isinstance(item, Rule)):
        if not rule.holds(value):
            kind = dimension(annotation)
            words = rule.words if kind is None else rule.words.replace(_SI, f", in {kind.unit}" if kind.unit else "")
            raise ValueError(f"{name} must {words}; got {value!r}")
    if type(None) in get_args(annotation) and value is not None:  # Positive | None
        for option in get_args(annotation):
            _check(name, option, value)
    if getattr(annotation, "__origin__", None) is tuple and isinstance(value, tuple):
        inner = get_args(annotation)
        each = inner[:1] * len(value) if len(inner) == 2 and inner[1] is Ellipsis else inner
        if len(each) != len(value):
            raise ValueError(f"{name} must have {len(each)} entries; got {value!r}")
        for i, (item, item_annotation) in enumerate(zip(value, each, strict=True)):
            _check(f"{name}[{i}]", item_annotation, item)


def _frozen(value: Any) -> Any:
    """Lists and arrays as nested tuples, numpy's numbers as Python's: the instance stays hashable."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return tuple(_frozen(item) for item in value)
    return value


def check_fields(instance: Any) -> None:
    """Check every field of a frozen dataclass against its annotation's rules.

    Sequences become tuples, so that the instance is hashable whatever it was built from.

    Raises
    ------
    ValueError
        The first field that breaks its rule, with the rule and the value got.
    """
    cls: Any = type(instance)
    types = field_types(cls)
    for field in dataclasses.fields(instance):
        value = _frozen(getattr(instance, field.name))
        object.__setattr__(instance, field.name, value)
        _check(field.name, types[field.name], value)
