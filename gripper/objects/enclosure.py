"""Proved bounds of the derivatives of an expression over discs, by interval arithmetic."""

from __future__ import annotations

import numpy as np
import sympy

from gripper.interval import NoEnclosureError, enclose_all
from gripper.objects.base import Array
from gripper.objects.compiled import X, Y

ROUNDING = 1e-14  # of the few lines of arithmetic after the intervals


def enclosed_largest(
    g: sympy.Expr, hessian: tuple[sympy.Expr, sympy.Expr, sympy.Expr], centers: Array, radii: Array
) -> Array:
    """Bound the Hessian's largest eigenvalue from above over discs; arguments as `enclosed_bounds`.

    Infinite where the expressions hold a function without an enclosure.
    """
    unknown: Array = np.full(len(centers), np.inf)
    low, high = np.nextafter(centers - radii[:, None], -np.inf), np.nextafter(centers + radii[:, None], np.inf)
    if g.has(sympy.Piecewise):
        return unknown
    try:
        entries = enclose_all([-entry for entry in hessian], {X: (low[:, 0], high[:, 0]), Y: (low[:, 1], high[:, 1])})
    except NoEnclosureError:
        return unknown
    return -_eigenvalues(entries)[0]


def enclosed_bounds(
    g: sympy.Expr,
    gradient: tuple[sympy.Expr, sympy.Expr],
    hessian: tuple[sympy.Expr, sympy.Expr, sympy.Expr],
    centers: Array,
    radii: Array,
) -> tuple[Array, Array] | None:
    """Bound |grad g| from above and the Hessian's smallest eigenvalue from below, over discs.

    Parameters
    ----------
    g, gradient, hessian
        Expressions in `X` and `Y`; the Hessian's entries are xx, xy, yy.
    centers, radii
        (n, 2) and (n,), in m.

    Returns
    -------
    (n,) each; None where the expressions hold a function without an enclosure.
    """
    n = len(centers)
    twice = np.vstack([centers, centers])  # each disc's square, and its centre alone
    low, high = twice.copy(), twice.copy()
    low[:n] = np.nextafter(centers - radii[:, None], -np.inf)
    high[:n] = np.nextafter(centers + radii[:, None], np.inf)
    squares = {X: (low[:, 0], high[:, 0]), Y: (low[:, 1], high[:, 1])}
    try:
        slopes = enclose_all(gradient, squares)
        curvatures = enclose_all(hessian, {symbol: (a[:n], b[:n]) for symbol, (a, b) in squares.items()})
    except NoEnclosureError:
        return None
    steepest = np.hypot(*(np.maximum(np.abs(a), np.abs(b)) for a, b in slopes))
    least, largest = _eigenvalues(curvatures)
    if g.has(sympy.Piecewise):  # its kinks leave nothing in the second derivatives
        least, largest = np.full(n, -np.inf), np.full(n, np.inf)
    with np.errstate(invalid="ignore"):
        from_center = steepest[n:] + np.where(radii > 0, largest * radii, 0.0)
    return np.minimum(steepest[:n], from_center) * (1 + ROUNDING), least


def _eigenvalues(hessian: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Bound the smallest eigenvalue from below and the largest modulus of one from above."""
    (a, a_high), (b, b_high), (c, c_high) = hessian
    cross = np.maximum(np.abs(b), np.abs(b_high))
    with np.errstate(invalid="ignore"):
        least = (a + c) / 2 - np.hypot((a - c) / 2, cross)
        a_most, c_most = np.maximum(np.abs(a), np.abs(a_high)), np.maximum(np.abs(c), np.abs(c_high))
        largest = (a_most + c_most) / 2 + np.hypot((a_most - c_most) / 2, cross)
    least = least - ROUNDING * largest
    return np.where(np.isnan(least), -np.inf, least), np.where(np.isnan(largest), np.inf, largest * (1 + ROUNDING))
