"""What is proved of the signed distance to a closed chain: where it is convex, and how concave it can be."""

from __future__ import annotations

import math

import numpy as np

from gripper.interval import enclose_all
from gripper.objects.base import Array
from gripper.objects.chain import Chain
from gripper.objects.chords import Indices
from gripper.objects.formulas import T

PARTS = 8  # of each chord, for a tight range of its curvature


class Concavity:
    """Lower bounds of the Hessian's smallest eigenvalue.

    A disc is settled where the features that can be nearest to its points are one run of the chain, without
    a re-entrant corner, that turns by less than pi: a run moved along its normals, by less than its
    radius of curvature, goes on in one direction, so it passes no point twice, feet are unique, and the
    distance's second derivative is kappa / (1 + kappa g) (kappa < 0 where the outline is hollow). Inside,
    where feet are not unique, the signed distance is a maximum of such pieces: its kinks are convex.

    Parameters
    ----------
    chain
        The outline.
    inside_out
        Bound -g, the distance to what is left around it, instead.
    """

    def __init__(self, chain: Chain, *, inside_out: bool = False) -> None:
        self.chain = chain
        lowest, highest, turn = _chords(chain)
        self.lowest = np.minimum(-highest if inside_out else lowest, 0.0)  # curvature, in 1/m
        self.turn = turn
        convex = chain.corner & ~chain.convex_corner if inside_out else chain.convex_corner
        first = np.flatnonzero(np.diff(chain.piece, prepend=-1))
        self.joint = np.zeros(chain.chords.count)  # turn at the start of each chord, infinite at a re-entrant corner
        self.joint[first] = np.where(convex, np.abs(chain.turn), np.where(chain.corner, math.inf, 0.0))
        simple = len(chain.first) == 1
        self.convex = bool(simple and not inside_out and (lowest >= 0).all() and np.isfinite(self.joint).all())

    def bound(self, centers: Array, radii: Array, g: Array) -> Array:
        """Lower bound (n,), in 1/m, over discs (n, 2), (n,) with g (n,) at their centres; -inf where none is known."""
        if self.convex:
            return np.zeros(len(centers))
        disc, chord = self.chain.chords.within(centers, np.abs(g) + 2 * radii)
        n = len(centers)
        count = np.bincount(disc, minlength=n)
        links, turn = self._runs(disc, chord, n)
        lowest = np.zeros(n)
        np.minimum.at(lowest, disc, self.lowest[chord])
        outside = np.maximum(g + radii, 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):  # at cusps the curvature is infinite
            left = 1 + lowest * outside  # how much of the radius of curvature is left
            bound = np.where(outside > 0, lowest / left, lowest)
        settled = (links >= count - 1) & (turn < math.pi) & (left > 0)
        settled |= (outside == 0) & np.isfinite(turn)
        return np.where(settled, bound, -math.inf)

    def _runs(self, disc: Indices, chord: Indices, n: int) -> tuple[Indices, Array]:
        """How many of each disc's chords follow another of them, and by how much they turn in all."""
        m = self.chain.chords.count
        key = np.sort(disc * m + chord)
        before = disc * m + self.chain.chord_before[chord]
        place = np.minimum(np.searchsorted(key, before), len(key) - 1)
        linked = key[place] == before if len(key) else np.zeros(0, dtype=bool)
        turn = self.turn[chord] + np.where(linked, self.joint[chord], 0.0)
        links: Indices = np.bincount(disc[linked], minlength=n)
        total: Array = np.asarray(np.bincount(disc, weights=turn, minlength=n), dtype=float)
        return links, total


def _chords(chain: Chain) -> tuple[Array, Array, Array]:
    """Bound the curvature (1/m) from below and above, and the turn (rad) from above, of the curve over each chord."""
    m = chain.chords.count
    if not chain.curved:
        return np.zeros(m), np.zeros(m), np.zeros(m)
    c = np.repeat(chain.coefficients[chain.piece].reshape(m, -1), PARTS, axis=0).T
    part = np.arange(PARTS) / PARTS
    step = ((chain.t1 - chain.t0) / PARTS)[:, None]
    t = chain.t0[:, None] + step * PARTS * part
    box = {symbol: (value, value) for symbol, value in zip(chain.span.c, c, strict=True)}
    box[T] = (t.ravel(), np.minimum(t + step * (1 + 1e-9), 1.0).ravel())
    (low, high), speed = enclose_all([chain.span.curvature, chain.span.speed], box)
    low, high = low.reshape(m, PARTS), high.reshape(m, PARTS)
    steepest = np.maximum(np.abs(low), np.abs(high)) * speed[1].reshape(m, PARTS)
    return low.min(axis=1), high.max(axis=1), (steepest * step).sum(axis=1)
