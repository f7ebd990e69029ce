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
def _compiled(
    clamp: Pose, body: Pose, parameter: str | None, orders: tuple[int, ...]
) -> Callable[[float], list[float]]:
    """The derivatives of the six coordinates, of these orders one after the other, as one function."""
    symbols = [s for s in clamp.parameters | body.parameters if s.name == parameter]
    q = sympy.Symbol(parameter or "q", real=True)
    coordinates = [
        sympy.sympify(e).subs({s: q for s in symbols})
        for e in (clamp.x, clamp.y, clamp.angle, body.x, body.y, body.angle)
    ]
    flat = [sympy.diff(e, q, order) for order in orders for e in coordinates]
    return sympy.lambdify([q], flat, "math", cse=True)


class Kinematics:
    """The relative motion of a scene."""

    def __init__(self, scene: Scene, length: float) -> None:
        self.length = length
        parameter = scene.motion.parameter if scene.motion else None
        self._poses = placed(scene.finger).pose, placed(scene.object).pose, parameter
        self._function = _compiled(*self._poses, (0, 1, 2))
        self._known = functools.lru_cache(maxsize=16)(self._frame)  # where a step ends the next one starts

    def _values(self, parameter: float) -> list[float]:
        try:
            values = list(map(float, self._function(parameter)))
        except (ValueError, ZeroDivisionError, OverflowError) as error:
            raise ValueError(f"poses must be finite at every pose; got {error} at {parameter!r}") from error
        if not all(map(math.isfinite, values)):
            raise ValueError(f"poses must be finite at every pose; got {values[:6]} at {parameter!r}")
        return values

    def placement(self, parameter: float) -> Placement:
        """World poses at a value of the parameter."""
        values = self._values(parameter)
        return Placement((values[0], values[1], values[2]), (values[3], values[4], values[5]))

    def turning(self, parameter: float) -> tuple[float, float]:
        """Rate of the clamp's angle with the parameter, in rad per unit, and the rate of that."""
        values = self._values(parameter)
        return values[8], values[14]

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

    def jerk(self, parameter: float) -> tuple[complex, float]:
        """Rates of :meth:`acceleration` with the parameter."""
        frame, values = self.frame(parameter), self._values(parameter)
        x, y, jolt, xo, yo, jolt_o = _compiled(*self._poses, (3,))(parameter)
        rate, turning = values[8], values[14]
        back = cmath.exp(-1j * values[2]) / self.length
        drift = back * complex(values[15] - values[12], values[16] - values[13])
        gliding = frame.velocity + 1j * rate * frame.origin
        sweep = turning * gliding + rate * (drift - 1j * rate * gliding)
        sweep += jolt * frame.origin + 2 * turning * frame.velocity + rate * self.acceleration(parameter)[0]
        return back * complex(xo - x, yo - y) - 1j * rate * drift - 1j * sweep, jolt_o - jolt

    def frame(self, parameter: float) -> Frame:
        """The object relative to the clamp, lengths by L, with rates.

        Raises
        ------
        ValueError
            Where a pose is not finite.
        """
        return self._known(parameter)

    def _frame(self, parameter: float) -> Frame:
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
