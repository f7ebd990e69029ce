"""The exact equilibrium of a known set of contacts: Newton on the KKT system, with places unknown.

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
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg.lapack import dgesv

from gripper.arrays import Array, Complex
from gripper.beam.axis import Axis
from gripper.beam.energy import energy, energy_gradient, energy_hessian
from gripper.beam.sections import Sections
from gripper.beam.strains import Beam, BeamTheory
from gripper.contact.linear import linearise
from gripper.contact.obstacle import Frame, Obstacle
from gripper.contact.outline import Outline
from gripper.contact.rows import Linearisation
from gripper.contact.site import WIDE, Site
from gripper.objects import Object
from gripper.statics.acting import Acting
from gripper.statics.compiled_loads import Loads

if TYPE_CHECKING:
    from gripper.contact.law import Law

_ITERATIONS = 20
_CONVERGED = 1e-6  # last step, relative: the next one, of second order, would be round-off
_ROUND_OFF = 1e-9  # relative: what must then be left of the forces
_FLUSH_ORDER = 5  # of strains that tell a pressure of many modes from the force of the corner that it ends in
_FITS = 1e-3  # last step, relative: below it the fields fit the places
_NARROWEST = 1e-8  # of L: breaks nearer than this are one
_SMALL = 1e-6  # of L
_EXACT = 1e-7  # of the shortest segment: breaks this near are the same
_NO_STRAIN = 1e-8  # |z| below which steps are judged by their own size: round-off of the gap moves z by 1e-16
_FURTHEST = 0.15  # of L: the most that a place moves in a step of Newton's
_SHRINKING = 0.5  # the most of its width that a patch loses in one
_DEPARTS = 0.3  # of a step of the loads: what it may differ from its prediction
_LEAST = 1e-4  # of the loads: the shortest step in which they grow
_WILD = 1e3  # |z|: a finger rolled up hundreds of times


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

    def breaks(self, sites: tuple[Site, ...]) -> tuple[float, ...]:
        """Where segments end: at these contacts, at the profile's own cuts, and where loads act."""
        marks = sorted({0.0, 1.0, *self.sections.cuts, *self.kinks}.union(*(site.breaks() for site in sites)))
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
        return np.concatenate([np.zeros(0), *(site.coordinates for site in self.sites)])

    def moved(self, dz: Array, dmultipliers: Array, dplaces: Array) -> State:
        """The state after a step in all unknowns."""
        sites, first = [], 0
        for site in self.sites:
            last = first + site.unknowns
            sites.append(site.moved(site.coordinates + dplaces[first:last]))
            first = last
        grip = sites[0].grip if sites else None
        moved = grip.law.shared(tuple(sites)) if grip else tuple(sites)
        return State(self.beam, self.z + dz, moved, self.multipliers + dmultipliers)

    @property
    def loads(self) -> list[Array]:
        """The multipliers of each contact."""
        return np.split(self.multipliers, np.cumsum([site.multipliers for site in self.sites], dtype=int))[:-1]

    def keeping(self, keep: Sequence[bool]) -> State:
        """The state with some of its contacts only."""
        sites = tuple(itertools.compress(self.sites, keep))
        if sites and sites[0].grip:
            sites = sites[0].grip.law.grouped(sites)  # one that others followed may be gone
        return replace(self, sites=sites, multipliers=np.concatenate(list(itertools.compress(self.loads, keep))))

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

    def matrix(self) -> Array:
        """The KKT matrix in (z, lambda, u)."""
        return _matrix(self.state, self.linear)

    def tangent(self) -> Step:
        """Rates of z, the multipliers and the places with the motion's parameter, the segments held still."""
        return self._tangent

    @functools.cached_property
    def _tangent(self) -> Step:
        lin = self.linear
        rates = solved(self.matrix(), np.concatenate([lin.load_rates, -lin.value_rates, -lin.residual_rates]))
        if rates is None:
            raise np.linalg.LinAlgError("the tangent is vertical")
        return _split(rates, lin)

    @property
    def stored(self) -> float:
        """Strain energy and the loads' potential, over EI(0) / L: what the drive changes."""
        push = self.linear.push
        return self.state.energy if push is None else self.state.energy + push.potential

    @property
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


def _matrix(state: State, lin: Linearisation) -> Array:
    n, m, k = lin.gradients.shape[1], len(lin.values), len(lin.residuals)
    matrix = np.zeros((n + m + k, n + m + k), order="F")  # as LAPACK has it
    np.subtract(state.energy_hessian, lin.hessian, out=matrix[:n, :n])
    matrix[:n, n : n + m], matrix[:n, n + m :] = -lin.loads.T, -lin.load_slopes
    matrix[n : n + m, :n], matrix[n : n + m, n + m :] = lin.gradients, lin.value_slopes
    matrix[n + m :, :n], matrix[n + m :, n + m :] = lin.residual_gradients, lin.residual_slopes
    return matrix


def _split(step: Array, lin: Linearisation) -> Step:
    n, m = lin.gradients.shape[1], len(lin.values)
    return step[:n], step[n : n + m], step[n + m :]


def kkt_step(state: State, lin: Linearisation, *, held: bool = False) -> Step:
    """Newton's step in z, multipliers and places; in z and multipliers alone with the places held.

    Raises
    ------
    NoEquilibriumError
        Where the system is singular.
    """
    matrix = _matrix(state, lin)
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


def advanced(setting: Setting, state: State, step: Step) -> State:
    """The state after a step in z (with the segments held still), the multipliers and the places.

    The segments move along with the contacts, and their fields with them.
    """
    moved = state.moved(*step)
    breaks = setting.breaks(moved.sites)
    if len(breaks) != len(state.beam.breaks):
        return moved
    moves = np.array(breaks) - state.beam.breaks
    if np.abs(moves).max() < _EXACT * state.beam.lengths.min():
        return moved
    carried = state.beam.convection(state.z, moves)
    return _carried(setting, moved, breaks, state.beam.coefficients(moved.z) + carried)


def _carried(setting: Setting, state: State, breaks: tuple[float, ...], fields: Array) -> State:
    """The state with these fields on segments that end elsewhere."""
    beam = state.beam
    if breaks != beam.breaks:
        beam = Beam(setting.sections, breaks, beam.order, setting.theory)
    return replace(state, beam=beam, z=beam.unknowns(fields, state.beam.base_turn(state.z)))


def predicted(
    setting: Setting, now: Equilibrium, change: float, last: tuple[Equilibrium, float] | None = None
) -> State:
    """The state a change of the parameter further: along the tangent, bent as it has turned since the last one.

    Parameters
    ----------
    setting, now
        Where it starts.
    change
        Of the parameter.
    last
        An earlier equilibrium of the same contacts, and how far back on the parameter.

    Raises
    ------
    NoEquilibriumError
        At a limit point, where the tangent is vertical.
    """
    try:
        rates = now.tangent()
        before = last[0].tangent() if last else rates
    except np.linalg.LinAlgError as error:
        raise NoEquilibriumError("the tangent is vertical (a limit point)") from error
    if last is None:
        return advanced(setting, now.state, (change * rates[0], change * rates[1], change * rates[2]))
    then, back = last
    turned = change**2 / 2 / back
    bent = [change * rate + turned * (rate - old) for rate, old in zip(rates[1:], before[1:], strict=True)]
    moved = now.state.moved(change * rates[0], *bent)
    breaks = setting.breaks(moved.sites)
    if len(breaks) != len(now.state.beam.breaks):
        return moved
    flow, old_flow = _flow(setting, now), _flow(setting, then)
    # the tangent is that of segments held still, which cannot follow the kinks exactly: off by as much as it was before
    off = (now.state.fields - then.state.fields) / back - (flow + old_flow) / 2
    return _carried(setting, moved, breaks, now.state.fields + change * (flow + off) + turned * (flow - old_flow))


@functools.lru_cache(maxsize=8)  # where a step ends the next one starts
def _flow(setting: Setting, equilibrium: Equilibrium) -> Array:
    """Rates of the fields' coefficients, the segments moving with the contacts: (fields, segments, p + 1)."""
    state, (dz, dmultipliers, dplaces) = equilibrium.state, equilibrium.tangent()
    small = _SMALL / max(_largest(dplaces), 1.0)
    moved = setting.breaks(state.moved(0 * dz, 0 * dmultipliers, small * dplaces).sites)
    moves = (
        np.subtract(moved, state.beam.breaks) / small if len(moved) == len(state.beam.breaks) else 0 * state.beam.starts
    )
    return state.beam.coefficients(dz) + state.beam.convection(state.z, moves)


def _shortening(state: State, dplaces: Array) -> float:
    """Factor on a step such that no place runs away and no patch turns inside out."""
    factor, first = 1.0, 0
    for site in state.sites:
        steps = dplaces[first : first + site.unknown_places].tolist()
        first += site.unknowns
        factor = min([factor, *(_FURTHEST / abs(step) for step in steps if abs(step) > _FURTHEST)])
        if site.kind in ("patch", "tail"):
            widening = (steps[1] if len(steps) > 1 else 0.0) - steps[0]
            least = -_SHRINKING * (site.place[1] - site.place[0])
            factor = min(factor, least / widening if widening < least else 1.0)
    return factor


def settle(setting: Setting, obstacle: Obstacle, state: State, order: int) -> Equilibrium:
    """Newton, the segments cut anew at the contacts' places before every step, so that they end where those are.

    Raises
    ------
    NoEquilibriumError
        Where it does not converge.
    """
    if not state.sites:
        return unloaded(setting, obstacle, order, state if state.z.any() else None)
    if any(site.kind in ("patch", "tail") and site.place[0] >= site.place[1] for site in state.sites):
        raise NoEquilibriumError("a patch has shrunk to nothing")
    if any(site.lifts_off and site.modes == WIDE for site in state.sites):
        order = max(order, _FLUSH_ORDER)
    return _newton(setting, obstacle, state, order)


def _newton(setting: Setting, obstacle: Obstacle, state: State, order: int) -> Equilibrium:
    last, way, held = np.inf, 0.0, False
    flush = any(site.lifts_off for site in state.sites)
    for iteration in range(_ITERATIONS):
        if iteration == 0 and not _fitted(setting, state, order):
            state = state.on(setting.beam(state.sites, order))
        lin = linearise(state.beam, state.z, setting.outline, obstacle, state.sites, state.multipliers)
        state = anchored(state, lin) if iteration == 0 else state
        if last < _CONVERGED and (last < _ROUND_OFF or _unbalanced(state, lin) < _ROUND_OFF):
            return Equilibrium(state, obstacle, lin, iteration, way)
        # flush on a flat: how the place of lift-off answers to steps shows only once the fields fit that place
        held = flush and not held and last > _FITS
        dz, dmultipliers, dplaces = kkt_step(state, lin, held=held)
        factor = _shortening(state, dplaces)
        state = advanced(setting, state, (factor * dz, factor * dmultipliers, factor * dplaces))
        length, size = factor * _size(dz), _size(state.z)
        way += length
        last = max(length / (size + _NO_STRAIN), float(held), _largest(dplaces))
        if not math.isfinite(last) or size > _WILD or _largest(state.multipliers) > _WILD**2:
            raise NoEquilibriumError("Newton's iteration diverged")
    raise NoEquilibriumError(f"Newton's iteration did not converge in {_ITERATIONS} steps")


def _unbalanced(state: State, lin: Linearisation) -> float:
    """What is left of the stationarity condition, relative."""
    left = _size(state.energy_gradient - lin.load(state.multipliers))
    return left / (_size(state.z) + _NO_STRAIN)


def _size(vector: Array) -> float:
    """Its length: of vectors this short numpy's norm takes longer."""
    return math.sqrt(float(vector @ vector))


def _largest(values: Array) -> float:
    """The largest of a few in size."""
    return max(map(abs, values.tolist()), default=0.0)


@functools.lru_cache(maxsize=16)
def straight(setting: Setting, order: int) -> State:
    """The finger that nothing touches."""
    beam = setting.beam((), order)
    return State(beam, np.zeros(beam.size))


def unloaded(setting: Setting, obstacle: Obstacle, order: int, start: State | None = None) -> Equilibrium:
    """The equilibrium of the finger that nothing touches.

    Parameters
    ----------
    setting, obstacle
        The obstacle tells what else acts.
    order
        Of the strain fields.
    start
        Of Newton's method, where loads bend the finger; by default these grow from none.

    Raises
    ------
    NoEquilibriumError
        Where the loads alone leave none that is stable.
    """
    if obstacle.acting is not None:
        return _bent(setting, obstacle, order, start)
    state = straight(setting, order)
    return Equilibrium(state, obstacle, linearise(state.beam, state.z, setting.outline, obstacle, (), np.empty(0)), 0)


def _bent(setting: Setting, obstacle: Obstacle, order: int, start: State | None) -> Equilibrium:
    """The equilibrium of the finger that only the loads bend: the one near a start, or that they grow to from none."""
    if start is not None:
        try:
            found = _newton(setting, obstacle, State(start.beam, start.z), order)
            if firmness(found.state, found.linear) > 0:
                return found
        except NoEquilibriumError:
            pass  # not near enough
    acting = obstacle.acting
    last, reached, step = straight(setting, order), 0.0, 1.0
    while acting is not None and reached < 1:
        part = min(reached + step, 1.0)
        partly = Obstacle(obstacle.body, obstacle.length, obstacle.frame, replace(acting, part=part))
        now = linearise(last.beam, last.z, setting.outline, partly, (), np.empty(0))
        way = np.linalg.solve(last.energy_hessian - now.hessian, now.load(last.multipliers) - last.energy_gradient)
        try:
            found = _newton(setting, partly, replace(last, z=last.z + way), order)
            if found.correction > _DEPARTS * np.linalg.norm(way) or firmness(found.state, found.linear) <= 0:
                raise NoEquilibriumError("the step departs from its prediction, or leads to what is not stable")
            last, reached, step = found.state, part, 2 * step
        except NoEquilibriumError as error:
            step /= 2
            if step < _LEAST:
                share = f"{100 * reached:.3g} % of them"
                raise NoEquilibriumError(f"the loads alone have no stable equilibrium beyond {share}") from error
    return found


def firmness(state: State, lin: Linearisation) -> float:
    """How far a finger that nothing touches is from losing its stability (V's own, linear: 1): below 0 it has lost it.

    The smallest eigenvalue of its Hessian. Where a load follows the finger, the smallest singular value of what is then
    no Hessian, less than 0 where its determinant has changed its sign: it tells of divergence, not of flutter.
    """
    stiffness = state.energy_hessian - lin.hessian
    if lin.push is None or lin.push.conservative:
        return float(np.linalg.eigvalsh((stiffness + stiffness.T) / 2)[0])
    sign = np.linalg.slogdet(stiffness)[0]
    return float(sign * np.min(np.linalg.svd(stiffness, compute_uv=False)))


def _fitted(setting: Setting, state: State, order: int) -> bool:
    """Whether the beam is this setting's, of this order, and its segments end where the contacts are."""
    beam, breaks = state.beam, setting.breaks(state.sites)
    if beam.sections is not setting.sections or beam.theory != setting.theory or beam.order != order:
        return False
    if len(breaks) != len(beam.breaks):
        return False
    return bool(np.abs(np.subtract(breaks, beam.breaks)).max() < _EXACT * beam.lengths.min())
