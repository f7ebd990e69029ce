"""Slip and stick of an equilibrium's contacts: what is consistent, and how a hold changes.

A contact that slips with a sense must go on that way; one that sticks must have a ratio within mu. Contacts that
share a ratio change together.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gripper.arrays import Array
from gripper.contact.grip import Grip
from gripper.contact.outline import UPPER
from gripper.contact.site import Site
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting
from gripper.statics.newton import settle

_STILL = 1e-12  # relative: slip this slow is none


def leaders(equilibrium: Equilibrium) -> list[int]:
    """The contacts that decide: one of each group."""
    sites = equilibrium.state.sites
    return [i for i, site in enumerate(sites) if site.grip is not None and leads(sites, i)]


def leads(sites: tuple[Site, ...], i: int) -> bool:
    """Whether a contact has its own ratio."""
    grip = sites[i].grip
    return grip is not None and grip.law.leader(sites, i) == i


def grip_of(equilibrium: Equilibrium, i: int) -> Grip:
    """The grip of a contact."""
    grip = equilibrium.state.sites[i].grip
    if grip is None:
        raise ValueError("the contact must have friction; got none")
    return grip


def coefficient(equilibrium: Equilibrium, i: int) -> float:
    """Mu at a contact."""
    site = equilibrium.state.sites[i]
    return grip_of(equilibrium, i).law.at(site.piece, site.middle)[0]


def slip_rates(equilibrium: Equilibrium) -> Array:
    """Velocity of the finger along t relative to the object, by the parameter, of each contact (sites,).

    Raises
    ------
    NoEquilibriumError
        At a limit point.
    """
    rubbing = equilibrium.linear.rubbing
    if rubbing is None:
        return np.zeros(0)
    slips: Array = rubbing.gradients @ tangent(equilibrium)[0] + rubbing.rates
    return slips


def tangent(equilibrium: Equilibrium) -> tuple[Array, Array, Array]:
    """The rates of all unknowns.

    Raises
    ------
    NoEquilibriumError
        At a limit point.
    """
    try:
        return equilibrium.tangent()
    except np.linalg.LinAlgError as error:
        raise NoEquilibriumError("the tangent is vertical (a limit point)") from error


def ratio_rate(equilibrium: Equilibrium, i: int) -> float:
    """Rate of the ratio of a contact that sticks, by the parameter."""
    sites = equilibrium.state.sites
    return float(tangent(equilibrium)[2][sum(site.unknowns for site in sites[: i + 1]) - 1])


def rolling(equilibrium: Equilibrium, i: int) -> float:
    """By how much the matter before and behind a contact that rolls along a face slip apart, by the parameter.

    Friction's lever to the axis turns the section: the curvature jumps there, and with it how fast sections turn.
    """
    site, sections = equilibrium.state.sites[i], equilibrium.state.beam.sections
    if site.kind != "tangent" or not site.on_face or site.flush:
        return 0.0
    place = np.array([site.middle])
    half = float(sections.thickness(place)[0]) / 2
    ratio = grip_of(equilibrium, i).ratios(site.piece, site.middle)[0]
    friction = abs(ratio) * abs(complex(equilibrium.linear.forces[i].sum())) / float(np.hypot(1.0, ratio))
    bent = friction * half / float(sections.stiffness(place)[0][0])
    moving = float(tangent(equilibrium)[2][sum(s.unknowns for s in equilibrium.state.sites[:i])])
    return half * bent * abs(moving)


def margin(equilibrium: Equilibrium, i: int, heading: float, bound: float) -> float:
    """How far a contact is from changing its hold: at least 0 where it may stay.

    Of one that slips the speed in its sense; of one that sticks mu less its ratio, towards the given bound (its sign).
    """
    grip = grip_of(equilibrium, i)
    if grip.hold == "slip":
        return float(slip_rates(equilibrium)[i]) * heading * grip.sense
    return coefficient(equilibrium, i) - bound * grip.ratio


def overdue(equilibrium: Equilibrium, heading: float) -> list[int]:
    """Contacts whose hold contradicts their motion or their force."""
    rates = slip_rates(equilibrium)
    out = []
    for i in leaders(equilibrium):
        grip = grip_of(equilibrium, i)
        if grip.hold == "slip" and rates[i] * heading * grip.sense < 0:
            out.append(i)
        elif grip.hold == "stick" and abs(grip.ratio) > coefficient(equilibrium, i) * (1 + _STILL):
            out.append(i)
    return out


def regripped(setting: Setting, equilibrium: Equilibrium, i: int, hold: int, order: int) -> Equilibrium:
    """The equilibrium with another hold of one group: 0 sticks from here on, 1 and -1 slip with that sense.

    On the jaw and the end section all stick together.

    Raises
    ------
    NoEquilibriumError
        Where there is none.
    """
    lin, sites = equilibrium.linear, list(equilibrium.state.sites)
    if lin.rubbing is None:
        raise ValueError("contacts must have friction; got none")
    for j, site in enumerate(sites):
        grip = grip_of(equilibrium, j)
        together = not hold and min(site.piece, sites[i].piece) > UPPER  # what is rigid sticks as one
        if grip.law.leader(equilibrium.state.sites, j) != i and not together:
            continue
        anchor = replace(lin.rubbing.anchors[j], origin=(equilibrium, j))
        stuck = grip.sticking(lin.rubbing.ratios[j], anchor)
        sites[j] = replace(site, grip=grip.slipping(hold) if hold else stuck)
    grouped = grip_of(equilibrium, i).law.grouped(tuple(sites))
    return settle(setting, equilibrium.obstacle, replace(equilibrium.state, sites=grouped), order)
