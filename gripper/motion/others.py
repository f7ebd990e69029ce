"""Whether Coulomb's law leaves another answer at a pose: other holds of its contacts, or a finger that is free.

A contact that slips with s v > 0 and the ratio rho = -s mu may as well stick from here on where its ratio would then
go inwards, s rho' > 0. With v = w + C rho', C being the slip that a unit of ratio makes, both are the linear
complementarity problem s v >= 0, s rho' >= 0, v rho' = 0: its answer is unique for every motion if all principal
minors of C are positive (Klarbring 1990), and for few contacts all its answers are tried. Where mu exceeds the limiting
coefficient (:mod:`gripper.motion.locking`) a finger may be jammed although its object does not reach the straight
finger: then the free finger is an answer, too.
"""

from __future__ import annotations

import itertools

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.features import named
from gripper.contact.obstacle import Obstacle
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import Equilibrium, Setting, State
from gripper.statics.holds import grip_of, leaders, slip_rates
from gripper.statics.newton import settle
from gripper.statics.verified import Verified, untouched

_CLEAR = 1e-9  # relative: rates this small decide nothing
_MOST = 4  # contacts that slip, of which all holds are tried
_MARKS = np.linspace(0.02, 1.0, 50)


def other_solutions(setting: Setting, equilibrium: Equilibrium, heading: float) -> tuple[str, ...]:
    """The other answers at an equilibrium, in words; none where it is the only one that is found.

    Parameters
    ----------
    setting
        With friction.
    equilibrium
        Of a motion.
    heading
        Sign of the way along its parameter.
    """
    if not equilibrium.state.sites:
        return ()
    free = ("free",) if is_clear(setting, equilibrium.obstacle, equilibrium.state.beam.order) else ()
    return (*_held_otherwise(setting, equilibrium, heading), *free)


def is_clear(setting: Setting, obstacle: Obstacle, order: int) -> bool:
    """Whether the straight finger does not touch the object."""
    straight_at_rest = setting.sections.rest is None and setting.loads is None
    if straight_at_rest and float(np.min(obstacle.gap(_straight(setting)))) < 0:  # quickly told, most often
        return False
    beam = setting.beam((), order)
    straight = settle(setting, obstacle, State(beam, np.zeros(beam.size)), order)
    return untouched(setting, Verified(straight, survey(setting, obstacle, straight.state, brief=True)))


def _straight(setting: Setting) -> Complex:
    """Points of the straight finger's outline, by L."""
    half = setting.sections.thickness(_MARKS) / 2
    points = [_MARKS - 1j * half, _MARKS + 1j * half]
    jaw = setting.outline.jaw
    if jaw is not None:
        points += [1 + jaw + (np.roll(jaw, -1) - jaw) * part for part in _MARKS[::8]]
    return np.concatenate(points)


def _held_otherwise(setting: Setting, equilibrium: Equilibrium, heading: float) -> tuple[str, ...]:
    slipping = [i for i in leaders(equilibrium) if grip_of(equilibrium, i).hold == "slip"]
    if not slipping or len(slipping) > _MOST:
        return ()
    senses = np.array([grip_of(equilibrium, i).sense for i in slipping], dtype=float)
    velocities = heading * slip_rates(equilibrium)[slipping]
    found = []
    for stuck in answers(senses * velocities, senses[:, None] * compliance(equilibrium, slipping) * senses):
        if any(stuck):
            sites = [equilibrium.state.sites[i] for i, sticks in zip(slipping, stuck, strict=True) if sticks]
            found.append(f"stuck ({', '.join(named(setting.outline, site) for site in sites)})")
    return tuple(found)


def compliance(equilibrium: Equilibrium, contacts: list[int]) -> Array:
    """The slip of some contacts (k,) that a unit of ratio at each of them makes, the motion held: (k, k)."""
    rubbing, lin = equilibrium.linear.rubbing, equilibrium.linear
    if rubbing is None:
        raise ValueError("contacts must have friction; got none")
    sites = equilibrium.state.sites
    n = lin.gradients.shape[1]
    pushes = np.zeros((n + len(lin.values) + len(lin.residuals), len(contacts)))
    for j, site in enumerate(sites):
        first = site.grip.law.leader(sites, j) if site.grip else -1
        if first in contacts:
            pushes[:n, contacts.index(first)] += rubbing.pushes[j]
    moved = np.linalg.solve(equilibrium.matrix(), pushes)[:n]
    slips: Array = rubbing.gradients[contacts] @ moved
    return slips


def answers(velocities: Array, compliance: Array) -> list[tuple[bool, ...]]:
    """All answers of v >= 0, rho' >= 0, v rho' = 0 with v = velocities + compliance rho': which contacts stick.

    Parameters
    ----------
    velocities
        Slip in its sense, if all slip on, (k,).
    compliance
        Slip by ratios that go inwards, (k, k).
    """
    scale = float(np.max(np.abs(velocities), initial=0.0))
    found = []
    for stuck in itertools.product((False, True), repeat=len(velocities)):
        s = np.flatnonzero(stuck)
        try:
            inwards = np.linalg.solve(compliance[np.ix_(s, s)], -velocities[s])
        except np.linalg.LinAlgError:
            continue
        left = velocities + compliance[:, s] @ inwards
        if np.all(inwards > 0) and np.all(np.delete(left, s) > _CLEAR * scale):
            found.append(stuck)
    return found
