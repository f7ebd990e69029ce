"""A deflected finger, read once at all stations that a result needs."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact_forces import loads
from gripper.equilibrium import Equilibrium, Setting, State
from gripper.outline import dot
from gripper.parabola import vertex

_DRAWN = np.linspace(0.0, 1.0, 81)
_AT = 1e-9  # of L: a segment that ends this near to a contact ends there
_ALONG = np.linspace(0.0, 1.0, 13)


@functools.cache
def _zeros(count: int) -> Array:
    """The zeros of P_count."""
    return np.polynomial.legendre.leggauss(count)[0]


@dataclass(frozen=True, eq=False)
class Profile:
    """What is read of a deflected finger; lengths by L, stiffness EI over EI(0)."""

    s: Array
    position: Complex
    psi: Array
    kappa: Array
    half: Array  # w / 2
    stiffness: Array
    drawn: slice
    balance: slice
    strain: slice


def _before_contact(state: State) -> int:
    """How many segments end before the first contact, or at it."""
    first = min((site.place[0] for site in state.sites if site.on_face and site.place), default=1.0)
    return max(1, sum(end <= first + _AT for end in state.beam.breaks[1:]))


@functools.lru_cache(maxsize=8)  # a pose's is asked for by its result and by the motion's extremes
def profile(setting: Setting, state: State) -> Profile:
    """Read the shape, where the balance is checked, and where strains are looked at."""
    beam = state.beam
    drawn = np.union1d(_DRAWN, beam.breaks)
    clear = _before_contact(state)
    balance = (beam.starts[:clear, None] + beam.lengths[:clear, None] * (_zeros(beam.modes) + 1) / 2).ravel()
    strain = (beam.starts[:, None] + beam.lengths[:, None] * _ALONG).ravel()
    s = np.concatenate([drawn, balance, strain])
    clamped, along = (
        np.arange(count).repeat(points) for count, points in ((clear, beam.modes), (beam.segments, _ALONG.size))
    )
    segment = np.concatenate([beam.segment_of(drawn), clamped, along])
    position, psi, _, kappa = state.axis.values(s, segment)
    half, stiffness = setting.sections.thickness(s) / 2, setting.sections.EI(s)
    first, second = drawn.size, drawn.size + balance.size
    spans = slice(0, first), slice(first, second), slice(second, s.size)
    return Profile(s, position, psi, kappa, half, stiffness, *spans)


@functools.lru_cache(maxsize=8)
def largest_strain(setting: Setting, equilibrium: Equilibrium) -> tuple[float, float]:
    """Largest abs(eps) + abs(kappa) w / 2 and its s (by L), both from the contact forces beyond each section.

    The forces and their moment are as good as the forces; the strain fields are right in the mean only.
    """
    state, lin = equilibrium.state, equilibrium.linear
    if not state.sites:
        return 0.0, 0.0
    seen = profile(setting, state)
    position, s = seen.position[seen.strain], seen.s[seen.strain]
    # which side of a force at a break a sample is on
    middle = s - np.tile((_ALONG - 0.5) * 1e-9, state.beam.segments)
    on_face = zip(state.sites, lin.stations, strict=True)
    places = np.concatenate([u if site.on_face else np.full(u.size, 2.0) for site, u in on_face])
    points, forces = loads(equilibrium)
    moments = ((points - position[:, None]).conj() * forces).imag
    beyond = places > middle[:, None]
    moment = np.sum(moments * beyond, axis=1)
    strain = np.abs(moment) / seen.stiffness[seen.strain] * seen.half[seen.strain]
    if state.beam.stretches:
        along = dot(np.exp(1j * seen.psi[seen.strain]), beyond @ forces)
        strain += np.abs(along) / state.beam.sections.EA(s)
    place, value = vertex(s, strain, int(np.argmax(strain)))
    return value, place
