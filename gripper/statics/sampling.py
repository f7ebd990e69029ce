"""Stretches of outline between samples: where they are, and how far and how sharply they run."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.contact.outline import LOWER, UPPER, Outline
from gripper.statics.equilibrium import Setting, State

DEPTH = 5e-7
"""Penetration that counts as none, by L."""
_PER_SEGMENT = 8
_PER_EDGE = 4
_CUT = 5
_UNBOUNDED = 1e300  # for a thickness without a proved bound: times no curvature it is still 0


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
class Seen:
    """Stretches of outline, and c, c' and kappa at samples (p,): each stretch runs from one to the next."""

    pieces: Pieces
    ends: Index  # the samples at both ends of each stretch, (2, k)
    points: Complex
    tangents: Complex
    kappa: Array
    bounds: Array  # of :func:`_bounds`, of the stretches' segments, (5, k)
    thick: float  # bound of w / 2, by L

    @functools.cached_property
    def lengths(self) -> Array:
        """How far each stretch runs along its piece, (k,)."""
        return self.pieces.u1 - self.pieces.u0

    @functools.cached_property
    def _bent(self) -> tuple[Array, Array]:
        """Upper bounds of |kappa|, and of what that adds to the speed of faces, (k,)."""
        first, last = np.abs(self.kappa)[self.ends]
        kappa = np.maximum(first, last) + self.bounds[0] * (self.lengths / 2)
        return kappa, kappa * self.thick

    @functools.cached_property
    def longest(self) -> Array:
        """Upper bounds of |c'| over each stretch, (k,)."""
        longest: Array = self.bounds[1] + self._bent[1]
        return longest

    @functools.cached_property
    def curved(self) -> tuple[Array, Array]:
        """Lower bounds of |c'| and upper bounds of |c''| over each stretch, (k,)."""
        kappa, added = self._bent
        _, _, slowest, sheared, rest = self.bounds
        return np.maximum(slowest - added, 0.0), kappa * (sheared + added) + rest


def _bounds(setting: Setting, state: State) -> tuple[Array, float]:
    """What bounds |c'| and |c''| on each of a beam's segments, and on what is rigid (a straight edge with |c'| = 1).

    With bounds W, W' and W'' of w / 2 and its derivatives: that of |kappa'|; of |r'| + W'; from below, of |r'| - W'; of
    |r'| + 2 W'; and of |r''| less |kappa r'|, + W |kappa'| + W'': (5, segments + 1). And W.
    """
    kappa_slope, strain_slope = state.beam.slope_bounds(state.axis.fields)
    if setting.sections.rest is not None:
        kappa_slope = kappa_slope + setting.sections.rest.bounds[1]
    slowest, fastest = state.beam.speed_bounds(state.axis.fields)
    thick, slope, curvature = (min(bound / 2, _UNBOUNDED) for bound in setting.sections.thickness_bounds)
    out = np.zeros((5, state.beam.segments + 1))
    out[1:3, -1] = 1.0
    out[0, :-1], out[4, :-1] = kappa_slope, strain_slope + kappa_slope * thick + curvature
    out[1, :-1], out[2, :-1], out[3, :-1] = fastest + slope, slowest - slope, fastest + 2 * slope
    return out, thick


@functools.lru_cache(maxsize=8)  # the straight finger is looked at again and again, with the object elsewhere
def first_look(setting: Setting, state: State) -> Seen:
    """Both faces segment by segment, every rigid edge."""
    plan = _plan(setting.outline, state.beam.segments)
    s, position, psi, along, kappa = state.axis.evenly(_PER_SEGMENT + 1)
    if setting.sections.rest is not None:
        kappa = kappa + setting.sections.rest.curvature(s)[0]
    w, slope, _ = setting.sections.profile(s)
    turn = np.exp(1j * psi)
    across = (0.5j * w) * turn  # from the axis to the upper face
    turning = 1j * kappa * across + (0.5j * slope) * turn
    points = np.concatenate([position - across, position + across, position[-1] + plan.offsets * turn[-1]])
    tangents = np.concatenate([along - turning, along + turning, plan.directions * turn[-1]])
    u = np.concatenate([s, s, plan.rigid])
    u0, u1 = u[plan.ends]
    pieces = Pieces(plan.piece, u0, u1, plan.segment)
    curvature = np.concatenate([kappa, kappa, plan.straight])
    bounds, thick = _bounds(setting, state)
    return Seen(pieces, plan.ends, points, tangents, curvature, bounds[:, plan.bounded], thick)


@dataclass(frozen=True, eq=False)
class _Plan:
    """How the whole outline is sampled: both faces at the same stations of the axis, rigid edges from the tip.

    Piece, segment and column of its bounds of each stretch, (k,); of samples on rigid edges u, the offset P from the
    end section and its rate, (r,), in this section's frame; the samples at both ends of each stretch, (2, k).
    """

    piece: Index
    segment: Index
    bounded: Index  # column of its bounds
    rigid: Array
    offsets: Complex
    directions: Complex
    straight: Array  # no curvature there
    ends: Index


@functools.lru_cache(maxsize=64)
def _plan(outline: Outline, segments: int) -> _Plan:
    edges, each = np.arange(UPPER + 1, len(outline.pieces)), _PER_SEGMENT + 1
    lengths = np.array([piece.length for piece in outline.pieces])[edges]
    rigid = (lengths[:, None] * np.linspace(0.0, 1.0, _PER_EDGE + 1)).ravel()
    _, offsets, directions, _ = outline.offsets(edges.repeat(_PER_EDGE + 1), rigid)
    faces = np.repeat([LOWER, UPPER], segments * _PER_SEGMENT)
    along = np.tile(np.arange(segments).repeat(_PER_SEGMENT), 2)
    ends = [_neighbours(2 * segments, each), 2 * segments * each + _neighbours(len(edges), _PER_EDGE + 1)]
    return _Plan(
        np.concatenate([faces, edges.repeat(_PER_EDGE)]),
        np.concatenate([along, np.full(edges.size * _PER_EDGE, segments - 1)]),
        np.concatenate([along, np.full(edges.size * _PER_EDGE, segments)]),
        rigid,
        offsets,
        directions,
        np.zeros(rigid.size),
        np.concatenate(ends, axis=1),
    )


def _neighbours(rows: int, each: int) -> Index:
    """The samples at both ends of each stretch, of rows with a number of samples each, (2, k)."""
    numbers = np.arange(rows * each).reshape(rows, each)
    return np.array([numbers[:, :-1].ravel(), numbers[:, 1:].ravel()])


def cut(setting: Setting, state: State, seen: Seen, which: Array) -> Seen:
    """Some stretches cut into equal parts."""
    pieces = seen.pieces.take(which)
    marks = pieces.u0[:, None] + (pieces.u1 - pieces.u0)[:, None] * np.linspace(0.0, 1.0, _CUT + 1)
    piece, segment = pieces.piece.repeat(_CUT + 1), pieces.segment.repeat(_CUT + 1)
    u = marks.ravel()
    ends = _neighbours(len(pieces.u0), _CUT + 1)
    first, last = ends
    parts = Pieces(piece[first], u[first], u[last], segment[first])
    bounds = seen.bounds[:, which].repeat(_CUT, axis=1)
    return Seen(parts, ends, *setting.outline.trace(state.axis, piece, u, segment), bounds, seen.thick)
