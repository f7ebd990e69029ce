"""The chords of a chain, searched in two rounds: groups of neighbours first, then the chords of those that matter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gripper.objects.base import Array

FEW = 48  # chords up to which comparing all of them beats groups (measured with 5 to 200 points)
GROUP = 12  # neighbours that are first looked at as one chord
HAIR = 1e-12  # of the distance: rounding

Indices = NDArray[np.intp]
ONE: Indices = np.zeros(1, dtype=np.intp)


class Chords:
    """Chords that each stand for a stretch of curve between their ends, nowhere farther from it than ``slack``.

    A point's distance to the stretch then differs from that to the chord by at most the slack, either way: the
    stretch's points, being connected, pass before every point of the chord.

    Parameters
    ----------
    start, along
        First ends (m, 2), and vectors from there to the other ends (m, 2), in m, in their order along the curve.
    slack
        (m,), in m.
    curves
        Where each curve of connected chords begins, from 0 on.
    """

    def __init__(self, start: Array, along: Array, slack: Array, curves: Indices = ONE) -> None:
        self.count = len(start)
        self.slack = slack
        self.exact = not slack.any()
        self._x, self._y = start.T.copy()
        self._dx, self._dy = along.T.copy()
        self._square = np.maximum(self._dx**2 + self._dy**2, 1e-300)
        self._groups: Chords | None = None
        if self.count > FEW:
            self._members, first = _neighbours(np.append(curves, self.count))
            self._groups = self._grouped(start, along, first)

    def _grouped(self, start: Array, along: Array, curves: Indices) -> Chords:
        first = start[self._members[:, 0]]
        whole = (start + along)[self._members[:, -1]] - first
        outer = Chords(first, whole, np.zeros(len(first)))
        groups = np.repeat(np.arange(len(first)), GROUP)
        members = self._members.ravel()
        off = np.maximum(outer._squares(start[members], groups)[0], outer._squares((start + along)[members], groups)[0])
        slack = np.sqrt(off).reshape(-1, GROUP).max(axis=1) + self.slack[self._members].max(axis=1)
        return Chords(first, whole, slack, curves)

    def _squares(self, points: Array, chord: Indices | slice) -> tuple[Array, Array]:
        """Squared distances, and how far along (0 to 1) they are: points (n, 2) to their chords (n,) or all (n, m)."""
        x, y = (points[:, :1], points[:, 1:]) if isinstance(chord, slice) else points.T
        x, y = x - self._x[chord], y - self._y[chord]
        dx, dy = self._dx[chord], self._dy[chord]
        along = np.minimum(np.maximum((x * dx + y * dy) / self._square[chord], 0.0), 1.0)
        x -= along * dx
        y -= along * dy
        return x * x + y * y, along

    def nearest(self, points: Array) -> tuple[Indices, Indices, Array]:
        """Find the chords on whose stretches the nearest point can lie.

        Returns
        -------
        Of each candidate: the index of its point (rising), its chord, and how far along (0 to 1) that is nearest.
        """
        if self._groups is None:
            squares, along = self._squares(points, slice(None))
            if self.exact:
                owner, chord = np.arange(len(points)), squares.argmin(axis=1)
                return owner, chord, along[owner, chord]
            distance = np.sqrt(squares)
            owner, chord = np.nonzero(distance - self.slack <= (distance + self.slack).min(axis=1)[:, None])
            return owner, chord, along[owner, chord]
        owner, group, _ = self._groups.nearest(points)
        owner, chord = np.repeat(owner, GROUP), self._members[group].ravel()
        squares, along = self._squares(points[owner], chord)
        first = np.searchsorted(owner, np.arange(len(points)))
        if len(points) == 0:
            return owner, chord, along
        if self.exact:
            best = np.minimum.reduceat(squares, first)
            kept = np.flatnonzero(squares == best[owner])
            kept = kept[np.diff(owner[kept], prepend=-1) > 0]
        else:
            distance = np.sqrt(squares)
            limit = np.minimum.reduceat(distance + self.slack[chord], first)
            kept = np.flatnonzero(distance - self.slack[chord] <= limit[owner])
        return owner[kept], chord[kept], along[kept]

    def within(self, points: Array, reach: Array) -> tuple[Indices, Indices]:
        """Pairs of a point (rising) and a chord, each once, whose stretch may be within reach (n,), in m."""
        reach = reach * (1 + HAIR)
        if self._groups is None:
            owner, chord = np.nonzero(self._squares(points, slice(None))[0] <= (reach[:, None] + self.slack) ** 2)
            return owner, chord
        owner, group = self._groups.within(points, reach)
        repeated = np.diff(self._members, axis=1, prepend=-1) == 0
        kept = np.flatnonzero(~repeated[group].ravel())
        owner, chord = np.repeat(owner, GROUP)[kept], self._members[group].ravel()[kept]
        near = self._squares(points[owner], chord)[0] <= (reach[owner] + self.slack[chord]) ** 2
        return owner[near], chord[near]


def _neighbours(ends: Indices) -> tuple[Indices, Indices]:
    """Groups (g, GROUP) of consecutive chords of one curve each, a curve's last chord repeated to fill its last group.

    Also where the groups of each curve begin.
    """
    counts = -(-np.diff(ends) // GROUP)
    curves = np.cumsum(counts) - counts
    own = np.arange(counts.sum()) - np.repeat(curves, counts)
    members = np.repeat(ends[:-1], counts)[:, None] + own[:, None] * GROUP + np.arange(GROUP)
    return np.minimum(members, np.repeat(ends[1:], counts)[:, None] - 1), curves
