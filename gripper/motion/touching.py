"""The first touch: from a finger that is free to the contacts that it has a step further on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gripper.contact.linear import linearise
from gripper.contact.obstacle import Obstacle
from gripper.contact.site import pointed
from gripper.motion.branch import Along
from gripper.motion.events import STRUT, head_on, touched_at
from gripper.motion.stride import Stride, check_moved
from gripper.statics.active import find
from gripper.statics.certificate import Survey, survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.handed import with_deepest
from gripper.statics.newton import unloaded
from gripper.statics.snap import distance
from gripper.statics.verified import Verified

NUDGE = 1e-7
"""Of L: how far beyond the first touch its contacts, and how they hold, are found."""
_DEPARTS = 0.5  # of a step: what it may differ from its prediction


def just_touched(stride: Stride, free: Along, following: float) -> float | None:
    """A little beyond the first touch of the free finger; None where that is the step's end, or it is grazed."""
    touch = touched_at(stride.setting, stride.path, free, following)
    rest = 0.0 if touch is None else stride.travel(touch, following, free.equilibrium.state)
    return touch + (following - touch) * NUDGE / rest if touch is not None and rest > NUDGE else None


def touched(stride: Stride, free: Along, following: float, order: int, known: Survey | None = None) -> Verified:
    """The finger is free and the object would penetrate it a step further on: the contacts there.

    Raises
    ------
    NoEquilibriumError
        Where it finds none that a single step leads to.
    """
    setting, path, start = stride.setting, stride.path, free.equilibrium.state
    try:
        found = _met(setting, setting.obstacle(path.frame(following)), start, order, known)
        state = found.equilibrium.state
        moved = distance(state, start)
        check_moved((*state.sites, *start.sites), moved, stride.travel(free.parameter, following, start))
        if distance(state, _pushed(setting, found, start, order)) > _DEPARTS * moved:
            raise NoEquilibriumError("the step departs from its prediction")
    except NoEquilibriumError as error:
        if head_on(setting, path, free, following):
            raise NoEquilibriumError(STRUT, error.effort) from error
        raise
    return found


def _met(setting: Setting, obstacle: Obstacle, free: State, order: int, known: Survey | None) -> Verified:
    """The contact of a finger that is free where it has sunk in; where there are others, SLSQP finds them."""
    known = known or survey(setting, obstacle, free, brief=True)
    try:
        return with_deepest(setting, obstacle, free, known, order)
    except NoEquilibriumError:
        return find(setting, obstacle, free, order, known)


def _pushed(setting: Setting, found: Verified, free: State, order: int) -> State:
    """The free finger bent by the least energy that closes the gaps where it touches now, to first order."""
    sites = tuple(pointed(site) for site in found.equilibrium.state.sites)
    beam, obstacle, none = setting.beam(sites, order), found.equilibrium.obstacle, np.zeros(len(sites))
    state = State(beam, np.zeros(beam.size))
    if obstacle.acting is not None:
        state = unloaded(setting, obstacle, order, free).state.on(beam)
    lin = linearise(state.beam, state.z, setting.outline, obstacle, sites, none, kinks=False)
    if lin.push is None:
        return replace(state, z=np.linalg.lstsq(lin.gradients, -lin.values)[0])
    yielding = np.linalg.solve(state.energy_hessian - lin.hessian, lin.gradients.T)
    return replace(state, z=state.z + yielding @ np.linalg.lstsq(lin.gradients @ yielding, -lin.values)[0])
