"""The outline g = 0 of a surface known only by its values: traced on a grid, then moved onto the outline by Newton."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gripper.objects.base import Array, Box

Evaluate = Callable[[Array, int], tuple[Array, ...]]

CELLS = 256  # of the grid, along the box's larger side
ROUNDS = 14  # of halving chords: a kink in the outline never gets within tolerance


def contour(evaluate: Evaluate, box: Box, tolerance: float) -> list[Array]:
    """Trace g = 0 in a box.

    Parameters
    ----------
    evaluate
        Gives g and its derivatives, as `gripper.objects.Object.evaluate`.
    box
        (xmin, ymin, xmax, ymax), in m.
    tolerance
        Largest distance from a chord's middle to the outline, in m.

    Returns
    -------
    Polylines (m, 2), in m; closed ones repeat their first vertex.
    """
    import contourpy

    x, y, g = _grid(evaluate, box)
    lines = contourpy.contour_generator(x, y, g).lines(0.0)
    cell = float(x[1] - x[0])
    return [refined(evaluate, projected(evaluate, np.asarray(line), cell), tolerance) for line in lines]


def _grid(evaluate: Evaluate, box: Box) -> tuple[Array, Array, Array]:
    xmin, ymin, xmax, ymax = box
    cell = max(xmax - xmin, ymax - ymin) / CELLS
    x = np.linspace(xmin, xmax, int(np.ceil((xmax - xmin) / cell)) + 1)
    y = np.linspace(ymin, ymax, int(np.ceil((ymax - ymin) / cell)) + 1)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    return x, y, evaluate(points.reshape(-1, 2), 0)[0].reshape(points.shape[:2])


def projected(evaluate: Evaluate, points: Array, reach: float) -> Array:
    """Move points near the outline onto it, along the gradient, by no more than ``reach`` (m) at a time."""
    for _ in range(6):
        g, gradient = evaluate(points, 1)
        square = np.maximum((gradient * gradient).sum(axis=1), 1e-300)
        step = (g / square)[:, None] * gradient
        length = np.maximum(np.linalg.norm(step, axis=1, keepdims=True), 1e-300)
        points = points - step * np.minimum(1.0, reach / length)
    return points


def refined(evaluate: Evaluate, line: Array, tolerance: float) -> Array:
    """Halve the chords whose middle is off the outline by more than ``tolerance`` (m)."""
    for _ in range(ROUNDS):
        middle = (line[1:] + line[:-1]) / 2
        longest = float(np.linalg.norm(np.diff(line, axis=0), axis=1).max())
        on = projected(evaluate, middle, longest / 2)
        off = np.flatnonzero(np.linalg.norm(on - middle, axis=1) > tolerance)
        if not len(off):
            break
        line = np.insert(line, off + 1, on[off], axis=0)
    return line


def settled(evaluate: Evaluate, line: Array, corners: Array, reach: float) -> Array:
    """Put a polyline's vertices (m, 2), in m, on the outline, and the corners (k, 2) that it passes among them.

    Parameters
    ----------
    evaluate
        Gives g and its derivatives, as `gripper.objects.Object.evaluate`.
    line
        Within ``reach`` (m) of the outline; a closed one repeats its first vertex.
    corners
        Where the outline has no tangent, in m.
    reach
        A vertex that near to a corner is replaced by it, in m.
    """
    closed = bool((line[0] == line[-1]).all())
    line = line[:-1].copy() if closed else line.copy()
    distance = np.linalg.norm(line[:, None] - corners, axis=2)
    passed = np.flatnonzero(distance.min(axis=0, initial=np.inf) < reach)
    at = distance[:, passed].argmin(axis=0)
    line[at] = corners[passed]
    corner = np.zeros(len(line), dtype=bool)
    corner[at] = True
    kept = corner | (distance.min(axis=1, initial=np.inf) >= reach)
    line, corner = line[kept], corner[kept]
    line[~corner] = projected(evaluate, line[~corner], reach)
    return np.vstack([line, line[:1]]) if closed else line


@dataclass(frozen=True)
class Inside:
    """The largest disc inside a bounded outline, and the largest one of its smallest part."""

    point: Array
    radius: float
    least_radius: float


def inside(evaluate: Evaluate, box: Box, outline: list[Array]) -> Inside:
    """Find how much room there is inside the outline (vertices (m, 2), in m), on a grid over the box."""
    from scipy.ndimage import label
    from scipy.spatial import KDTree

    x, y, g = _grid(evaluate, box)
    tree = KDTree(np.vstack(outline))
    parts, count = label(g < 0)
    best: list[tuple[float, Array]] = []
    for part in range(1, count + 1):
        row, column = np.nonzero(parts == part)
        points = np.column_stack([x[column], y[row]])
        best.append(_roomiest(evaluate, tree.query, points, float(x[1] - x[0])))
    radius, point = max(best, key=lambda disc: disc[0])
    return Inside(point, radius, min(disc[0] for disc in best))


def _roomiest(
    evaluate: Evaluate, query: Callable[[Array], tuple[Array, Array]], points: Array, cell: float
) -> tuple[float, Array]:
    """Distance to the outline (m) and place of the inner point farthest from it, refined around the best of points."""
    offsets = np.stack(np.meshgrid([-1, -0.5, 0, 0.5, 1], [-1, -0.5, 0, 0.5, 1]), axis=-1).reshape(-1, 2)
    for shrink in (1.0, 0.5, 0.25, 0.125):
        inner = points[evaluate(points, 0)[0] < 0]
        point = inner[query(inner)[0].argmax()]
        points = point + offsets * cell * shrink
    return float(query(point[None])[0][0]), point
