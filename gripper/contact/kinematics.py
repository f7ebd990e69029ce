"""Where object and clamp are at a value of the motion's parameter, and how fast they move with it."""

from __future__ import annotations

import cmath
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import sympy

from gripper.contact.obstacle import Frame, Stage
from gripper.pose import Pose, placed
from gripper.scene import Scene


@dataclass(frozen=True)
class Placement:
    """World poses (x, y in m, angle in rad) of clamp and object at one value of the parameter."""

    clamp: tuple[float, float, float]
    object: tuple[float, float, float]

    @property
    def turn(self) -> complex:
        """From the clamp's axes to the world's: a factor on vectors x + iy."""
        return cmath.exp(1j * self.clamp[2])

    @property
    def origin(self) -> complex:
        """The clamp, in the world."""
        return complex(*self.clamp[:2])


@functools.lru_cache(maxsize=256)
def _compiled(clamp: Pose, body: Pose, parameter: str | None) -> Callable[[float], list[float]]:
    """The six coordinates, their rates and the rates of these as one function, differentiated once a pair of poses."""
    symbols = [s for s in clamp.parameters | body.parameters if s.name == parameter]
    q = sympy.Symbol(parameter or "q", real=True)
    coordinates = [
        sympy.sympify(e).subs({s: q for s in symbols})
        for e in (clamp.x, clamp.y, clamp.angle, body.x, body.y, body.angle)
    ]
    rates = [[sympy.diff(e, q, order) for e in coordinates] for order in (1, 2)]
    return sympy.lambdify([q], [*coordinates, *rates[0], *rates[1]], "math", cse=True)


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
            raise ValueError(f"poses must be finite at every pose; got {error} at {parameter!r}") from error
        if not all(map(math.isfinite, values)):
            raise ValueError(f"poses must be finite at every pose; got {values[:6]} at {parameter!r}")
        return values

    def placement(self, parameter: float) -> Placement:
        """World poses at a value of the parameter."""
        values = self._values(parameter)
        return Placement((values[0], values[1], values[2]), (values[3], values[4], values[5]))

    def turning(self, parameter: float) -> float:
        """Rate of the clamp's angle with the parameter, in rad per unit."""
        return self._values(parameter)[8]

    def clamp_velocity(self, parameter: float) -> complex:
        """Rate of the clamp's place in the world with the parameter, in m per unit."""
        return complex(*self._values(parameter)[6:8])

    def acceleration(self, parameter: float) -> tuple[complex, float]:
        """Rates of the frame's velocity and spin with the parameter."""
        frame, values = self.frame(parameter), self._values(parameter)
        x, y, turning, xo, yo, turning_o = values[12:]
        turn, rate = values[2], values[8]
        drift = cmath.exp(-1j * turn) / self.length * complex(xo - x, yo - y)
        gliding = frame.velocity + 1j * rate * frame.origin
        return drift - 1j * (rate * gliding + turning * frame.origin + rate * frame.velocity), turning_o - turning

    def frame(self, parameter: float) -> Frame:
        """The object relative to the clamp, lengths by L, with rates.

        Raises
        ------
        ValueError
            Where a pose is not finite.
        """
        x, y, turn, xo, yo, turn_o, dx, dy, dturn, dxo, dyo, dturn_o = self._values(parameter)[:12]
        inverse = cmath.exp(-1j * turn) / self.length
        origin = inverse * complex(xo - x, yo - y)
        velocity = inverse * complex(dxo - dx, dyo - dy) - 1j * dturn * origin
        stage = Stage(parameter, turn, 1.0, dturn)
        return Frame(origin, turn_o - turn, velocity, dturn_o - dturn, parameter, stage)


@dataclass(frozen=True, eq=False)
class Retreat:
    """A straight approach: the frame of a pose, shifted back along a direction; its parameter runs from -t to 0."""

    final: Frame
    direction: complex  # unit, in the clamp's frame

    def frame(self, parameter: float) -> Frame:
        """The object at a distance (by L) before its pose."""
        final = self.final
        origin = final.origin + parameter * self.direction
        return Frame(origin, final.angle, self.direction, 0.0, stage=final.stage.held())
