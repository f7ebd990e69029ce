"""The finger whose thickness falls (or grows) evenly from clamp to tip."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.fields import Length
from gripper.fingers import Finger


@dataclass(frozen=True, kw_only=True)
class Tapered(Finger):
    """Finger of linear thickness: w(s) = w_0 + (w_L - w_0) s / L.

    Parameters
    ----------
    base_thickness, tip_thickness
        In-plane thickness w_0 at the clamp and w_L at s = L, in m.
    length, width, material, jaw
        As every `gripper.fingers.Finger`.
    """

    base_thickness: Length
    tip_thickness: Length

    def w(self, s: sympy.Expr) -> sympy.Expr:
        """Write the thickness, in m."""
        return self.base_thickness + (self.tip_thickness - self.base_thickness) * s / self.length
