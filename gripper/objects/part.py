"""A part of a combined object: an object at a fixed place in the whole's frame."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Any, TypeAlias

import numpy as np
import sympy

from gripper.fields import Nested, Rule
from gripper.objects.base import Array, Box, Object
from gripper.pose import Placed, placed


def _is_part(value: Any) -> bool:
    body = value.body if isinstance(value, Placed) else value
    return isinstance(body, Object) and not placed(value).pose.parameters


Part: TypeAlias = Annotated[
    Placed[Object] | Object,
    Nested("gripper.objects"),
    Rule("be an object, as it is or placed by numbers with .at(...)", _is_part),
]
"""An object, or one placed in the whole's frame."""


class Member:
    """A part as the whole sees it: everything of it in the whole's frame.

    Parameters
    ----------
    part
        The object, placed by numbers.
    sign
        1, or -1 for a part that is cut out: its g is turned over.
    """

    def __init__(self, part: Placed[Object] | Object, sign: float = 1.0) -> None:
        at = placed(part)
        self.body, self.sign = at.body, sign
        x, y, angle = (float(sympy.sympify(value)) for value in (at.pose.x, at.pose.y, at.pose.angle))
        self.origin = np.array([x, y])
        self.turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def local(self, points: Array) -> Array:
        """Points (n, 2) of the whole in the part's own frame, in m."""
        inner: Array = (points - self.origin) @ self.turn
        return inner

    def moved(self, points: Array) -> Array:
        """Points (n, 2) of the part's own frame in the whole, in m."""
        outer: Array = points @ self.turn.T + self.origin
        return outer

    def evaluate(self, points: Array, order: int) -> tuple[Array, ...]:
        """The part's g and its derivatives, as `Object.evaluate`, times the sign."""
        values = [self.sign * value for value in self.body.evaluate(self.local(points), order)]
        if order > 0:
            values[1] = values[1] @ self.turn.T
        if order > 1:
            values[2] = self.turn @ values[2] @ self.turn.T
        return tuple(values)

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """See `Object.bounds`, of the part's g times the sign."""
        own = self.local(centers)
        bounds = self.body.bounds(own, radii)
        if bounds is None or self.sign > 0:
            return bounds
        return bounds[0], -self.body.largest_curvature(own, radii)

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """See `Object.largest_curvature`, of the part's g times the sign."""
        own = self.local(centers)
        if self.sign > 0:
            return self.body.largest_curvature(own, radii)
        bounds = self.body.bounds(own, radii)
        return np.full(len(centers), np.inf) if bounds is None else -bounds[1]

    def lines(self, window: Box, tolerance: float) -> list[Array]:
        """The part's outline, as `Object.outline`: whole, or what of it lies about a window (xmin, ymin, ...) in m."""
        low, high = np.reshape(window, (2, 2))
        (x, y), reach = self.local((low + high)[None] / 2)[0], float(np.linalg.norm(high - low)) / 2
        return [self.moved(line) for line in self.body.outline((x - reach, y - reach, x + reach, y + reach), tolerance)]

    @cached_property
    def anchors(self) -> Array:
        """Points (n, 2), in m, about which the part extends: its box's corners, or a point inside where it has none."""
        xmin, ymin, xmax, ymax = self.body.box
        if not np.isfinite(self.body.box).all():
            return self.moved(self.body.inner_point[None])
        return self.moved(np.array([[xmin, ymin], [xmax, ymin], [xmax, ymax], [xmin, ymax]]))

    @cached_property
    def corners(self) -> tuple[Array, Array]:
        """All corners (k, 2), in m, convex and re-entrant, and the normals (k, 2, 2) before and after each."""
        points = np.concatenate([self.body.corners, self.body.hollows])
        normals = np.concatenate([self.body.corner_normals, self.body.hollow_normals])
        return self.moved(points), normals @ self.turn.T
