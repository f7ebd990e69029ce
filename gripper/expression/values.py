"""The values of an expression's nodes: floats as long as no symbol is in them, sympy's nodes from there on.

So sympy computes no constant (9**9**9**9 overflows, it does not fill the memory), and no node without a finite real
value passes. Errors say the rule only; the parser adds the place and the text.
"""

from __future__ import annotations

import decimal
import math
import operator
from collections.abc import Callable
from typing import Any, TypeAlias

import sympy

from gripper.expression.vocabulary import FUNCTIONS, LARGEST_EXPONENT, MOST_ARGUMENTS, SCALES, UNITS
from gripper.names import shortened

Value: TypeAlias = float | sympy.Expr

_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
_EXPONENTS = f"have exponents between -{LARGEST_EXPONENT} and {LARGEST_EXPONENT}"
_UNREAL = (sympy.nan, sympy.zoo, sympy.oo, -sympy.oo, sympy.I)
# Own precision: a caller's decimal context must not change what "8.9 mm" means.
_DECIMALS = decimal.Context(prec=50)


def symbolic(value: Value) -> sympy.Expr:
    """Give a number to sympy: as a Float, whose powers cannot grow without bound as an Integer's can."""
    if not isinstance(value, float):
        return value
    return sympy.Integer(int(value)) if value in (-1.0, 0.0, 1.0) else sympy.Float(value)


def quantity(digits: str, unit: str | None = None) -> float:
    """Read a number, with its unit: rounded once, so that "8.9 mm" is the float nearest to 0.0089."""
    value = _finite(digits, lambda: float(digits))
    if unit is None or value == 0:
        return value
    if unit not in SCALES:
        return _finite(digits, lambda: value * UNITS[unit])
    exact = _DECIMALS.multiply(decimal.Decimal(digits), decimal.Decimal(SCALES[unit]))
    return _finite(digits, lambda: float(exact))


def combined(sign: str, left: Value, right: Value) -> Value:
    """Add, subtract, multiply or divide."""
    compute = _OPERATORS[sign]
    if isinstance(left, float) and isinstance(right, float):
        return _finite(sign, lambda: compute(left, right))
    return _real(sign, lambda: compute(symbolic(left), symbolic(right)))


def raised(base: Value, exponent: Value) -> Value:
    """Compute base**exponent; constant exponents are bounded."""
    if isinstance(exponent, float) and abs(exponent) > LARGEST_EXPONENT:
        raise ValueError(_EXPONENTS)
    if isinstance(base, float) and isinstance(exponent, float):
        if base == 0 and exponent < 0:
            raise ValueError("have a finite value: 0 to a negative power divides by 0")
        return _finite("**", lambda: math.pow(base, exponent))  # unlike **, no complex root of a negative number
    power = symbolic(base) ** _exponent(exponent)
    exponents = (item.exp for item in power.atoms(sympy.Pow))
    if any(item.is_number and abs(item) > LARGEST_EXPONENT for item in exponents):  # (x**100)**100
        raise ValueError(_EXPONENTS)
    return _real("**", lambda: power)


def applied(name: str, values: list[Value]) -> Value:
    """Call a function."""
    compute, function = FUNCTIONS[name]
    if all(isinstance(value, float) for value in values):
        return _finite(name, lambda: compute(*values))
    arguments = [symbolic(value) for value in values]
    if name in ("min", "max"):
        count = sum(len(argument.args) if isinstance(argument, function) else 1 for argument in arguments)
        if count > MOST_ARGUMENTS:
            raise ValueError(f"give {name} at most {MOST_ARGUMENTS} arguments, those of nested {name} counted")
    return _real(name, lambda: function(*arguments))


def _exponent(value: Value) -> sympy.Expr:
    """Give an exponent to sympy: whole and half ones exactly, so that x**2 and x**0.5 are a square and a root."""
    if isinstance(value, float) and (2 * value).is_integer():
        return sympy.Rational(int(2 * value), 2)
    return symbolic(value)


def _finite(what: str, compute: Callable[[], float]) -> float:
    """Compute a constant; refuse what has no finite real value."""
    try:
        value = float(compute())
    except ZeroDivisionError:
        raise ValueError(f"have a finite value: {what!r} divides by 0") from None
    except OverflowError:
        value = math.inf
    except ValueError:  # outside the function's domain
        raise ValueError(f"have a real value: {what!r} has none here") from None
    if not math.isfinite(value):
        raise ValueError(f"have a finite value: {shortened(what)!r} gives one too large for a float")
    return value


def _real(what: str, compute: Callable[[], sympy.Expr]) -> Value:
    """Check what sympy makes of a node; where the symbols drop out, give its number."""
    try:
        value = compute()
    except (TypeError, ValueError):  # sympy's, of min and max: it knows that an argument is not real
        raise ValueError(f"have a real value: {what!r} has none here") from None
    if value.has(*_UNREAL) or value.is_extended_real is False:
        raise ValueError(f"have a finite real value: {what!r} gives none")
    if not value.free_symbols:
        return _finite(what, lambda: _constant(value))
    _finite(what, lambda: max((abs(float(item)) for item in value.atoms(sympy.Float)), default=0.0))
    return value


def _constant(value: sympy.Expr) -> float:
    """Evaluate what holds no symbol; ValueError where it is not real, as asin(2)."""
    evaluated = value.evalf()
    if not evaluated.is_real:
        raise ValueError(f"value must be real; got {value}")
    return float(evaluated)
