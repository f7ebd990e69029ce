"""A deflected finger, read once at all stations that a result needs."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.contact.outline import dot
from gripper.contact.parabola import vertex
from gripper.laws import Response
from gripper.statics.contact_forces import loads
from gripper.statics.equilibrium import Equilibrium, Setting, State

_DRAWN = np.linspace(0.0, 1.0, 81)
_AT = 1e-9  # of L: a segment that ends this near to a contact ends there
_ALONG = np.linspace(0.0, 1.0, 13)


@functools.cache
def _zeros(count: int) -> Array:
    """The zeros of P_count."""
    return np.polynomial.legendre.leggauss(count)[0]


@dataclass(frozen=True, eq=False)
class Profile:
    """What is read of a deflected finger at some stations, (k,) each; lengths by L, stiffness EI over EI(0)."""

    s: Array
    segment: Index
    position: Complex
    psi: Array
    kappa: Array
    stiffness: Array


@functools.lru_cache(maxsize=8)  # a pose's is asked for by its result and by the motion's extremes
def profile(setting: Setting, state: State) -> Profile:
    """Where strains are looked at: at even distances on each segment, both its ends included."""
    s, position, psi, _, kappa = state.axis.evenly(_ALONG.size)
    return Profile(s, _segments(state.beam.segments, _ALONG.size), position, psi, kappa, setting.sections.EI(s))


def balanced(setting: Setting, state: State) -> Profile:
    """Between the clamp and the first contact, at the zeros of P_(p+1): there the strains tell the moments best."""
    beam, clear = state.beam, _before_contact(state)
    s = (beam.starts[:clear, None] + beam.lengths[:clear, None] * (_zeros(beam.modes) + 1) / 2).ravel()
    segment = _segments(clear, beam.modes)
    position, psi, _, kappa = state.axis.values(s, segment)
    return Profile(s, segment, position, psi, kappa, setting.sections.EI(s))


def drawn(setting: Setting, state: State) -> Profile:
    """Where a picture has its points: at even distances from clamp to tip, and where segments end."""
    s = np.union1d(_DRAWN, state.beam.breaks)
    segment = state.beam.segment_of(s)
    position, psi, _, kappa = state.axis.values(s, segment)
    return Profile(s, segment, position, psi, kappa, setting.sections.EI(s))


@functools.lru_cache(maxsize=64)
def _segments(count: int, points: int) -> Index:
    """The segments of as many points on each of the first ones."""
    return np.arange(count).repeat(points)


def _before_contact(state: State) -> int:
    """How many segments end before the first contact, or at it."""
    first = min((site.place[0] for site in state.sites if site.on_face and site.place), default=1.0)
    return max(1, sum(end <= first + _AT for end in state.beam.breaks[1:]))


def responding(setting: Setting, state: State, seen: Profile) -> tuple[Response, Array]:
    """A law's sections at some stations, and their strains (fields, k)."""
    beam, law = state.beam, setting.sections.law
    if law is None:
        raise ValueError("the material must have a law of its own; got the linear one")
    strains = beam.strains(state.z, seen.s, seen.segment)
    return Response(law, setting.sections, seen.s, beam.fields), strains


def carried(setting: Setting, state: State, seen: Profile) -> Array:
    """The moments of the strains at some stations, (k,)."""
    if setting.sections.law is None:
        return seen.stiffness * seen.kappa
    response, strains = responding(setting, state, seen)
    return response.stress(strains)[0]


def unknown(setting: Setting, state: State, seen: Profile) -> str | None:
    """Where the strains leave what the material's law knows, in words, or None."""
    if setting.sections.law is None:
        return None
    response, strains = responding(setting, state, seen)
    strain, (least, most) = response.beyond(strains), setting.sections.law.fibre.span
    if strain is None:
        return None
    return f"a fibre's strain is {strain:.3g}: the material's law is known from {least:.3g} to {most:.3g}"


@functools.lru_cache(maxsize=8)
def largest_strain(setting: Setting, equilibrium: Equilibrium) -> tuple[float, float]:
    """Largest abs(eps) + abs(kappa) w / 2 and its s (by L), both from the forces beyond each section.

    The forces and their moment are as good as the forces; the strain fields are right in the mean only.
    """
    state, lin, acting = equilibrium.state, equilibrium.linear, equilibrium.obstacle.acting
    if not state.sites and acting is None:
        return 0.0, 0.0
    seen = profile(setting, state)
    position, s = seen.position, seen.s
    # which side of a force at a break a sample is on
    middle = s - np.tile((_ALONG - 0.5) * 1e-9, state.beam.segments)
    on_face = zip(state.sites, lin.stations, strict=True)
    places = np.concatenate([np.zeros(0), *(u if site.on_face else np.full(u.size, 2.0) for site, u in on_face)])
    points, forces = loads(equilibrium)
    moments = ((points - position[:, None]).conj() * forces).imag
    beyond = places > middle[:, None]
    moment, force = np.sum(moments * beyond, axis=1), beyond @ forces
    if acting is not None:
        more = acting.beyond(state.axis, middle, seen.segment)
        force, moment = force + more[0], moment + more[1]
    stretches = state.beam.stretches
    along = dot(np.exp(1j * seen.psi), force) if stretches else np.zeros(s.size)
    if setting.sections.law is not None:
        response, strains = responding(setting, state, seen)
        strain = response.loaded(strains, moment, along)
    else:
        strain = np.abs(moment) / seen.stiffness * (setting.sections.thickness(s) / 2)
        if stretches:
            strain += np.abs(along) / setting.sections.EA(s)
    i = int(np.argmax(strain))
    place, value = vertex(s, strain, i)
    for j in np.flatnonzero(s == s[i]).tolist():  # where segments end: beside it, perhaps
        inner = j + {0: 1, _ALONG.size - 1: -1}.get(j % _ALONG.size, 0)
        near = vertex(s, strain, inner, beyond=True) if inner != j else (place, value)
        place, value = near if abs(near[0] - s[inner]) < abs(s[j] - s[inner]) else (place, value)
    return value, place
