"""The polygon."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.fields import Point
from gripper.objects import Array, FeatureSurface, closed_points


@dataclass(frozen=True, kw_only=True)
class Polygon(FeatureSurface):
    """Polygon, convex or not: g is the signed distance to its edges and corners.

    Parameters
    ----------
    vertices
        Corners (x, y), in m, in either sense; the last one joins the first.
    """

    vertices: tuple[Point, ...]

    def pieces(self) -> Array:
        """Write the edges: q(t) = vertex + t (next vertex - vertex)."""
        start = closed_points("vertices", self.vertices)
        return np.stack([start, np.roll(start, -1, axis=0) - start], axis=1)

    def piece_rates(self) -> dict[str, Array]:
        """Write how the edges beside a vertex move with it."""
        count = len(self.vertices)
        rates = np.zeros((count, 2, count, 2, 2))
        for i, d in np.ndindex(count, 2):
            rates[i, d, i, :, d] = 1.0, -1.0
            rates[i, d, i - 1, 1, d] = 1.0
        return {f"vertices[{i}][{d}]": rates[i, d] for i, d in np.ndindex(count, 2)}
