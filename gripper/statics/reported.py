"""Contacts as a result reports them: SI, world frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from gripper.arrays import Array
from gripper.contact.features import conform
from gripper.contact.kinematics import Placement
from gripper.contact.linearisation import Linearisation
from gripper.contact.outline import Part
from gripper.contact.site import Site
from gripper.result import Contact
from gripper.statics.contact_forces import NO_FORCE
from gripper.statics.equilibrium import Equilibrium, Setting
from gripper.statics.patches import flat_until, lies_flat

_CORNER = 0.01  # of L: a corner of the object this near behind a flat is its end
_STATES = {"open": "slip", "slip": "slip", "stick": "stick"}


def vector(value: complex) -> tuple[float, float]:
    """x + iy as a pair."""
    return float(value.real), float(value.imag)


def contacts(setting: Setting, equilibrium: Equilibrium, placement: Placement) -> tuple[Contact, ...]:
    """One entry a separate contact, ordered by s; a patch that ends in the tip's corner is one with it."""
    lin, sites = equilibrium.linear, equilibrium.state.sites
    extents = [_extent(setting, equilibrium, site) for site in sites]
    ended = [site.kind == "tail" and extent[-1] == 1 for site, extent in zip(sites, extents, strict=True)]
    tips = [
        setting.outline.tip_corner(site.piece) if end else site.piece for site, end in zip(sites, ended, strict=True)
    ]
    tails = {tip for tip, end in zip(tips, ended, strict=True) if end}
    groups: dict[object, list[int]] = {}
    last = -1
    for i in sorted(range(len(sites)), key=lambda i: (sites[i].piece, sites[i].place)):
        tip = sites[i].piece if tips[i] is None else tips[i]
        if tip in tails:
            groups.setdefault(("tail", tip), []).append(i)
        elif last >= 0 and _one_stretch(sites[last], extents[last][-1], sites[i]):
            next(members for members in groups.values() if last in members).append(i)
        else:
            groups[i] = [i]
        last = i
    length = setting.sections.length
    out = []
    for members in groups.values():
        points = np.concatenate([lin.points[i] for i in members])
        forces = np.concatenate([lin.forces[i] / _incline(lin, i) for i in members])  # normal forces
        total = complex(forces.sum())
        if abs(total) <= NO_FORCE:
            continue
        weights = (forces.conj() * total).real  # a ripple where a pressure has decayed counts with its sign
        on, places = _places(setting, [sites[i] for i in members], [lin.stations[i] for i in members])
        extent = [s for i in members for s in setting.outline.place(sites[i].piece, extents[i])[1]]
        rubbing = complex(sum(lin.forces[i].sum() for i in members)) - total
        out.append(
            Contact(
                on=on,
                s=float(places @ weights / weights.sum()) * length,
                extent=(min(extent) * length, max(extent) * length),
                point=vector(placement.origin + placement.turn * complex(weights @ points / weights.sum()) * length),
                normal=vector(placement.turn * total / abs(total)),
                normal_force=abs(total) * setting.sections.force_scale,
                **_friction(setting, sites[members[0]], rubbing, total),
            )
        )
    return tuple(sorted(out, key=lambda contact: contact.s))


def _incline(lin: Linearisation, i: int) -> complex:
    """From the normal force to the force at a contact: 1 - i rho."""
    return 1.0 if lin.rubbing is None else 1 - 1j * lin.rubbing.ratios[i]


def _friction(setting: Setting, site: Site, rubbing: complex, normal: complex) -> dict[str, Any]:
    """Friction on the object towards the tip, and whether the contact sticks."""
    if site.grip is None:
        return {}
    along = (1j * normal.conjugate() / abs(normal) * rubbing).real * site.grip.law.side(site)
    return {"tangential_force": -along * setting.sections.force_scale, "state": _STATES[site.grip.hold]}


def _places(setting: Setting, sites: list[Site], stations: list[Array]) -> tuple[Part, Array]:
    """Which part of the finger, and s (by L) of each of its contact points."""
    places = [setting.outline.place(site.piece, u) for site, u in zip(sites, stations, strict=True)]
    return places[0][0], np.concatenate([s for _, s in places])


def _extent(setting: Setting, equilibrium: Equilibrium, site: Site) -> Array:
    """From first to last touching place (by L); a face that lies flush touches as far as the flat goes."""
    ends = np.array(site.place or (0.0,))
    if site.kind == "tail" and lies_flat(setting, equilibrium.obstacle, equilibrium.state, site):
        ends[1] = max(ends[1], flat_until(setting, equilibrium.obstacle, equilibrium.state, site, 1.0))
    return ends


def _one_stretch(one: Site, end: float, other: Site) -> bool:
    """Whether neighbouring contacts are one: a stretch that conforms, a flat with its object's corner."""
    if one.piece == other.piece and other.kind == "span":
        return one.kind == "vertex"
    if one.piece == other.piece and one.kind in ("tail", "span") and other.kind == "vertex":
        return other.place[0] - end < _CORNER
    return conform(one, other)
