"""Penetration over the whole outline: found where it is, bounded where it is not.

On a piece of outline between two samples, g along it is f(t) with f'' >= -M, where

    M = K max|c''| - lambda min|c'|^2   (max|c'|^2 where lambda < 0),

K bounding |grad g| and lambda bounding the Hessian's eigenvalues from below over a disc that holds the piece. So f
lies above two parabolas, one from each end, and above (f0 + f1 - K * arc length) / 2 in any case. Pieces that could
still hide a penetration are cut.
"""

from __future__ import annotations

import cmath
import functools
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.axis import Axis
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER, Outline, crossings, dot
from gripper.statics.equilibrium import Setting, State

DEPTH = 5e-7
"""Penetration that counts as none, by L."""
_PER_SEGMENT = 8
_PER_EDGE = 4
_ROUNDS = 14
_MOST_PIECES = 60_000
_CUT = 5
_CLOSE = 0.15  # of L: corners of the object nearer than this to a sample are looked at exactly
_ASIDE = 0.03  # of L: a corner that much outside the tangent at the nearest sample is not in the finger
_FEET = 6
_SETTLED = 1e-10  # of L: a foot that moves by less is found
_FLAT = 1e-6  # least |grad g| that a gap is divided by to be a distance
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
    pieces, points, gaps, depths
        The first sampling, where its pieces start, (k,), and g and g / |grad g| at their ends, (2, k) each.
    engulfed
        Whether the object's inner point lies within the finger or its jaw.
    sunken
        Corners of the object that lie in the finger, by (piece, u) of the nearest outline: a needle's outline may be
        in no outline's way, and its tip yet be in the finger.
    least
        A lower bound of the gap over the whole outline: above 0 nothing touches.
    """

    min_gap: float
    penetration_bound: float
    proved: bool
    deepest: tuple[tuple[int, float], ...]
    pieces: Pieces
    points: Complex
    gaps: Array
    depths: Array
    engulfed: bool
    sunken: tuple[tuple[int, float], ...]
    least: float

    @property
    def clear(self) -> bool:
        """Whether no point of the outline lies inside by more than :data:`DEPTH`, and the object not in the finger."""
        return self.penetration_bound <= DEPTH and not self.engulfed and not self.sunken


def survey(setting: Setting, obstacle: Obstacle, state: State, *, brief: bool = False) -> Survey:
    """Look for penetration over both faces, the end face and every edge of the jaw.

    A brief one stops at the first sampling where that finds penetration.
    """
    seen = first_look(setting, state)
    first, arc = seen.pieces, _ArcBounds(setting, state)
    proved, engulfed, worst, nearest = True, False, np.inf, np.inf
    inside: list[tuple[int, float, float]] = []
    gaps = rough = points = np.empty((2, 0))
    sunken: tuple[tuple[int, float], ...] = ()
    total = 0
    for round_ in range(_ROUNDS):
        pieces, ends = seen.pieces, _Ends.of(obstacle, seen)
        total += len(pieces.u0)
        depths = ends.g / ends.steepness
        if round_ == 0:
            points, gaps, rough, engulfed = (
                ends.points,
                ends.g,
                depths,
                _engulfed(setting, obstacle, pieces, ends.points),
            )
            sunken = _sunken_corners(setting, obstacle, state.axis, pieces, ends.points)
        nearest = min(nearest, float(depths.min()))
        lower, sure = _lower_bound(obstacle, arc, pieces, ends)
        lower = lower / ends.steepness.min(axis=0)
        proved &= sure
        depth = depths.min(axis=0)
        deep = depth < -DEPTH
        if deep.any():
            u = np.where(depths[1] < depths[0], pieces.u1, pieces.u0)
            inside += list(zip(pieces.piece[deep], u[deep], depth[deep], strict=True))
        open_ = ~deep & (lower < -DEPTH)
        last = round_ == _ROUNDS - 1 or total > _MOST_PIECES or (brief and bool(deep.any()))
        done = np.ones_like(open_) if last else ~open_
        worst = min(worst, float(np.min(lower[done], initial=np.inf)))
        if done.all():
            break
        seen = _cut(setting, state, pieces.take(open_))
    worst = min(worst, min((depth for *_, depth in inside), default=np.inf))
    least = float(worst)
    return Survey(
        nearest, max(0.0, -least), proved, _deepest(inside), first, points[0], gaps, rough, engulfed, sunken, least
    )


@dataclass(frozen=True, eq=False)
class _Ends:
    """Both ends of each piece, (2, k): points, g, |grad g|, dg/du and kappa."""

    points: Complex
    g: Array
    steepness: Array
    slopes: Array
    kappa: Array

    @classmethod
    def of(cls, obstacle: Obstacle, seen: Seen) -> _Ends:
        g, normal = obstacle.slope(seen.points)
        values = (seen.points, g, np.maximum(np.abs(normal), _FLAT), dot(normal, seen.tangents), seen.kappa)
        return cls(*(value[seen.ends] for value in values))


@dataclass(frozen=True, eq=False)
class Seen:
    """Stretches of outline, and c, c' and kappa at samples (p,): each stretch runs from one to the next."""

    pieces: Pieces
    ends: Index  # the samples at both ends of each stretch, (2, k)
    points: Complex
    tangents: Complex
    kappa: Array


@functools.lru_cache(maxsize=8)  # the straight finger is looked at again and again, with the object elsewhere
def first_look(setting: Setting, state: State) -> Seen:
    """Both faces segment by segment, every rigid edge."""
    plan = _plan(setting.outline, state.beam.segments)
    s, *values = state.axis.evenly(_PER_SEGMENT + 1)
    u = np.concatenate([s, s, plan.rigid])
    s = s[plan.station]
    offsets = setting.outline.offsets(plan.piece, u)[1:]
    position, psi, along, kappa = (value[plan.station] for value in values)
    points, tangents, kappa = setting.outline.lifted(plan.piece, s, offsets, (position, psi, along, kappa))
    first, last = plan.ends
    pieces = Pieces(plan.piece[first], u[first], u[last], plan.segment[first])
    return Seen(pieces, plan.ends, points, tangents, kappa)


@dataclass(frozen=True, eq=False)
class _Plan:
    """Where the whole outline is sampled: piece, segment and station (of those read from the axis) of samples (p,)."""

    piece: Index
    segment: Index
    station: Index
    rigid: Array  # u of the samples on rigid edges, the last ones
    ends: Index


@functools.lru_cache(maxsize=64)
def _plan(outline: Outline, segments: int) -> _Plan:
    """Both faces read at the same stations, rigid edges from the last one: the tip."""
    edges, each = np.arange(UPPER + 1, len(outline.pieces)), _PER_SEGMENT + 1
    lengths = np.array([piece.length for piece in outline.pieces])[edges]
    rigid = lengths[:, None] * np.linspace(0.0, 1.0, _PER_EDGE + 1)
    faces, along = np.repeat([LOWER, UPPER], segments * each), np.tile(np.arange(segments).repeat(each), 2)
    stations = np.tile(np.arange(segments * each), 2)
    ends = [_neighbours(2 * segments, each), faces.size + _neighbours(len(edges), _PER_EDGE + 1)]
    return _Plan(
        np.concatenate([faces, edges.repeat(_PER_EDGE + 1)]),
        np.concatenate([along, np.full(rigid.size, segments - 1)]),
        np.concatenate([stations, np.full(rigid.size, segments * each - 1)]),
        rigid.ravel(),
        np.concatenate(ends, axis=1),
    )


def _neighbours(rows: int, each: int) -> Index:
    """The samples at both ends of each stretch, of rows with a number of samples each, (2, k)."""
    numbers = np.arange(rows * each).reshape(rows, each)
    return np.array([numbers[:, :-1].ravel(), numbers[:, 1:].ravel()])


def _cut(setting: Setting, state: State, pieces: Pieces) -> Seen:
    """Each stretch cut into equal parts."""
    marks = pieces.u0[:, None] + (pieces.u1 - pieces.u0)[:, None] * np.linspace(0.0, 1.0, _CUT + 1)
    piece, segment = pieces.piece.repeat(_CUT + 1), pieces.segment.repeat(_CUT + 1)
    u = marks.ravel()
    ends = _neighbours(len(pieces.u0), _CUT + 1)
    first, last = ends
    parts = Pieces(piece[first], u[first], u[last], segment[first])
    return Seen(parts, ends, *setting.outline.trace(state.axis, piece, u, segment))


class _ArcBounds:
    """Bounds of |c'| and |c''| over stretches of the faces; a rigid edge is straight with |c'| = 1."""

    def __init__(self, setting: Setting, state: State) -> None:
        self.kappa_slope, self.strain_slope = state.beam.slope_bounds(state.axis.fields)
        if setting.sections.rest is not None:
            self.kappa_slope = self.kappa_slope + setting.sections.rest.bounds[1]
        self.slowest, self.fastest = state.beam.speed_bounds(state.axis.fields)
        self.thickness = setting.sections.thickness_bounds

    def of(self, pieces: Pieces, kappas: Array) -> tuple[Array, Array, Array]:
        """Max |c'|, min |c'|, max |c''| of each piece, kappa being known at its ends (2, k)."""
        w, slope, curvature = self.thickness
        flexible = pieces.piece <= UPPER
        kappa_slope, strain_slope = self.kappa_slope[pieces.segment], self.strain_slope[pieces.segment]
        slowest, fastest = self.slowest[pieces.segment], self.fastest[pieces.segment]
        kappa = np.abs(kappas).max(axis=0) + kappa_slope * (pieces.u1 - pieces.u0) / 2
        stretched = slope / 2 + kappa * w / 2
        bent = kappa * fastest + strain_slope + curvature / 2 + kappa * slope + kappa_slope * w / 2 + kappa**2 * w / 2
        return (
            np.where(flexible, fastest + stretched, 1.0),
            np.where(flexible, np.maximum(slowest - stretched, 0.0), 1.0),
            np.where(flexible, bent, 0.0),
        )


def _lower_bound(obstacle: Obstacle, arc: _ArcBounds, pieces: Pieces, ends: _Ends) -> tuple[Array, bool]:
    """A lower bound of g over each piece, and whether it is proved."""
    h = pieces.u1 - pieces.u0
    longest, shortest, bent = arc.of(pieces, ends.kappa)
    bounds = obstacle.bounds(ends.points.mean(axis=0), h * longest / 2)
    if bounds is None:
        steep, flat = _STEEPER * ends.steepness.max(axis=0), np.full(h.shape, -np.inf)
    else:
        steep, flat = bounds
    (f0, f1), slopes = ends.g, ends.slopes
    plain = (f0 + f1 - steep * h * longest) / 2
    if plain.min() > 0:
        return plain, bounds is not None
    with np.errstate(invalid="ignore", over="ignore"):
        M = steep * bent - flat * np.where(flat < 0, longest, shortest) ** 2
    finite = np.isfinite(M)
    convex = finite & (M < 0)
    parabolas = _between_parabolas(f0, f1, slopes[0], slopes[1], h, np.where(finite & (M > 0), M, 0.0))
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


def _engulfed(setting: Setting, obstacle: Obstacle, pieces: Pieces, points: Complex) -> bool:
    """Whether the object's inner point lies within the finger: then its outline may be clear and yet all is wrong."""
    inner = obstacle.inner_point
    if not cmath.isfinite(inner):
        return False
    spacing = float(np.max(pieces.u1 - pieces.u0)) * 2
    starts, stops = points
    if np.abs(points - inner).min() > spacing + max(setting.outline.room, setting.sections.thickness_bounds[0]):
        return False
    lower, upper = (pieces.piece == face for face in (LOWER, UPPER))
    polygons = [np.concatenate([starts[lower], stops[lower][-1:], stops[upper][-1:], starts[upper][::-1]])]
    jaw = [i for i, piece in enumerate(setting.outline.pieces) if piece.on == "jaw"]
    if jaw:
        polygons.append(starts[np.isin(pieces.piece, jaw)])
    return any(bool(np.sum(crossings(inner, polygon)) % 2) for polygon in polygons)


def _sunken_corners(
    setting: Setting, obstacle: Obstacle, axis: Axis, pieces: Pieces, ends: Complex
) -> tuple[tuple[int, float], ...]:
    """Corners of the object that lie deeper than :data:`DEPTH` behind the nearest piece of the outline."""
    corners, points = obstacle.corners, ends[0]
    if not len(corners):
        return ()
    near = np.flatnonzero(_around(corners, points))
    near = near[np.abs(corners[near, None] - points).min(axis=1, initial=np.inf) < _CLOSE]
    if not len(near):
        return ()
    nearest = np.argmin(_to_chords(corners[near], ends), axis=1)
    tangent = setting.outline.trace(axis, pieces.piece[nearest], pieces.u0[nearest], pieces.segment[nearest])[1]
    outside = dot(points[nearest] - corners[near], 1j * tangent / np.abs(tangent)) * _sides(pieces.piece[nearest])
    close, nearest = near[outside < _ASIDE], nearest[outside < _ASIDE]
    if not len(close):
        return ()
    piece, segment, u = pieces.piece[nearest], pieces.segment[nearest], pieces.u0[nearest]
    ends = np.array([p.length for p in setting.outline.pieces])[piece]
    for _ in range(_FEET):
        place, tangent, _ = setting.outline.trace(axis, piece, u, segment)
        along = (tangent.conj() * (corners[close] - place)).real / np.abs(tangent) ** 2
        moved = np.clip(u + along, 0.0, ends)
        settled = np.abs(moved - u).max() < _SETTLED
        u, face = moved, piece <= UPPER
        segment = np.where(face, axis.beam.segment_of(u * face), segment)
        if settled:
            break
    place, tangent, _ = setting.outline.trace(axis, piece, u, segment)
    height = dot(place - corners[close], 1j * tangent / np.abs(tangent)) * _sides(piece)
    half = setting.sections.thickness(np.where(piece <= UPPER, u, 1.0)) / 2
    inside = (height < -DEPTH) & (height > -half) & (u > 0) & (u < ends)
    for i in np.flatnonzero(inside & (piece > UPPER)):  # a thin jaw's far side is near, too
        part = [p for p, other in enumerate(setting.outline.pieces) if other.on == setting.outline.pieces[piece[i]].on]
        ring = points[np.isin(pieces.piece, part if len(part) > 1 else (LOWER, UPPER))]
        inside[i] = bool(np.sum(crossings(complex(corners[close[i]]), ring)) % 2)
    return tuple(zip(piece[inside].tolist(), u[inside].tolist(), strict=True))


def _to_chords(places: Complex, ends: Complex) -> Array:
    """Distances of places (n,) to the chords between ends (2, k): (n, k)."""
    chord, away = ends[1] - ends[0], places[:, None] - ends[0]
    along = np.clip(dot(away, chord) / np.abs(chord) ** 2, 0.0, 1.0)
    return np.abs(away - along * chord)


def _around(places: Complex, points: Complex) -> Array:
    """Which places lie within :data:`_CLOSE` of the box about points."""
    x, y = (
        np.clip(places.real, points.real.min(), points.real.max()),
        np.clip(places.imag, points.imag.min(), points.imag.max()),
    )
    return np.abs(places - (x + 1j * y)) < _CLOSE


def _sides(piece: Index) -> Array:
    """Which side of the tangent is inside: left of it (1), on the upper face right (-1)."""
    return np.where(piece == UPPER, -1.0, 1.0)
