"""Closed chains of polynomial pieces: the nearest point on them, and their corners."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gripper.objects.base import Array, Box
from gripper.objects.chords import Chords, Indices
from gripper.objects.formulas import Span

FINENESS = 5e-4  # chords to search among are within this part of the chain's size of the curve
STRAIGHT = 1e-9  # rad: a smaller turn is no corner
NEWTON_STEPS = 40  # three do, but near the evolute, deep inside
SETTLED = 1e-7  # the error after a Newton step is about the square of it


@dataclass(frozen=True)
class Nearest:
    """Nearest feature of the chain, a point each: piece and parameter t, and the corner's index or -1."""

    piece: Indices
    t: Array
    corner: Indices


class Chain:
    """Closed loops of pieces q_i(t) = sum_k c_ik t^k, t in [0, 1], with what they enclose on their left.

    Parameters
    ----------
    loops
        (m, degree + 1, 2) each, in m; each piece ends where the next begins, the last where the first does. A loop
        alone may have either sense; of several the outer ones are counter-clockwise, holes clockwise.
    """

    def __init__(self, *loops: Array) -> None:
        self.turned = len(loops) == 1 and _area(loops[0]) < 0
        loops = (_reversed(loops[0]),) if self.turned else loops
        self.coefficients = np.concatenate(loops)
        last = np.cumsum([len(loop) for loop in loops]) - 1
        self.first = np.concatenate([[0], last[:-1] + 1])  # of each loop
        self.after = np.arange(1, last[-1] + 2)
        self.after[last] = self.first
        self.before = np.empty_like(self.after)
        self.before[self.after] = np.arange(len(self.after))
        self.lengths = np.linalg.norm(self.coefficients[:, 1:], axis=2).sum(axis=1)  # about
        self.span = Span.of_degree(self.coefficients.shape[1] - 1)
        self.size = float(np.ptp(_some_points(self.coefficients), axis=0).max())
        self.curved = self.coefficients.shape[1] > 2
        self.piece, self.t0, self.t1, self.sagitta = self.subdivide(FINENESS * self.size)
        start, starts = self.at(self.piece, self.t0), np.searchsorted(self.piece, self.first)
        following = np.arange(1, len(start) + 1)
        following[np.append(starts[1:], len(start)) - 1] = starts
        self.chord_before = np.argsort(following)
        self.chords = Chords(start, start[following] - start, self.sagitta, starts)
        self._find_corners()

    def carried(self, rates: Array) -> Array:
        """Rates (p, m, degree + 1, 2) of the pieces as they were given, for the pieces as they are passed here."""
        return np.array([_reversed(rate) for rate in rates]) if self.turned else rates

    def at(self, piece: Indices, t: Array) -> Array:
        """Points q(t) (n, 2), in m, of pieces (n,) at t (n,)."""
        q = np.zeros((len(piece), 2))
        for k in reversed(range(self.coefficients.shape[1])):
            q = q * t[:, None] + self.coefficients[piece, k]
        return q

    def subdivide(self, tolerance: float) -> tuple[Indices, Array, Array, Array]:
        """Cut every piece into chords that are within ``tolerance`` (m) of it.

        Returns
        -------
        Of each chord: its piece, the parameters at its ends, and the largest distance (m) to the curve.
        """
        powers = np.arange(self.coefficients.shape[1])
        bend = (powers * (powers - 1)) @ np.linalg.norm(self.coefficients, axis=2).T  # >= |q''|
        counts = np.maximum(1, np.ceil(np.sqrt(bend / (8 * tolerance)))).astype(int)
        piece = np.repeat(np.arange(len(counts)), counts)
        step = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
        return piece, step / counts[piece], (step + 1) / counts[piece], (bend / counts**2 / 8)[piece]

    def _find_corners(self) -> None:
        """At the start of each piece: the normals before and after, the turn, and whether it is a corner."""
        powers = np.arange(self.coefficients.shape[1])
        after = self.coefficients[:, 1]
        before = (powers[:, None] * self.coefficients).sum(axis=1)[self.before]
        turned = [tangent / np.linalg.norm(tangent, axis=1, keepdims=True) for tangent in (before, after)]
        normals = np.stack([np.column_stack([tangent[:, 1], -tangent[:, 0]]) for tangent in turned], axis=1)
        cross = turned[0][:, 0] * turned[1][:, 1] - turned[0][:, 1] * turned[1][:, 0]
        self.turn: Array = np.arctan2(cross, (turned[0] * turned[1]).sum(axis=1))
        self.corner: NDArray[np.bool_] = np.abs(self.turn) > STRAIGHT
        self.convex_corner: NDArray[np.bool_] = self.corner & (self.turn > 0)
        self.normals: Array = normals
        self.vertex: Array = self.coefficients[:, 0]
        bisector = normals.sum(axis=1) + 1e-9 * turned[0]  # a needle's normals cancel
        self.bisector: Array = bisector / np.linalg.norm(bisector, axis=1, keepdims=True)

    @cached_property
    def polygon(self) -> Any:
        """A shapely polygon within 1e-5 of the chain's size of its first loop."""
        import shapely

        return shapely.Polygon(self.polylines(1e-5 * self.size)[0])

    @cached_property
    def inner_disc(self) -> tuple[Array, float]:
        """Centre (2,) and radius of the largest disc inside, in m, to 1e-3 of it."""
        import shapely

        line = shapely.maximum_inscribed_circle(self.polygon, tolerance=1e-4 * self.size)
        return np.array(line.coords[0]), float(line.length)

    @cached_property
    def box(self) -> Box:
        """The box that holds the chain, in m."""
        piece, t, _, sagitta = self.subdivide(1e-6 * self.size)
        vertices = self.at(piece, t)
        low, high = vertices.min(axis=0) - sagitta.max(), vertices.max(axis=0) + sagitta.max()
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def polylines(self, tolerance: float) -> list[Array]:
        """Vertices (m, 2) on each loop, the first one repeated, with chords within ``tolerance`` (m) of it."""
        piece, t, _, _ = self.subdivide(tolerance)
        loops = np.split(self.at(piece, t), np.searchsorted(piece, self.first[1:]))
        return [np.vstack([vertices, vertices[:1]]) for vertices in loops]

    def nearest(self, points: Array) -> Nearest:
        """Find the feature nearest to each of points (n, 2), in m."""
        owner, chord, along = self.chords.nearest(points)
        piece = self.piece[chord]
        t = self.t0[chord] + (self.t1 - self.t0)[chord] * along
        if self.curved:
            piece, t = self._foot(points[owner], piece, t, (self.t1 - self.t0)[chord])
            if len(owner) > len(points):
                distance = np.linalg.norm(points[owner] - self.at(piece, t), axis=1)
                first = np.searchsorted(owner, np.arange(len(points)))
                closest = np.lexsort((distance, owner))[first]
                piece, t = piece[closest], t[closest]
        joint = np.where(t >= 1, self.after[piece], piece)
        at_joint = (t <= 0) | (t >= 1)
        return Nearest(piece, t, np.where(at_joint & self.corner[joint], joint, -1))

    def _foot(self, points: Array, piece: Indices, t: Array, reach: Array) -> tuple[Indices, Array]:
        """Find the foot by Newton's steps of at most ``reach`` in t, on to the next piece where the joint is smooth."""
        for _ in range(NEWTON_STEPS):
            step = self.span.step(points, t, self.coefficients[piece])
            moved_piece, moved = self._walk(piece, t + np.minimum(np.maximum(step, -reach), reach))
            settled = bool((np.abs(moved - t) < SETTLED).all())
            piece, t = moved_piece, moved
            if settled:
                break
        return piece, t

    def _walk(self, piece: Indices, t: Array) -> tuple[Indices, Array]:
        """Carry t beyond 0 or 1 over a smooth joint into the neighbour; stop it at a corner."""
        over, under = t > 1, t < 0
        if not (over | under).any():
            return piece, t
        neighbour = np.where(over, self.after[piece], np.where(under, self.before[piece], piece))
        smooth = (over | under) & ~self.corner[np.where(over, neighbour, piece)]
        ratio = self.lengths[piece] / self.lengths[neighbour]
        entered = np.where(over, (t - 1) * ratio, 1 + t * ratio)
        return np.where(smooth, neighbour, piece), np.clip(np.where(smooth, entered, t), 0.0, 1.0)


def _some_points(coefficients: Array) -> Array:
    """A few points of each piece (n, 2), in their order."""
    degree = coefficients.shape[1] - 1
    t = np.linspace(0, 1, 8, endpoint=False) if degree > 1 else np.zeros(1)
    return np.einsum("tk,mkd->mtd", t[:, None] ** np.arange(degree + 1), coefficients).reshape(-1, 2)


def _area(coefficients: Array) -> float:
    """Twice the signed area (m^2) of the polygon of some points of each piece."""
    x, y = _some_points(coefficients).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _reversed(coefficients: Array) -> Array:
    """Return the same chain, passed the other way: pieces in reverse, 1 - t for t."""
    count = coefficients.shape[1]
    flip = np.array([[math.comb(k, j) * (-1) ** j for j in range(count)] for k in range(count)], dtype=float)
    return np.ascontiguousarray(np.einsum("kj,mkd->mjd", flip, coefficients)[::-1])
