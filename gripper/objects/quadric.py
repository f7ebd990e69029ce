"""Quadratic g: kind, box, inner disc and outline in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gripper.objects.base import Array, Box

NOTHING = 1e-13  # relative to the largest entry: below it an eigenvalue or a remainder is rounding


@dataclass(frozen=True)
class Quadric:
    """The normal form of g = b1 x^2 + b2 y^2 + b3 x y + b4 x + b5 y + b6.

    In the axes of its Hessian, about ``center``: g = (l1 u^2 + l2 v^2)/2 + m1 u + m2 v + c, where m_i is
    left only where l_i is zero.

    Parameters
    ----------
    coefficients
        (b1, ..., b6), in SI units.
    name
        What the errors call them.

    Raises
    ------
    ValueError
        The quadric has no outline, a point or crossing lines for an outline, or is positive inside.
    """

    coefficients: tuple[float, float, float, float, float, float]
    name: str = "coefficients"

    def __post_init__(self) -> None:
        positive, negative = self._eigenvalues > 0, self._eigenvalues < 0
        c = self.center_value
        if self._slope.any():
            return  # a line or a parabola
        if not (positive | negative).any():
            raise ValueError(self._message("not be constant"))
        if negative.any() and not positive.any() and negative.all() and c > 0:
            raise ValueError(self._message("be negative inside (change all signs)"))
        if (not positive.any() and c <= 0) or (not negative.any() and c >= 0):
            raise ValueError(self._message("have an outline (points on both sides of g = 0)"))
        if c == 0:
            raise ValueError(self._message("have a gradient all along the outline, which crossing lines lack"))

    def _message(self, rule: str) -> str:
        return f"{self.name} must {rule}, in SI units; got {self.coefficients!r}"

    @cached_property
    def hessian(self) -> Array:
        """The constant Hessian (2, 2), in 1/m."""
        b1, b2, b3 = self.coefficients[:3]
        return np.array([[2 * b1, b3], [b3, 2 * b2]])

    @cached_property
    def _axes(self) -> tuple[Array, Array]:
        values, axes = np.linalg.eigh(self.hessian)
        values[np.abs(values) <= NOTHING * np.abs(values).max()] = 0.0
        return values, axes

    @property
    def _eigenvalues(self) -> Array:
        return self._axes[0]

    @cached_property
    def _slope(self) -> Array:
        linear = self._axes[1].T @ np.array(self.coefficients[3:5])
        rest = np.where(self._eigenvalues == 0, linear, 0.0)
        return np.where(np.abs(rest) > NOTHING * np.abs(linear).max(initial=0.0), rest, 0.0)

    @cached_property
    def _normal_form(self) -> tuple[Array, float]:
        values, axes = self._axes
        linear = axes.T @ np.array(self.coefficients[3:5])
        curved = values != 0
        shift = np.where(curved, -linear / np.where(curved, values, 1.0), 0.0)
        terms = values * shift**2 / 2
        value = self.coefficients[5] - terms.sum()
        if abs(value) <= NOTHING * max(abs(self.coefficients[5]), float(np.abs(terms).max())):
            value = 0.0
        if self._slope.any():  # to the vertex: along the axis that has no curvature
            along = self._slope / (self._slope @ self._slope)
            shift, value = shift - value * along, 0.0
        return axes @ shift, value

    @property
    def center(self) -> Array:
        """The centre (2,), in m; of a parabola its vertex, of a line its point nearest to the origin."""
        return self._normal_form[0]

    @property
    def center_value(self) -> float:
        """The value of g at the centre, in the unit of g."""
        return self._normal_form[1]

    @property
    def bounded(self) -> bool:
        """Whether the outline is an ellipse."""
        return bool((self._eigenvalues > 0).all())

    @property
    def _semi_axes(self) -> Array:
        """Distance (2,) from the centre to the outline along each axis; inf where it is not met."""
        with np.errstate(divide="ignore", invalid="ignore"):
            squares = -2 * self.center_value / self._eigenvalues
        return np.sqrt(np.where(squares > 0, squares, math.inf))

    @property
    def vertex_slope(self) -> float:
        """|grad g| at the vertices of the outline (of an ellipse at its minor axis' ends), in the unit of g over m."""
        if self._slope.any():
            return float(np.linalg.norm(self._slope))
        return float(np.abs(2 * self.center_value / self._semi_axes).max())

    @property
    def box(self) -> Box:
        """Exact for an ellipse, infinite for all others."""
        if not self.bounded:
            return (-math.inf, -math.inf, math.inf, math.inf)
        half = np.sqrt(-2 * self.center_value * np.diag(np.linalg.inv(self.hessian)))
        low, high = self.center - half, self.center + half
        return (float(low[0]), float(low[1]), float(high[0]), float(high[1]))

    @property
    def inner_radius(self) -> float:
        """Radius of the largest disc inside, in m; infinite where none is the largest."""
        return float(self._semi_axes.min()) if self.center_value < 0 else math.inf

    @property
    def inner_point(self) -> Array:
        """A point (2,) well inside, in m."""
        values, axes = self._axes
        if self.center_value < 0:
            return self.center
        if self.center_value > 0:  # between hyperbola's branches or lines g > 0: go beyond the vertex
            reach = np.where(np.isfinite(self._semi_axes), 2 * self._semi_axes, 0.0)
            return self.center + axes @ reach
        slope = float(np.linalg.norm(self._slope))
        curvature = float(np.abs(values).max()) / slope
        depth = 1 / curvature if curvature else 0.1
        return self.center - depth * (axes @ self._slope) / slope

    def ellipse(self, tolerance: float) -> Array:
        """Trace the closed polyline (m, 2) whose chords are within ``tolerance`` (m) of the ellipse."""
        semi_axes = self._semi_axes
        # a chord over dt of the parameter is off by at most (largest semi-axis) (1 - cos(dt/2))
        half_step = math.acos(max(1 - tolerance / float(semi_axes.max()), 0.0))
        t = np.linspace(0, 2 * np.pi, max(16, math.ceil(np.pi / half_step)) + 1)
        unit = np.column_stack([np.cos(t), np.sin(t)])
        unit[-1] = unit[0]
        return self.center + (unit * semi_axes) @ self._axes[1].T
