"""What acts on the finger besides the object: forces, moments, weight, tendons. Knows no particular load."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from typing import Literal, NamedTuple

import sympy

from gripper.fields import check_fields
from gripper.fingers import Finger


class Section(NamedTuple):
    """A section of the deflected finger: symbols, of which a load makes expressions.

    Parameters
    ----------
    s
        Its arc length from the clamp, in m.
    x, y
        Its place on the neutral axis, from the clamp, in m, in the load's frame.
    angle
        How far it has turned in that frame, in rad.
    """

    s: sympy.Expr
    x: sympy.Expr
    y: sympy.Expr
    angle: sympy.Expr

    def point(self, along: sympy.Expr | float, across: sympy.Expr | float) -> tuple[sympy.Expr, sympy.Expr]:
        """A point fixed to the section: along the finger, and across it towards the upper face, from the axis, in m."""
        cos, sin = sympy.cos(self.angle), sympy.sin(self.angle)
        return self.x + along * cos - across * sin, self.y + along * sin + across * cos


class Action(NamedTuple):
    """What a load does to a section: force (N) and moment (N m) about its place on the axis, in the load's frame.

    Of a load along the whole axis: per m.
    """

    x: sympy.Expr
    y: sympy.Expr
    moment: sympy.Expr


@dataclasses.dataclass(frozen=True, kw_only=True)
class Load(ABC):
    """What acts on the finger besides the object; a plugin says where and how.

    One that has a potential is a `PotentialLoad`. The others follow the finger and do not derive from an energy: the
    work that they do depends on the way.
    """

    def __post_init__(self) -> None:
        check_fields(self)
        if self.frame not in ("finger", "world"):
            raise ValueError(f"frame must be 'finger' or 'world'; got {self.frame!r}")

    @property
    def frame(self) -> Literal["finger", "world"]:
        """Whose axes the sections' places and the actions are written in: the clamp's ("finger") or the world's."""
        return "finger"

    @abstractmethod
    def stations(self, finger: Finger) -> tuple[float, ...] | None:
        """Arc lengths at which it acts, above 0 and up to L, in m; None where it acts along the whole axis."""

    @abstractmethod
    def actions(self, finger: Finger, *sections: Section) -> tuple[Action, ...]:
        """What it does to the section at each of its stations (along the whole axis: to the only one, per m)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class PotentialLoad(Load):
    """A load with a potential: dead forces and moments, weight, tendons; a plugin writes that potential."""

    @abstractmethod
    def potential(self, finger: Finger, *sections: Section) -> sympy.Expr:
        """Potential energy in J, its zero anywhere: of the sections at its stations (along the whole axis: in J/m)."""

    def actions(self, finger: Finger, *sections: Section) -> tuple[Action, ...]:
        """Minus the potential's gradient."""
        energy = sympy.sympify(self.potential(finger, *sections))
        return tuple(Action(*(-sympy.diff(energy, name) for name in (at.x, at.y, at.angle))) for at in sections)
