"""The object as the finger sees it: in the clamp's frame, dimensionless, with its motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gripper.objects import Object

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Frame:
    """The object's pose relative to the clamp, lengths by L, and its rate of change with the motion's parameter."""

    origin: Array
    angle: float
    velocity: Array
    spin: float

    @property
    def rotation(self) -> Array:
        """From the object's frame to the clamp's."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, -s], [s, c]])


class Obstacle:
    """An object at a pose: g / L, grad g and L times its Hessian over points in the clamp's frame (lengths by L)."""

    def __init__(self, body: Object, length: float, frame: Frame) -> None:
        self.body, self.length, self.frame = body, length, frame
        self._rotation = frame.rotation
        self._corners = body.corners

    def local(self, points: Array) -> Array:
        """Points in the object's own frame, in m."""
        return ((points - self.frame.origin) @ self._rotation) * self.length

    def gap(self, points: Array) -> Array:
        """G / L."""
        return self.body.evaluate(self.local(points), 0)[0] / self.length

    def slope(self, points: Array) -> tuple[Array, Array]:
        """G / L and grad g."""
        g, gradient = self.body.evaluate(self.local(points), 1)
        return g / self.length, gradient @ self._rotation.T

    def curvature(self, points: Array) -> tuple[Array, Array, Array]:
        """G / L, grad g, and L times the Hessian of g."""
        g, gradient, hessian = self.body.evaluate(self.local(points), 2)
        turned = self._rotation @ hessian @ self._rotation.T
        return g / self.length, gradient @ self._rotation.T, turned * self.length

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """Over discs: an upper bound of |grad g| and a lower bound of L times the Hessian's eigenvalues."""
        bounds = self.body.bounds(self.local(centers), radii * self.length)
        return None if bounds is None else (bounds[0], bounds[1] * self.length)

    @property
    def corners(self) -> Array:
        """The object's corners (k, 2) in the clamp's frame."""
        return self.place(self._corners) if len(self._corners) else self._corners

    def place(self, points: Array) -> Array:
        """Points of the object's own frame (m) in the clamp's frame (by L)."""
        return points / self.length @ self._rotation.T + self.frame.origin

    def velocities(self, points: Array) -> Array:
        """Velocity of the object's matter at points of the clamp's frame, per unit of the motion's parameter."""
        arm = points - self.frame.origin
        return self.frame.velocity + self.frame.spin * np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
