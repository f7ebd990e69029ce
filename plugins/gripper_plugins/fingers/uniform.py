"""The finger of constant thickness."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.fields import Length
from gripper.fingers import Finger


@dataclass(frozen=True, kw_only=True)
class Uniform(Finger):
    """Finger of constant thickness: w(s) = w.

    Parameters
    ----------
    thickness
        In-plane thickness w, in m.
    length, width, material, jaw
        As every `gripper.fingers.Finger`.
    """

    thickness: Length

    def w(self, s: sympy.Expr) -> sympy.Expr:
        """Write the thickness, in m."""
        return sympy.sympify(self.thickness)
