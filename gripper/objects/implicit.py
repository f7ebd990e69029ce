"""A surface written as one sympy expression; everything else is derived from it."""

from __future__ import annotations

import dataclasses
import math
from abc import abstractmethod
from dataclasses import dataclass

import sympy

from gripper.objects.base import Array, Box, Object, chord_tolerance
from gripper.objects.compiled import PerInstance, X, Y
from gripper.objects.contour import contour
from gripper.objects.level_set import LevelSet


@dataclass(frozen=True, kw_only=True)
class ImplicitSurface(Object):
    """An object whose plugin writes g(x, y) as a sympy expression.

    sympy differentiates it, once per instance. A quadratic g needs nothing else; any other must also say
    in ``half_size`` where its outline is.

    Raises
    ------
    ValueError
        g is not a real function of x and y, has no outline, or is not positive on the edge of that square.
    TypeError
        g is not quadratic and the plugin does not say where its outline is.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        level_set = _level_set(self)
        if self.half_size() is not None:
            level_set.check_extent()
        elif level_set.quadric is None:
            raise TypeError(f"{type(self).__name__}.half_size must be written where g is not quadratic")

    @abstractmethod
    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write g(x, y), in m, of x and y in m: negative inside, |grad g| about 1 on the outline, continuous."""

    def half_size(self) -> float | None:
        """Half the side of a square about the origin that holds the outline, in m; None for a quadratic g."""
        return None

    def evaluate(self, points: Array, order: int = 2) -> tuple[Array, ...]:
        """See `Object.evaluate`.

        Raises
        ------
        ValueError
            g or a derivative is not finite at a point, nor beside it.
        """
        return _level_set(self).evaluate(points, order)

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """See `Object.bounds`; exact for a quadratic g, by interval arithmetic for others."""
        return _level_set(self).bounds(centers, radii)

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """See `Object.largest_curvature`."""
        return _level_set(self).largest_curvature(centers, radii)

    @property
    def box(self) -> Box:
        """See `Object.box`."""
        level_set = _level_set(self)
        return level_set.quadric.box if level_set.quadric is not None else level_set.traced_box

    @property
    def inner_radius(self) -> float:
        """See `Object.inner_radius`."""
        level_set = _level_set(self)
        return level_set.quadric.inner_radius if level_set.quadric is not None else level_set.inside.least_radius

    @property
    def inner_point(self) -> Array:
        """See `Object.inner_point`."""
        level_set = _level_set(self)
        return level_set.quadric.inner_point if level_set.quadric is not None else level_set.inside.point

    def outline(self, box: Box | None = None, tolerance: float | None = None) -> list[Array]:
        """See `Object.outline`."""
        level_set = _level_set(self)
        bounded = level_set.quadric is None or level_set.quadric.bounded
        xmin, ymin, xmax, ymax = within = self.box if bounded else box or (0.0, 0.0, 0.0, 0.0)
        if not (0 < xmax - xmin < math.inf and 0 < ymax - ymin < math.inf):
            raise ValueError(f"box must be given, finite and in m, for an outline without bounds; got {box!r}")
        tolerance = chord_tolerance(tolerance, max(xmax - xmin, ymax - ymin))
        if level_set.quadric is not None and bounded:
            return [level_set.quadric.ellipse(tolerance)]
        return contour(level_set.evaluate, level_set.square if bounded else within, tolerance)


def _build(owner: ImplicitSurface) -> LevelSet:
    names = " and ".join(field.name for field in dataclasses.fields(owner))
    return LevelSet(owner.g(X, Y), owner.half_size(), names)


_level_set: PerInstance[ImplicitSurface, LevelSet] = PerInstance(_build)
