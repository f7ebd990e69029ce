"""What an object's numbers change: g and its gradient at fixed points, and the object's corners."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gripper.arrays import Array, Complex
from gripper.objects import ImplicitSurface, Object
from gripper.objects.compiled import X, Y
from gripper.sensitivity.opened import NotOpenError, Opened, surface


class ObjectRates:
    """Derivatives of g by an object's numbers (p), in its own frame.

    Raises
    ------
    NotOpenError
        An object whose formulas sympy cannot differentiate.
    """

    def __init__(self, body: Object, values: Mapping[str, float]) -> None:
        self.body, self.count = body, len(values)
        self.values = list(values.values())
        if not self.count:
            return
        if not isinstance(body, ImplicitSurface):
            raise NotOpenError(f"{type(body).__name__} must be an ImplicitSurface, to be differentiated by its numbers")
        opened = Opened(body, values)
        self._rates = surface(opened.read(lambda part: part.g(X, Y)), tuple(opened.symbols.values()))

    def at(self, points: Array) -> tuple[Array, Complex]:
        """Rates of g (p, k), and of its gradient (p, k), at points (k, 2) in m."""
        k = len(points)
        if not self.count:
            return np.zeros((0, k)), np.zeros((0, k), dtype=complex)
        table = np.empty((self.count, 3, k))
        for row, values in enumerate(self._rates(points[:, 0], points[:, 1], *self.values)[3:]):
            table[divmod(row, 3)] = values  # a constant fills its row
        return table[:, 0], table[:, 1] + 1j * table[:, 2]

    def corners(self) -> Complex:
        """Rates of the object's corners, in m, (p, corners)."""
        return np.zeros((self.count, len(self.body.corners)), dtype=complex)
