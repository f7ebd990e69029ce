"""What an object's numbers change: g and its gradient at fixed points, and the object's corners."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import sympy

from gripper.arrays import Array, Complex
from gripper.objects import Combined, FeatureSurface, ImplicitSurface, Object, Offset
from gripper.objects.compiled import X, Y
from gripper.sensitivity.opened import NotOpenError, Opened, surface
from gripper.sensitivity.swept import filled, swept


class ObjectRates(Protocol):
    """Derivatives of g by an object's numbers (p), in its own frame."""

    def at(self, points: Array) -> tuple[Array, Complex]:
        """Rates of g (p, k), and of its gradient (p, k), at points (k, 2) in m."""

    def corners(self, points: Array) -> Complex:
        """Rates (p, k), in m, of the object's corners, convex or not, that lie at points (k, 2)."""


def object_rates(body: Object, values: Mapping[str, float]) -> ObjectRates:
    """The derivatives of an object by its numbers, given by their keys within it.

    Raises
    ------
    NotOpenError
        An object whose formulas sympy cannot differentiate, and that writes no rates of its pieces.
    """
    if not values:
        return _NoRates()
    if isinstance(body, ImplicitSurface):
        return _FormulaRates(body, values)
    if isinstance(body, (Combined, Offset)):
        from gripper.sensitivity.part_rates import CombinedRates, OffsetRates  # here: their parts are objects again

        return CombinedRates(body, values) if isinstance(body, Combined) else OffsetRates(body, values)
    rates = body.piece_rates() if isinstance(body, FeatureSurface) else {}
    if isinstance(body, FeatureSurface) and set(values) <= set(rates):
        return _PieceRates(body, np.array([rates[key] for key in values]))
    rule = "be an ImplicitSurface, a FeatureSurface that writes piece_rates, or made of such"
    raise NotOpenError(f"{type(body).__name__} must {rule}, to be differentiated by its numbers")


class _NoRates:
    """No numbers."""

    def at(self, points: Array) -> tuple[Array, Complex]:
        return np.zeros((0, len(points))), np.zeros((0, len(points)), dtype=complex)

    def corners(self, points: Array) -> Complex:
        return np.zeros((0, len(points)), dtype=complex)


class _FormulaRates:
    """By sympy, of an object that is one formula g(x, y)."""

    def __init__(self, body: ImplicitSurface, values: Mapping[str, float]) -> None:
        self.values = list(values.values())
        opened = Opened(body, values)
        self._formula, self._symbols = opened.read(lambda part: part.g(X, Y)), tuple(opened.symbols.values())
        self._rates = surface(self._formula, self._symbols)

    def at(self, points: Array) -> tuple[Array, Complex]:
        table = swept(self._table, points)
        return table[:, 0], table[:, 1] + 1j * table[:, 2]

    def _table(self, points: Array, order: int) -> Array:
        """Rates of g, g_x and g_y, (p, 3, k); of order 1 their derivatives by x and y, (2, p, 3, k)."""
        each = [
            rates(points[:, 0], points[:, 1], *self.values)[3:] for rates in (self._ahead if order else [self._rates])
        ]
        tables = [filled(values, len(points)).reshape(len(self.values), 3, len(points)) for values in each]
        return np.stack(tables) if order else tables[0]

    @functools.cached_property
    def _ahead(self) -> list[Any]:
        """The same of g_x and of g_y."""
        return [surface(sympy.diff(self._formula, along), self._symbols) for along in (X, Y)]

    def corners(self, points: Array) -> Complex:
        return np.zeros((len(self.values), len(points)), dtype=complex)


class _PieceRates:
    """Of an object whose g is the distance to pieces of curve q(t): it changes by how the nearest point moves.

    With that point's velocity v and the normal n = grad g: g by -n.v, and n by -H v - (n.v') grad t.
    """

    def __init__(self, body: FeatureSurface, rates: Array) -> None:
        self.body, self.chain = body, body.chain
        self.rates = self.chain.carried(rates)  # of the coefficients of q, (p, pieces, degree + 1, 2)

    def at(self, points: Array) -> tuple[Array, Complex]:
        chain, nearest = self.chain, self.chain.nearest(points)
        _, normals, hessians = self.body.evaluate(points, 2)
        piece, cornered = nearest.piece, nearest.corner >= 0
        velocity, stretch = _along(self.rates[:, piece], nearest.t)
        velocity[:, cornered] = self.rates[:, nearest.corner[cornered], 0]
        tangent, bend = _derivatives(chain.coefficients[piece], nearest.t)
        away = points - chain.at(piece, nearest.t)
        steep = tangent / ((tangent**2).sum(axis=1) - (away * bend).sum(axis=1))[:, None]  # grad t
        steep[cornered] = 0.0
        turned = (hessians @ velocity[..., None])[..., 0] + (normals * stretch).sum(axis=2)[..., None] * steep
        return -(normals * velocity).sum(axis=2), -(turned[..., 0] + 1j * turned[..., 1])

    def corners(self, points: Array) -> Complex:
        nearest = np.abs(points[:, None] - self.chain.vertex).max(axis=2).argmin(axis=1)
        moved = self.rates[:, nearest, 0]
        found: Complex = moved[..., 0] + 1j * moved[..., 1]
        return found


def _along(coefficients: Array, t: Array) -> tuple[Array, Array]:
    """Values and slopes by t of polynomials (..., k, degree + 1, 2) at t (k,)."""
    powers = np.arange(coefficients.shape[-2])
    table = t[:, None] ** powers
    slopes = powers * t[:, None] ** np.maximum(powers - 1, 0)
    return np.einsum("kj,...kjd->...kd", table, coefficients), np.einsum("kj,...kjd->...kd", slopes, coefficients)


def _derivatives(coefficients: Array, t: Array) -> tuple[Array, Array]:
    """Tangents q' and bends q'' (k, 2) of pieces (k, degree + 1, 2) at t (k,)."""
    powers = np.arange(coefficients.shape[1])
    first = (powers[:, None] * coefficients)[:, 1:]
    return _along(first, t)
