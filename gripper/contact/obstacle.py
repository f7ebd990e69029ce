"""The object as the finger sees it: in the clamp's frame, dimensionless, with its motion; vectors are x + iy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array, Complex
from gripper.objects import Object

if TYPE_CHECKING:
    from gripper.statics.acting import Acting


@dataclass(frozen=True)
class Stage:
    """What loads depend on along a path: the motion's parameter, the clamp's angle in the world, and their rates."""

    parameter: float = 0.0
    turn: float = 0.0
    pace: float = 0.0
    turning: float = 0.0

    def held(self) -> Stage:
        """The same on a path along which the loads stay as they are."""
        return Stage(self.parameter, self.turn)


@dataclass(frozen=True)
class Frame:
    """The object's pose relative to the clamp, lengths by L, and its rates with the motion's parameter."""

    origin: complex
    angle: float
    velocity: complex
    spin: float
    parameter: float | None = None
    """The motion's, where the pose is one of a motion."""
    stage: Stage = Stage()
    """What loads depend on."""


def _plane(points: Complex) -> Array:
    """Complex numbers (k,), the result of arithmetic, as points (k, 2)."""
    return points.view(float).reshape(-1, 2)


def _complex(points: Array) -> Complex:
    """Points (k, 2) as complex numbers (k,)."""
    return points[:, 0] + 1j * points[:, 1]


class Obstacle:
    """An object at a pose: g / L, grad g and L times its Hessian over points in the clamp's frame (lengths by L).

    A Hessian H is given as the pair (a, b) with H v = a v + b conj(v): a is half its trace. ``acting`` is what else
    loads the finger at this pose; None where nothing does.
    """

    def __init__(self, body: Object, length: float, frame: Frame, acting: Acting | None = None) -> None:
        self.body, self.length, self.frame, self.acting = body, length, frame, acting
        self._turn = complex(np.exp(1j * frame.angle))
        self.corners = self.place(_complex(body.corners))

    def local(self, points: Complex) -> Array:
        """Points (k, 2) in the object's own frame, in m."""
        return _plane((points - self.frame.origin) * (self.length * self._turn.conjugate()))

    def place(self, points: Complex) -> Complex:
        """Points of the object's own frame (m) in the clamp's frame (by L)."""
        return points * (self._turn / self.length) + self.frame.origin

    def gap(self, points: Complex) -> Array:
        """G / L."""
        return self.body.evaluate(self.local(points), 0)[0] / self.length

    def slope(self, points: Complex) -> tuple[Array, Complex]:
        """G / L and grad g."""
        g, gradient = self.body.evaluate(self.local(points), 1)
        return g / self.length, _complex(gradient) * self._turn

    def curvature(self, points: Complex) -> tuple[Array, Complex, tuple[Array, Complex]]:
        """G / L, grad g, and L times the Hessian of g as (a, b)."""
        g, gradient, hessian = self.body.evaluate(self.local(points), 2)
        xx, yy, half = hessian[:, 0, 0], hessian[:, 1, 1], self.length / 2
        trace = half * (xx + yy)
        rest = (xx - yy + 2j * hessian[:, 0, 1]) * (half * self._turn**2)
        return g / self.length, _complex(gradient) * self._turn, (trace, rest)

    def bounds(self, centers: Complex, radii: Array) -> tuple[Array, Array] | None:
        """Over discs: an upper bound of |grad g| and a lower bound of L times the Hessian's eigenvalues."""
        bounds = self.body.bounds(self.local(centers), radii * self.length)
        return None if bounds is None else (bounds[0], bounds[1] * self.length)

    def velocities(self, points: Complex) -> Complex:
        """Velocity of the object's matter at points of the clamp's frame, per unit of the motion's parameter."""
        return self.frame.velocity + 1j * self.frame.spin * (points - self.frame.origin)

    @property
    def inner_point(self) -> complex:
        """A point well inside the object (not finite where it has none)."""
        x, y = np.asarray(self.body.inner_point, dtype=float)
        return complex(self.place(np.array([complex(x, y)]))[0])
