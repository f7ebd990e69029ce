"""The distance between finger and object: of a free finger the least way to the object, in contact 0 (or less)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.contact.obstacle import Frame, Obstacle
from gripper.contact.outline import dot
from gripper.objects import Object
from gripper.objects.compiled import PerInstance
from gripper.statics.equilibrium import Setting, State
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
_SETTLED = 1e-10  # of L: what the last of them would still gain, where nothing else is asked
_STILL = Frame(0j, 0.0, 0j, 0.0)
_AT_ONCE = 64  # poses: some megabytes
_WIDER = 2.0  # g / |grad g| may be off a distance by this much: samples within it are looked at


def clearance(setting: Setting, verified: Verified, settled: float = _SETTLED) -> float:
    """Smallest distance of outline and object, by L; negative: depth. Where it is positive, it may be off by that."""
    return clearances(setting, [verified], settled)[0]


def clearances(setting: Setting, poses: Sequence[Verified], settled: float = _SETTLED) -> list[float]:
    """Those of several poses of one motion, by L: where the finger stays as it is, all are found in one go."""
    found, apart = [0.0] * len(poses), dict[int, list[int]]()
    for i, verified in enumerate(poses):
        survey, lin = verified.survey, verified.equilibrium.linear
        if lin.points:
            found[i] = min(survey.min_gap, float(np.max(np.abs(lin.values), initial=0.0)))
        elif survey.min_gap < 0:
            found[i] = survey.min_gap
        else:
            apart.setdefault(id(verified.equilibrium.state), []).append(i)
    for alike in apart.values():
        for first in range(0, len(alike), _AT_ONCE):
            some = alike[first : first + _AT_ONCE]
            for i, distance in zip(some, _distances(setting, [poses[i] for i in some], settled).tolist(), strict=True):
                found[i] = distance
    return found


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


@dataclass(frozen=True, eq=False)
class _Views:
    """A finger as its object sees it from several poses: from points of the clamp's frame to points of the object's."""

    origins: Complex  # of the object, (m,)
    turns: Complex  # from the clamp's axes to the object's, (m,)

    @classmethod
    def of(cls, poses: Sequence[Verified]) -> _Views:
        """Those of some poses."""
        frames = [verified.equilibrium.obstacle.frame for verified in poses]
        turns = np.exp([-1j * frame.angle for frame in frames])
        return cls(np.array([frame.origin for frame in frames]), turns)

    def take(self, which: Index) -> _Views:
        """Those of some poses, (k,)."""
        return _Views(self.origins[which], self.turns[which])

    def points(self, points: Complex) -> Complex:
        """Points (..., m) of the clamp's frame, each seen from its pose."""
        return (points - self.origins) * self.turns


def _distances(setting: Setting, poses: Sequence[Verified], settled: float) -> Array:
    """The least distances of one deflected finger, which touches nothing, at several poses of the object, (m,).

    They are least over the sampled outline, and between samples where they may be less.
    """
    state = poses[0].equilibrium.state
    seen, views, still = first_look(setting, state), _Views.of(poses), setting.obstacle(_STILL)
    depths = np.array([verified.survey.depths for verified in poses]).min(axis=1)
    # a small object lies between two samples
    pose, close = np.nonzero(depths <= _WIDER * depths.min(axis=1)[:, None] + seen.lengths)
    samples, where = np.unique(pose * seen.points.size + seen.ends[:, close], return_inverse=True)
    sampled, sample = np.divmod(samples, seen.points.size)
    from_there = views.take(sampled)
    points, tangents = from_there.points(seen.points[sample]), seen.tangents[sample] * from_there.turns
    feet = feet_of(still, points, beside(still, points))
    least = np.full(len(poses), np.inf)
    np.minimum.at(least, sampled, feet.distances)
    first, last = where.reshape(2, -1)
    slopes, speeds = dot(feet.outward, tangents), np.abs(tangents)
    spacing = seen.lengths[close]
    arc = spacing * np.maximum(speeds[first], speeds[last])
    lower = (feet.distances[first] + feet.distances[last] - arc) / 2
    turning = np.flatnonzero((slopes[first] < 0) & (slopes[last] > 0) & (lower < least[pose]))
    if not turning.size:
        return least
    pose, first, last = pose[turning], first[turning], last[turning]
    start = np.where(feet.distances[first] < feet.distances[last], first, last)
    stretches = _Stretches(seen.pieces.take(close[turning]), views.take(pose))
    bent = (tangents[last] - tangents[first]) / spacing[turning]
    ends = slopes[first], slopes[last]
    np.minimum.at(least, pose, _between(setting, state, stretches, ends, feet.places[start], bent, settled))
    return least


@dataclass(frozen=True, eq=False)
class _Stretches:
    """Stretches of outline, each with the pose that it is seen from, (k,)."""

    pieces: Pieces
    views: _Views

    def at(self, setting: Setting, state: State, u: Array) -> tuple[Complex, Complex]:
        """Points and tangents at u (k,), as the object sees them."""
        points, tangents, _ = setting.outline.trace(state.axis, self.pieces.piece, u, self.pieces.segment)
        return self.views.points(points), tangents * self.views.turns


def _between(
    setting: Setting,
    state: State,
    stretches: _Stretches,
    ends: tuple[Array, Array],
    foot: Complex,
    bent: Complex,
    settled: float,
) -> Array:
    """The least distances on stretches of outline where they have a minimum, (k,): Newton's method, kept within.

    Parameters
    ----------
    setting, state
        The finger.
    stretches
        Of its outline, (k,).
    ends
        The distance's slope where each starts, where it falls, and where it stops, (k,) both.
    foot
        On the object, near the feet, (k,).
    bent
        The outline's second derivatives there, roughly, (k,).
    settled
        By L: what the last step would still gain.
    """
    still = setting.obstacle(_STILL)
    low, high, (falls, rises) = stretches.pieces.u0, stretches.pieces.u1, ends
    u, least = low + (high - low) * falls / (falls - rises), np.full(foot.size, np.inf)
    for step in range(_NEARER):
        points, tangents = stretches.at(setting, state, u)
        feet = feet_of(still, points, foot)
        foot, least = feet.places, np.minimum(least, feet.distances)
        slope = dot(feet.outward, tangents)
        # the second derivative of the distance along a straight outline, taken along all of c' as where d is a cone
        rise = feet.bends * np.abs(tangents) ** 2 + dot(feet.outward, bent)
        low, high = np.where(slope < 0, u, low), np.where(slope > 0, u, high)
        falls, rises = np.where(slope < 0, slope, falls), np.where(slope > 0, slope, rises)
        moved = u - slope / np.where(rise > 0, rise, np.inf)
        # along a polygon the slope goes by steps: a secant, and the middle in turns
        between = low + (high - low) * (falls / (falls - rises) if step % 2 == 0 else 0.5)
        moved = np.where((rise > 0) & (moved > low) & (moved < high), moved, between)
        if (np.abs(slope * (moved - u)) < settled).all():
            break
        u = moved
    return least
