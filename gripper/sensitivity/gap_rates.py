"""How the least distance of a finger that touches nothing changes: of the nearest points, along their normal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.contact.outline import UPPER, Outline, dot
from gripper.contact.site import Site
from gripper.sensitivity.flow import flow
from gripper.sensitivity.seeds import Seeds, Solved
from gripper.sensitivity.touching import Touching
from gripper.statics.clearance import OFF, beside, feet_of
from gripper.statics.equilibrium import Equilibrium
from gripper.statics.newton import unloaded

_APART = 1e-6  # of L: nearer points have no direction of their own, that of a face is across it
_MARKS = 33  # of each piece
_ZOOMS = 6  # each sixteen times as near: to the distance's round-off


def gap_rates(seeds: Seeds, equilibrium: Equilibrium) -> Array:
    """Rates of the smallest distance of finger and object, in m, (p,): 0 where they touch.

    The nearest point of the outline stays on its piece: there the distance is least, or the piece ends in a corner.
    """
    if equilibrium.state.sites:
        return np.zeros(len(seeds.keys))
    solved, obstacle = seeds.solved(equilibrium), equilibrium.obstacle
    touching = Touching(seeds.setting, _looking(seeds, equilibrium), seeds.finger, seeds.loads)
    point = touching.points
    feet = feet_of(obstacle, point, beside(obstacle, point))
    foot, distance = feet.places, float(feet.distances[0])
    moved = _moved(seeds, touching, solved)
    corner = int(np.argmin(np.abs(obstacle.corners - point))) if len(obstacle.corners) else -1
    if corner >= 0 and abs(abs(obstacle.corners[corner] - point[0]) - distance) < OFF * (1 + distance):
        site, unit = touching.sites[0], (point - obstacle.corners[corner]) / max(distance, _APART)
        if distance < _APART and site.place:
            unit = touching.side(site) * 1j * touching.tangents / np.abs(touching.tangents)
        rate = dot(unit, moved - seeds.corner(obstacle, solved.frames, corner))
    else:
        normal = obstacle.slope(foot)[1]
        unit = normal / np.abs(normal)
        rate = dot(unit, moved) + seeds.passing(obstacle, solved.frames, foot)[0][:, 0] / abs(normal[0])
    return np.asarray((rate + distance * seeds.log_length) * seeds.setting.sections.length)


def meeting_rates(seeds: Seeds, parameter: float, order: int) -> Array:
    """Rates of where on the motion the free finger meets its object, (p,): there the least distance vanishes.

    Parameters
    ----------
    seeds
        Of the numbers, with the motion's parameter after them.
    parameter
        Where.
    order
        Of the strain fields.
    """
    obstacle = seeds.setting.obstacle(seeds.kinematics.frame(parameter))
    rates = gap_rates(seeds, unloaded(seeds.setting, obstacle, order))
    return np.asarray(-rates[:-1] / rates[-1])


def _moved(seeds: Seeds, touching: Touching, solved: Solved) -> Complex:
    """Rates of the one point that is looked at, (p,)."""
    known = solved.rates.change
    change = seeds.change(touching, solved.frames)
    change = replace(change, coefficients=known.coefficients, base_turns=known.base_turns)
    found: Complex = flow(touching, change).points[:, 0]
    return found


def _looking(seeds: Seeds, equilibrium: Equilibrium) -> Equilibrium:
    """The equilibrium with the outline's point that is nearest to the object as a contact without a force."""
    outline = seeds.setting.outline
    piece, u = _nearest(outline, equilibrium)
    corner = outline.corner_at(piece, u) if piece > UPPER else None
    site = Site("node", piece, (u,)) if corner is None else Site("corner", corner, ())
    return replace(equilibrium, state=replace(equilibrium.state, sites=(site,), multipliers=np.zeros(1)))


def _nearest(outline: Outline, equilibrium: Equilibrium) -> tuple[int, float]:
    """The piece of the outline that is nearest to the object, and where on it: zoomed in on."""
    state, obstacle = equilibrium.state, equilibrium.obstacle
    lengths = np.array([piece.length for piece in outline.pieces])

    def distances(piece: Index, u: Array) -> Array:
        segment = np.where(piece <= UPPER, state.beam.segment_of(u), state.beam.segments - 1)
        points = outline.trace(state.axis, piece, u, segment)[0]
        return feet_of(obstacle, points, beside(obstacle, points)).distances

    pieces = np.repeat(np.arange(lengths.size), _MARKS)
    marks = (lengths[:, None] * np.linspace(0.0, 1.0, _MARKS)).ravel()
    rough = distances(pieces, marks)
    rivals = np.unique(pieces[rough <= rough.min() + lengths[pieces] / (_MARKS - 1)])
    found = [_zoomed(distances, int(piece), float(lengths[piece]), marks, rough) for piece in rivals]
    _, piece, u = min(found)
    return piece, u


def _zoomed(
    distances: Callable[[Index, Array], Array], piece: int, length: float, marks: Array, rough: Array
) -> tuple[float, int, float]:
    """The least distance of a piece, the piece, and where on it."""
    own = slice(piece * _MARKS, (piece + 1) * _MARKS)
    marks, values = marks[own], rough[own]
    for _ in range(_ZOOMS):
        best = int(np.argmin(values))
        low, high = marks[max(best - 1, 0)], marks[min(best + 1, _MARKS - 1)]
        if best in (0, _MARKS - 1) and marks[best] in (0.0, length):
            closer = distances(np.full(1, piece), np.array([(low + high) / 2]))
            if closer[0] >= values[best]:
                break  # it ends there
        marks = np.linspace(low, high, _MARKS)
        values = distances(np.full(_MARKS, piece), marks)
    best = int(np.argmin(values))
    return float(values[best]), piece, float(marks[best])
