"""Interval arithmetic over sympy expressions: ranges that are proved to hold every value.

Ends are rounded outwards, so a range holds every value that exact arithmetic could give (Moore, Kearfott &
Cloud, Introduction to Interval Analysis, 2009, chapter 2). Ends are arrays: many boxes at a time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import Any, TypeAlias

import numpy as np
import sympy
from numpy.typing import NDArray

Ends: TypeAlias = NDArray[np.float64]
Interval: TypeAlias = tuple[Ends, Ends]
"""Lower and upper ends, of one shape, lower <= upper."""

ULPS = 4  # numpy's exp, log, sin, ... are off by less than this many units in the last place


class NoEnclosureError(ValueError):
    """A function whose range this module does not know."""


def enclose(expression: sympy.Expr, box: Mapping[sympy.Symbol, Interval]) -> Interval:
    """Find ends between which every value of the expression over the box lies.

    Parameters
    ----------
    expression
        Of +, *, powers, exp, log, sin, cos, tan, asin, acos, atan, atan2, Abs, sign, Min, Max, Heaviside,
        DiracDelta, Piecewise and numbers.
    box
        Lower and upper ends (n,) of each symbol.

    Returns
    -------
    Lower and upper ends (n,); infinite at poles and wherever the expression is not defined all over the box.

    Raises
    ------
    NoEnclosureError
        A symbol without a range, or a function that is not among these.
    """
    return enclose_all([expression], box)[0]


def enclose_all(expressions: Sequence[sympy.Expr], box: Mapping[sympy.Symbol, Interval]) -> list[Interval]:
    """Enclose several expressions at once, as `enclose`; what they share is worked out once."""
    with np.errstate(all="ignore"):
        known: dict[Any, Interval] = {symbol: _ends(*ends) for symbol, ends in box.items()}
        shape = np.broadcast_shapes(*(ends[0].shape for ends in known.values()))
        ranges = [_range(sympy.sympify(expression), known) for expression in expressions]
        return [(np.broadcast_to(low, shape), np.broadcast_to(high, shape)) for low, high in ranges]


def _ends(lower: Any, upper: Any) -> Interval:
    return np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)


def _range(expression: Any, known: dict[Any, Interval]) -> Interval:
    found = known.get(expression)
    if found is None:
        found = known[expression] = _new_range(expression, known)
    return found


def _new_range(expression: Any, known: dict[Any, Interval]) -> Interval:
    if expression.is_Number or expression.is_NumberSymbol:
        value = float(expression)
        exact = (expression.is_Float and expression._prec <= 53) or (expression.is_Integer and abs(expression) < 2**53)
        return _ends(value, value) if exact else _outward(*_ends(value, value))
    if expression.is_Pow:
        return _power(expression.base, expression.exp, known)
    if isinstance(expression, sympy.Piecewise):
        return _piecewise(expression, known)
    rule = _RULES.get(expression.func)
    if rule is None:
        raise NoEnclosureError(
            f"expression must be of symbols with a range and functions that have one; got {expression}"
        )
    return rule(*(_range(argument, known) for argument in expression.args))


def _outward(lower: Ends, upper: Ends, ulps: int = 1) -> Interval:
    """Move the ends apart by ``ulps`` units in the last place; NaN (undefined) becomes everything."""
    for _ in range(ulps):
        lower, upper = np.nextafter(lower, -math.inf), np.nextafter(upper, math.inf)
    return np.where(np.isnan(lower), -math.inf, lower), np.where(np.isnan(upper), math.inf, upper)


def _add_two(a: Interval, b: Interval) -> Interval:
    lower, upper = a[0] + b[0], a[1] + b[1]
    low, high = _outward(lower, upper)
    return np.where(lower == 0, 0.0, low), np.where(upper == 0, 0.0, high)  # a sum of 0 is exact


def _add(*terms: Interval) -> Interval:
    return reduce(_add_two, terms)


def _products(a: Ends, b: Ends) -> Ends:
    return np.where((a == 0) | (b == 0), 0.0, a * b)  # 0 * inf is 0: an end at infinity is not a value


def _multiply_two(a: Interval, b: Interval) -> Interval:
    products = [_products(p, q) for p in a for q in b]
    exact_zero = [(p == 0) | (q == 0) for p in a for q in b]
    low = [np.where(zero, 0.0, np.nextafter(p, -math.inf)) for zero, p in zip(exact_zero, products, strict=True)]
    high = [np.where(zero, 0.0, np.nextafter(p, math.inf)) for zero, p in zip(exact_zero, products, strict=True)]
    return reduce(np.minimum, low), reduce(np.maximum, high)


def _multiply(*factors: Interval) -> Interval:
    return reduce(_multiply_two, factors)


def _power(base: Any, exponent: Any, known: dict[Any, Interval]) -> Interval:
    if base is sympy.E:
        return _exp(_range(exponent, known))
    a = _range(base, known)
    if exponent.is_Integer:
        n = int(exponent)
        return _integer_power(a, n) if n > 0 else _reciprocal(_integer_power(a, -n))
    if exponent.is_number and not exponent.is_extended_real:
        raise NoEnclosureError(f"expression must have real exponents; got {exponent}")
    if exponent.is_number and exponent > 0:
        return _positive_power(a, exponent)
    if exponent.is_number:
        return _reciprocal(_positive_power(a, -exponent))
    return _exp(_multiply_two(_range(exponent, known), _log(a)))


def _integer_power(a: Interval, n: int) -> Interval:
    if n == 1:
        return a
    ends = a[0] ** n, a[1] ** n
    low, high = _outward(np.minimum(*ends), np.maximum(*ends), 1 if n == 2 else ULPS)
    if n % 2:
        return np.where(a[0] == 0, 0.0, low), np.where(a[1] == 0, 0.0, high)
    holds_zero = (a[0] <= 0) & (a[1] >= 0)
    return np.where(holds_zero, 0.0, np.maximum(low, 0.0)), high


def _reciprocal(a: Interval) -> Interval:
    low, high = a
    # a range that only touches zero has a reciprocal on one side
    lower = np.where(high == 0, -math.inf, 1 / high)
    upper = np.where(low == 0, math.inf, 1 / low)
    lower, upper = _outward(lower, upper)
    across = (low < 0) & (high > 0)
    return np.where(across, -math.inf, lower), np.where(across, math.inf, upper)


def _positive_power(a: Interval, exponent: Any) -> Interval:
    """Raise a base that must not be negative: where it may be, the range is everything."""
    if exponent == sympy.Rational(1, 2):
        low, high = _outward(np.sqrt(a[0]), np.sqrt(a[1]))
    else:
        low, high = _outward(a[0] ** float(exponent), a[1] ** float(exponent), ULPS)
        if not exponent.is_Float:  # 1/3 is not a float: both neighbours' powers
            for neighbour in np.nextafter(float(exponent), [0.0, math.inf]):
                low, high = np.minimum(low, a[0] ** neighbour), np.maximum(high, a[1] ** neighbour)
            low, high = _outward(low, high, ULPS)
    defined = a[0] >= 0
    return np.where(defined, np.maximum(low, 0.0), -math.inf), np.where(defined, high, math.inf)


def _exp(a: Interval) -> Interval:
    low, high = _outward(np.exp(a[0]), np.exp(a[1]), ULPS)
    return np.maximum(low, 0.0), high


def _log(a: Interval) -> Interval:
    low, high = _outward(np.log(a[0]), np.log(a[1]), ULPS)
    return np.where(a[0] < 0, -math.inf, low), np.where(a[0] < 0, math.inf, high)


def _holds(a: Interval, phase: float, period: float) -> NDArray[np.bool_]:
    """Whether a range may hold phase + k period; ends within rounding of it count."""
    slack = 1e-15 * (1 + np.maximum(np.abs(a[0]), np.abs(a[1])))
    return np.floor((a[1] + slack - phase) / period) >= np.ceil((a[0] - slack - phase) / period)


def _sine_like(function: Callable[[Ends], Ends], top: float, a: Interval) -> Interval:
    ends = function(a[0]), function(a[1])
    low, high = _outward(np.minimum(*ends), np.maximum(*ends), ULPS)
    low, high = np.maximum(low, -1.0), np.minimum(high, 1.0)
    wide = ~(a[1] - a[0] < 2 * math.pi)  # also where an end is infinite
    low = np.where(wide | _holds(a, top + math.pi, 2 * math.pi), -1.0, low)
    return low, np.where(wide | _holds(a, top, 2 * math.pi), 1.0, high)


def _sin(a: Interval) -> Interval:
    return _sine_like(np.sin, math.pi / 2, a)


def _cos(a: Interval) -> Interval:
    return _sine_like(np.cos, 0.0, a)


def _tan(a: Interval) -> Interval:
    low, high = _outward(np.tan(a[0]), np.tan(a[1]), ULPS)
    pole = ~(a[1] - a[0] < math.pi) | _holds(a, math.pi / 2, math.pi)
    return np.where(pole, -math.inf, low), np.where(pole, math.inf, high)


def _rising(function: Callable[[Ends], Ends]) -> Callable[[Interval], Interval]:
    return lambda a: _outward(function(a[0]), function(a[1]), ULPS)


def _acos(a: Interval) -> Interval:
    return _outward(np.arccos(a[1]), np.arccos(a[0]), ULPS)


def _atan2(y: Interval, x: Interval) -> Interval:
    angles = [np.arctan2(p, q) for p in y for q in x]
    low, high = _outward(reduce(np.minimum, angles), reduce(np.maximum, angles), ULPS)
    cut = (x[0] <= 0) & (y[0] <= 0) & (y[1] >= 0)  # the branch cut, or the origin
    return np.where(cut, -4.0, low), np.where(cut, 4.0, high)


def _abs(a: Interval) -> Interval:
    ends = np.abs(a[0]), np.abs(a[1])
    return np.where((a[0] <= 0) & (a[1] >= 0), 0.0, np.minimum(*ends)), np.maximum(*ends)


def _minimum(*values: Interval) -> Interval:
    return reduce(np.minimum, [value[0] for value in values]), reduce(np.minimum, [value[1] for value in values])


def _maximum(*values: Interval) -> Interval:
    return reduce(np.maximum, [value[0] for value in values]), reduce(np.maximum, [value[1] for value in values])


def _sign(a: Interval) -> Interval:
    return np.sign(a[0]), np.sign(a[1])


def _heaviside(a: Interval, at_zero: Interval | None = None) -> Interval:
    return np.where(a[0] > 0, 1.0, 0.0), np.where(a[1] < 0, 0.0, 1.0)


def _dirac(a: Interval) -> Interval:
    """Enclose the second derivative of a kink: nothing away from it, anything positive on it."""
    return np.zeros_like(a[0]), np.where((a[0] <= 0) & (a[1] >= 0), math.inf, 0.0)


def _piecewise(expression: Any, known: dict[Any, Interval]) -> Interval:
    """Take the hull of the branches that may apply."""
    low: Ends = np.asarray(math.inf)
    high: Ends = np.asarray(-math.inf)
    open_: NDArray[np.bool_] = np.asarray(True)  # no earlier branch surely applies
    for branch, condition in expression.args:
        may, must = _condition(condition, known)
        branch_low, branch_high = _range(branch, known)
        low = np.where(open_ & may, np.minimum(low, branch_low), low)
        high = np.where(open_ & may, np.maximum(high, branch_high), high)
        open_ = open_ & ~must
    undefined = open_
    return np.where(undefined, -math.inf, low), np.where(undefined, math.inf, high)


def _condition(condition: Any, known: dict[Any, Interval]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether a condition may hold somewhere, and whether it must hold everywhere."""
    if condition in (sympy.true, sympy.false):
        value = np.asarray(condition == sympy.true)
        return value, value
    kinds = {sympy.StrictLessThan: 1, sympy.LessThan: 1, sympy.StrictGreaterThan: -1, sympy.GreaterThan: -1}
    sign = kinds.get(condition.func)
    if sign is None:
        return np.asarray(True), np.asarray(False)
    low, high = _range(condition.lhs - condition.rhs, known)
    below, above = (high < 0, low > 0) if sign > 0 else (low > 0, high < 0)
    return ~above, below


_RULES: dict[Any, Callable[..., Interval]] = {
    sympy.Add: _add,
    sympy.Mul: _multiply,
    sympy.exp: _exp,
    sympy.log: _log,
    sympy.sin: _sin,
    sympy.cos: _cos,
    sympy.tan: _tan,
    sympy.asin: _rising(np.arcsin),
    sympy.acos: _acos,
    sympy.atan: _rising(np.arctan),
    sympy.atan2: _atan2,
    sympy.Abs: _abs,
    sympy.sign: _sign,
    sympy.Min: _minimum,
    sympy.Max: _maximum,
    sympy.Heaviside: _heaviside,
    sympy.DiracDelta: _dirac,
}
