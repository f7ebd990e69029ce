"""The tendon that is pulled."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import sympy

from gripper.fields import Coordinate, Length, VaryingForce
from gripper.fingers import Finger
from gripper.loads import PotentialLoad, Section


@dataclass(frozen=True, kw_only=True)
class Tendon(PotentialLoad):
    """Inextensible tendon, pulled through the clamp with a constant force: U = T times its length outside the clamp.

    It runs straight and without friction from the clamp through one guide after the other to the last one, where it is
    tied. Guides near to one another make the channel along the finger.

    Parameters
    ----------
    tension
        T, in N, at least 0: a number, or an expression in the motion's parameter.
    offset
        From the neutral axis to the tendon, at the clamp and at each guide, in m: positive on the upper side.
    guides
        Arc lengths of the guides, rising, in m.

    Raises
    ------
    ValueError
        No guide, guides that do not rise, or a tension below 0.
    """

    tension: VaryingForce
    offset: Coordinate
    guides: tuple[Length, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.guides or any(a >= b for a, b in pairwise(self.guides)):
            raise ValueError(f"guides must be one or more arc lengths that rise, in m; got {self.guides!r}")
        if not isinstance(self.tension, sympy.Expr) and self.tension < 0:
            raise ValueError(f"tension must be at least 0, in N: a tendon does not push; got {self.tension!r}")

    def stations(self, finger: Finger) -> tuple[float, ...]:
        """Name the guides."""
        return self.guides

    def potential(self, finger: Finger, *sections: Section) -> sympy.Expr:
        """Write the tension times the tendon's length."""
        points = [(0.0, self.offset), *(section.point(0.0, self.offset) for section in sections)]
        parts = [sympy.sqrt((x - a) ** 2 + (y - b) ** 2) for (a, b), (x, y) in pairwise(points)]
        return self.tension * sympy.Add(*parts)
