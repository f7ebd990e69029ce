"""What is found from one g(x, y): its derivatives, its outline, the room inside, and what is proved of it."""

from __future__ import annotations

from functools import cached_property
from itertools import islice

import numpy as np
import sympy
from numpy.typing import NDArray

from gripper.objects.base import Array, Box
from gripper.objects.compiled import Derivatives, X, Y, second_derivatives
from gripper.objects.contour import CELLS, Inside, contour, inside
from gripper.objects.enclosure import ROUNDING, enclosed_bounds, enclosed_largest
from gripper.objects.quadric import Quadric

MOST_TERMS = 3000  # of a gradient whose derivatives are bounded
HAIR = np.array([1e-9, 0.618e-9])  # m: where a formula is 0/0, as at a cone's tip, it is read this far beside


class LevelSet:
    """One g(x, y), differentiated by sympy, and what is found from it.

    Parameters
    ----------
    g
        Expression in `X` and `Y`, in m.
    half_size
        Half the side of a square about the origin that holds the outline, in m; None for a quadratic g.
    names
        What the errors call it.

    Raises
    ------
    ValueError
        g is not a real function of x and y, or is quadratic without being an outline.
    """

    def __init__(self, g: sympy.Expr, half_size: float | None, names: str) -> None:
        self.names = names
        self.half_size = half_size
        self.g = _real(g, names)
        self.gradient = (sympy.diff(self.g, X), sympy.diff(self.g, Y))
        self.polynomial = bool(self.g.is_polynomial(X, Y))
        self.quadric: Quadric | None = None
        if self.polynomial and not any(entry.free_symbols for entry in self.hessian):
            xx, xy, yy = (float(entry) for entry in self.hessian)
            x, y, constant = (float(entry.subs({X: 0, Y: 0})) for entry in (*self.gradient, self.g))
            self.quadric = Quadric((xx / 2, yy / 2, xy, x, y, constant), name=self.names)

    @cached_property
    def hessian(self) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
        """Its entries xx, xy, yy, with the delta functions of kinks: for bounds."""
        return second_derivatives(self.gradient)

    @cached_property
    def too_large(self) -> bool:
        """Whether bounds would take longer than they are worth: a Hessian has up to 40 times the gradient's terms."""
        terms = (term for slope in self.gradient for term in sympy.preorder_traversal(slope))
        return next(islice(terms, MOST_TERMS, None), None) is not None

    @cached_property
    def derivatives(self) -> Derivatives:
        """The compiled form."""
        return Derivatives(self.g, self.gradient)

    def evaluate(self, points: Array, order: int) -> tuple[Array, ...]:
        """Return g and its derivatives, as `gripper.objects.Object.evaluate`."""
        if self.polynomial:
            return self.derivatives(points, order)
        with np.errstate(all="ignore"):
            values = self.derivatives(points, order)
            if all(np.isfinite(value).all() for value in values):
                return values
            return self._beside(points, values, order)

    def _beside(self, points: Array, values: tuple[Array, ...], order: int) -> tuple[Array, ...]:
        """Replace what is not finite by its value a hair beside the point."""
        bad = ~_finite(values)
        beside = self.derivatives(points[bad] + HAIR, order)
        still = ~_finite(beside)
        if still.any():
            at = tuple(points[bad][still][0].tolist())
            raise ValueError(f"{self.names} must be finite, with its derivatives, at {at}; got {self.g}")
        for value, replacement in zip(values, beside, strict=True):
            value[bad] = replacement
        return values

    @property
    def square(self) -> Box:
        """The square that holds the outline."""
        h = self.half_size or 0.0
        return (-h, -h, h, h)

    @cached_property
    def traced(self) -> list[Array]:
        """The outline to 1e-4 of the square."""
        return contour(self.evaluate, self.square, 1e-4 * (self.half_size or 0.0))

    @cached_property
    def traced_box(self) -> Box:
        """A box that holds the outline."""
        vertices = np.vstack(self.traced)
        slack = 1e-3 * (self.half_size or 0.0)  # above the chords' tolerance, also at kinks
        low, high = vertices.min(axis=0) - slack, vertices.max(axis=0) + slack
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @cached_property
    def inside(self) -> Inside:
        """The room inside the outline."""
        return inside(self.evaluate, self.square, self.traced)

    def check_extent(self) -> None:
        """Refuse an outline that is not within the square, or that is not there."""
        h = self.half_size or 0.0
        side = np.linspace(-h, h, CELLS + 1)  # the grid that the outline is traced on
        edge = np.vstack(
            [np.column_stack(pair) for end in (-h, h) for pair in ((side, 0 * side + end), (0 * side + end, side))]
        )
        g = self.evaluate(edge, 0)[0]
        if g.min() <= 0:
            at = tuple(edge[g.argmin()].tolist())
            rule = f"make a g that is positive on the edge of its extent, a square of half size {h} m about the origin"
            raise ValueError(f"{self.names} must {rule}; got {g.min()} at {at}")
        x, y = np.meshgrid(side, side)
        g = self.evaluate(np.column_stack([x.ravel(), y.ravel()]), 1)[0]
        if g.min() >= 0:
            raise ValueError(f"{self.names} must make a g that is negative inside; got {g.min()} or more, on a grid")

    @cached_property
    def continuous(self) -> bool:
        """Whether g does not jump at the branch cut of an atan2: adding a turn to it changes nothing."""
        turned = self.g.replace(sympy.atan2, lambda y, x: sympy.atan2(y, x) + 2 * sympy.pi)
        if turned == self.g:
            return True
        points = np.random.default_rng(0).uniform(-1, 1, (50, 2)) * (self.half_size or 1.0)
        difference = sympy.lambdify((X, Y), turned - self.g, "numpy")(points[:, 0], points[:, 1])
        return bool(np.abs(difference).max() < 1e-12 * np.abs(self.evaluate(points, 0)[0]).max())

    @cached_property
    def _eigenvalues(self) -> tuple[float, float]:
        """Of a quadratic g's Hessian: the least, and the largest in size."""
        values = np.linalg.eigvalsh(self.quadric.hessian) if self.quadric else np.zeros(2)
        return float(values[0]), float(np.abs(values).max())

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """Bound the derivatives of g over discs, as `gripper.objects.Object.bounds`."""
        if self.quadric is not None:
            gradient = self.evaluate(centers, 1)[1]
            least, size = self._eigenvalues
            steepest = np.hypot(gradient[:, 0], gradient[:, 1]) + size * radii
            return steepest * (1 + ROUNDING), np.full(len(centers), least)
        if not self.continuous:
            return None
        if self.too_large:
            return None
        return enclosed_bounds(self.g, self.gradient, self.hessian, centers, radii)

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """Bound the Hessian from above over discs, as `gripper.objects.Object.largest_curvature`."""
        if self.quadric is not None:
            return np.full(len(centers), np.linalg.eigvalsh(self.quadric.hessian)[1])
        if not self.continuous or self.too_large:
            return np.full(len(centers), np.inf)
        return enclosed_largest(self.g, self.hessian, centers, radii)


def typical_slope(g: sympy.Expr, half_size: float, name: str = "g") -> float:
    """Return the median of |grad g| over the outline, in the unit of g over m.

    Parameters
    ----------
    g
        Expression in `X` and `Y`.
    half_size
        Half the side of a square about the origin that holds the outline, in m.
    name
        What errors call g.

    Raises
    ------
    ValueError
        g is not a real and finite function of x and y, has no outline, or is not positive on the edge of that square.
    """
    level_set = LevelSet(g, half_size, name)
    level_set.check_extent()  # before its outline is traced, which may take seconds
    if not level_set.traced:
        return 1.0
    slopes = np.linalg.norm(level_set.evaluate(np.vstack(level_set.traced), 1)[1], axis=1)
    return float(np.median(slopes)) or 1.0


def _finite(values: tuple[Array, ...]) -> NDArray[np.bool_]:
    """Tell at which points all values are finite: (n,)."""
    finite: NDArray[np.bool_] = np.isfinite(values[0])
    for value in values[1:]:
        finite = finite & np.isfinite(value).all(axis=tuple(range(1, value.ndim)))
    return finite


def _real(g: sympy.Expr, names: str) -> sympy.Expr:
    """Refuse what is no real function of x and y; write |u| so that sympy can differentiate it."""
    g = sympy.sympify(g)
    if g.free_symbols - {X, Y} or not g.free_symbols:
        raise ValueError(f"{names} must depend on x and y, and on nothing else; got {g}")
    if g.has(sympy.I, sympy.nan, sympy.zoo, sympy.oo):
        raise ValueError(f"{names} must be real and finite; got {g}")
    return g.replace(sympy.Abs, lambda u: sympy.Abs(u) if u.is_extended_real else sympy.Max(u, -u))
