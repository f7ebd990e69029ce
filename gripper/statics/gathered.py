"""The contacts of an equilibrium gathered one by one: with friction they may be others than without.

SLSQP's are those of the frictionless finger. Where friction keeps one on, or brings another sooner, contacts are
taken in where the object penetrates, and let go where they would pull, until neither is left.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gripper.contact.obstacle import Obstacle
from gripper.contact.site import Site
from gripper.statics.active import held
from gripper.statics.candidates import resolved, violated
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State
from gripper.statics.problem import Candidate, Problem
from gripper.statics.settling import settle_contacts
from gripper.statics.verified import PULL, Verified, verify

_ROUNDS = 6


def gathered(setting: Setting, obstacle: Obstacle, start: State, guess: State, order: int) -> Verified:
    """Equilibrium from a guess of some of its contacts.

    Parameters
    ----------
    setting, obstacle
        Finger and object.
    start
        The last equilibrium, whose holds go on.
    guess
        Where to start from.
    order
        Of the strain fields.

    Raises
    ------
    NoEquilibriumError
        Where none is found that verifies.
    """
    known: tuple[Candidate, ...] = ()
    for _ in range(_ROUNDS):
        equilibrium = settle_contacts(setting, obstacle, guess, order)
        state = equilibrium.state
        least = PULL * float(np.max(np.abs(state.multipliers), initial=0.0))
        keep = [float(load.min()) >= -least for load in state.loads]
        if not any(keep):
            raise NoEquilibriumError("no contact presses")
        if not all(keep):
            guess = held(setting, obstacle, start, state.keeping(keep))  # what carries on in its place holds as it did
            continue
        candidate, come = _penetrated(setting, equilibrium, known)
        if come is None:
            return verify(setting, equilibrium)
        known += candidate
        sites = (*state.sites, replace(come, grip=None))
        guess = held(setting, obstacle, start, State(state.beam, state.z, sites, np.append(state.multipliers, 0.0)))
    raise NoEquilibriumError("the contacts come and go without end")


def _penetrated(
    setting: Setting, equilibrium: Equilibrium, known: tuple[Candidate, ...]
) -> tuple[tuple[Candidate, ...], Site | None]:
    """Where the object lies deepest in the finger, if it does; a corner that did not stay leaves that to its side."""
    candidates = violated(setting, equilibrium.obstacle, equilibrium.state, known)
    if not candidates:
        return (), None
    problem = Problem(setting, equilibrium.obstacle, equilibrium.state, candidates)
    deepest = int(np.argmin(problem.gaps(problem.x0)))
    site = resolved(setting, problem.sites(problem.x0)[deepest])
    return tuple(c for c in candidates[deepest : deepest + 1] if c.kind == "vertex"), site
