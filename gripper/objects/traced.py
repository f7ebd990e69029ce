"""Any bounded outline as a chain: pieces of curve through its points, along its tangents, that g itself confirms."""

from __future__ import annotations

import math

import numpy as np

from gripper.objects.base import Array, Object
from gripper.objects.chain import Chain
from gripper.objects.feature import FeatureSurface
from gripper.objects.part import Member

FINENESS = (1e-5, 1e-6, 1e-7)  # of the outline's size: chords to draw pieces over, until they are on it
OFF = 1e-9  # of the outline's size: as far as a piece may lie off it


def chain_of(member: Member, name: str) -> Chain:
    """Draw a part's outline as a chain in the whole's frame: exact where it is made of pieces, else to 1e-9 of it.

    Raises
    ------
    ValueError
        The part has no bounds, or corners that it does not name.
    """
    body = member.body
    if not np.isfinite(body.box).all():
        raise ValueError(f"{name} must be an object with bounds; got {body!r}")
    loops = [body.pieces()] if isinstance(body, FeatureSurface) else _drawn(body, name)
    placed = [loop @ member.turn.T for loop in loops]
    for loop in placed:
        loop[:, 0] += member.origin
    return Chain(*placed)


def _drawn(body: Object, name: str) -> list[Array]:
    size = max(body.box[2] - body.box[0], body.box[3] - body.box[1])
    off = math.inf
    for fineness in FINENESS:
        loops = [_pieces(body, line, size) for line in body.outline(tolerance=fineness * size)]
        middle = np.concatenate([np.einsum("k,mkd->md", 0.5 ** np.arange(4), loop) for loop in loops])
        g, slope = body.evaluate(middle, 1)
        off = float(np.abs(g / np.linalg.norm(slope, axis=1)).max())
        if off < OFF * size:
            return loops
    raise ValueError(f"{name} must be smooth between the corners that it names, to {OFF * size} m; got {off}")


def _pieces(body: Object, line: Array, size: float) -> Array:
    """Cubics (m, 4, 2) over the chords of a closed polyline (m + 1, 2), along the outline's tangents at its vertices.

    Their speed is that of a circle's arc over the same turn, which they then follow to the sixth order.
    """
    line = _sensed(body, line)
    before, after = _normals(body, line[:-1], size)
    chord = np.diff(line, axis=0)
    tangents = [np.column_stack([-n[:, 1], n[:, 0]]) for n in (after, np.roll(before, -1, axis=0))]
    cosine = np.clip((tangents[0] * tangents[1]).sum(axis=1), -1, 1)
    speed = np.linalg.norm(chord, axis=1) / np.cos(np.arccos(cosine) / 4) ** 2
    start, stop = (tangent * speed[:, None] for tangent in tangents)
    return np.stack([line[:-1], start, 3 * chord - 2 * start - stop, start + stop - 2 * chord], axis=1)


def _sensed(body: Object, line: Array) -> Array:
    """The polyline with what it encloses on its left."""
    middle, chord = (line[1:] + line[:-1]) / 2, np.diff(line, axis=0)
    slope = body.gradient(middle)
    inward = float((chord[:, 0] * -slope[:, 1] + chord[:, 1] * slope[:, 0]).sum())
    return line if inward > 0 else line[::-1]


def _normals(body: Object, vertices: Array, size: float) -> tuple[Array, Array]:
    """Unit normals (m, 2) before and after each vertex: two at corners, else the gradient's."""
    slope = body.gradient(vertices)
    normal = slope / np.linalg.norm(slope, axis=1, keepdims=True)
    before, after = normal, normal.copy()
    points = np.concatenate([body.corners, body.hollows])
    sides = np.concatenate([body.corner_normals, body.hollow_normals])
    for point, (first, second) in zip(points, sides, strict=True):
        at = np.abs(vertices - point).max(axis=1) < OFF * size
        before[at], after[at] = first, second
    return before, after
