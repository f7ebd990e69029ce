"""What touches, as a name that stays along a motion: faces, edges, corners of the finger and of the object."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from gripper.contact.outline import Outline
from gripper.contact.site import Site, corners_of

Feature = tuple[Literal["flank", "corner", "vertex"], int, int, int]
"""Its kind, the piece of the outline, the object's corner (or -1), and which one of these along the piece."""

_CONFORMING = 0.06  # of L: nodes nearer to one another than this are one contact
_TOGETHER = 0.02  # of L: the object's corners that are nearer to one another carry as one
_ANOTHER = 0.05  # of L: a contact that is so much further than expected is another one
_KINDS: dict[str, Literal["flank", "corner", "vertex"]] = {"corner": "corner", "vertex": "vertex"}


def conform(one: Site, other: Site) -> bool:
    """Whether neighbouring contacts on one piece belong to one stretch that conforms to the object."""
    if one.piece != other.piece or "node" not in (one.kind, other.kind):
        return False
    first, last = sorted((one.place, other.place))
    return last[0] - first[-1] < _CONFORMING


def _lies_beside(corner: Site, site: Site) -> bool:
    """Whether a face that lies on a flat carries both at the flat's first corner and beside it."""
    return corner.kind == "vertex" and site.grip is not None and site.grip.flush


def features(sites: tuple[Site, ...]) -> dict[Feature, int]:
    """What touches, and the number of its site; a patch that ends in the tip's corner is the corner."""
    found: dict[Feature, int] = {}
    last = -1
    for i in sorted(range(len(sites)), key=lambda i: (sites[i].piece, sites[i].place)):
        site = sites[i]
        if site.kind in ("tail", "span"):
            continue
        key = _KINDS.get(site.kind, "flank"), site.piece, site.vertex
        if last < 0 or not conform(sites[last], site) or _lies_beside(sites[last], site):
            found[*key, sum(other[:3] == key for other in found)] = i
        last = i
    return found


def gone_and_come(
    old: tuple[Site, ...], new: tuple[Site, ...], moves: Sequence[float] = ()
) -> tuple[list[Feature], list[Feature]]:
    """What touches in the old state alone, and in the new one alone.

    Of several contacts on one piece those go on that are nearest to each other, in their order along it.

    Parameters
    ----------
    old, new
        The contacts of both.
    moves
        How far each old contact is expected to move along its piece, where that is known: one that is much further
        away is another one, at another bump of the object.
    """
    before, after = features(old), features(new)
    gone, come = [], []
    for kind in dict.fromkeys(feature[:3] for feature in (*before, *after)):
        olds = [feature for feature in before if feature[:3] == kind]
        news = [feature for feature in after if feature[:3] == kind]
        ahead = [old[before[f]].middle + (moves[before[f]] if len(moves) else 0.0) for f in olds]
        reached = [new[after[f]].middle for f in news]
        pairs = _nearest(ahead, reached)
        if len(moves):
            rolled = [2 * abs(moves[before[f]]) + _ANOTHER for f in olds]
            pairs = [(i, j) for i, j in pairs if abs(ahead[i] - reached[j]) < rolled[i]]
        gone += [feature for k, feature in enumerate(olds) if k not in {i for i, _ in pairs}]
        come += [feature for k, feature in enumerate(news) if k not in {j for _, j in pairs}]
    return gone, come


def stayed(old: tuple[Site, ...], new: tuple[Site, ...]) -> bool:
    """Whether the contacts of two neighbouring states are the same, as all are of one kind and near each other.

    However far they were expected to move, :func:`gone_and_come` then finds nothing gone, and nothing come.
    """
    return len(old) == len(new) and all(
        (a.kind, a.piece, a.vertex) == (b.kind, b.piece, b.vertex) and abs(a.middle - b.middle) < _ANOTHER
        for a, b in zip(old, new, strict=True)
    )


def _nearest(one: Sequence[float], other: Sequence[float]) -> list[tuple[int, int]]:
    """Which of the places in both belong together, as many as the shorter one has."""
    if len(one) > len(other):
        return [(i, j) for j, i in _nearest(other, one)]
    choices = itertools.combinations(range(len(other)), len(one))
    best = min(choices, key=lambda chosen: float(np.abs(np.subtract([other[k] for k in chosen], one)).sum()))
    return list(enumerate(best))


def neighbours(sites: Sequence[Site], i: int, reach: float = _TOGETHER) -> list[int]:
    """A corner of the object on a piece, and the others within reach (by L) of it there, or with pressure up to it."""
    own = sites[i]
    if own.kind != "vertex":
        return [i]
    linked = [pair for pair in (corners_of(sites, j) for j in range(len(sites))) if i in pair]
    mine = [j for j, site in enumerate(sites) if (site.kind, site.piece) == (own.kind, own.piece)]
    return [j for j in mine if abs(sites[j].middle - own.middle) < reach or any(j in pair for pair in linked)]


def apart_from(sites: tuple[Site, ...], found: Sequence[Feature], one: Feature) -> list[Feature]:
    """Without one of them, and without the object's corners beside it: they roll on with it."""
    numbers = features(sites)
    group = neighbours(sites, numbers[one])
    return [feature for feature in found if numbers[feature] not in group]


def feature_name(outline: Outline, feature: Feature) -> str:
    """What a feature is called in an event."""
    kind, piece, vertex, _ = feature
    on = outline.place(piece, np.zeros(1))[0]
    if kind == "vertex":
        return f"the object's corner {vertex} on {on}"
    return f"corner of {on}" if kind == "corner" else on


def named(outline: Outline, site: Site) -> str:
    """What a contact is called in an event."""
    plain = replace(site, kind="patch") if site.kind in ("tail", "span") else site
    return feature_name(outline, next(iter(features((plain,)))))


def transition(outline: Outline, old: tuple[Site, ...], new: tuple[Site, ...]) -> str:
    """What changes between two states so near that they are one place of the motion."""
    gone, come = gone_and_come(old, new)
    if len(gone) == len(come) == 1:
        return f"{feature_name(outline, gone[0])} to {feature_name(outline, come[0])}"
    return "several contacts at once"
