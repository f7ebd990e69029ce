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

from gripper.arrays import Array
from gripper.contact import linearise
from gripper.equilibrium import Equilibrium, Setting
from gripper.grip import dressed, leader, tipward
from gripper.holds import slip_rates

_REAL = 1e-6
_FINITE = 1e4


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
        super().__init__(
            f"friction holds the finger for any force: its coefficient is {mu:.4g}, the limiting one {limit:.4g}"
        )


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


def check_locked(setting: Setting, equilibrium: Equilibrium) -> None:
    """Whether friction of a given sense locks a frictionless equilibrium.

    Raises
    ------
    LockedError
        Where it does.
    """
    law, sites = setting.friction, equilibrium.state.sites
    if law is None:
        return
    held = dressed(law, (), sites)
    state = replace(equilibrium.state, sites=held)
    for i, site in enumerate(held):
        sign = -law.tipward * tipward(site, law.outline)
        limit, mu = (
            limiting_ratio(setting, replace(equilibrium, state=state), i, sign),
            law.at(site.piece, site.middle)[0],
        )
        if limit <= mu:
            raise LockedError(limit, mu)
