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

    def piece_rates(self) -> dict[str, Array]:
        """Write how the spans move with each coordinate of a point: the equations of a C2 spline, differentiated."""
        knots, pieces = closed_points("points", self.points), self.pieces()
        count = len(knots)
        moved = np.eye(2 * count).reshape(-1, count, 2)
        spans, spread = (np.roll(points, -1, axis=-2) - points for points in (knots, moved))
        chords = np.linalg.norm(spans, axis=1)[:, None]
        lengthened = (spread * spans).sum(axis=-1, keepdims=True) / chords
        flat, flatter = 1 / chords, -lengthened / chords**2
        first = pieces[:, 1] / chords  # slopes by chord length at each span's start, and at its end
        last = np.roll(first, -1, axis=0)
        load = 3 * (spread * flat**2 + 2 * spans * flat * flatter)
        right = load - flatter * (2 * first + last) + np.roll(load - flatter * (first + 2 * last), 1, axis=1)
        each = np.arange(count)
        matrix = np.zeros((count, count))
        matrix[each, each - 1] = np.roll(flat[:, 0], 1)
        matrix[each, (each + 1) % count] = flat[:, 0]
        matrix[each, each] = 2 * (flat[:, 0] + np.roll(flat[:, 0], 1))
        turned = np.linalg.solve(matrix, right)
        start = lengthened * first + chords * turned
        end = lengthened * last + chords * np.roll(turned, -1, axis=1)
        rates = np.stack([moved, start, 3 * spread - 2 * start - end, start + end - 2 * spread], axis=2)
        return {f"points[{i}][{d}]": rates[2 * i + d] for i, d in np.ndindex(count, 2)}
