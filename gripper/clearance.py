"""The distance between finger and object: of a free finger the least way to the object, in contact 0 (or less)."""

from __future__ import annotations

import numpy as np

from gripper.arrays import Array, Complex
from gripper.equilibrium import Setting
from gripper.obstacle import Obstacle
from gripper.outline import UPPER, dot
from gripper.parabola import vertex
from gripper.verified import Verified

_FEET = 60  # far from the object each step halves the way that is left, near it Newton's doubles the digits
_OFF = 1e-7  # of L: a foot that near is on the outline
_ARRIVED = 1e-8  # of L: the distance of a foot that is off by this much is right to its square
_MARKS = np.linspace(-1.0, 1.0, 9)
_ZOOMS = 7
_FINER = 16.0  # a parabola's vertex is that much nearer than the samples
_SETTLED = 1e-10  # of L
_SMOOTH = 0.01  # of the marks' spacing: two neighbours together rise by less where the distance has no corner
_WIDER = 2.0  # g / |grad g| may be off a distance by this much: samples within it are looked at


def clearance(setting: Setting, verified: Verified) -> float:
    """Smallest distance of outline and object, by L; negative: depth."""
    survey, lin = verified.survey, verified.equilibrium.linear
    if lin.points:
        touching = float(np.max(np.abs(lin.values), initial=0.0))
        return min(survey.min_gap, touching)
    if survey.min_gap < 0:
        return survey.min_gap
    return _distance(setting, verified)


def distances(obstacle: Obstacle, points: Complex) -> Array:
    """Distances of points outside to the object, by L: to the feet of the normals, found by Newton's method."""
    g, normal = obstacle.slope(points)
    if np.all(np.abs(np.abs(normal) - 1) < 1e-9):
        return _past_corners(obstacle, points, g, points - g * normal)  # g is the distance itself
    size = np.maximum(np.abs(normal), 1e-12)
    foot = points - g / size**2 * normal
    for _ in range(_FEET):
        g, normal, (a, b) = obstacle.curvature(foot)
        size = np.maximum(np.abs(normal), 1e-12)
        unit = normal / size
        tangent, away = 1j * unit, points - foot
        # on to g = 0 along the normal; along the tangent to the foot of the point on the circle of curvature
        curvature = (a + (b * tangent.conj() ** 2).real) / size
        widening = np.maximum(1 + curvature * dot(away, unit), 0.5)
        step = dot(away, tangent) / widening * tangent - g / size * unit
        foot = foot + step
        if np.abs(step).max() < _ARRIVED:
            break
    return _past_corners(obstacle, points, np.abs(points - foot), foot)


def _past_corners(obstacle: Obstacle, points: Complex, found: Array, foot: Complex) -> Array:
    """The distances found, but to the nearest corner where the foot is off the outline: beyond its edges' ends."""
    if not len(obstacle.corners):
        return found
    off = np.flatnonzero(np.abs(obstacle.gap(foot)) > _OFF * (1 + found))
    found[off] = np.abs(points[off, None] - obstacle.corners).min(axis=1)
    return found


def _distance(setting: Setting, verified: Verified) -> float:
    """The least distance over the sampled outline, zoomed in on where it is least."""
    state, obstacle, survey = verified.equilibrium.state, verified.equilibrium.obstacle, verified.survey
    pieces, rough = survey.pieces, survey.depths[0]
    close = np.flatnonzero(rough <= _WIDER * rough.min() + 1e-9)
    points = setting.outline.trace(state.axis, pieces.piece[close], pieces.u0[close], pieces.segment[close])[0]
    found = distances(obstacle, points)
    best = int(close[np.argmin(found)])
    u, piece, least = float(pieces.u0[best]), int(pieces.piece[best]), float(np.min(found))
    step, length = float(pieces.u1[best] - pieces.u0[best]), setting.outline.pieces[piece].length
    which = np.full(_MARKS.size, piece)
    for _ in range(_ZOOMS):
        marks = (u + step * _MARKS).clip(0.0, length)
        segment = state.beam.segment_of(marks) if piece <= UPPER else np.full(marks.size, state.beam.segments - 1)
        found = distances(obstacle, setting.outline.trace(state.axis, which, marks, segment)[0])
        i = int(np.argmin(found))
        (u, lowest), least = vertex(marks, found, i), min(least, float(found[i]))
        beside = found[max(i - 1, 0) : i + 2]
        if least - lowest < _SETTLED and np.ptp(beside) < _SMOOTH * step:
            break
        step /= _FINER
    return least
