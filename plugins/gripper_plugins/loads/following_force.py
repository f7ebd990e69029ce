"""The force that turns with the finger."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from gripper.fields import Length, Point, VaryingForce
from gripper.fingers import Finger
from gripper.loads import Action, Load, Section


@dataclass(frozen=True, kw_only=True)
class FollowingForce(Load):
    """Force that keeps its angle to a section of the finger: it has no potential.

    Parameters
    ----------
    force
        Along the finger, and across it towards the upper face, in N: numbers, or expressions in the motion's parameter.
    s
        Arc length of the section that it acts on, in m; None for the tip.
    offset
        Its point of that section: along the finger, and across it from the neutral axis, in m.
    """

    force: tuple[VaryingForce, VaryingForce]
    s: Length | None = None
    offset: Point = (0.0, 0.0)

    def stations(self, finger: Finger) -> tuple[float, ...]:
        """Name the section that it acts on."""
        return (finger.length if self.s is None else self.s,)

    def actions(self, finger: Finger, *sections: Section) -> tuple[Action, ...]:
        """Turn the force with its section; its arm about the axis turns along."""
        (along, across), angle = self.force, sections[0].angle
        cos, sin = sympy.cos(angle), sympy.sin(angle)
        moment = self.offset[0] * across - self.offset[1] * along
        return (Action(along * cos - across * sin, along * sin + across * cos, sympy.sympify(moment)),)
