"""The pieces of an expression: each has a value, and kinds of quantity that it can be."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import sympy

from gripper.expression import dimensions, values
from gripper.expression.dimensions import Dimension, Measure
from gripper.expression.vocabulary import CONSTANTS, UNITS


class Term(NamedTuple):
    """What a piece of the text says: its value, and what kind of quantity it can be."""

    value: values.Value
    measure: Measure


_SIGNS: dict[str, Callable[[Measure, Measure], Measure]] = {
    "+": lambda left, right: dimensions.total((left, right)),
    "-": lambda left, right: dimensions.total((left, right)),
    "*": dimensions.product,
    "/": lambda left, right: dimensions.product(left, right, -1),
}


def combined(sign: str, left: Term, right: Term) -> Term:
    """Add, subtract, multiply or divide."""
    value = values.combined(sign, left.value, right.value)
    return Term(value, _SIGNS[sign](left.measure, right.measure))


def raised(base: Term, exponent: Term) -> Term:
    """Compute a power."""
    value = values.raised(base.value, exponent.value)
    number = exponent.value if isinstance(exponent.value, float) else None
    return Term(value, dimensions.raised(base.measure, exponent.measure, number))


def applied(name: str, arguments: list[Term]) -> Term:
    """Call a function."""
    value = values.applied(name, [argument.value for argument in arguments])
    return Term(value, dimensions.applied(name, [argument.measure for argument in arguments]))


def symbol(name: str, kind: Dimension | None) -> Term:
    """Of a symbol, of a kind where that is known."""
    return Term(sympy.Symbol(name, real=True), dimensions.of_symbol(name, kind))


def constant(name: str) -> Term:
    """Of a constant's or a unit's name."""
    if name in CONSTANTS:
        return Term(CONSTANTS[name], dimensions.PLAIN)
    return Term(UNITS[name], dimensions.of_unit(name))


def quantity(digits: str, unit: str | None = None) -> Term:
    """Of a number, with its unit."""
    measure = dimensions.PLAIN if unit is None else dimensions.of_unit(unit)
    return Term(values.quantity(digits, unit), measure)
