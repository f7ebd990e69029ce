"""The smooth closed curve through points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.fields import Point
from gripper.objects import Array, FeatureSurface, closed_points


@dataclass(frozen=True, kw_only=True)
class Spline(FeatureSurface):
    """Closed cubic spline, C2, over chord length: g is the signed distance to it.

    Parameters
    ----------
    points
        Points (x, y), in m, that it passes through, in either sense; the last one joins the first.
    """

    points: tuple[Point, ...]

    def pieces(self) -> Array:
        """Write the spans between the points, in powers of their own parameter."""
        from scipy.interpolate import CubicSpline  # slow to import, and no other object needs it

        knots = closed_points("points", self.points)
        closed = np.vstack([knots, knots[:1]])
        chords = np.linalg.norm(np.diff(closed, axis=0), axis=1)
        spline = CubicSpline(np.concatenate([[0.0], np.cumsum(chords)]), closed, bc_type="periodic")
        powers = np.arange(4)[:, None, None]
        return np.ascontiguousarray((spline.c[::-1] * chords[:, None] ** powers).swapaxes(0, 1))
