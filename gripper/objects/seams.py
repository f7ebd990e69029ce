"""Where the outlines of parts cross, and which corners the whole has there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gripper.objects.base import Array
from gripper.objects.part import Member

STRAIGHT = 1e-7  # rad: a smaller turn is no corner
NEAR = 1e-9  # of the whole's size: what is that near is on the outline, or is one point
PROBE = 1e-6  # of the whole's size: as far from a corner its sectors are looked at
NEWTON = 30


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners (k, 2), in m, and the normals (k, 2, 2) of the outline before and after each."""

    points: Array
    normals: Array


def crossings(lines: Sequence[Sequence[Array]], members: Sequence[Member], size: float) -> Array:
    """Find the points (k, 2), in m, where the outlines (polylines about them) of two parts cross."""
    import shapely

    drawn = [shapely.multilinestrings([shapely.linestrings(line) for line in own]) for own in lines]
    found = [np.empty((0, 2))]
    for i, one in enumerate(members):
        for j, other in enumerate(members[:i]):
            rough = shapely.get_coordinates(shapely.intersection(drawn[i], drawn[j]))
            found.append(_polished(rough, one, other, size))
    return np.concatenate(found)


def _polished(points: Array, one: Member, other: Member, size: float) -> Array:
    """Move points (k, 2) on to both outlines; those that find no crossing nearby are left out."""
    start = points
    for _ in range(NEWTON):
        g, slopes = (
            np.stack(pair, axis=1) for pair in zip(*(m.evaluate(points, 1) for m in (one, other)), strict=True)
        )
        step = np.einsum("kij,kj->ki", np.linalg.pinv(slopes, rcond=1e-9), g)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        points = points - step * np.minimum(1.0, 1e-2 * size / np.maximum(length, 1e-300))
        if not len(points) or length.max() < 1e-15 * size:
            break
    on = np.all([np.abs(m.evaluate(points, 0)[0]) < NEAR * size for m in (one, other)], axis=0)
    return points[on & (np.linalg.norm(points - start, axis=1) < 1e-2 * size)]


def corners(
    candidates: Array, members: Sequence[Member], gap: Callable[[Array], Array], size: float
) -> tuple[Corners, Corners]:
    """Tell which of the candidates (k, 2), in m, are convex and which re-entrant corners of the whole.

    Around each point the outlines of the parts are rays; between two of them the whole is inside or outside.

    Parameters
    ----------
    candidates
        Crossings, and the parts' own corners.
    members
        The parts.
    gap
        The whole's g (n,), in m, at points (n, 2), in m.
    size
        Of the whole, in m.
    """
    convex: list[tuple[Array, Array]] = []
    hollow: list[tuple[Array, Array]] = []
    known = np.empty((0, 2))
    for point in candidates:
        if len(known) and np.abs(known - point).max(axis=1).min() < 10 * NEAR * size:
            continue
        known = np.vstack([known, point])
        sector = _sector(point, _rays(point, members, size), gap, PROBE * size)
        if sector is None or abs(math.pi - sector[1]) < STRAIGHT:
            continue
        start, opening = sector
        # what is inside lies left of the outline: it comes in along the sector's end and leaves along its start
        normals = np.array([[_cos_sin(start + opening, 1)], [_cos_sin(start, -1)]]).reshape(2, 2)
        (convex if opening < math.pi else hollow).append((point, normals))
    return _gathered(convex), _gathered(hollow)


def _cos_sin(angle: float, side: int) -> tuple[float, float]:
    """The unit vector a quarter turn to the left (1) or right (-1) of an angle."""
    return -side * math.sin(angle), side * math.cos(angle)


def _gathered(found: list[tuple[Array, Array]]) -> Corners:
    return Corners(
        np.array([point for point, _ in found]).reshape(-1, 2), np.array([n for _, n in found]).reshape(-1, 2, 2)
    )


def _rays(point: Array, members: Sequence[Member], size: float) -> Array:
    """Angles (r,), rising, of the parts' outlines as they leave a point."""
    angles: list[float] = []
    for member in members:
        own, normals = member.corners
        at = np.flatnonzero(np.abs(own - point).max(axis=1, initial=0.0) < 10 * NEAR * size)
        if len(at):
            (bx, by), (ax, ay) = normals[at[0]]
            angles += [math.atan2(-bx, by), math.atan2(ax, -ay)]  # back along the one before, on along the one after
            continue
        g, slope = member.evaluate(point[None], 1)
        steep = float(np.linalg.norm(slope))
        if abs(g[0]) < 10 * NEAR * size * max(steep, 1.0):
            along = math.atan2(slope[0, 0], -slope[0, 1])
            angles += [along, along + math.pi]
    rays = np.unique(np.mod(angles, 2 * math.pi))
    apart = np.diff(rays, append=rays[:1] + 2 * math.pi) > STRAIGHT
    return rays[apart]


def _sector(point: Array, rays: Array, gap: Callable[[Array], Array], probe: float) -> tuple[float, float] | None:
    """Where the whole's inside begins at a point, and how wide it opens, in rad; None where it has not one sector."""
    if len(rays) < 2:
        return None
    widths = np.diff(rays, append=rays[0] + 2 * math.pi)
    middle = rays + widths / 2
    inside = gap(point + probe * np.column_stack([np.cos(middle), np.sin(middle)])) < 0
    begins = np.flatnonzero(inside & ~np.roll(inside, 1))
    if len(begins) != 1:
        return None
    return float(rays[begins[0]]), float(widths[inside].sum())
