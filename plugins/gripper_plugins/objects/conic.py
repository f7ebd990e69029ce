"""Any conic, by its coefficients."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.fields import Finite
from gripper.objects import ImplicitSurface, Quadric


@dataclass(frozen=True, kw_only=True)
class Conic(ImplicitSurface):
    """Ellipse, parabola, hyperbola, strip or wall: b1 x^2 + b2 y^2 + b3 x y + b4 x + b5 y + b6 = 0, negative inside.

    g is that polynomial over its slope at the outline's vertices, so that |grad g| = 1 there.

    Parameters
    ----------
    coefficients
        (b1, ..., b6), in units that give one unit for x and y in m.
    """

    coefficients: tuple[Finite, Finite, Finite, Finite, Finite, Finite]

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write the scaled polynomial."""
        slope = Quadric(self.coefficients).vertex_slope
        b1, b2, b3, b4, b5, b6 = (b / slope for b in self.coefficients)
        return b1 * x**2 + b2 * y**2 + b3 * x * y + b4 * x + b5 * y + b6
