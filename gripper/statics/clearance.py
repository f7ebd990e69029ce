"""The distance between finger and object: of a free finger the least way to the object, in contact 0 (or less)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import dot
from gripper.objects import Object
from gripper.objects.compiled import PerInstance
from gripper.statics.equilibrium import Setting
from gripper.statics.sampling import Pieces, first_look
from gripper.statics.verified import Verified

_FEET = 60  # six do; many where g is far from a parabola
_TURN = 0.5  # rad: the most that a foot goes round its circle of curvature in a step
_COARSE = 1e-3  # of an object's size: how near chords between samples of its outline are
OFF = 1e-7
"""Of L: a foot that near is on the outline."""
_ARRIVED = (
    1e-4  # last step, relative: what is left of a foot's way is its square, and of the distance the square of that
)
_NEARER = 40  # steps to the least distance between two samples: three do where finger and object are smooth
_SETTLED = 1e-10  # of L: what the last of them would still gain
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


@dataclass(frozen=True, eq=False)
class Feet:
    """Of points outside an object: the feet of their normals, how far these are, and the way there; (k,) each."""

    places: Complex
    distances: Array
    outward: Complex  # unit vectors from the feet to the points
    bends: Array  # curvature of the line of this distance: kappa / (1 + kappa d)


def distances(obstacle: Obstacle, points: Complex) -> Array:
    """Distances of points outside to the object, by L: to the feet of the normals, found by Newton's method."""
    return feet_of(obstacle, points, beside(obstacle, points)).distances


def beside(obstacle: Obstacle, points: Complex) -> Complex:
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


def feet_of(obstacle: Obstacle, points: Complex, foot: Complex) -> Feet:
    """The feet of points, found from others nearby."""
    g, normal, (a, b) = obstacle.curvature(points)
    if np.all(np.abs(np.abs(normal) - 1) < 1e-9):  # g is the distance itself
        return _past_corners(obstacle, points, Feet(points - g * normal, g, normal, _bend(1j * normal, a, b)))
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
    found = np.abs(points - foot)
    outward = np.where(found > 0, (points - foot) / np.where(found > 0, found, 1.0), unit)
    return _past_corners(
        obstacle, points, Feet(foot, found, outward, curvature / np.maximum(1 + curvature * found, 0.5))
    )


def _bend(tangent: Complex, a: Array, b: Complex) -> Array:
    """An object's Hessian (a, b) along tangents."""
    bend: Array = a + (b * tangent.conj() ** 2).real
    return bend


def _past_corners(obstacle: Obstacle, points: Complex, feet: Feet) -> Feet:
    """The feet found, but the nearest corner for one that is off the outline: beyond its edges' ends."""
    if not len(obstacle.corners):
        return feet
    off = np.flatnonzero(np.abs(obstacle.gap(feet.places)) > OFF * (1 + feet.distances))
    if off.size:
        corner = obstacle.corners[np.abs(points[off, None] - obstacle.corners).argmin(axis=1)]
        away = points[off] - corner
        feet.places[off], feet.distances[off] = corner, np.abs(away)
        feet.outward[off] = away / np.maximum(feet.distances[off], 1e-300)
        feet.bends[off] = 1 / np.maximum(feet.distances[off], 1e-300)
    return feet


def _distance(setting: Setting, verified: Verified) -> float:
    """The least distance over the sampled outline, and between samples where it may be less."""
    state, obstacle, survey = verified.equilibrium.state, verified.equilibrium.obstacle, verified.survey
    seen = first_look(setting, state)
    spacing = seen.pieces.u1 - seen.pieces.u0
    rough = survey.depths.min(axis=0)
    close = np.flatnonzero(rough <= _WIDER * rough.min() + spacing)  # a small object lies between two samples
    samples, where = np.unique(seen.ends[:, close], return_inverse=True)
    points, tangents = seen.points[samples], seen.tangents[samples]
    feet = feet_of(obstacle, points, beside(obstacle, points))
    least = float(feet.distances.min())
    first, last = where.reshape(2, -1)
    slopes, speeds = dot(feet.outward, tangents), np.abs(tangents)
    arc = spacing[close] * np.maximum(speeds[first], speeds[last])
    lower = (feet.distances[first] + feet.distances[last] - arc) / 2
    turning = np.flatnonzero((slopes[first] < 0) & (slopes[last] > 0) & (lower < least))
    if not turning.size:
        return least
    first, last = first[turning], last[turning]
    start = np.where(feet.distances[first] < feet.distances[last], first, last)
    stretches = seen.pieces.take(close[turning])
    bent = (tangents[last] - tangents[first]) / spacing[close[turning]]
    falls, rises = slopes[first], slopes[last]
    return min(least, _between(setting, verified, stretches, (falls, rises), feet.places[start], bent))


def _between(
    setting: Setting, verified: Verified, stretches: Pieces, ends: tuple[Array, Array], foot: Complex, bent: Complex
) -> float:
    """The least distance on stretches of outline where it has a minimum: Newton's method, kept within.

    Parameters
    ----------
    setting, verified
        The finger and its equilibrium.
    stretches
        Of the outline, (k,).
    ends
        The distance's slope where each starts, where it falls, and where it stops, (k,) both.
    foot
        On the object, near the feet, (k,).
    bent
        The outline's second derivatives there, roughly, (k,).
    """
    state, obstacle = verified.equilibrium.state, verified.equilibrium.obstacle
    low, high, (falls, rises) = stretches.u0, stretches.u1, ends
    u, least = low + (high - low) * falls / (falls - rises), np.inf
    for step in range(_NEARER):
        points, tangents, _ = setting.outline.trace(state.axis, stretches.piece, u, stretches.segment)
        feet = feet_of(obstacle, points, foot)
        foot, least = feet.places, min(least, float(feet.distances.min()))
        slope = dot(feet.outward, tangents)
        # the second derivative of the distance along a straight outline, taken along all of c' as where d is a cone
        rise = feet.bends * np.abs(tangents) ** 2 + dot(feet.outward, bent)
        low, high = np.where(slope < 0, u, low), np.where(slope > 0, u, high)
        falls, rises = np.where(slope < 0, slope, falls), np.where(slope > 0, slope, rises)
        moved = u - slope / np.where(rise > 0, rise, np.inf)
        # along a polygon the slope goes by steps: a secant, and the middle in turns
        between = low + (high - low) * (falls / (falls - rises) if step % 2 == 0 else 0.5)
        moved = np.where((rise > 0) & (moved > low) & (moved < high), moved, between)
        if (np.abs(slope * (moved - u)) < _SETTLED).all():
            break
        u = moved
    return least
