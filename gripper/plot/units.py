"""Units of what is drawn: each a name and the factor from SI."""

from __future__ import annotations

import math
from typing import NamedTuple

import sympy

from gripper.pose import placed
from gripper.scene import Scene


class Unit(NamedTuple):
    """A unit: its name, and how many of it make one of SI's."""

    name: str
    factor: float


def length_unit(size: float) -> Unit:
    """Choose the unit for lengths up to this one, in m."""
    if size < 2e-3:
        return Unit("\N{MICRO SIGN}m", 1e6)
    return Unit("mm", 1e3) if size < 1 else Unit("m", 1.0)


def force_unit(largest: float) -> Unit:
    """Choose the unit for forces up to this one, in N."""
    if largest >= 1e3:
        return Unit("kN", 1e-3)
    return Unit("N", 1.0) if largest >= 0.1 or largest == 0 else Unit("mN", 1e3)


def strain_unit(largest: float) -> Unit:
    """Choose the unit for strains up to this one."""
    if largest >= 1e-5 or largest == 0:
        return Unit("%", 100.0)
    return (
        Unit("10\N{SUPERSCRIPT MINUS}\N{SUPERSCRIPT SIX}", 1e6)
        if largest >= 1e-8
        else Unit("10\N{SUPERSCRIPT MINUS}\N{SUPERSCRIPT ONE}\N{SUPERSCRIPT TWO}", 1e12)
    )


def parameter_unit(scene: Scene) -> Unit:
    """Tell the unit of a motion's parameter: where a pose's x or y is the parameter itself it is a length.

    Where an angle is, it is an angle; else it is a number without unit, as far as anyone can tell.
    """
    assert scene.motion is not None, "without a motion there is no parameter"
    parameter = sympy.Symbol(scene.motion.parameter)
    poses = [placed(scene.finger).pose, placed(scene.object).pose]
    lengths = [value for pose in poses for value in (pose.x, pose.y)]
    if any(_is(value, parameter) for value in lengths):
        return length_unit(max(map(abs, scene.motion.values)))
    if any(_is(pose.angle, parameter) for pose in poses):
        return Unit("deg", 180 / math.pi)
    return Unit("", 1.0)


def _is(value: float | sympy.Expr, parameter: sympy.Symbol) -> bool:
    """Whether a pose's coordinate is the parameter, but for its sign and a constant."""
    slope = sympy.sympify(value).subs({s: parameter for s in sympy.sympify(value).free_symbols}).diff(parameter)
    return bool(slope.is_number and abs(abs(float(slope)) - 1) < 1e-12)


def labelled(name: str, unit: Unit) -> str:
    """Label an axis: the quantity and its unit."""
    return f"{name} ({unit.name})" if unit.name else name
