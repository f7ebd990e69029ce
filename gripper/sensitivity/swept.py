"""An object on whose surface points move: g and its derivatives along them, one order higher than elsewhere."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy

from gripper.arrays import Array, Complex
from gripper.contact.obstacle import Frame, Obstacle
from gripper.objects import ImplicitSurface, Object
from gripper.objects.compiled import X, Y, compiled
from gripper.sensitivity.jet import Jet, NotFormedError, jet


def filled(values: Sequence[Any], size: int) -> Array:
    """Compiled expressions as rows (k, size): a constant fills its row."""
    table = np.empty((len(values), size))
    for row, value in enumerate(values):
        table[row] = value
    return table


def swept(read: Callable[[Array, int], Array], points: Array) -> Array:
    """What is read of a surface at points (k, 2), which may carry their rates.

    Parameters
    ----------
    read
        Of points and an order: 0 gives values (..., k), 1 their derivatives by x and y, (2, ..., k).
    """
    if not isinstance(points, Jet):
        return read(points, 0)
    along_x, along_y = read(points.value, 1)
    return jet(read(points.value, 0), along_x * points.rate[:, 0] + along_y * points.rate[:, 1])


class SweptObstacle(Obstacle):
    """An obstacle whose frame, and the points at which it is asked, carry their rates in one direction.

    Raises
    ------
    NotFormedError
        Of an object that is not one formula g(x, y).
    """

    def __init__(self, obstacle: Obstacle, frame: Frame) -> None:
        if not isinstance(obstacle.body, ImplicitSurface):
            raise NotFormedError(f"an object of the kind {type(obstacle.body).__name__}")
        self.body, self.length, self.frame, self.acting = obstacle.body, obstacle.length, frame, obstacle.acting
        self._turn: Any = np.exp(1j * frame.angle)
        corners: Array = self.body.corners
        self.corners = self.place(corners[:, 0] + 1j * corners[:, 1])

    def local(self, points: Complex) -> Array:
        """See `Obstacle.local`."""
        away = (points - self.frame.origin) * (self.length * self._turn.conj())
        return np.stack([away.real, away.imag], axis=1)

    def curvature(self, points: Complex) -> tuple[Array, Complex, tuple[Array, Complex]]:
        """See `Obstacle.curvature`."""
        g, x, y, xx, xy, yy = swept(functools.partial(_read, self.body), self.local(points))
        half = self.length / 2
        rest = (xx - yy + 2j * xy) * (half * self._turn**2)
        return g / self.length, (x + 1j * y) * self._turn, (half * (xx + yy), rest)


def _read(body: Object, points: Array, order: int) -> Array:
    """g, its gradient and its Hessian's xx, xy, yy, (6, k); their derivatives by x and y, (2, 6, k)."""
    _, gradient, hessian = known = body.evaluate(points, 2)
    (x, y), (xx, xy, yy) = gradient.T, (hessian[:, 0, 0], hessian[:, 0, 1], hessian[:, 1, 1])
    if not order:
        return np.stack([known[0], x, y, xx, xy, yy])
    xxx, xxy, xyy, yyy = filled(_third(body)(points[:, 0], points[:, 1]), len(points))
    return np.stack([[x, xx, xy, xxx, xxy, xyy], [y, xy, yy, xxy, xyy, yyy]])


@functools.lru_cache(maxsize=256)
def _third(body: ImplicitSurface) -> Any:
    """The third derivatives of g, compiled."""
    g = sympy.sympify(body.g(X, Y))
    return compiled((X, Y), tuple(sympy.diff(g, *by) for by in ((X, X, X), (X, X, Y), (X, Y, Y), (Y, Y, Y))))
