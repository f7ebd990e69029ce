"""The finger whose thickness is any expression of the arc length."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.fields import LengthProfile
from gripper.fingers import Finger, S


@dataclass(frozen=True, kw_only=True)
class Formula(Finger):
    """Finger of any thickness: w(s) and b(s) are expressions in the arc length s, in m.

    Parameters
    ----------
    thickness
        In-plane thickness w, in m: an expression in s (in m, from the clamp), continuous; kinks of abs, min and max
        are found.
    length, width, material, jaw
        As every `gripper.fingers.Finger`; the width b may be an expression in s, too.
    """

    thickness: LengthProfile

    def __post_init__(self) -> None:
        super().__post_init__()
        others = sorted(symbol.name for symbol in self.w(S).free_symbols - {S})
        if others:
            raise ValueError(f"thickness must be an expression in s alone, in m; got one in {', '.join(others)}")

    def w(self, s: sympy.Expr) -> sympy.Expr:
        """Write the thickness, in m."""
        profile = sympy.sympify(self.thickness)
        return profile.subs({symbol: s for symbol in profile.free_symbols if symbol.name == S.name})
