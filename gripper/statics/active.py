"""One pose: SLSQP finds the active set, the exact KKT system finishes, and the answer verifies itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from gripper.contact.linear import linearise
from gripper.contact.obstacle import Obstacle
from gripper.statics.candidates import active_sets, violated
from gripper.statics.certificate import Survey, survey
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, anchored
from gripper.statics.nearby import near
from gripper.statics.newton import settle
from gripper.statics.problem import Problem
from gripper.statics.settling import settle_contacts
from gripper.statics.verified import PULL, Verified, verify

_ROUNDS = 5
_PATIENCE = 40  # SLSQP takes 8 to 15 iterations where it gets somewhere
_COARSE = 1e-6  # SLSQP only has to tell who touches: Newton does the rest
_SETTLING = 20  # evaluations that a set of contacts costs that is none
REACH = 0.05
"""Stretches of outline this near to the object (by L) are candidates from the start; the survey adds others."""


def held(setting: Setting, obstacle: Obstacle, start: State, guess: State) -> State:
    """A guess whose contacts hold as those of the start that they continue; they stick from where that had them."""
    if setting.friction is None or not guess.sites:
        return guess
    sites = setting.friction.dressed(start.sites, guess.sites)
    before = replace(start, sites=sites, multipliers=guess.multipliers)
    lin = linearise(start.beam, start.z, setting.outline, obstacle, sites, guess.multipliers)
    return replace(guess, sites=anchored(before, lin).sites)


def find(setting: Setting, obstacle: Obstacle, start: State, order: int, known: Survey | None = None) -> Verified:
    """Equilibrium from a start whose contacts are not known: SLSQP for the active set, Newton to round-off.

    Raises
    ------
    NoEquilibriumError
        Where none is found that verifies.
    """
    state = State(start.beam, start.z)
    found = known or survey(setting, obstacle, state, brief=True)
    candidates = near(setting, obstacle, state, found, REACH)
    reason, iterations, effort = "no candidate for a contact", 0, 0
    for _ in range(_ROUNDS):
        problem = Problem(setting, obstacle, state, candidates)
        answer = minimize(**problem.scipy(_COARSE, _PATIENCE))
        iterations, effort = iterations + int(answer.nit), effort + int(answer.nfev)
        relaxed = problem.state(answer.x)
        for sites, multipliers in active_sets(setting, problem, answer.x, np.atleast_1d(answer.multipliers)):
            try:
                guess = held(setting, obstacle, start, State(relaxed.beam, relaxed.z, sites, multipliers))
                settled = _loaded(setting, settle_contacts(setting, obstacle, guess, order), order)
                verified = verify(setting, settled)
            except NoEquilibriumError as error:
                reason, effort = str(error), effort + _SETTLING
                continue
            total = replace(verified.equilibrium, iterations=iterations + settled.iterations)
            return replace(verified, equilibrium=total)
        more = violated(setting, obstacle, relaxed, candidates)
        if not more:
            break
        candidates += more
    raise NoEquilibriumError(reason, effort)


def _loaded(setting: Setting, settled: Equilibrium, order: int) -> Equilibrium:
    """The equilibrium without the contacts that turn out to carry nothing."""
    state = settled.state
    least = PULL * float(np.max(np.abs(state.multipliers), initial=0.0))
    keep = [float(np.max(np.abs(load))) >= least for load in state.loads]
    return settled if all(keep) else settle(setting, settled.obstacle, state.keeping(keep), order)
