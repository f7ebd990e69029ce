"""Any outline, as an expression in x and y."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.expression import parse
from gripper.fields import Length, Surface
from gripper.objects import ImplicitSurface, typical_slope


@dataclass(frozen=True, kw_only=True)
class Implicit(ImplicitSurface):
    """The outline on which an expression is zero; g is the expression over its typical slope there.

    Parameters
    ----------
    expression
        In x and y, in m, negative inside and positive outside, continuous, in any unit: a sympy expression, or
        its text.
    extent
        Half the side of a square about the origin that holds the outline, in m.
    """

    expression: Surface
    extent: Length

    def __post_init__(self) -> None:
        if isinstance(self.expression, str):
            object.__setattr__(self, "expression", parse(self.expression, names=("x", "y")))
        object.__setattr__(self, "expression", sympy.sympify(self.expression))
        super().__post_init__()

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write the expression, whatever the assumptions of its own symbols x and y, over its slope."""
        own = {"x": x, "y": y}
        symbols = {symbol: own.get(symbol.name, symbol) for symbol in self.expression.free_symbols}
        expression = self.expression.subs(symbols, simultaneous=True)
        return expression / typical_slope(expression, self.extent, "expression")

    def half_size(self) -> float:
        """Return the extent, in m."""
        return self.extent
