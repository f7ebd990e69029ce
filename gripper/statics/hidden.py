"""Objects in the finger that no sample of its outline tells of: engulfed ones, and corners that have sunk in."""

from __future__ import annotations

import cmath
import functools
import math

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.axis import Axis
from gripper.contact.obstacle import Frame, Obstacle
from gripper.contact.outline import LOWER, UPPER, crossings, dot
from gripper.statics.equilibrium import Setting
from gripper.statics.sampling import DEPTH, Pieces

_CLOSE = 0.15  # of L: corners of the object nearer than this to a sample are looked at exactly
_ASIDE = 0.03  # of L: a corner that much outside the tangent at the nearest sample is not in the finger
_FEET = 6
_SETTLED = 1e-10  # of L: a foot that moves by less is found
_STRETCH = 0.08  # of L: more than half of the longest stretch between two samples
_STILL = Frame(0j, 0.0, 0j, 0.0)


def engulfed(setting: Setting, obstacle: Obstacle, pieces: Pieces, points: Complex) -> bool:
    """Whether the object's inner point lies within the finger: then its outline may be clear and yet all is wrong.

    Parameters
    ----------
    setting, obstacle
        Finger and object.
    pieces
        Stretches of the whole outline.
    points
        Both ends of each, (2, k).
    """
    if _too_large(setting):
        return False
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


@functools.lru_cache(maxsize=64)
def _too_large(setting: Setting) -> bool:
    """Whether the object's inner point cannot lie in the finger without samples of its outline in the object.

    No point of the finger is further from its outline than half its thickness: an object that is proved to fill a
    larger disc about its inner point, by enough for a sample to lie in it, would hold such samples.
    """
    obstacle = setting.obstacle(_STILL)
    inner = np.array([obstacle.inner_point])
    radius = math.hypot(max(setting.sections.thickness_bounds[0] / 2, setting.outline.room), _STRETCH)
    if not (cmath.isfinite(inner[0]) and math.isfinite(radius)):
        return False
    bounds = obstacle.bounds(inner, np.array([radius]))
    return bounds is not None and float(obstacle.gap(inner)[0] + bounds[0][0] * radius) < -DEPTH


def sunken_corners(
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
