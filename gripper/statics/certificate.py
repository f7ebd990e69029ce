"""Penetration over the whole outline: found where it is, bounded where it is not.

Stretches of outline between samples that could still hide a penetration (:mod:`gripper.statics.beneath`) are cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array
from gripper.contact.obstacle import Obstacle
from gripper.statics.beneath import Ends, lower_bound
from gripper.statics.equilibrium import Setting, State
from gripper.statics.hidden import engulfed, sunken_corners
from gripper.statics.sampling import DEPTH, Pieces, cut, first_look

_ROUNDS = 14
_MOST_PIECES = 60_000


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
    pieces, gaps, depths
        The first sampling, and g and g / |grad g| at the ends of its pieces, (2, k) each.
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
    first, looked = seen.pieces, Ends.of(obstacle, seen)
    ends, proved, worst, nearest = looked, True, np.inf, np.inf
    inside: list[tuple[int, float, float]] = []
    total = 0
    for round_ in range(_ROUNDS):
        pieces = seen.pieces
        total += pieces.u0.size
        lower, sure = lower_bound(obstacle, seen, ends)
        lower = lower / ends.steepness.min(axis=0)
        proved &= sure
        depth = ends.depths.min(axis=0)
        least = float(depth.min())
        nearest = min(nearest, least)
        open_ = lower < -DEPTH
        if least < -DEPTH:
            deep = depth < -DEPTH
            u = np.where(ends.depths[1] < ends.depths[0], pieces.u1, pieces.u0)
            inside += list(zip(pieces.piece[deep], u[deep], depth[deep], strict=True))
            open_ &= ~deep
        last = round_ == _ROUNDS - 1 or total > _MOST_PIECES or (brief and least < -DEPTH)
        if last or not open_.any():
            worst = min(worst, float(lower.min()))
            break
        worst = min(worst, float(np.min(lower, where=~open_, initial=np.inf)))
        seen = cut(setting, state, seen, open_)
        ends = Ends.of(obstacle, seen)
    worst = min([worst, *(depth for *_, depth in inside)])
    return Survey(
        min_gap=nearest,
        penetration_bound=max(0.0, -worst),
        proved=proved,
        deepest=_deepest(inside),
        pieces=first,
        gaps=looked.g,
        depths=looked.depths,
        engulfed=engulfed(setting, obstacle, first, looked.points),
        sunken=sunken_corners(setting, obstacle, state.axis, first, looked.points),
        least=worst,
    )


def _deepest(inside: list[tuple[int, float, float]]) -> tuple[tuple[int, float], ...]:
    """One sample for each connected stretch in penetration, the deepest."""
    found: list[tuple[int, float, float]] = []
    for piece, u, depth in sorted(inside, key=lambda sample: sample[2]):
        if not any(piece == other and abs(u - v) < 0.05 for other, v, _ in found):
            found.append((int(piece), float(u), depth))
    return tuple((piece, u) for piece, u, _ in found)
