"""The distance between finger and object: of a free finger the least way to the object, in contact 0 (or less)."""

from __future__ import annotations

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import UPPER, dot
from gripper.contact.parabola import vertex
from gripper.objects import Object
from gripper.objects.compiled import PerInstance
from gripper.statics.equilibrium import Setting
from gripper.statics.verified import Verified

_FEET = 60  # six do; many where g is far from a parabola
_TURN = 0.5  # rad: the most that a foot goes round its circle of curvature in a step
_COARSE = 1e-3  # of an object's size: how near chords between samples of its outline are
_OFF = 1e-7  # of L: a foot that near is on the outline
_ARRIVED = (
    1e-4  # last step, relative: what is left of a foot's way is its square, and of the distance the square of that
)
_MARKS = np.linspace(-1.0, 1.0, 9)
_ZOOMS = 7
_COARSER = 4.0  # the same as the marks' spacing: of an object that is small and near against it
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
    return _distances(obstacle, points, _beside(obstacle, points))[0]


def _beside(obstacle: Obstacle, points: Complex) -> Complex:
    """The sample of the object's outline nearest to each point: feet of other normals lie about it."""
    samples = obstacle.place(_samples(obstacle.body))
    if not samples.size:
        return points
    near: Complex = samples[np.abs(points[:, None] - samples).argmin(axis=1)]
    return near


def _sampled(body: Object) -> Complex:
    """Points of an outline (k,), in m, in the object's frame; none of one without bounds."""
    box = body.box
    if not np.all(np.isfinite(box)):
        return np.empty(0, dtype=complex)
    lines = body.outline(tolerance=_COARSE * max(box[2] - box[0], box[3] - box[1]))
    return np.concatenate([line[:, 0] + 1j * line[:, 1] for line in lines])


_samples: PerInstance[Object, Complex] = PerInstance(_sampled)


def _distances(obstacle: Obstacle, points: Complex, foot: Complex) -> tuple[Array, Complex]:
    """The distances and the feet, found from others nearby."""
    g, normal = obstacle.slope(points)
    if np.all(np.abs(np.abs(normal) - 1) < 1e-9):
        foot = points - g * normal
        return _past_corners(obstacle, points, g, foot), foot  # g is the distance itself
    for _ in range(_FEET):
        g, normal, (a, b) = obstacle.curvature(foot)
        size = np.maximum(np.abs(normal), 1e-12)
        unit = normal / size
        tangent, away = 1j * unit, points - foot
        # on to g = 0 along the normal, where the parabola has its root: a g that grows as the square of the distance
        # is met in one step; along the tangent to the foot of the point on the circle of curvature
        turn = (b * tangent.conj() ** 2).real  # of the Hessian: a + turn along the tangent, a - turn along the normal
        down = 2 * g / (size + np.sqrt(np.maximum(size**2 - 2 * g * (a - turn), 0.0)))
        curvature = (a + turn) / size
        aside = dot(away, tangent) / np.maximum(1 + curvature * dot(away, unit), 0.5)
        aside *= 1 / np.maximum(np.abs(aside * curvature) / _TURN, 1.0)
        step = aside * tangent - down * unit
        foot = foot + step
        if (np.abs(step) < _ARRIVED * (_ARRIVED + np.abs(away))).all():
            break
    return _past_corners(obstacle, points, np.abs(points - foot), foot), foot


def _past_corners(obstacle: Obstacle, points: Complex, found: Array, foot: Complex) -> Array:
    """The distances found, but to the nearest corner where the foot is off the outline: beyond its edges' ends."""
    if not len(obstacle.corners):
        return found
    off = np.flatnonzero(np.abs(obstacle.gap(foot)) > _OFF * (1 + found))
    found[off] = np.abs(points[off, None] - obstacle.corners).min(axis=1)
    return found


def _distance(setting: Setting, verified: Verified) -> float:
    """The least distance over the sampled outline, zoomed in on where it may be least on each of its pieces."""
    obstacle, survey = verified.equilibrium.obstacle, verified.survey
    pieces, rough = survey.pieces, survey.depths[0]
    spacing = pieces.u1 - pieces.u0
    close = np.flatnonzero(rough <= _WIDER * rough.min() + spacing)  # a small object lies between two samples
    points = survey.points[close]
    found, feet = _distances(obstacle, points, _beside(obstacle, points))
    least = float(np.min(found))
    for piece in np.unique(pieces.piece[close]).tolist():
        mine = np.flatnonzero(pieces.piece[close] == piece)
        best = int(mine[np.argmin(found[mine])])
        if found[best] - spacing[close[best]] < least:
            place = float(pieces.u0[close[best]]), float(spacing[close[best]])
            least = min(least, _zoomed(setting, verified, piece, place, complex(feet[best]), float(found[best])))
    return least


def _zoomed(
    setting: Setting, verified: Verified, piece: int, place: tuple[float, float], foot: complex, least: float
) -> float:
    """The least distance on a piece about a place, known to that spacing, its foot and its distance."""
    state, obstacle = verified.equilibrium.state, verified.equilibrium.obstacle
    (u, step), length = place, setting.outline.pieces[piece].length
    which, size = np.full(_MARKS.size, piece), setting.body.inner_radius / setting.sections.length
    for _ in range(_ZOOMS):
        marks = (u + step * _MARKS).clip(0.0, length)
        segment = state.beam.segment_of(marks) if piece <= UPPER else np.full(marks.size, state.beam.segments - 1)
        points = setting.outline.trace(state.axis, which, marks, segment)[0]
        found, feet = _distances(obstacle, points, np.full(marks.size, foot))
        i = int(np.argmin(found))
        foot = feet[i]
        (u, lowest), least = vertex(marks, found, i), min(least, float(found[i]))
        beside = found[max(i - 1, 0) : i + 2]
        if least - lowest < _SETTLED and np.ptp(beside) < _SMOOTH * step:
            break
        step /= _FINER if step < 2 * (least + size) else _COARSER
    return least
