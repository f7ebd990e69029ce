"""Legendre polynomials on [-1, 1]: values, integrals, derivatives, and a Gauss rule with what follows from it."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from scipy.special import eval_legendre

from gripper.arrays import Array, Index


def legendre(x: Array, count: int) -> Array:
    """P_0 .. P_(count-1) at x (n,): (n, count)."""
    table: Array = eval_legendre(_degrees(count), x[:, None])
    return table


@functools.cache
def _degrees(count: int) -> Index:
    return np.arange(count)


@functools.cache
def evenly(count: int, degrees: int) -> Array:
    """P_0 .. P_(degrees-1) at even distances from -1 to 1: (count, degrees)."""
    return legendre(np.linspace(-1.0, 1.0, count), degrees)


def legendre_integrals(table: Array) -> Array:
    """Integrals from -1 of P_0 .. P_(count-2), from a table (n, count) of P_k: (n, count - 1)."""
    return table @ _integration(table.shape[1] - 1)


@functools.cache
def differentiation(count: int) -> Array:
    """Legendre coefficients of a series -> those of its derivative, (count, count)."""
    matrix = np.zeros((count, count))
    matrix[: count - 1] = np.polynomial.legendre.legder(np.eye(count), axis=0)
    return matrix


@functools.cache
def multiplication(count: int) -> Array:
    """Legendre coefficients of a series -> those of x times it, cut off at the same length, (count, count)."""
    k = np.arange(1, count)
    return np.diag(k / (2 * k - 1), -1) + np.diag(k / (2 * k + 1), 1)


@functools.cache
def _integration(count: int) -> Array:
    """Legendre coefficients of a series -> those of its integral from -1, (count + 1, count)."""
    return np.polynomial.legendre.legint(np.eye(count), lbnd=-1, axis=0)


@dataclass(frozen=True, eq=False)
class Rule:
    """Gauss points on [-1, 1], and what follows from their number q and that of the fields' modes m."""

    x: Array
    along: Array  # (x + 1) / 2: how far along a segment
    weights: Array
    modes: Array  # P_k at the points, (q, m)
    integrals: Array  # int_-1 P_k at the points, (q, m)
    primitive: Array  # coefficients of a field -> those of its integral from -1, (q + 1, m)
    path: Array  # values at the points -> coefficients of their interpolant's integral from -1, (q + 1, q)
    station: Array  # P_0 .. P_q there -> modes, their integrals, their derivatives, the path: (q + 1, 3m + q)
    grams: Array  # weights times P_i P_j at the points, (q, m^2)


@functools.cache
def rule(order: int, modes: int) -> Rule:
    """The rule for fields of an order, with so many modes of theirs."""
    q = order + 8  # cos(theta) of a polynomial theta: this many leave round-off for turns below a radian a segment
    x, weights = np.polynomial.legendre.leggauss(q)
    table = legendre(x, q)
    shapes = table[:, :modes]
    integrals = legendre(x, modes + 1) @ _integration(modes)
    interpolant = ((2 * np.arange(q) + 1) / 2)[:, None] * (weights * table.T)
    integral = _integration(q)
    path, primitive = integral @ interpolant, integral[:, :modes]
    own = np.eye(q + 1, modes)
    slope = np.zeros((q + 1, modes))
    slope[:modes] = differentiation(modes)
    station = np.concatenate([own, primitive, slope, path], axis=1)
    grams = (weights[:, None, None] * shapes[:, :, None] * shapes[:, None, :]).reshape(q, -1)
    return Rule(x, (x + 1) / 2, weights, shapes, integrals, primitive, path, station, grams)
