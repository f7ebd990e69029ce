"""Where the object is, seen from the clamp, along a scene's motion; read from the scene alone."""

from __future__ import annotations

import cmath
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy

from gripper.objects import Array
from gripper.pose import placed
from gripper.scene import Scene


@dataclass(frozen=True)
class Frame:
    """The object's own frame in the clamp's: origin in m, angle in rad."""

    x: float
    y: float
    angle: float

    @property
    def turn(self) -> Array:
        """Rotation matrix from the object's axes to the clamp's, (2, 2)."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, -s], [s, c]])

    def local(self, points: Array) -> Array:
        """Points (n, 2) of the clamp's frame, in the object's."""
        return (points - np.array([self.x, self.y])) @ self.turn

    def place(self, points: Array) -> Array:
        """Points (n, 2) of the object's frame, in the clamp's."""
        return np.asarray(points @ self.turn.T + np.array([self.x, self.y]))

    def shifted(self, direction: tuple[float, float], distance: float) -> Frame:
        """The frame moved along a unit direction of the clamp's frame by a distance in m."""
        return Frame(self.x + direction[0] * distance, self.y + direction[1] * distance, self.angle)


Path = Callable[[float], Frame]
"""From a parameter to the object's frame."""


def relative(scene: Scene) -> Path:
    """The object's frame at a value of the motion's parameter (any value without a motion)."""
    poses = placed(scene.finger).pose, placed(scene.object).pose
    name = scene.motion.parameter if scene.motion else "q"
    q = sympy.Symbol(name)
    raw = [sympy.sympify(value) for pose in poses for value in (pose.x, pose.y, pose.angle)]
    expressions = [e.subs({symbol: q for symbol in e.free_symbols}) for e in raw]
    function = sympy.lambdify([q], expressions, "math")

    def frame(value: float) -> Frame:
        x, y, angle, xo, yo, turned = (float(v) for v in function(value))
        if not np.all(np.isfinite([x, y, angle, xo, yo, turned])):
            raise ValueError(f"poses must be finite at every pose; got {(x, y, angle, xo, yo, turned)} at {value!r}")
        origin = complex(xo - x, yo - y) * cmath.exp(-1j * angle)
        return Frame(origin.real, origin.imag, turned - angle)

    return frame


def travel(start: Frame, stop: Frame, reach: float) -> float:
    """How far the object's matter moves at most within this reach (m) of its origin, in m."""
    return float(np.hypot(stop.x - start.x, stop.y - start.y) + reach * abs(stop.angle - start.angle))
