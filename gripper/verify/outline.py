"""Edges and corners of a meshed finger's outline, counter-clockwise around finger and jaw."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gripper.fingers import Finger
from gripper.objects import Array

Index = NDArray[np.intp]
Part = Literal["lower", "upper", "tip", "jaw"]
PARTS: tuple[Part, ...] = ("lower", "upper", "tip", "jaw")
LOWER, UPPER, TIP, JAW = range(4)


class Outline:
    """Edges of three nodes, collected part by part.

    Parameters
    ----------
    grid
        Nodes by column and place across, from the lower face (c, m).
    nodes
        Their places (n, 2), in m.
    end
        The column at s = L; columns behind it belong to a jaw of the finger's material.
    below
        Whether such a jaw stands on the lower face.
    """

    def __init__(self, grid: Index, nodes: Array, end: int, below: bool) -> None:
        self._edges: list[Index] = []
        self._parts: list[int] = []
        self._along: list[Array] = []
        self.corners = [int(grid[-1, 0]), int(grid[-1, -1])]
        s = nodes[grid[:, 0], 0]
        self._face(LOWER, grid[:, 0], nodes, end, below)
        self._add(TIP, grid[-1], np.full(grid.shape[1], s[-1]))
        self._face(UPPER, grid[:, -1], nodes, end, not below)

    def _face(self, part: int, line: Index, nodes: Array, end: int, jaw: bool) -> None:
        s = nodes[line, 0]
        end = end if jaw else len(line) - 1
        pieces = [(part, line[: end + 1], s[: end + 1])]
        if end < len(line) - 1:
            steps = np.linalg.norm(np.diff(nodes[line[end:]], axis=0), axis=1)
            pieces.append((JAW, line[end:], np.append(0.0, np.cumsum(steps))))
        turned = part == UPPER
        for name, ids, along in reversed(pieces) if turned else pieces:
            self._add(name, ids[::-1] if turned else ids, along[::-1] if turned else along)

    def _add(self, part: int, ids: Index, along: Array) -> None:
        window = np.lib.stride_tricks.sliding_window_view
        self._edges.append(window(ids, 3)[::2])
        self._along.append(window(along, 3)[::2])
        self._parts += [part] * len(self._edges[-1])

    def add_rigid(self, polygon: Array, first: int) -> Array:
        """Add a rigid polygon (k, 2), counter-clockwise; its corners and middles become nodes from this number on.

        Returns
        -------
        Their places (2 k, 2), in m.
        """
        following = np.roll(polygon, -1, axis=0)
        k = len(polygon)
        lengths = np.linalg.norm(following - polygon, axis=1)
        arc = np.append(0.0, np.cumsum(np.repeat(lengths / 2, 2)))
        self._add(JAW, first + np.append(np.arange(2 * k), 0), arc)
        self.corners += [int(first + 2 * i) for i in np.flatnonzero(convex(polygon))]
        return np.stack([polygon, (polygon + following) / 2], axis=1).reshape(-1, 2)

    @property
    def edges(self) -> Index:
        """Three nodes each (k, 3)."""
        return np.concatenate(self._edges)

    @property
    def part(self) -> Index:
        """Of each edge, an index into `PARTS`, (k,)."""
        return np.array(self._parts, dtype=np.intp)

    @property
    def along(self) -> Array:
        """What the edges' nodes are called in a report (k, 3), in m."""
        return np.concatenate(self._along)


def convex(polygon: Array) -> NDArray[np.bool_]:
    """Which corners of a counter-clockwise polygon (k, 2) are convex, (k,)."""
    before, after = polygon - np.roll(polygon, 1, axis=0), np.roll(polygon, -1, axis=0) - polygon
    return np.asarray(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0)


def jaw_polygon(finger: Finger, thickness: float) -> Array | None:
    """The jaw's corners (k, 2), counter-clockwise from its first, in the jaw frame, in m; None without a jaw."""
    if finger.jaw is None:
        return None
    polygon = np.array(finger.jaw.polygon(thickness), dtype=float)
    x, y = polygon.T
    area = np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    return np.roll(polygon[::-1], 1, axis=0) if area < 0 else polygon


def inside(points: Array, positions: Array, edges: Index) -> Array:
    """Which points (k, 2) lie inside the outline of straightened edges, (k,)."""
    first, last = edges[:, 0], edges[:, 2]
    clamp = np.setdiff1d(last, first), np.setdiff1d(first, last)
    a, b = positions[np.append(first, clamp[0])], positions[np.append(last, clamp[1])]
    x, y = points[:, :1], points[:, 1:]
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return np.asarray(np.sum(crosses & (x < at), axis=1) % 2 == 1)
