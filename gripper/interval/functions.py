"""Ranges of single functions over intervals, rounded outwards."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from typing import Any, TypeAlias

import numpy as np
import sympy
from numpy.typing import NDArray

Ends: TypeAlias = NDArray[np.float64]
Interval: TypeAlias = tuple[Ends, Ends]
"""Lower and upper ends, of one shape, lower <= upper."""

ULPS = 4  # numpy's exp, log, sin, ... are off by less than this many units in the last place


def outward(lower: Ends, upper: Ends, ulps: int = 1) -> Interval:
    """Move the ends apart by ``ulps`` units in the last place; NaN (undefined) becomes everything."""
    for _ in range(ulps):
        lower, upper = np.nextafter(lower, -math.inf), np.nextafter(upper, math.inf)
    return np.where(np.isnan(lower), -math.inf, lower), np.where(np.isnan(upper), math.inf, upper)


def _add_two(a: Interval, b: Interval) -> Interval:
    lower, upper = a[0] + b[0], a[1] + b[1]
    low, high = outward(lower, upper)
    return np.where(lower == 0, 0.0, low), np.where(upper == 0, 0.0, high)  # a sum of 0 is exact


def _add(*terms: Interval) -> Interval:
    return reduce(_add_two, terms)


def multiplied(a: Interval, b: Interval) -> Interval:
    """Give the range of the product."""
    if b[0].ndim == 0 and b[0] == b[1]:
        a, b = b, a
    if a[0].ndim == 0 and a[0] == a[1] and a[0] != 0:  # most factors are constants
        products = np.stack([a[0] * b[0], a[0] * b[1]])
        exact = np.stack(b) == 0
    else:
        a_low, a_high, b_low, b_high = np.broadcast_arrays(*a, *b)
        p, q = np.stack([a_low, a_low, a_high, a_high]), np.stack([b_low, b_high, b_low, b_high])
        products = p * q
        exact = (p == 0) | (q == 0)  # also 0 * inf: an end at infinity is not a value
    lows, highs = np.nextafter(products, -math.inf), np.nextafter(products, math.inf)
    if exact.any():
        lows[exact] = highs[exact] = 0.0
    return lows.min(axis=0), highs.max(axis=0)


def _multiply(*factors: Interval) -> Interval:
    return reduce(multiplied, factors)


def integer_power(a: Interval, n: int) -> Interval:
    """Give the range of a^n, n > 0."""
    if n == 1:
        return a
    ends = a[0] ** n, a[1] ** n
    low, high = outward(np.minimum(*ends), np.maximum(*ends), 1 if n == 2 else ULPS)
    if n % 2:
        return np.where(a[0] == 0, 0.0, low), np.where(a[1] == 0, 0.0, high)
    holds_zero = (a[0] <= 0) & (a[1] >= 0)
    return np.where(holds_zero, 0.0, np.maximum(low, 0.0)), high


def reciprocal(a: Interval) -> Interval:
    """Give the range of 1/a; everything where a holds zero inside."""
    low, high = a
    # a range that only touches zero has a reciprocal on one side
    lower = np.where(high == 0, -math.inf, 1 / high)
    upper = np.where(low == 0, math.inf, 1 / low)
    lower, upper = outward(lower, upper)
    across = (low < 0) & (high > 0)
    return np.where(across, -math.inf, lower), np.where(across, math.inf, upper)


def positive_power(a: Interval, exponent: Any) -> Interval:
    """Give the range of a to a positive exponent that is no integer, a >= 0."""
    if exponent == sympy.Rational(1, 2):
        low, high = outward(np.sqrt(a[0]), np.sqrt(a[1]))
    else:
        low, high = outward(a[0] ** float(exponent), a[1] ** float(exponent), ULPS)
        if not exponent.is_Float:  # 1/3 is not a float: both neighbours' powers
            for neighbour in np.nextafter(float(exponent), [0.0, math.inf]):
                low, high = np.minimum(low, a[0] ** neighbour), np.maximum(high, a[1] ** neighbour)
            low, high = outward(low, high, ULPS)
    return np.maximum(low, 0.0), high


def exp(a: Interval) -> Interval:
    """Give the range of the exponential."""
    low, high = outward(np.exp(a[0]), np.exp(a[1]), ULPS)
    return np.maximum(low, 0.0), high


def log(a: Interval) -> Interval:
    """Give the range of the logarithm, a >= 0."""
    return outward(np.log(a[0]), np.log(a[1]), ULPS)


def _holds(a: Interval, phase: float, period: float) -> NDArray[np.bool_]:
    """Whether a range may hold phase + k period; ends within rounding of it count."""
    slack = 1e-15 * (1 + np.maximum(np.abs(a[0]), np.abs(a[1])))
    return np.floor((a[1] + slack - phase) / period) >= np.ceil((a[0] - slack - phase) / period)


def _sine_like(function: Callable[[Ends], Ends], top: float, a: Interval) -> Interval:
    ends = function(a[0]), function(a[1])
    low, high = outward(np.minimum(*ends), np.maximum(*ends), ULPS)
    low, high = np.maximum(low, -1.0), np.minimum(high, 1.0)
    wide = ~(a[1] - a[0] < 2 * math.pi)  # also where an end is infinite
    low = np.where(wide | _holds(a, top + math.pi, 2 * math.pi), -1.0, low)
    return low, np.where(wide | _holds(a, top, 2 * math.pi), 1.0, high)


def _sin(a: Interval) -> Interval:
    return _sine_like(np.sin, math.pi / 2, a)


def _cos(a: Interval) -> Interval:
    return _sine_like(np.cos, 0.0, a)


def _tan(a: Interval) -> Interval:
    low, high = outward(np.tan(a[0]), np.tan(a[1]), ULPS)
    pole = ~(a[1] - a[0] < math.pi) | _holds(a, math.pi / 2, math.pi)
    return np.where(pole, -math.inf, low), np.where(pole, math.inf, high)


def _rising(function: Callable[[Ends], Ends]) -> Callable[[Interval], Interval]:
    return lambda a: outward(function(a[0]), function(a[1]), ULPS)


def _acos(a: Interval) -> Interval:
    return outward(np.arccos(a[1]), np.arccos(a[0]), ULPS)


def _atan2(y: Interval, x: Interval) -> Interval:
    angles = [np.arctan2(p, q) for p in y for q in x]
    low, high = outward(reduce(np.minimum, angles), reduce(np.maximum, angles), ULPS)
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


RULES: dict[Any, Callable[..., Interval]] = {
    sympy.Add: _add,
    sympy.Mul: _multiply,
    sympy.exp: exp,
    sympy.log: log,
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

DOMAINS = {sympy.log: (0.0, math.inf), sympy.asin: (-1.0, 1.0), sympy.acos: (-1.0, 1.0)}
