"""Where no hold of one contact is consistent any more, the holds of all: one comes, another sticks on, or slips on.

At the end of a branch the contacts that touch, and one that comes there, may hold in several ways. Each is tried a
little further on: it is an answer where all press, those that slip go on in their sense, and those that stick stay
within mu.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gripper.contact.obstacle import Obstacle
from gripper.contact.site import Site
from gripper.statics.active import held
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State
from gripper.statics.gathered import penetrated
from gripper.statics.holds import leads, overdue, regripped
from gripper.statics.newton import settle
from gripper.statics.verified import Verified, verify

_MOST = 4  # contacts whose holds are tried
_AT_MU = 1e-6  # relative: a contact that sticks slips on from here


def reheld(setting: Setting, obstacle: Obstacle, start: Equilibrium, heading: float, order: int) -> Verified | None:
    """The equilibrium a little further on with other holds of the contacts, or with one that has come.

    Parameters
    ----------
    setting, obstacle
        The obstacle is that little further on.
    start
        The last equilibrium.
    heading
        Sign of the way along the parameter.
    order
        Of the strain fields.

    Returns
    -------
    None where no holds are consistent with Coulomb's law: the finger snaps, or is locked.
    """
    before = [site.grip for site in start.state.sites]
    for guess in _guesses(setting, obstacle, start, order):
        if sum(leads(guess.sites, i) for i in range(len(guess.sites))) > _MOST:
            continue
        for state in _holds(guess):
            if [site.grip for site in state.sites] == before:
                continue  # it does not go on as it is
            found = _consistent(setting, obstacle, state, heading, order)
            if found is not None:
                return found
    return None


def _consistent(setting: Setting, obstacle: Obstacle, state: State, heading: float, order: int) -> Verified | None:
    """The equilibrium with these holds; with those stuck from there on that would slip against their sense."""
    try:
        found = verify(setting, settle(setting, obstacle, state, order))
        late = overdue(found.equilibrium, heading)
        if not late:
            return found
        found = verify(setting, regripped(setting, found.equilibrium, late[0], 0, order))
        return None if overdue(found.equilibrium, heading) else found
    except NoEquilibriumError:
        return None


def _guesses(setting: Setting, obstacle: Obstacle, start: Equilibrium, order: int) -> Iterator[State]:
    """The contacts as they are, and with the one that comes where they are held on to."""
    state = start.state
    yield state
    try:
        kept = settle(setting, obstacle, state, order)
        _, come = penetrated(setting, kept, ())
    except NoEquilibriumError:
        return
    if come is not None:
        more = State(state.beam, state.z, (*state.sites, replace(come, grip=None)), np.append(state.multipliers, 0.0))
        yield held(setting, obstacle, state, more)


def _holds(state: State) -> Iterator[State]:
    """The state with all holds that its contacts may have from here on, the nearest to what they have first."""
    choices = [list(_choices(state, i)) for i in range(len(state.sites))]
    numbers = sorted(itertools.product(*(range(len(c)) for c in choices)), key=sum)
    for chosen in numbers:
        sites = tuple(choices[i][k] for i, k in enumerate(chosen))
        law = sites[0].grip.law if sites[0].grip else None
        yield replace(state, sites=law.grouped(sites) if law else sites)


def _choices(state: State, i: int) -> Iterator[Site]:
    """One contact with the holds that it may have from here on."""
    site = state.sites[i]
    grip = site.grip
    if grip is None or not leads(state.sites, i):
        yield site
        return
    mu = grip.law.at(site.piece, site.middle)[0]
    if grip.hold == "slip":
        yield site
        yield replace(site, grip=grip.sticking(-grip.sense * mu, None))
    elif grip.hold == "stick":
        yield site
        if abs(grip.ratio) >= mu * (1 - _AT_MU):
            yield replace(site, grip=grip.slipping(-int(np.sign(grip.ratio))))
    else:
        for sense in (1, -1):
            yield replace(site, grip=grip.slipping(sense))
        yield replace(site, grip=grip.sticking(0.0, None))
