"""A finger that is bent at rest: psi' = kappa0(s) + kappa, the strains counting from there. By L."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy

from gripper.arrays import Array
from gripper.fingers import S
from gripper.interval import NoEnclosureError, enclose_all
from gripper.kinks import beside_kinks, kinks_of

_PARTS = 16  # between kinks: Gauss points on each integrate any smooth curvature to round-off
_POINTS = 16
_TURN = 1.0  # rad: segments turn by no more at rest, so that their Gauss points integrate the axis


@dataclass(frozen=True, eq=False)
class Rest:
    """Curvature of the unloaded axis over sigma = s / L.

    Parameters
    ----------
    kinks
        Where it jumps or has corners, and where the axis has turned by another radian: rising, within (0, 1).
    bounds
        Upper bounds of abs(kappa0) L and abs(kappa0') L^2, proved by interval arithmetic.
    """

    kinks: tuple[float, ...]
    bounds: tuple[float, float]
    _breaks: Array
    _angles: Array  # Legendre coefficients of psi0 on each part
    _curvature: Callable[[Array], tuple[Array, Array]]

    def angle(self, sigma: Array) -> Array:
        """psi0: how far the unloaded section has turned, in rad."""
        part = np.clip(np.searchsorted(self._breaks, sigma, side="right") - 1, 0, len(self._angles) - 1)
        x = 2 * (sigma - self._breaks[part]) / np.diff(self._breaks)[part] - 1
        table = np.polynomial.legendre.legvander(x, _POINTS)
        values: Array = np.einsum("km,km->k", table, self._angles[part])
        return values

    def curvature(self, sigma: Array) -> tuple[Array, Array]:
        """kappa0 L and kappa0' L^2."""
        return self._curvature(sigma)


def rest(curvature: sympy.Expr, length: float, kinks: tuple[float, ...]) -> Rest | None:
    """The rest shape of a finger; None where it is straight.

    Parameters
    ----------
    curvature
        kappa0 in 1/m, an expression in s (m): positive turns the finger towards its upper face.
    length
        L, in m.
    kinks
        Those of its profile, by L.

    Raises
    ------
    ValueError
        Where the curvature or its slope is not bounded.
    """
    curvature = sympy.sympify(curvature)
    if curvature == 0:
        return None
    bounds = _bounds(curvature, length)
    function = sympy.lambdify([S], [curvature, beside_kinks(sympy.diff(curvature, S))], "numpy", cse=True)

    def evaluate(sigma: Array) -> tuple[Array, Array]:
        value, slope = function(sigma * length)
        return value * length + 0 * sigma, slope * length**2 + 0 * sigma

    own = tuple(kink / length for kink in kinks_of(curvature, S, length))
    marks = np.array([0.0, *sorted({*kinks, *own}), 1.0])
    breaks = np.append((marks[:-1, None] + np.diff(marks)[:, None] * np.arange(_PARTS) / _PARTS).ravel(), 1.0)
    x, weights = np.polynomial.legendre.leggauss(_POINTS)
    half = np.diff(breaks)[:, None] / 2
    values = evaluate((breaks[:-1, None] + half * (x + 1)).ravel())[0].reshape(half.size, -1) * half
    modes = np.polynomial.legendre.legvander(x, _POINTS - 1) * (np.arange(_POINTS) + 0.5)
    angles = np.polynomial.legendre.legint(values @ (weights[:, None] * modes), lbnd=-1, axis=1)
    angles[1:, 0] += np.cumsum(angles[:-1].sum(axis=1))  # every P_k is 1 at a part's end
    turned = np.append(0.0, np.cumsum(np.abs(values) @ weights))
    turns = np.interp(np.arange(_TURN, turned[-1], _TURN), turned, breaks)
    return Rest((*own, *turns.tolist()), bounds, breaks, angles, evaluate)


def _bounds(curvature: sympy.Expr, length: float) -> tuple[float, float]:
    marks = np.linspace(0.0, length, _PARTS + 1)
    parts = [curvature, beside_kinks(sympy.diff(curvature, S))]
    try:
        ranges = enclose_all(parts, {S: (marks[:-1], marks[1:])})
    except NoEnclosureError:
        ranges = [(np.full(1, -np.inf), np.full(1, np.inf))] * 2
    largest = [float(np.max(np.maximum(np.abs(low), np.abs(high)))) for low, high in ranges]
    if not np.isfinite(largest).all():
        raise ValueError(f"rest_curvature must be bounded along the finger, with its slope, in 1/m; got {curvature}")
    return largest[0] * length, largest[1] * length**2
