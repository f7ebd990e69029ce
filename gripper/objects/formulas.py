"""The formulas of features: one for a piece of outline, one for a corner; coefficients are symbols."""

from __future__ import annotations

import functools

import numpy as np
import sympy

from gripper.objects.base import Array
from gripper.objects.compiled import Derivatives, X, Y, compiled

T = sympy.Symbol("t", real=True)
"""The parameter along a piece, 0 to 1."""

# F_t is -|q'|^2 (1 + kappa g): zero on the evolute, deep inside, where the distance has no Hessian
LEAST = 1e-6
CONVEX = 0.02


class Span:
    """Signed distance to the curve q(t) = sum_k c_k t^k, along its right-hand normal at the foot of a point.

    The foot parameter t(x, y) solves F = (p - q) . q' = 0. There the distance n(t) . (p - q(t)) is stationary
    in t, since n' is along q', so that its gradient is n(t), and its Hessian is n'(t) (grad t)^T with
    grad t = -grad F / F_t (implicit differentiation).

    Parameters
    ----------
    degree
        Degree of the polynomials.
    """

    def __init__(self, degree: int) -> None:
        self.c = sympy.symbols([f"c{k}{axis}" for k in range(degree + 1) for axis in "xy"], real=True)
        q = [sum(self.c[2 * k + axis] * T**k for k in range(degree + 1)) for axis in (0, 1)]
        dx, dy = (sympy.diff(entry, T) for entry in q)
        speed = sympy.sqrt(dx**2 + dy**2)
        normal = (dy / speed, -dx / speed)
        g = normal[0] * (X - q[0]) + normal[1] * (Y - q[1])
        foot = (X - q[0]) * dx + (Y - q[1]) * dy
        foot_t = sympy.Min(sympy.diff(foot, T), -LEAST * speed**2)
        t_x, t_y = (-sympy.diff(foot, symbol) / foot_t for symbol in (X, Y))
        n_t = [sympy.diff(entry, T) for entry in normal]
        self.curvature = (dx * sympy.diff(dy, T) - dy * sympy.diff(dx, T)) / speed**3
        self.speed = speed
        self.derivatives = Derivatives(g, normal, (n_t[0] * t_x, n_t[0] * t_y, n_t[1] * t_y), (T, *self.c))
        convex = sympy.Min(sympy.diff(foot, T), -CONVEX * speed**2)  # where the distance is not convex in t: downhill
        self._step = compiled((X, Y, T, *self.c), (-foot / convex,))

    @staticmethod
    @functools.cache
    def of_degree(degree: int) -> Span:
        """Return the formulas of this degree, compiled once."""
        return Span(degree)

    def evaluate(self, points: Array, order: int, t: Array, coefficients: Array) -> tuple[Array, ...]:
        """Return g, its gradient, its Hessian up to ``order`` at points (n, 2) with their feet t (n,).

        ``coefficients`` (n, degree + 1, 2), in m, are those of each point's piece.
        """
        return self.derivatives(points, order, t, *coefficients.reshape(-1, len(self.c)).T)

    def step(self, points: Array, t: Array, coefficients: Array) -> Array:
        """Newton's step (n,) of t towards the foot."""
        step: Array = self._step(points[:, 0], points[:, 1], t, *coefficients.reshape(-1, len(self.c)).T)[0]
        return step


@functools.cache
def corner() -> Derivatives:
    """Signed distance to a corner: its coefficients are the corner's x, y and the sign (-1 at a re-entrant one)."""
    px, py, sign = sympy.symbols("px py sign", real=True)
    g = sign * sympy.sqrt((X - px) ** 2 + (Y - py) ** 2)
    gradient = (sympy.diff(g, X), sympy.diff(g, Y))
    return Derivatives(g, gradient, coefficients=(px, py, sign))


def away(points: Array, vertex: Array, direction: Array, hair: float) -> Array:
    """Move points (n, 2) that lie on their vertex (n, 2) a hair (m) along the direction (n, 2).

    The distance to a point has no gradient at zero.
    """
    on = np.abs(points - vertex).max(axis=1) < hair
    return np.where(on[:, None], vertex + hair * direction, points) if on.any() else points
