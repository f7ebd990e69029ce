"""A surface written as one sympy expression; everything else is derived from it."""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from dataclasses import dataclass

import sympy

from gripper.objects.base import Array, Box, Object, chord_tolerance
from gripper.objects.compiled import PerInstance, X, Y
from gripper.objects.contour import contour
from gripper.objects.surface import Surface


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
        surface = _surface(self)
        if self.half_size() is not None:
            surface.check_extent()
        elif surface.quadric is None:
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
        return _surface(self).evaluate(points, order)

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """See `Object.bounds`; exact for a quadratic g, by interval arithmetic for others."""
        return _surface(self).bounds(centers, radii)

    @property
    def box(self) -> Box:
        """See `Object.box`."""
        surface = _surface(self)
        return surface.quadric.box if surface.quadric is not None else surface.traced_box

    @property
    def inner_radius(self) -> float:
        """See `Object.inner_radius`."""
        surface = _surface(self)
        return surface.quadric.inner_radius if surface.quadric is not None else surface.inside.least_radius

    @property
    def inner_point(self) -> Array:
        """See `Object.inner_point`."""
        surface = _surface(self)
        return surface.quadric.inner_point if surface.quadric is not None else surface.inside.point

    def outline(self, box: Box | None = None, tolerance: float | None = None) -> list[Array]:
        """See `Object.outline`."""
        surface = _surface(self)
        bounded = surface.quadric is None or surface.quadric.bounded
        xmin, ymin, xmax, ymax = within = self.box if bounded else box or (0.0, 0.0, 0.0, 0.0)
        if not max(xmax - xmin, ymax - ymin) > 0:
            raise ValueError(f"box must be given, in m, for an outline without bounds; got {box!r}")
        tolerance = chord_tolerance(tolerance, max(xmax - xmin, ymax - ymin))
        if surface.quadric is not None and bounded:
            return [surface.quadric.ellipse(tolerance)]
        return contour(surface.evaluate, surface.square if bounded else within, tolerance)


def _build(owner: ImplicitSurface) -> Surface:
    names = " and ".join(field.name for field in dataclasses.fields(owner))
    return Surface(owner.g(X, Y), owner.half_size(), names)


_surface: PerInstance[ImplicitSurface, Surface] = PerInstance(_build)
