"""Lower bounds of the gap over stretches of outline between samples.

On such a stretch g is f(t) with f'' >= -M, where

    M = K max|c''| - lambda min|c'|^2   (max|c'|^2 where lambda < 0),

K bounding |grad g| and lambda bounding the Hessian's eigenvalues from below over a disc that holds the stretch. So f
lies above two parabolas, one from each end, and above (f0 + f1 - K * arc length) / 2 in any case.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import dot
from gripper.statics.sampling import Seen

_FLAT = 1e-6  # least |grad g| that a gap is divided by to be a distance
_STEEPER = 1.5  # where nothing is proved of grad g: its sampled size may be off by this much


@dataclass(frozen=True, eq=False)
class Ends:
    """Both ends of each stretch, (2, k): points, g, |grad g| and dg/du."""

    points: Complex
    g: Array
    steepness: Array
    slopes: Array

    @classmethod
    def of(cls, obstacle: Obstacle, seen: Seen) -> Ends:
        """The ends of what is seen of an outline."""
        g, normal = obstacle.slope(seen.points)
        values = np.array([g, np.maximum(np.abs(normal), _FLAT), dot(normal, seen.tangents)])
        return cls(seen.points[seen.ends], *values[:, seen.ends])

    @functools.cached_property
    def depths(self) -> Array:
        """G / |grad g|, (2, k)."""
        depths: Array = self.g / self.steepness
        return depths


def lower_bound(obstacle: Obstacle, seen: Seen, ends: Ends) -> tuple[Array, bool]:
    """A lower bound of g over each stretch, (k,), and whether it is proved."""
    arc = seen.lengths * seen.longest
    bounds = obstacle.bounds((ends.points[0] + ends.points[1]) / 2, arc / 2)
    if bounds is None:
        steep, flat = _STEEPER * ends.steepness.max(axis=0), np.full(arc.shape, -np.inf)
    else:
        steep, flat = bounds
    (f0, f1), h = ends.g, seen.lengths
    lower: Array = (f0 + f1 - steep * arc) / 2
    if lower.min() > 0:
        return lower, bounds is not None
    shortest, bent = seen.curved
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        M = steep * bent - flat * np.where(flat < 0, seen.longest, shortest) ** 2
        M = np.where(np.isfinite(M), M, np.nan)  # which bounds nothing
        lower = np.fmax(lower, _between_parabolas(ends.g, ends.slopes * h, np.maximum(M, 0.0) * (h * h / 2)))
        if (M < 0).any():  # a convex f lies above the vertex of either parabola
            vertices = (ends.g + ends.slopes**2 / (2 * M)).max(axis=0)
            lower = np.where(M < 0, np.fmax(lower, vertices), lower)
    return lower, bounds is not None


def _between_parabolas(f: Array, slopes: Array, bulge: Array) -> Array:
    """Least value over [0, 1] of the larger of two parabolas, tangent to f at 0 and at 1; not a number without bounds.

    Parameters
    ----------
    f, slopes
        Values and slopes at both ends, (2, k).
    bulge
        By how much each parabola falls below its tangent over [0, 1], (k,); at least 0.
    """
    (f0, f1), (slope0, slope1) = f, slopes
    first, last = f1 - slope1 - bulge, f0 + slope0 - bulge  # each at the other's end
    least = np.minimum(np.maximum(f0, first), np.maximum(f1, last))
    # they cross once, where their difference, which is linear, vanishes
    crossing = (f0 - first) / (slope1 - slope0 + 2 * bulge)
    value = f0 + crossing * (slope0 - bulge * crossing)
    return np.where((crossing > 0) & (crossing < 1), np.minimum(least, value), least)
