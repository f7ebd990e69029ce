"""Interval arithmetic over sympy expressions: ranges that are proved to hold every value.

Ends are rounded outwards, so a range holds every value that exact arithmetic could give (Moore, Kearfott &
Cloud, Introduction to Interval Analysis, 2009, chapter 2). Ends are arrays: many boxes at a time.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from gripper.interval.functions import (
    DOMAINS,
    RULES,
    Ends,
    Interval,
    exp,
    integer_power,
    log,
    multiplied,
    outward,
    positive_power,
    reciprocal,
)

__all__ = ["Ends", "Interval", "NoEnclosureError", "enclose", "enclose_all"]


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
    Lower and upper ends (n,); infinite at poles, and where a function leaves its domain anywhere in the box.

    Raises
    ------
    NoEnclosureError
        A symbol without a range, or a function that is not among these.
    """
    return enclose_all([expression], box)[0]


def enclose_all(expressions: Sequence[sympy.Expr], box: Mapping[sympy.Symbol, Interval]) -> list[Interval]:
    """Enclose several expressions at once, as `enclose`; what they share is worked out once."""
    with np.errstate(all="ignore"):
        walk = _Walk(box)
        ranges = [walk.range(sympy.sympify(expression)) for expression in expressions]
        return [walk.finished(low, high) for low, high in ranges]


def _ends(lower: Any, upper: Any) -> Interval:
    return np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)


def _is_exact(number: Any, value: float) -> bool:
    """Tell whether a double is the number itself."""
    if number.is_zero:
        return True
    normal = sys.float_info.min <= abs(value) < math.inf
    return normal and bool((number.is_Float and number._prec <= 53) or (number.is_Integer and abs(value) < 2**53))


class _Walk:
    """One pass over expressions: the ranges known so far, and the boxes where a function leaves its domain."""

    def __init__(self, box: Mapping[sympy.Symbol, Interval]) -> None:
        self.known: dict[Any, Interval] = {symbol: _ends(*ends) for symbol, ends in box.items()}
        self.undefined: NDArray[np.bool_] = np.zeros(
            np.broadcast_shapes(*(a.shape for a, _ in self.known.values())), bool
        )

    def finished(self, low: Ends, high: Ends) -> Interval:
        return np.where(self.undefined, -math.inf, low), np.where(self.undefined, math.inf, high)

    def range(self, expression: Any) -> Interval:
        found = self.known.get(expression)
        if found is None:
            found = self.known[expression] = self._new(expression)
        return found

    def _new(self, expression: Any) -> Interval:
        if expression.is_Number or expression.is_NumberSymbol:
            value = float(expression)
            return _ends(value, value) if _is_exact(expression, value) else outward(*_ends(value, value))
        if expression.is_Pow:
            return self._power(expression.base, expression.exp)
        if isinstance(expression, sympy.Piecewise):
            return self._piecewise(expression)
        rule = RULES.get(expression.func)
        if rule is None:
            raise NoEnclosureError(f"expression must be of symbols with a range and known functions; got {expression}")
        arguments = [self.range(argument) for argument in expression.args]
        if expression.func in DOMAINS:
            self._leave_out(arguments[0], *DOMAINS[expression.func])
        return rule(*arguments)

    def _leave_out(self, a: Interval, lowest: float, highest: float) -> None:
        self.undefined = self.undefined | (a[0] < lowest) | (a[1] > highest)

    def _power(self, base: Any, exponent: Any) -> Interval:
        if base is sympy.E:
            return exp(self.range(exponent))
        a = self.range(base)
        if exponent.is_Integer:
            n = int(exponent)
            return integer_power(a, n) if n > 0 else reciprocal(integer_power(a, -n))
        if exponent.is_number and not exponent.is_extended_real:
            raise NoEnclosureError(f"expression must have real exponents; got {exponent}")
        self._leave_out(a, 0.0, math.inf)
        if exponent.is_number and exponent > 0:
            return positive_power(a, exponent)
        if exponent.is_number:
            return reciprocal(positive_power(a, -exponent))
        return exp(multiplied(self.range(exponent), log(a)))

    def _piecewise(self, expression: Any) -> Interval:
        """Take the hull of the branches that may apply."""
        low: Ends = np.asarray(math.inf)
        high: Ends = np.asarray(-math.inf)
        unsettled: NDArray[np.bool_] = np.asarray(True)  # no earlier branch surely applies
        for branch, condition in expression.args:
            may, must = self._condition(condition)
            branch_low, branch_high = self.range(branch)
            low = np.where(unsettled & may, np.minimum(low, branch_low), low)
            high = np.where(unsettled & may, np.maximum(high, branch_high), high)
            unsettled = unsettled & ~must
        self.undefined = self.undefined | unsettled
        return low, high

    def _condition(self, condition: Any) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Whether a condition may hold somewhere, and whether it must hold everywhere."""
        if condition in (sympy.true, sympy.false):
            value = np.asarray(condition == sympy.true)
            return value, value
        kinds = {sympy.StrictLessThan: 1, sympy.LessThan: 1, sympy.StrictGreaterThan: -1, sympy.GreaterThan: -1}
        sign = kinds.get(condition.func)
        if sign is None:
            return np.asarray(True), np.asarray(False)
        low, high = self.range(condition.lhs - condition.rhs)
        below, above = (high < 0, low > 0) if sign > 0 else (low > 0, high < 0)
        return ~above, below
