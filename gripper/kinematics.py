"""Where object and clamp are at a value of the motion's parameter, and how fast they move with it."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray

from gripper.obstacle import Frame
from gripper.pose import Pose, placed
from gripper.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Placement:
    """World poses (x, y in m, angle in rad) of clamp and object at one value of the parameter."""

    clamp: tuple[float, float, float]
    object: tuple[float, float, float]

    @property
    def clamp_rotation(self) -> Array:
        """From the clamp's axes to the world's."""
        c, s = np.cos(self.clamp[2]), np.sin(self.clamp[2])
        return np.array([[c, -s], [s, c]])


@functools.lru_cache(maxsize=256)
def _compiled(clamp: Pose, body: Pose, parameter: str | None) -> Callable[[float], list[float]]:
    """The six coordinates and their six rates as one function, differentiated by sympy once a pair of poses."""
    symbols = [s for s in clamp.parameters | body.parameters if s.name == parameter]
    q = sympy.Symbol(parameter or "q", real=True)
    coordinates = [
        sympy.sympify(e).subs({s: q for s in symbols})
        for e in (clamp.x, clamp.y, clamp.angle, body.x, body.y, body.angle)
    ]
    return sympy.lambdify([q], coordinates + [sympy.diff(e, q) for e in coordinates], "math", cse=True)  # type: ignore[no-any-return]


class Kinematics:
    """The relative motion of a scene."""

    def __init__(self, scene: Scene, length: float) -> None:
        self.length = length
        self._function = _compiled(
            placed(scene.finger).pose, placed(scene.object).pose, scene.motion.parameter if scene.motion else None
        )

    def _values(self, parameter: float) -> list[float]:
        try:
            values = [float(v) for v in self._function(parameter)]
        except (ValueError, ZeroDivisionError, OverflowError) as error:
            raise ValueError(f"poses must be finite at every pose; at {parameter!r}: {error}") from error
        if not np.isfinite(values).all():
            raise ValueError(f"poses must be finite at every pose; got {values[:6]} at {parameter!r}")
        return values

    def placement(self, parameter: float) -> Placement:
        """World poses at a value of the parameter."""
        values = self._values(parameter)
        return Placement((values[0], values[1], values[2]), (values[3], values[4], values[5]))

    def frame(self, parameter: float) -> Frame:
        """The object relative to the clamp, lengths by L, with rates.

        Raises
        ------
        ValueError
            Where a pose is not finite.
        """
        x, y, turn, xo, yo, turn_o, dx, dy, dturn, dxo, dyo, dturn_o = self._values(parameter)
        c, s = np.cos(turn), np.sin(turn)
        inverse = np.array([[c, s], [-s, c]])
        origin = inverse @ np.array([xo - x, yo - y]) / self.length
        velocity = inverse @ np.array([dxo - dx, dyo - dy]) / self.length - dturn * np.array([-origin[1], origin[0]])
        return Frame(origin, turn_o - turn, velocity, dturn_o - dturn)


@dataclass(frozen=True, eq=False)
class Retreat:
    """A straight approach: the frame of a pose, shifted back along a direction; its parameter runs from -t to 0."""

    final: Frame
    direction: Array  # unit, in the clamp's frame

    def frame(self, parameter: float) -> Frame:
        """The object at a distance (by L) before its pose."""
        return Frame(self.final.origin + parameter * self.direction, self.final.angle, self.direction, 0.0)
