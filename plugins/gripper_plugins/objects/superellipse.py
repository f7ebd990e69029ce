"""The superellipse: from an ellipse to a rectangle with rounded corners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import sympy

from gripper.fields import Length, Ratio, Rule
from gripper.objects import ImplicitSurface

Exponent = Annotated[Ratio, Rule("lie between 2 (an ellipse) and 20, without unit", lambda n: 2 <= n <= 20)]


@dataclass(frozen=True, kw_only=True)
class Superellipse(ImplicitSurface):
    """Superellipse about the origin (Lame's curve): g = min(a, b) ((|x/a|^n + |y/b|^n)^(1/n) - 1).

    Parameters
    ----------
    semi_axes
        Semi-axes (a, b), in m.
    exponent
        n, from 2 (an ellipse) up; the larger, the more of a rectangle.
    """

    semi_axes: tuple[Length, Length]
    exponent: Exponent

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write g: on the outline |grad g| is 1 at the ends of the minor axis."""
        (a, b), n = self.semi_axes, self.exponent
        n = int(n) if float(n).is_integer() else sympy.Float(n)
        return min(a, b) * ((sympy.Abs(x / a) ** n + sympy.Abs(y / b) ** n) ** (sympy.Integer(1) / n) - 1)

    def half_size(self) -> float:
        """Return a tenth more than the larger semi-axis, in m."""
        return 1.1 * max(self.semi_axes)
