"""Poses in the world: numbers, or expressions of a motion's parameter. A body knows nothing of its own pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Generic, Self, TypeVar

import sympy

from gripper.expression.dimensions import METRE, RADIAN
from gripper.fields import Expression, check_fields


@dataclass(frozen=True, kw_only=True)
class Pose:
    """Where a body's own frame stands in the world.

    Parameters
    ----------
    x, y
        Origin, in m.
    angle
        Angle from the world's x axis to the body's, in rad, counter-clockwise.

    Each is a number or a sympy expression of the motion's parameter.
    """

    x: Annotated[Expression, METRE] = 0.0
    y: Annotated[Expression, METRE] = 0.0
    angle: Annotated[Expression, RADIAN] = 0.0

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def parameters(self) -> frozenset[sympy.Symbol]:
        """The symbols that this pose depends on."""
        return frozenset().union(*(sympy.sympify(value).free_symbols for value in (self.x, self.y, self.angle)))


Body = TypeVar("Body", covariant=True)


@dataclass(frozen=True)
class Placed(Generic[Body]):
    """A body and its pose in the world."""

    body: Body
    pose: Pose


def placed(part: Placed[Body] | Body) -> Placed[Body]:
    """The part itself where it has a pose, else the part at the world's origin."""
    return part if isinstance(part, Placed) else Placed(part, Pose())


class Placeable:
    """Gives a body ``.at(...)``."""

    def at(self, *, x: Expression = 0.0, y: Expression = 0.0, angle: Expression = 0.0) -> Placed[Self]:
        """This body, placed in the world: x, y in m, angle in rad; numbers or expressions of the motion's parameter."""
        return Placed(self, Pose(x=x, y=y, angle=angle))
