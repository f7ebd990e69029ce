"""A contact comes and another one goes soon after: both are located on the branch on which both hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gripper.contact.features import Feature
from gripper.contact.site import pointed as as_point
from gripper.motion.branch import Along, Branch, Path, joined, let_go, number, pointed
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.newton import settle

SEVERAL = "several contacts change within one step"


def handed_over(
    setting: Setting, path: Path, ends: tuple[Along, Along], lost: Feature, won: Feature, order: int
) -> tuple[float, float]:
    """Where a contact comes and where the other one, which it relieves, goes: without friction.

    Parameters
    ----------
    setting, path, order
        Of the motion.
    ends
        Equilibria with the one and with the other.
    lost, won
        Which goes, and which comes.

    Raises
    ------
    NoEquilibriumError
        Where the branch of both contacts does not lead from the one to the other.
    """
    if "vertex" in (lost[0], won[0]):  # corners of the object beside each other carry as one
        raise NoEquilibriumError(SEVERAL)
    old, new = (Along(at.parameter, pointed(setting, at.equilibrium, order)) for at in ends)
    site = as_point(ends[0].equilibrium.state.sites[number(ends[0], lost)])
    known = new.equilibrium.state
    both = State(known.beam, known.z, (*known.sites, site), np.append(known.multipliers, 0.0))
    branch = Branch(
        setting, path, replace(new, equilibrium=settle(setting, new.equilibrium.obstacle, both, order)), order
    )
    goes = _vanishing(branch, len(known.sites), new, old.parameter)
    comes = _vanishing(branch, number(new, won), replace(new, parameter=goes), old.parameter)
    for where, end in ((goes, new), (comes, old)):
        there = branch.at(where)
        if not survey(setting, there.obstacle, there.state).clear:
            raise NoEquilibriumError("something else touches before")
        joined(setting, path, Along(where, there), end, order)
    if any(load.min() < 0 for load in branch.at((goes + comes) / 2).state.loads):
        raise NoEquilibriumError("the step leads to another branch")
    return comes, goes


def _vanishing(branch: Branch, i: int, start: Along, stop: float) -> float:
    where = let_go(branch, i, start.parameter, stop)
    if where is None:
        raise NoEquilibriumError(SEVERAL)
    return where
