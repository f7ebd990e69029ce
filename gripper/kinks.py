"""Where a finger's profile has kinks: found from its expression."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np
import sympy

from gripper.arrays import Array

SAMPLES = 4097
INSET = 1e-9  # of L: what is nearer to an end is no kink


def kinks_of(profile: sympy.Expr, s: sympy.Symbol, length: float) -> tuple[float, ...]:
    """Find the arc lengths at which absolute values, minima, maxima, steps and branches change over.

    Parameters
    ----------
    profile
        An expression in ``s``.
    s
        The arc length, in m.
    length
        L, in m.

    Returns
    -------
    Rising, strictly between 0 and L, in m: every place where something changes sign between 4097 samples.
    """
    places = np.linspace(0.0, length, SAMPLES)
    found = {root for switch in set(switches(profile)) for root in _roots(switch, s, places)}
    inner = sorted(root for root in found if INSET * length < root < (1 - INSET) * length)
    return tuple(b for a, b in zip([-length, *inner], inner, strict=False) if b - a > INSET * length)


def beside_kinks(derivative: sympy.Expr) -> sympy.Expr:
    """Drop the delta functions that kinks leave in second derivatives: the value beside a kink."""
    return derivative.replace(sympy.DiracDelta, lambda *_: sympy.Integer(0))


def switches(profile: sympy.Expr) -> Iterator[sympy.Expr]:
    """What is zero where the profile changes over."""
    for part in sympy.preorder_traversal(profile):
        if isinstance(part, (sympy.Abs, sympy.sign, sympy.Heaviside)):
            yield part.args[0]
        elif isinstance(part, (sympy.Min, sympy.Max)):
            yield from (a - b for a, b in combinations(part.args, 2))
        elif isinstance(part, sympy.core.relational.Relational):
            yield part.lhs - part.rhs


def _roots(switch: sympy.Expr, s: sympy.Symbol, places: Array) -> list[float]:
    if s not in switch.free_symbols:
        return []
    from scipy.optimize import brentq  # as heavy as sympy itself, and few profiles switch

    function = sympy.lambdify([s], switch, "numpy")
    with np.errstate(all="ignore"):
        values = np.asarray(function(places), dtype=float)
        crossed = np.flatnonzero(values[:-1] * values[1:] < 0)
        roots = [brentq(function, places[i], places[i + 1], xtol=1e-15) for i in crossed]
    return [*places[values == 0].tolist(), *roots]
