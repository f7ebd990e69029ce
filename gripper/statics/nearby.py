"""Where finger and object come near one another: candidates for contacts, least gaps, corners over faces."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from gripper.arrays import Array
from gripper.beam.axis import Axis
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER, dot, outward
from gripper.contact.site import Site
from gripper.statics.certificate import Survey
from gripper.statics.equilibrium import Setting, State
from gripper.statics.problem import Candidate, Problem
from gripper.statics.sampling import first_look

_FLAT = 1e-6  # least |grad g| that a gap is divided by to be a distance
_FEET = 6  # Newton steps to the foot of a normal
_GRAZED = 0.05  # of L: how much wider than the least sampled gap is looked at
_MARKS = np.linspace(0.0, 1.0, 33)  # of a stretch: where it is looked at for hollows of the object
_HOLLOW = 1e-5  # of L: a gap that rises by less between two minima has one


def sampled_gap(setting: Setting, obstacle: Obstacle, state: State) -> float:
    """The least gap at samples along the outline, by L: between them it may be less."""
    g, normal = obstacle.slope(first_look(setting, state).points)
    return float((g / np.maximum(np.abs(normal), _FLAT)).min())


def least_gaps(setting: Setting, obstacle: Obstacle, state: State, found: Survey) -> list[tuple[float, Site]]:
    """The gaps of the places that come nearest to the object, by L: negative where it penetrates, however little."""
    # what lies between two samples may be this much nearer
    unseen = float(np.max(found.pieces.u1 - found.pieces.u0)) / 2
    reach = max(found.min_gap, 0.0) + _GRAZED + unseen
    candidates = near(setting, obstacle, state, found, reach)
    if len(obstacle.corners):
        candidates += tuple(_smooth(setting, obstacle, state, found, reach))
    if not candidates:
        return []
    problem = Problem(setting, obstacle, state, candidates)
    gaps = problem.gaps(problem.x0) / setting.sections.length
    return list(zip(gaps.tolist(), problem.sites(problem.x0), strict=True))


def near(setting: Setting, obstacle: Obstacle, state: State, found: Survey, reach: float) -> tuple[Candidate, ...]:
    """Candidates within reach (by L) of the object: stretches with one minimum each, corners on both sides."""
    cornered = len(obstacle.corners) > 0
    candidates = [] if cornered else _smooth(setting, obstacle, state, found, reach)
    axis = state.axis
    outline = setting.outline
    numbers = np.array([outline.corner_piece(i) for i in range(len(outline.corners))], dtype=np.intp)
    if len(numbers):
        last = np.full(len(numbers), state.beam.segments - 1)
        points, *_ = outline.trace(axis, numbers, np.zeros(len(numbers)), last)
        gaps = obstacle.gap(points)
        candidates += [Candidate("corner", int(n)) for n, gap in zip(numbers, gaps, strict=True) if gap < reach]
    return tuple(candidates) + (_vertices(setting, obstacle, axis, found, reach) if cornered else ())


def _stretches(setting: Setting, state: State, found: Survey, reach: float) -> list[Candidate]:
    pieces, least = found.pieces, np.minimum(found.gaps, found.depths).min(axis=0)
    out: dict[tuple[int, int], Candidate] = {}
    for i in np.flatnonzero(least < reach):
        piece, segment = int(pieces.piece[i]), int(pieces.segment[i])
        if piece <= UPPER:
            ends = state.beam.breaks[segment], state.beam.breaks[segment + 1]
        else:
            segment, ends = -1, (0.0, setting.outline.pieces[piece].length)
        out[piece, segment] = Candidate("stretch", piece, *ends)
    return list(out.values())


def _smooth(setting: Setting, obstacle: Obstacle, state: State, found: Survey, reach: float) -> list[Candidate]:
    """Stretches within reach, cut where the gap is greatest between two minima: the object has another bump there."""
    stretches, axis = _stretches(setting, state, found, reach), state.axis
    if not stretches:
        return []
    u = np.array([c.start + (c.stop - c.start) * _MARKS for c in stretches])
    piece = np.array([c.piece for c in stretches])[:, None]
    inside = np.where(piece <= UPPER, u[:, 1:2], 1.0)
    which = (np.broadcast_to(values, u.shape).ravel() for values in (piece, u, axis.beam.segment_of(inside)))
    gaps = obstacle.gap(setting.outline.trace(axis, *which)[0]).reshape(u.shape)
    out: list[Candidate] = []
    for stretch, places, heights in zip(stretches, u.tolist(), gaps, strict=True):
        crests = _crests(heights)
        if not crests:
            out.append(stretch)
            continue
        near = reach + places[1] - places[0]  # what lies between two samples may be this much nearer
        for first, last in itertools.pairwise([0, *crests, len(places) - 1]):
            if heights[first : last + 1].min() < near:
                out.append(replace(stretch, start=places[first], stop=places[last]))
    return out


def _crests(heights: Array) -> list[int]:
    """The highest of samples between each two minima."""
    before, behind = np.minimum.accumulate(heights), np.minimum.accumulate(heights[::-1])[::-1]
    rise = heights - np.maximum(before, behind)
    top = int(np.argmax(rise))
    if rise[top] <= _HOLLOW:
        return []
    return [*_crests(heights[: top + 1]), top, *(top + i for i in _crests(heights[top:]))]


def _vertices(setting: Setting, obstacle: Obstacle, axis: Axis, found: Survey, reach: float) -> tuple[Candidate, ...]:
    """The object's corners that come nearest to a piece: lower than both their neighbours on the object."""
    out: list[Candidate] = []
    for piece, heights in vertex_heights(setting, obstacle, axis, found).items():
        lowest = (heights <= np.roll(heights, 1)) & (heights <= np.roll(heights, -1)) & (heights < reach)
        length = setting.outline.pieces[piece].length
        out += [Candidate("vertex", piece, 0.0, length, int(number)) for number in np.flatnonzero(lowest)]
    return tuple(out)


def vertex_heights(setting: Setting, obstacle: Obstacle, axis: Axis, found: Survey) -> dict[int, Array]:
    """Distance of each of the object's corners outside each piece, by L: negative where it has sunk through it.

    Infinite for a corner that has sunk so deep, or is behind a piece so far, that it belongs to another one.
    """
    pieces = found.pieces
    points, tangents, _ = setting.outline.trace(axis, pieces.piece, pieces.u0, pieces.segment)
    along = tangents / np.abs(tangents)
    away = obstacle.corners[:, None] - points[None, :]
    foot = np.clip(dot(away, along), 0.0, (pieces.u1 - pieces.u0) * np.abs(tangents))
    distances = np.abs(away - foot * along)
    heights = dot(away, outward(pieces.piece, along))
    nearest, each = pieces.piece[np.argmin(distances, axis=1)], np.arange(len(away))
    out = {}
    for piece in np.unique(pieces.piece).tolist():
        mine = np.flatnonzero(pieces.piece == piece)
        closest = mine[np.argmin(distances[:, mine], axis=1)]
        height = heights[each, closest]
        deepest = _half_thickness(setting, piece, pieces.u0[closest])
        sunk = np.where((nearest == piece) & (-height < deepest), height, np.inf)
        out[piece] = np.where(height < 0, sunk, distances[each, closest])
    return out


def vertex_height(setting: Setting, obstacle: Obstacle, axis: Axis, site: Site) -> float:
    """How far one of the object's corners is outside a piece, by L, near a place there; negative: sunk in."""
    piece, u, corner = np.array([site.piece]), np.array(site.place), obstacle.corners[site.vertex]
    end = setting.outline.pieces[site.piece].length
    place, tangent = 0j, 1 + 0j
    for _ in range(_FEET):
        segment = axis.beam.segment_of(u) if site.on_face else np.array([axis.beam.segments - 1])
        place, tangent = (complex(v[0]) for v in setting.outline.trace(axis, piece, u, segment)[:2])
        u = np.clip(u + ((corner - place) * tangent.conjugate()).real / abs(tangent) ** 2, 0.0, end)
    return float(((corner - place) * outward(site.piece, np.array(tangent)).conjugate()).real)


def _half_thickness(setting: Setting, piece: int, u: Array) -> Array:
    """How deep a corner may have sunk through a piece and still belong to it."""
    if piece in (LOWER, UPPER):
        return setting.sections.thickness(u) / 2
    return np.full(u.shape, setting.outline.pieces[piece].length / 2)
