"""The force that keeps its direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import sympy

from gripper.fields import Length, Point, VaryingForce
from gripper.fingers import Finger
from gripper.loads import PotentialLoad, Section


@dataclass(frozen=True, kw_only=True)
class Force(PotentialLoad):
    """Dead force: it acts on a point of the finger and keeps direction and magnitude, U = -F . p.

    Parameters
    ----------
    force
        F in x and y, in N: numbers, or expressions in the motion's parameter.
    s
        Arc length of the section that it acts on, in m; None for the tip.
    offset
        Its point of that section: along the finger, and across it from the neutral axis, in m.
    frame
        Whose axes x and y are: "world", or "finger" (the clamp's).
    """

    force: tuple[VaryingForce, VaryingForce]
    s: Length | None = None
    offset: Point = (0.0, 0.0)
    frame: Literal["world", "finger"] = "world"

    def stations(self, finger: Finger) -> tuple[float, ...]:
        """Name the section that it acts on."""
        return (finger.length if self.s is None else self.s,)

    def potential(self, finger: Finger, *sections: Section) -> sympy.Expr:
        """Write what the force has not done yet."""
        x, y = sections[0].point(*self.offset)
        return -self.force[0] * x - self.force[1] * y
