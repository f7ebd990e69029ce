"""The exact equilibrium of a known set of contacts: its KKT system, with places unknown.

Unknowns are the beam's z, the multipliers lambda and the contacts' places u; the equations are

    dV/dz - C_z^T lambda = 0,   C(z, u) = 0,   R(z, u) = 0,

V's gradient being z and its Hessian the identity unless the material has a law of its own (:mod:`gripper.beam.energy`).
With friction the loads are not C_z but what the inclined forces do, and a contact that sticks has one more unknown, its
ratio of friction, and one more equation: no slip (:mod:`gripper.contact.rubbing`). The same matrix gives the tangent
along a motion, the stability and the error estimate. Segments end at the contacts: they are cut anew until the places
that come out are those that went in.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg.lapack import dgesv

from gripper.arrays import Array, Complex, Index
from gripper.beam.axis import Axis
from gripper.beam.energy import energy, energy_gradient, energy_hessian
from gripper.beam.sections import Sections
from gripper.beam.strains import Beam, BeamTheory
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Frame, Obstacle
from gripper.contact.outline import Outline
from gripper.contact.site import Site, tied
from gripper.objects import Object
from gripper.statics.acting import Acting
from gripper.statics.compiled_loads import Loads

if TYPE_CHECKING:
    from gripper.contact.law import Law

_ENRICHED = 2  # modes more that judge an equilibrium
_NARROWEST = 1e-8  # of L: breaks nearer than this are one


Step = tuple[Array, Array, Array]
"""Changes of z (n,), of the multipliers (m,) and of the places (k,)."""


@dataclass(frozen=True, eq=False)
class Setting:
    """What stays the same over a motion: the finger, its outline, the theory, the object."""

    sections: Sections
    outline: Outline
    theory: BeamTheory
    body: Object
    tolerance: float
    friction: Law | None = None
    loads: Loads | None = None

    def obstacle(self, frame: Frame) -> Obstacle:
        """The object at a pose."""
        acting = None if self.loads is None else Acting(self.loads, frame.stage)
        return Obstacle(self.body, self.sections.length, frame, acting)

    @functools.cached_property
    def clamped(self) -> Complex:
        """Points of the clamped section (3,), by L."""
        half = float(self.sections.thickness(np.zeros(1))[0]) / 2
        return np.array([-1j, 0j, 1j]) * half

    @property
    def kinks(self) -> tuple[float, ...]:
        """Where strains jump without contact: at the profile's kinks, and where loads act."""
        return self.sections.kinks if self.loads is None else (*self.sections.kinks, *self.loads.marks)

    @functools.cached_property
    def _marks(self) -> tuple[float, ...]:
        """Where segments end whatever touches."""
        return (0.0, 1.0, *self.sections.cuts, *self.kinks)

    def breaks(self, sites: tuple[Site, ...]) -> tuple[float, ...]:
        """Where segments end: at these contacts, at the profile's own cuts, and where loads act."""
        marks = list(self._marks)
        for site in sites:
            marks += site.breaks()
        marks.sort()
        breaks = [0.0]
        for mark in marks:
            if mark - breaks[-1] > _NARROWEST and (1.0 - mark > _NARROWEST or mark == 1.0):
                breaks.append(mark)
        return tuple(breaks)

    def beam(self, sites: tuple[Site, ...], order: int) -> Beam:
        """A beam whose segments end where those of these contacts do."""
        return Beam(self.sections, self.breaks(sites), order, self.theory)


@dataclass(frozen=True, eq=False)
class State:
    """A deflected finger and its contacts."""

    beam: Beam
    z: Array
    sites: tuple[Site, ...] = ()
    multipliers: Array = field(default_factory=lambda: np.empty(0))

    @functools.cached_property
    def axis(self) -> Axis:
        """The deflected axis."""
        return Axis.of(self.beam, self.z)

    @property
    def fields(self) -> Array:
        """The strain fields' coefficients, (fields, segments, p + 1)."""
        return self.axis.fields

    @functools.cached_property
    def energy(self) -> float:
        """Strain energy over EI(0) / L."""
        return energy(self.beam, self.z)

    @functools.cached_property
    def energy_gradient(self) -> Array:
        """Its gradient by z, (n,)."""
        return energy_gradient(self.beam, self.z)

    @property
    def energy_hessian(self) -> Array:
        """Its Hessian by z, (n, n)."""
        return energy_hessian(self.beam, self.z)

    @property
    def places(self) -> Array:
        """The contacts' unknowns, one after the other."""
        return np.array([value for site in self.sites for value in site.coordinates])

    @functools.cached_property
    def kinds(self) -> tuple[object, ...]:
        """What states have in common that have the same contacts, held alike, and the same unknowns."""
        sites = [
            (s.kind, s.piece, s.vertex, s.modes, s.unknowns, s.grip and (s.grip.hold, s.grip.sense)) for s in self.sites
        ]
        return (self.z.size, *sites)

    @functools.cached_property
    def followed(self) -> Array:
        """What a motion follows: the fields' coefficients, the multipliers and the places, one after the other."""
        return np.concatenate([self.fields.ravel(), self.multipliers, self.places])

    def moved(self, dz: Array, dmultipliers: Array, dplaces: Array) -> State:
        """The state after a step in all unknowns."""
        return State(self.beam, self.z + dz, self.placed(self.places + dplaces), self.multipliers + dmultipliers)

    def placed(self, places: Array) -> tuple[Site, ...]:
        """The contacts at other values of their unknowns."""
        if len(self.sites) == 1:
            return (self.sites[0].moved(places),)
        sites, first = [], 0
        for site in self.sites:
            last = first + site.unknowns
            sites.append(site.moved(places[first:last]))
            first = last
        grip = sites[0].grip if sites else None
        return grip.law.shared(tuple(sites)) if grip else tied(tuple(sites))

    @property
    def loads(self) -> list[Array]:
        """The multipliers of each contact."""
        loads, first = [], 0
        for site in self.sites:
            loads.append(self.multipliers[first : first + site.multipliers])
            first += site.multipliers
        return loads

    def keeping(self, keep: Sequence[bool]) -> State:
        """The state with some of its contacts only."""
        sites = tuple(itertools.compress(self.sites, keep))
        if sites and sites[0].grip:
            sites = sites[0].grip.law.grouped(sites)  # one that others followed may be gone
        kept = [np.empty(0), *itertools.compress(self.loads, keep)]
        return replace(self, sites=sites, multipliers=np.concatenate(kept))

    def enriched(self) -> tuple[State, Index]:
        """The state among two modes more a field, and which of the unknowns are its own."""
        beam, kept = self.beam.richer(_ENRICHED)
        z = np.zeros(beam.size)
        z[kept] = self.z
        return State(beam, z, self.sites, self.multipliers), kept

    def on(self, beam: Beam) -> State:
        """The strains nearest to these on other segments."""
        return replace(self, beam=beam, z=beam.project(self.beam, self.z))


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A converged state with the linearisation that it converged on."""

    state: State
    obstacle: Obstacle
    linear: Linearisation
    iterations: int
    correction: float = 0.0
    """Length of Newton's way in z: how far the start was off."""
    enriched: tuple[State, Linearisation] | None = None
    """The state among more modes, and its linearisation there, where the error was to be estimated."""

    def matrix(self) -> Array:
        """The KKT matrix in (z, lambda, u), the segments held still."""
        return _matrix(self.state, self.linear, self.linear.load_slopes)

    def tangent(self) -> Step:
        """Rates of z, the multipliers and the places with the motion's parameter.

        Those of z are at segments held still, as of a shape whose kinks are carried along by the places.
        """
        return self._tangent

    @functools.cached_property
    def _tangent(self) -> Step:
        rates = solved(carried_matrix(self.state, self.linear), self.passing())
        if rates is None:
            raise np.linalg.LinAlgError("the tangent is vertical")
        return _split(rates, self.linear)

    def passing(self) -> Array:
        """What the object's motion, and that of the loads, adds to the right-hand side, (n + m + k,)."""
        values, residuals, loads = self.linear.rates()
        return np.concatenate([loads, -values, -residuals])

    @property
    def stored(self) -> float:
        """Strain energy and the loads' potential, over EI(0) / L: what the drive changes."""
        push = self.linear.push
        return self.state.energy if push is None else self.state.energy + push.potential

    @functools.cached_property
    def force(self) -> complex:
        """Total contact force on the finger, x + iy."""
        return complex(sum(f.sum() for f in self.linear.forces))


def anchored(state: State, lin: Linearisation) -> State:
    """Contacts that stick and have no anchor yet begin to where they are."""
    if lin.rubbing is None or not any(s.grip and s.grip.hold == "stick" and s.grip.anchor is None for s in state.sites):
        return state
    sites = [
        replace(site, grip=replace(site.grip, anchor=anchor))
        if site.grip is not None and site.grip.hold == "stick" and site.grip.anchor is None
        else site
        for site, anchor in zip(state.sites, lin.rubbing.anchors, strict=True)
    ]
    return replace(state, sites=tuple(sites))


class NoEquilibriumError(Exception):
    """Newton found no equilibrium with this set of contacts; says why.

    Parameters
    ----------
    reason
        In words.
    effort
        How often the gaps were evaluated in vain.
    """

    def __init__(self, reason: str, effort: int = 0) -> None:
        super().__init__(reason)
        self.effort = effort


@contextmanager
def reckoned() -> Iterator[None]:
    """Arithmetic that breaks down within is a refusal with a reason.

    Raises
    ------
    NoEquilibriumError
        In place of a matrix that cannot be factorised, an overflow or a division by zero.
    """
    try:
        yield
    except (np.linalg.LinAlgError, ArithmeticError) as error:
        raise NoEquilibriumError(f"the arithmetic breaks down: {error}") from error


def carried_matrix(state: State, lin: Linearisation) -> Array:
    """The KKT matrix in (z, lambda, u) of a finger whose segments' ends are carried along by the places."""
    return _matrix(state, lin, lin.carried_slopes)


def _matrix(state: State, lin: Linearisation, load_slopes: Array) -> Array:
    n, m, k = lin.gradients.shape[1], len(lin.values), len(lin.residuals)
    matrix = np.zeros((n + m + k, n + m + k), order="F")  # as LAPACK has it
    np.subtract(state.energy_hessian, lin.hessian, out=matrix[:n, :n])
    matrix[:n, n : n + m], matrix[:n, n + m :] = -lin.loads.T, -load_slopes
    matrix[n : n + m, :n], matrix[n : n + m, n + m :] = lin.gradients, lin.value_slopes
    matrix[n + m :, :n], matrix[n + m :, n + m :] = lin.residual_gradients, lin.residual_slopes
    return matrix


def _split(step: Array, lin: Linearisation) -> Step:
    n, m = lin.gradients.shape[1], len(lin.values)
    return step[:n], step[n : n + m], step[n + m :]


def kkt_step(state: State, lin: Linearisation, *, held: bool = False) -> Step:
    """Newton's step in z, multipliers and places, which carry the ends of their segments along.

    In z and multipliers alone with the places held.

    Raises
    ------
    NoEquilibriumError
        Where the system is singular.
    """
    matrix = carried_matrix(state, lin)
    left = np.concatenate([state.energy_gradient - lin.load(state.multipliers), lin.values, lin.residuals])
    if held:
        first = len(left) - len(lin.residuals)
        matrix[first:], left[first:] = np.eye(len(left))[first:], 0.0
    step = solved(matrix, -left)
    if step is None:
        raise NoEquilibriumError("the KKT system is singular (parallel constraints)")
    return _split(step, lin)


def solved(matrix: Array, right: Array) -> Array | None:
    """The solution of a linear system, whose matrix is overwritten; None where it is singular.

    LAPACK's own routine: numpy's and scipy's functions take twice as long on matrices of this size.
    """
    *_, solution, info = dgesv(matrix, right, overwrite_a=True, overwrite_b=True)
    return None if info else solution
