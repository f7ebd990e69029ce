"""Contacts that a step changes, where its prediction tells: SLSQP need not look for those that are next.

A contact that runs off its edge goes over to the corner there, one at a corner to the edge that comes down beside it,
and one that would have to pull lets go.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import UPPER, Outline, dot
from gripper.contact.site import Site
from gripper.statics.active import held
from gripper.statics.candidates import resolved
from gripper.statics.certificate import Survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.settling import settle_contacts
from gripper.statics.verified import Verified, verify

_STRAIGHT = 1e-9  # curvature, by 1 / L
_INSIDE = 0.5  # of an edge: no further from its corner is the place first looked for


def handed_on(setting: Setting, obstacle: Obstacle, state: State) -> State:
    """A predicted state with those contacts alone that press, on the neighbours that they go over to.

    Only where points give way to points: not where shear spreads a force, whose patch has more than one way to shrink,
    nor with an object that has corners, which rolls on to them (:mod:`gripper.statics.rolling`).

    Parameters
    ----------
    setting, obstacle
        The object where the state is predicted.
    state
        With the contacts that there were before; it is returned itself where all of them stay.
    """
    if len(obstacle.corners) or any(site.spreads for site in state.sites):
        return state
    sites = tuple(_handed(setting, obstacle, state, site) for site in state.sites)
    handed = state if sites == state.sites else replace(state, sites=sites)
    if min(state.multipliers.tolist(), default=1.0) > 0:
        return handed
    return handed.keeping([load > 0 for load in state.multipliers.tolist()])


def with_deepest(setting: Setting, obstacle: Obstacle, state: State, known: Survey, order: int) -> Verified:
    """The equilibrium of a finger that nothing touches any more, or yet, but where the object lies deepest in it.

    Parameters
    ----------
    setting, obstacle
        Smooth.
    state
        Without contacts.
    known
        Of the state.
    order
        Of the strain fields.

    Raises
    ------
    NoEquilibriumError
        Where that place is not all that touches.
    """
    outline = setting.outline
    places = [(piece, u) for piece, u in known.deepest if outline.pieces[piece].on != "tip"]
    if state.sites or not places or known.engulfed or len(obstacle.corners):
        raise NoEquilibriumError("no single place tells what touches")
    # beside a corner that has sunk in, too, a face rather bends until it lies on the object than stands on its corner
    piece, u = min(places, key=lambda place: outline.corner_at(*place) is not None)
    if setting.theory != "bending" and _flat(setting, obstacle, state, piece, u):
        raise NoEquilibriumError("a face comes to lie flush on a straight edge: its place does not tell how far")
    guess = replace(state, sites=(resolved(setting, Site("tangent", piece, (u,))),), multipliers=np.zeros(1))
    return verify(setting, settle_contacts(setting, obstacle, held(setting, obstacle, state, guess), order))


def _flat(setting: Setting, obstacle: Obstacle, state: State, piece: int, u: float) -> bool:
    """Whether the object is straight where a place of the outline lies in it."""
    last = np.array([state.beam.segment_of(np.array([u]))[0] if piece <= UPPER else state.beam.segments - 1])
    points, tangents, _ = setting.outline.trace(state.axis, np.array([piece]), np.array([u]), last)
    _, _, (own, conjugate) = obstacle.curvature(points)
    return bool(dot(tangents, own * tangents + conjugate * tangents.conj())[0] <= _STRAIGHT)


def _handed(setting: Setting, obstacle: Obstacle, state: State, site: Site) -> Site:
    """The contact, or its neighbour."""
    if site.kind == "corner":
        return _beside(setting, obstacle, state, site)
    if site.kind != "tangent" or not _pointlike(setting, site.piece):
        return site
    end = min(max(site.place[0], 0.0), setting.outline.pieces[site.piece].length)
    corner = None if end == site.place[0] else setting.outline.corner_at(site.piece, end)
    return site if corner is None else replace(site, kind="corner", piece=corner, place=())


def _pointlike(setting: Setting, piece: int) -> bool:
    """Whether contacts on a piece stay points."""
    return piece > UPPER or setting.theory == "bending"


def _beside(setting: Setting, obstacle: Obstacle, state: State, site: Site) -> Site:
    """A contact at a corner of the outline, or where the gap is least on an edge along which it falls from there."""
    edges = [edge for edge in _edges(setting.outline, site.piece) if _pointlike(setting, edge[0])]
    if not edges:
        return site
    pieces, ends, ways = (np.array(values) for values in zip(*edges, strict=True))
    last = np.full(len(edges), state.beam.segments - 1)
    points, tangents, _ = setting.outline.trace(state.axis, pieces, ends, last)
    _, normals, (own, conjugate) = obstacle.curvature(points)
    along = ways * tangents
    falls, bends = -dot(normals, along), dot(along, own * along + conjugate * along.conj())
    for (piece, end, way), fall, bend in zip(edges, falls.tolist(), bends.tolist(), strict=True):
        if fall > 0 and bend > 0:
            inwards = min(fall / bend, _INSIDE * setting.outline.pieces[piece].length)
            return replace(site, kind="tangent", piece=piece, place=(end + way * inwards,))
    return site


@functools.lru_cache(maxsize=64)
def _edges(outline: Outline, corner: int) -> list[tuple[int, float, int]]:
    """The pieces beside a corner of the outline, the ends at which they meet it, and the way along them from there."""
    ends = [(piece, *end) for piece, edge in enumerate(outline.pieces) for end in ((0.0, 1), (edge.length, -1))]
    return [(piece, end, way) for piece, end, way in ends if outline.corner_at(piece, end) == corner]
