"""The circle."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.fields import Length
from gripper.objects import ImplicitSurface


@dataclass(frozen=True, kw_only=True)
class Circle(ImplicitSurface):
    """Circle about the origin: g = (x^2 + y^2 - R^2) / 2R.

    Parameters
    ----------
    radius
        Radius R, in m.
    """

    radius: Length

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write the circle's g: |grad g| = 1 on the outline."""
        return (x**2 + y**2 - self.radius**2) / (2 * self.radius)
