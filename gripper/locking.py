"""Locking: friction alone holds the finger, whatever the force.

A contact that slips under the inclined force n + rho t moves away from it as long as n . A (n + rho t) > 0, A being the
compliance of the contact point. Where that vanishes no finite force moves the finger on: the equations of the slipping
contact are singular. The ratio at which they are, is the limiting coefficient.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import scipy.linalg

from gripper.active import definiteness
from gripper.arrays import Array
from gripper.contact import linearise
from gripper.equilibrium import Equilibrium, NoEquilibriumError, Setting, settle
from gripper.grip import Grip, dressed, leader, tipward
from gripper.holds import coefficient, grip_of, leaders, slip_rates

_REAL = 1e-6
_FINITE = 1e4
_RAMP = 16
_LIMITED = 1e-4


class LockedError(Exception):
    """The motion cannot go on: friction holds the finger for any force.

    Parameters
    ----------
    limit
        The coefficient of friction from which on it does.
    mu
        The coefficient that it has.
    """

    def __init__(self, limit: float, mu: float) -> None:
        self.limit, self.mu = limit, mu
        holds = "holds the finger for any force" if limit <= mu else "all but holds the finger"
        super().__init__(f"friction {holds}: its coefficient is {mu:.4g}, the limiting one {limit:.4g}")


def free_slip(setting: Setting, equilibrium: Equilibrium, i: int) -> float:
    """The slip rate that a contact would have without friction."""
    opened = _opened(setting, equilibrium, i, 0.0)
    return float(slip_rates(opened)[i])


def limiting_ratio(setting: Setting, equilibrium: Equilibrium, i: int, sign: float) -> float:
    """The least ratio of this sign at which a slipping contact is not moved by any force; infinite where none is."""
    without = _opened(setting, equilibrium, i, 0.0).matrix()
    friction = _opened(setting, equilibrium, i, 1.0).matrix() - without
    above, below = scipy.linalg.eigvals(without, -friction, homogeneous_eigvals=True)
    finite = np.abs(below) * _FINITE > np.abs(above)
    ratios: Array = above[finite] / below[finite]
    real = ratios.real[np.abs(ratios.imag) < _REAL * np.abs(ratios)]
    return float(np.min(np.abs(real[real * sign > 0]), initial=math.inf))


def nearness(setting: Setting, equilibrium: Equilibrium, heading: float) -> float:
    """How near friction is to locking the finger: mu over its limiting value, of the contact where that is largest."""
    nearest = 0.0
    for i in leaders(equilibrium):
        grip = grip_of(equilibrium, i)
        side = -grip.sense if grip.sense else -heading * np.sign(free_slip(setting, equilibrium, i))
        nearest = max(nearest, coefficient(equilibrium, i) / limiting_ratio(setting, equilibrium, i, side))
    return nearest


def _opened(setting: Setting, equilibrium: Equilibrium, i: int, ratio: float) -> Equilibrium:
    """The linearisation with a fixed ratio at one group of contacts."""
    sites = list(equilibrium.state.sites)
    for j, site in enumerate(sites):
        grip = site.grip
        if grip is not None and leader(grip.law.outline, equilibrium.state.sites, j) == i:
            sites[j] = replace(site, grip=replace(grip, hold="open", sense=0, ratio=ratio, anchor=None))
    state = replace(equilibrium.state, sites=tuple(sites))
    lin = linearise(state.beam, state.z, setting.outline, equilibrium.obstacle, state.sites, state.multipliers)
    return replace(equilibrium, state=state, linear=lin)


def check_locked(setting: Setting, equilibrium: Equilibrium, order: int) -> None:
    """Whether friction of a given sense locks a frictionless equilibrium: whether it ends as friction grows.

    Raises
    ------
    LockedError
        Where it does.
    """
    law, sites = setting.friction, equilibrium.state.sites
    if law is None or not sites:
        return
    held = [(site, tipward(site, law.outline) * law.tipward) for site in dressed(law, (), sites)]
    mu = max(law.at(site.piece, site.middle)[0] for site in sites)
    state, reached, step = equilibrium.state, 0.0, mu / _RAMP
    while step > _LIMITED * mu:
        ratio = min(reached + step, mu)
        ruled = [replace(s, grip=Grip(law, ratio=-sense * ratio)) for s, sense in held]
        moved = [replace(new, place=old.place) for new, old in zip(ruled, state.sites, strict=True)]
        try:
            found = settle(setting, equilibrium.obstacle, replace(state, sites=tuple(moved)), order)
        except NoEquilibriumError:
            step /= 2
            continue
        if np.any(found.state.multipliers < 0) or definiteness(found) < 0:
            step /= 2
            continue
        state, reached = found.state, ratio
        if reached == mu:
            return
    raise LockedError(reached, mu)
