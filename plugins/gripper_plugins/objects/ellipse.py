"""The ellipse."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.fields import Length
from gripper.objects import ImplicitSurface


@dataclass(frozen=True, kw_only=True)
class Ellipse(ImplicitSurface):
    """Ellipse about the origin, its axes along x and y: g = min(a, b) ((x/a)^2 + (y/b)^2 - 1) / 2.

    Parameters
    ----------
    semi_axes
        Semi-axes (a, b), in m.
    """

    semi_axes: tuple[Length, Length]

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write the ellipse's g: on the outline |grad g| <= 1, and 1 at the ends of the minor axis."""
        a, b = self.semi_axes
        return min(a, b) / 2 * ((x / a) ** 2 + (y / b) ** 2 - 1)
