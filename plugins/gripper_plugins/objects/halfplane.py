"""The half-plane: a wall."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.objects import ImplicitSurface


@dataclass(frozen=True, kw_only=True)
class HalfPlane(ImplicitSurface):
    """All that lies below the x axis of its own frame: g = y. Its pose puts and turns the wall."""

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write the distance from the wall."""
        return y
