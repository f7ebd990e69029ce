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
    guesses = [guess]
    for _ in range(_ROUNDS):
        equilibrium = _settled(setting, obstacle, guesses, order)
        state = equilibrium.state
        least = PULL * float(np.max(np.abs(state.multipliers), initial=0.0))
        keep = [float(load.min()) >= -least for load in state.loads]
        if not any(keep):
            raise NoEquilibriumError("no contact presses")
        if not all(keep):
            left = held(setting, obstacle, start, state.keeping(keep))  # what carries on in its place holds as it did
            guesses = [left]
            continue
        candidate, come = penetrated(setting, equilibrium, known)
        if come is None:
            return verify(setting, equilibrium)
        known += candidate
        guesses = [held(setting, obstacle, start, choice) for choice in _taken_in(state, replace(come, grip=None))]
    raise NoEquilibriumError("the contacts come and go without end")


def _settled(setting: Setting, obstacle: Obstacle, guesses: list[State], order: int) -> Equilibrium:
    """The equilibrium from the first guess from which Newton's method finds one."""
    for guess in guesses[:-1]:
        try:
            return settle_contacts(setting, obstacle, guess, order)
        except NoEquilibriumError:
            pass  # the next guess
    return settle_contacts(setting, obstacle, guesses[-1], order)


def _taken_in(state: State, come: Site) -> list[State]:
    """The state with one more contact; before that, where an object rolls from a corner to its side, with that alone.

    Both hold the face in all but one place and direction: together Newton's method hardly finds them.
    """
    sites, loads = state.sites, state.loads
    mine = [i for i, s in enumerate(sites) if s.piece == come.piece and {s.kind, come.kind} == {"vertex", "tangent"}]
    out = [replace(state, sites=(*sites, come), multipliers=np.append(state.multipliers, 0.0))]
    if mine:
        i = min(mine, key=lambda i: abs(sites[i].middle - come.middle))
        rolled = (*sites[:i], come, *sites[i + 1 :])
        multipliers = np.concatenate([*loads[:i], [loads[i][0]], *loads[i + 1 :]])
        out.insert(0, replace(state, sites=rolled, multipliers=multipliers))
    return out


def penetrated(
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
