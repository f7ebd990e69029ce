"""The moment on a section."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import sympy

from gripper.expression.dimensions import unit
from gripper.fields import Length, Varying
from gripper.fingers import Finger
from gripper.loads import PotentialLoad, Section


@dataclass(frozen=True, kw_only=True)
class Moment(PotentialLoad):
    """Dead moment on a section of the finger: U = -M psi(s).

    Parameters
    ----------
    moment
        M, in N m, positive towards the upper face: a number, or an expression in the motion's parameter.
    s
        Arc length of the section that it acts on, in m; None for the tip.
    """

    moment: Annotated[Varying, unit("N*m")]
    s: Length | None = None

    def stations(self, finger: Finger) -> tuple[float, ...]:
        """Name the section that it acts on."""
        return (finger.length if self.s is None else self.s,)

    def potential(self, finger: Finger, *sections: Section) -> sympy.Expr:
        """Write what the moment has not done yet."""
        return -self.moment * sections[0].angle
