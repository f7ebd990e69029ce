"""Where a contact lets go, or comes: its multiplier vanishes on the branch that has it."""

from __future__ import annotations

import numpy as np

from gripper.contact.features import Feature
from gripper.motion.branch import (
    SHARP,
    STILL,
    Along,
    Branch,
    Path,
    bracketed,
    branch_from,
    joined,
    number,
    pointed_at,
    speed,
)
from gripper.motion.pinned import Pin
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting

_ROUNDS = 8  # of Newton's method, of which three or four are needed
_LATE = 1e-3  # of L: a contact may be told that much late, while it lies within the penetration allowed


def released(setting: Setting, path: Path, known: Along, other: Along, feature: Feature, order: int) -> float:
    """Where a contact's multiplier vanishes on the branch of a known equilibrium, the contact held beyond.

    Beside a contact on the same edge a gap may close so slowly that the step's other end, which does not have the
    contact yet, or any more, lies behind that place: the branches meet there all the same.

    Raises
    ------
    NoEquilibriumError
        Where it does not, or where something else has touched before.
    """
    i = number(known, feature)
    near = Along(known.parameter, pointed_at(setting, known.equilibrium, i, order))
    branch = branch_from(setting, path, near, order)
    where = let_go(branch, i, known.parameter, other.parameter)
    if where is None:
        where = bracketed(lambda parameter: pressing(branch.at(parameter), i), known.parameter, other.parameter)
    there = branch.at(where)
    if not survey(setting, there.obstacle, there.state).clear:
        raise NoEquilibriumError("something else touches before")
    return joined(setting, path, Along(where, there), other, order)


def let_go(branch: Branch, i: int, start: float, stop: float) -> float | None:
    """Where a contact's multiplier vanishes, by Newton's method on its rate; None where that leaves the step."""
    at, way = start, stop - start
    late = max(1.0, _LATE / (speed(branch.known[0].equilibrium) * abs(way) + STILL))
    row = _row(branch.known[0].equilibrium, i)
    where = branch.pinned(start, Pin(row, 0.0), (start, stop + late * way))
    if where is not None:
        return where
    for _ in range(_ROUNDS):  # where the equations are all but singular: equilibrium by equilibrium
        try:
            equilibrium = branch.at(at)
            rate = float(equilibrium.tangent()[1][_row(equilibrium, i)])
        except (NoEquilibriumError, np.linalg.LinAlgError):
            return None  # the bracket is searched instead
        step = -pressing(equilibrium, i) / rate if rate else np.inf
        if abs(step) <= SHARP * abs(way):
            return at
        at += step
        if not 0 <= (at - start) / way <= 1 + late:
            return None
    return None


def pressing(equilibrium: Equilibrium, i: int) -> float:
    """The multiplier of a contact: 0 where it is released, or was not yet touched."""
    return float(equilibrium.state.multipliers[_row(equilibrium, i)])


def _row(equilibrium: Equilibrium, i: int) -> int:
    """The number of a contact's first multiplier."""
    return sum(site.multipliers for site in equilibrium.state.sites[:i])
