"""Penetration over the whole outline: found where it is, bounded where it is not.

On a piece of outline between two samples, g along it is f(t) with f'' >= -M, where

    M = K max|c''| - lambda min|c'|^2   (max|c'|^2 where lambda < 0),

K bounding |grad g| and lambda bounding the Hessian's eigenvalues from below over a disc that holds the piece. So f
lies above two parabolas, one from each end, and above (f0 + f1 - K * arc length) / 2 in any case. Pieces that could
still hide a penetration are cut into four.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gripper.equilibrium import Setting, State
from gripper.obstacle import Obstacle
from gripper.outline import UPPER, Axis

Array = NDArray[np.float64]
Index = NDArray[np.intp]
DEPTH = 2e-7
"""Penetration that counts as none, by L."""
_PER_SEGMENT = 8
_PER_EDGE = 4
_ROUNDS = 14
_MOST_PIECES = 60_000
_STEEPER = 1.5  # where nothing is proved of grad g: its sampled size may be off by this much


@dataclass(frozen=True, eq=False)
class Pieces:
    """Stretches of outline: their piece, ends u0 and u1, and the beam's segment: (k,) each."""

    piece: Index
    u0: Array
    u1: Array
    segment: Index

    def take(self, which: Array) -> Pieces:
        """Some of them."""
        return Pieces(self.piece[which], self.u0[which], self.u1[which], self.segment[which])

    def cut(self, count: int) -> Pieces:
        """Each cut into equal parts."""
        steps = np.linspace(0.0, 1.0, count + 1)
        marks = self.u0[:, None] + (self.u1 - self.u0)[:, None] * steps
        again = [np.repeat(values, count) for values in (self.piece, self.segment)]
        return Pieces(again[0], marks[:, :-1].ravel(), marks[:, 1:].ravel(), again[1])


@dataclass(frozen=True, eq=False)
class Survey:
    """What is known of the gap over the whole outline, by L.

    Parameters
    ----------
    min_gap
        Smallest sampled g / |grad g|.
    penetration_bound
        No point of the outline lies deeper (0 where none can lie inside at all).
    proved
        Whether the bound is proved, or rests on sampled sizes of grad g.
    deepest
        Samples in penetration that are the deepest of their neighbourhood: (piece, u) each.
    pieces, gaps
        The first sampling and g at the pieces' ends, (2, k).
    engulfed
        Whether the object's inner point lies within the finger.
    """

    min_gap: float
    penetration_bound: float
    proved: bool
    deepest: tuple[tuple[int, float], ...]
    pieces: Pieces
    gaps: Array
    engulfed: bool

    @property
    def clear(self) -> bool:
        """Whether no point of the outline lies inside by more than :data:`DEPTH`, and the object not in the finger."""
        return self.penetration_bound <= DEPTH and not self.engulfed


def survey(setting: Setting, obstacle: Obstacle, state: State) -> Survey:
    """Look for penetration over both faces, the end face and every edge of the jaw."""
    axis = Axis.of(state.beam, state.z)
    arc = _ArcBounds(setting, state)
    first = pieces = _whole(setting, state)
    proved, worst, nearest = True, np.inf, np.inf
    inside: list[tuple[int, float, float]] = []
    gaps = np.empty((2, 0))
    total = 0
    for round_ in range(_ROUNDS):
        p0, t0 = setting.outline.trace(axis, pieces.piece, pieces.u0, pieces.segment)
        p1, t1 = setting.outline.trace(axis, pieces.piece, pieces.u1, pieces.segment)
        g, normal = obstacle.slope(np.concatenate([p0, p1]))
        k = len(p0)
        size = np.maximum(np.hypot(*normal.T), 1e-6)
        depth = np.minimum(g[:k] / size[:k], g[k:] / size[k:])
        nearest = min(nearest, float(depth.min()))
        if round_ == 0:
            gaps = g.reshape(2, k)
            engulfed = _engulfed(setting, obstacle, pieces, p0)
        slopes = np.sum(normal[:k] * t0, axis=1), np.sum(normal[k:] * t1, axis=1)
        lower, sure = _lower_bound(obstacle, arc, pieces, (p0 + p1) / 2, (g[:k], g[k:]), slopes, size)
        lower = lower / np.minimum(size[:k], size[k:])
        proved &= sure
        deep = depth < -DEPTH
        at_end = g[k:] / size[k:] < g[:k] / size[:k]
        inside += list(zip(pieces.piece[deep], np.where(at_end, pieces.u1, pieces.u0)[deep], depth[deep], strict=True))
        total += k
        open_ = ~deep & (lower < -DEPTH)
        done = ~open_ if round_ < _ROUNDS - 1 and total < _MOST_PIECES else np.ones(k, dtype=bool)
        worst = min(worst, float(np.min(lower[done], initial=np.inf)))
        if done.all():
            break
        pieces = pieces.take(open_).cut(4)
    worst = min(worst, float(min((d for *_, d in inside), default=np.inf)))
    return Survey(nearest, max(0.0, -worst), proved, _deepest(inside), first, gaps, engulfed)


def _whole(setting: Setting, state: State) -> Pieces:
    """Both faces segment by segment, every rigid edge."""
    breaks = np.array(state.beam.breaks)
    n = state.beam.segments
    faces = Pieces(np.repeat([0, 1], n), np.tile(breaks[:-1], 2), np.tile(breaks[1:], 2), np.tile(np.arange(n), 2))
    faces = faces.cut(_PER_SEGMENT)
    edges = range(UPPER + 1, len(setting.outline.pieces))
    lengths = np.array([setting.outline.pieces[i].length for i in edges])
    rigid = Pieces(np.array(edges, dtype=np.intp), np.zeros(len(edges)), lengths, np.full(len(edges), n - 1)).cut(_PER_EDGE)
    return Pieces(*(np.concatenate([getattr(faces, f), getattr(rigid, f)]) for f in ("piece", "u0", "u1", "segment")))


class _ArcBounds:
    """Bounds of |c'| and |c''| over the faces, segment by segment; a rigid edge is straight with |c'| = 1."""

    def __init__(self, setting: Setting, state: State) -> None:
        kappa, kappa_slope, gamma_slope = state.beam.bounds(state.z)
        w, slope, curvature = setting.sections.thickness_bounds
        self.longest = 1 + slope / 2 + kappa * w / 2
        self.shortest = np.maximum(1 - slope / 2 - kappa * w / 2, 0.0)
        self.bent = kappa + gamma_slope + curvature / 2 + kappa * slope + kappa_slope * w / 2 + kappa**2 * w / 2

    def of(self, pieces: Pieces) -> tuple[Array, Array, Array]:
        """Max |c'|, min |c'|, max |c''| of each piece."""
        rigid = pieces.piece > UPPER
        e = pieces.segment
        return (
            np.where(rigid, 1.0, self.longest[e]),
            np.where(rigid, 1.0, self.shortest[e]),
            np.where(rigid, 0.0, self.bent[e]),
        )


def _lower_bound(
    obstacle: Obstacle,
    arc: _ArcBounds,
    pieces: Pieces,
    centers: Array,
    ends: tuple[Array, Array],
    slopes: tuple[Array, Array],
    sizes: Array,
) -> tuple[Array, bool]:
    h = pieces.u1 - pieces.u0
    longest, shortest, bent = arc.of(pieces)
    bounds = obstacle.bounds(centers, h * longest / 2)
    if bounds is None:
        steep, flat = _STEEPER * sizes.reshape(2, -1).max(axis=0), np.full(h.shape, -np.inf)
    else:
        steep, flat = bounds
    f0, f1 = ends
    plain = (f0 + f1 - steep * h * longest) / 2
    with np.errstate(invalid="ignore", over="ignore"):
        M = steep * bent - flat * np.where(flat < 0, longest, shortest) ** 2
    finite = np.isfinite(M)
    convex = finite & (M < 0)
    parabolas = _between_parabolas(f0, f1, *slopes, h, np.where(finite & (M > 0), M, 0.0))
    # a convex f lies above the vertex of either parabola
    stiff = np.where(convex, -M, 1.0)
    vertices = np.maximum(f0 - slopes[0] ** 2 / (2 * stiff), f1 - slopes[1] ** 2 / (2 * stiff))
    parabolas = np.where(convex, np.maximum(parabolas, vertices), parabolas)
    return np.where(finite, np.maximum(plain, parabolas), plain), bounds is not None


def _between_parabolas(f0: Array, f1: Array, slope0: Array, slope1: Array, h: Array, M: Array) -> Array:
    """Least value over [0, h] of the larger of two parabolas of second derivative -M, tangent to f at 0 and at h."""
    start = np.maximum(f0, f1 - slope1 * h - M * h**2 / 2)
    stop = np.maximum(f1, f0 + slope0 * h - M * h**2 / 2)
    # they cross once, where their difference, which is linear, vanishes
    fall = slope0 - slope1 - M * h
    crossing = np.divide(f1 - f0 - slope1 * h - M * h**2 / 2, fall, out=np.full(h.shape, -1.0), where=fall != 0)
    value = f0 + slope0 * crossing - M * crossing**2 / 2
    least = np.minimum(start, stop)
    return np.where((crossing > 0) & (crossing < h), np.minimum(least, value), least)


def _deepest(inside: list[tuple[int, float, float]]) -> tuple[tuple[int, float], ...]:
    """One sample for each connected stretch in penetration, the deepest."""
    found: list[tuple[int, float, float]] = []
    for piece, u, depth in sorted(inside, key=lambda sample: sample[2]):
        if not any(piece == other and abs(u - v) < 0.05 for other, v, _ in found):
            found.append((int(piece), float(u), depth))
    return tuple((piece, u) for piece, u, _ in found)


def _engulfed(setting: Setting, obstacle: Obstacle, pieces: Pieces, points: Array) -> bool:
    """Whether the object's inner point lies within the finger: then its outline may be clear and yet all is wrong."""
    inner = obstacle.place(np.asarray(obstacle.body.inner_point)[None])[0]
    if not np.isfinite(inner).all():
        return False
    polygon = np.concatenate([points[pieces.piece == 0], points[pieces.piece == 1][::-1]])
    a, b = polygon, np.roll(polygon, -1, axis=0)
    crosses = (a[:, 1] > inner[1]) != (b[:, 1] > inner[1])
    rise = np.where(crosses, b[:, 1] - a[:, 1], 1.0)
    x = a[:, 0] + (inner[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / rise
    return bool(np.sum(crosses & (x > inner[0])) % 2)
