"""Locking: friction alone holds the finger, whatever the force.

A contact that slips under the inclined force n + rho t moves away from it as long as n . A (n + rho t) > 0, A being the
compliance of the contact point. Where that vanishes no finite force moves the finger on: the equations of the slipping
contact are singular. The ratio at which they are, is the limiting coefficient.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gripper.arrays import Array
from gripper.contact.features import features
from gripper.contact.grip import Grip
from gripper.contact.linear import linearise
from gripper.contact.site import Site
from gripper.motion.locked import LockedError
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State
from gripper.statics.holds import coefficient, grip_of, leaders, leads, slip_rates
from gripper.statics.newton import settle
from gripper.statics.verified import objection, singularity

_REAL = 1e-6
_FINITE = 1e4
_LIMITED = 1e-4
_ALMOST = 1.05
_TELLING = 1e-3  # a ratio from which the part of friction is told


def free_slip(setting: Setting, equilibrium: Equilibrium, i: int) -> float:
    """The slip rate that a contact would have without friction."""
    return float(slip_rates(opened(setting, equilibrium, i, 0.0))[i])


def limiting_ratio(setting: Setting, equilibrium: Equilibrium, i: int, sign: float) -> float:
    """The least ratio of this sign at which a slipping contact is not moved by any force; infinite where none is."""
    without = opened(setting, equilibrium, i, 0.0).matrix()
    matrix, ratio = _with_ratio(setting, equilibrium, i)
    friction = (matrix - without) / ratio  # the matrix is linear in the ratio
    try:
        inverse: Array = np.linalg.eigvals(np.linalg.solve(without, -friction))
    except np.linalg.LinAlgError:
        return 0.0  # a limit point even without friction
    ratios = 1 / inverse[np.abs(inverse) * _FINITE > 1]
    real = ratios.real[np.abs(ratios.imag) < _REAL * np.abs(ratios)]
    return float(np.min(np.abs(real[real * sign > 0]), initial=math.inf))


def _with_ratio(setting: Setting, equilibrium: Equilibrium, i: int) -> tuple[Array, float]:
    """The matrix at a ratio, and that: of a contact that slips its own."""
    rubbing, grip = equilibrium.linear.rubbing, equilibrium.state.sites[i].grip
    if rubbing is not None and grip is not None and grip.hold == "slip" and abs(rubbing.ratios[i]) > _TELLING:
        return equilibrium.matrix(), rubbing.ratios[i]
    return opened(setting, equilibrium, i, 1.0).matrix(), 1.0


def nearness(setting: Setting, equilibrium: Equilibrium, heading: float) -> float:
    """How near friction is to locking the finger: mu over its limiting value, of the contact where that is largest."""
    return max((limit.nearness for limit in limits(setting, equilibrium, heading)), default=0.0)


@dataclass(frozen=True)
class Limit:
    """A contact (the number of the first of its group), its coefficient, and the ratio that would lock the finger."""

    contact: int
    mu: float
    ratio: float  # with its sign

    @property
    def nearness(self) -> float:
        """Mu over its limiting value; 1 at a limit point without friction."""
        return self.mu / (abs(self.ratio) or self.mu)


def limits(setting: Setting, equilibrium: Equilibrium, heading: float) -> list[Limit]:
    """Where each contact locks the finger, if it slips on the way along the motion's parameter (its sign)."""
    found = []
    for i in leaders(equilibrium):
        grip = grip_of(equilibrium, i)
        side = float(-grip.sense if grip.sense else -heading * np.sign(free_slip(setting, equilibrium, i)))
        ratio = side * limiting_ratio(setting, equilibrium, i, side)
        found.append(Limit(i, coefficient(equilibrium, i), ratio))
    return found


def opened(setting: Setting, equilibrium: Equilibrium, i: int, ratio: float) -> Equilibrium:
    """The linearisation with a fixed ratio at one group of contacts, which is free to slip."""
    sites = list(equilibrium.state.sites)
    for j, site in enumerate(sites):
        grip = site.grip
        if grip is not None and grip.law.leader(equilibrium.state.sites, j) == i:
            sites[j] = replace(site, grip=replace(grip, hold="open", sense=0, ratio=ratio, anchor=None))
    state = replace(equilibrium.state, sites=tuple(sites))
    lin = linearise(state.beam, state.z, setting.outline, equilibrium.obstacle, state.sites, state.multipliers)
    return replace(equilibrium, state=state, linear=lin)


def check_locked(setting: Setting, equilibrium: Equilibrium, heading: float, factor: float = 1.0) -> None:
    """Whether a contact that sticks could not slip on with any force, the coefficient being that much larger.

    Of several contacts one may let go before: they are followed as they stick.

    Raises
    ------
    LockedError
        Where friction holds the finger.
    """
    if len(features(equilibrium.state.sites)) > 1:
        return
    for i in leaders(equilibrium):
        if grip_of(equilibrium, i).hold == "slip":
            continue
        side = -heading * np.sign(free_slip(setting, equilibrium, i))
        limit, mu = limiting_ratio(setting, equilibrium, i, side), coefficient(equilibrium, i)
        if limit <= factor * mu:
            raise LockedError(limit, mu)


def grown(setting: Setting, smooth: Equilibrium, order: int) -> State | None:
    """A frictionless equilibrium with friction of a given sense, which is made to grow from 0.

    Returns
    -------
    The state whose contacts slip as given, nearly in equilibrium; None where its end is not friction's alone.

    Raises
    ------
    LockedError
        Where friction locks the finger: where the slipping contacts are singular at less than their coefficient.
    """
    law, sites = setting.friction, smooth.state.sites
    if law is None or not sites:
        return smooth.state
    held = law.dressed((), sites)
    mu = max(law.at(site.piece, site.middle)[0] for site in sites)
    last, reached, step = smooth, 0.0, mu
    while reached < mu and step > _LIMITED * mu:
        ratio = min(reached + step, mu)
        found = _at_ratio(setting, last, held, ratio, order)
        if found is None:
            step /= 2
        else:
            last, reached = found, ratio
    if reached == mu:
        places = zip(held, last.state.sites, strict=True)
        return replace(last.state, sites=tuple(replace(site, place=at.place) for site, at in places))
    signs = [float(np.sign(site.grip.ratio)) if site.grip else 0.0 for site in last.state.sites]
    limits = [limiting_ratio(setting, last, i, sign) for i, sign in enumerate(signs) if leads(last.state.sites, i)]
    if reached and min(limits) < _ALMOST * reached:
        raise LockedError(reached, mu)
    return None


def _at_ratio(
    setting: Setting, near: Equilibrium, held: tuple[Site, ...], ratio: float, order: int
) -> Equilibrium | None:
    """The equilibrium with one ratio at all contacts, against the senses that are given; None where there is none."""
    ruled = []
    for site, at in zip(held, near.state.sites, strict=True):
        sense = site.grip.sense if site.grip else 0
        law = setting.friction
        ruled.append(replace(site, place=at.place, grip=Grip(law, ratio=-sense * ratio) if law else None))
    try:
        found = settle(setting, near.obstacle, replace(near.state, sites=tuple(ruled)), order)
    except NoEquilibriumError:
        return None
    return None if objection(setting, found) or singularity(found) < 0 else found
