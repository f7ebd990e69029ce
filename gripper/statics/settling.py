"""From a guess of the contacts to their equilibrium: corners roll on, points become patches, patches points."""

from __future__ import annotations

from dataclasses import replace

from gripper.contact.linear import linearise
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Obstacle
from gripper.contact.site import Site
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State
from gripper.statics.lying import laid, laid_ahead
from gripper.statics.newton import settle
from gripper.statics.patches import PATCH, fit_patches, spread_out, with_sites
from gripper.statics.rolling import rolled_ahead, rolled_on

_POINTLIKE = 5 * PATCH


def settle_contacts(
    setting: Setting,
    obstacle: Obstacle,
    state: State,
    order: int,
    *,
    judged: bool = False,
    known: Linearisation | None = None,
) -> Equilibrium:
    """Settle, and again where the object rolls on to another corner, a point must become a patch or a patch a point.

    With ``judged`` for an estimate of the error (:func:`gripper.statics.newton.settle`). What is ``known`` of the same
    contacts nearby tells how far points are going to spread.

    Raises
    ------
    NoEquilibriumError
        Where Newton does not converge.
    """
    foreseen = laid_ahead(
        setting, obstacle, rolled_ahead(setting, obstacle, _foreseen(setting, obstacle, state, known))
    )
    try:
        found = settle(setting, obstacle, foreseen, order, judged=judged)
    except NoEquilibriumError:
        if foreseen is state:
            raise
        found = settle(setting, obstacle, state, order, judged=judged)
    found = laid(setting, rolled_on(setting, found, order, judged=judged), order, judged=judged)
    sites = fit_patches(setting, found)
    if sites == found.state.sites:
        return found
    try:
        again = settle(setting, obstacle, with_sites(found.state, sites), order, judged=judged)
    except NoEquilibriumError:
        if any(old.kind != new.kind and not _pointlike(new) for old, new in zip(found.state.sites, sites, strict=True)):
            raise
        return found  # a patch so narrow that Newton's method does not find its ends: a point is as good
    total = found.iterations + again.iterations
    return replace(again, iterations=total, correction=found.correction + again.correction)


def _pointlike(site: Site) -> bool:
    """Whether a patch is so narrow that the mean tangent of a point is as good."""
    return site.kind == "patch" and site.place[1] - site.place[0] < _POINTLIKE


def _foreseen(setting: Setting, obstacle: Obstacle, state: State, known: Linearisation | None) -> State:
    """Points on faces as the short patches that they are going to be, so that Newton need not find the points first."""
    if setting.theory == "bending" or not any(s.kind == "tangent" and s.on_face for s in state.sites):
        return state
    if known is None:
        known = linearise(state.beam, state.z, setting.outline, obstacle, state.sites, state.multipliers, kinks=False)
    sites = fit_patches(setting, Equilibrium(state, obstacle, known, 0))
    return spread_out(setting, state, sites) if all(site.kind != "tail" for site in sites) else state
