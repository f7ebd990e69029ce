"""The finger's own weight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import sympy

from gripper.expression.dimensions import unit
from gripper.fields import Positive, Profile, Varying
from gripper.fingers import Finger, S
from gripper.loads import PotentialLoad, Section

Acceleration = Annotated[Varying, unit("m/s**2")]


@dataclass(frozen=True, kw_only=True)
class Gravity(PotentialLoad):
    """Weight of the finger: U = -int m(s) g . r(s) ds. A jaw's weight is a force of its own, at its centre.

    Parameters
    ----------
    density
        Of the material, in kg/m^3; or
    mass_per_length
        m(s), in kg/m: a number or an expression in s.
    acceleration
        g in the world's x and y, in m/s^2: numbers, or expressions in the motion's parameter.

    Raises
    ------
    ValueError
        Neither density nor mass_per_length is given, or both are.
    """

    density: Annotated[Positive, unit("kg/m**3")] | None = None
    mass_per_length: Annotated[Profile, unit("kg/m")] | None = None
    acceleration: tuple[Acceleration, Acceleration] = (0.0, -9.80665)

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.density is None) == (self.mass_per_length is None):
            given = "neither" if self.density is None else "both"
            raise ValueError(f"density must be given, in kg/m^3, or else mass_per_length, in kg/m; got {given}")

    @property
    def frame(self) -> Literal["world"]:
        """The world's axes: they do not turn with the clamp."""
        return "world"

    def stations(self, finger: Finger) -> None:
        """Act along the whole axis."""

    def potential(self, finger: Finger, *sections: Section) -> sympy.Expr:
        """Write the height of each piece against gravity, times its mass."""
        s, x, y, _ = sections[0]
        given = self.mass_per_length
        mass = self.density * finger.w(s) * finger.b(s) if given is None else sympy.sympify(given).subs(S, s)
        return -mass * (self.acceleration[0] * x + self.acceleration[1] * y)
