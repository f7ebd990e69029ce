"""Newton's method for a known set of contacts, and for the finger that only its loads bend."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np

from gripper.arrays import Array
from gripper.contact.linear import linearise
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Obstacle
from gripper.contact.site import WIDE
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, anchored, kkt_step
from gripper.statics.patches import flushed
from gripper.statics.steps import advanced, ends_at, largest

_ITERATIONS = 20
_SQUARED = 3.0  # of what may be left: the square of the last step, which the next one is about, may be as large
_LEFT = 5e-5  # of the tolerance: what may then be left of the equations, relative
_LEAST_LEFT, _MOST_LEFT = 1e-10, 5e-9  # within these bounds
_PRECISE = 1e-8  # tolerance of an equilibrium that is differentiated
_FLUSH_ORDER = 5  # of strains that tell a pressure of many modes from the force of the corner that it ends in
_FITS = 1e-3  # last step, relative: below it the fields fit the places
_NO_STRAIN = 1e-8  # |z| below which steps are judged by their own size: round-off of the gap moves z by 1e-16
_NO_REACH = 1e-4  # |dC/dz| below which what is left of a contact is judged by its own size
_ROUND_OFF = 1e-15  # of a gap, by L
_FURTHEST = 0.15  # of L: the most that a place moves in a step of Newton's
_SHRINKING = 0.5  # the most of its width that a patch loses in one
_DEPARTS = 0.3  # of a step of the loads: what it may differ from its prediction
_LEAST = 1e-4  # of the loads: the shortest step in which they grow
_WILD = 1e3  # |z|: a finger rolled up hundreds of times


def _shortening(state: State, dplaces: Array) -> float:
    """Factor on a step such that no place runs away and no patch turns inside out."""
    factor, first, each = 1.0, 0, dplaces.tolist()
    for site in state.sites:
        count = site.unknown_places
        steps = each[first : first + count]
        first += site.unknowns
        for step in steps:
            if not -_FURTHEST <= factor * step <= _FURTHEST:
                factor = _FURTHEST / abs(step)
        if steps and site.spreads:
            widening = (steps[1] if count > 1 else 0.0) - steps[0]
            least = -_SHRINKING * (site.place[1] - site.place[0])
            if factor * widening < least:
                factor = least / widening
    return factor


def settle(setting: Setting, obstacle: Obstacle, state: State, order: int, *, judged: bool = False) -> Equilibrium:
    """Newton, the segments cut anew at the contacts' places before every step, so that they end where those are.

    Where its error is going to be estimated (``judged``) the last linearisation is that of the enriched system, which
    holds its own.

    Raises
    ------
    NoEquilibriumError
        Where it does not converge.
    """
    if not state.sites:
        return unloaded(setting, obstacle, order, state if state.z.any() else None)
    if any(site.spreads and site.place[0] >= site.place[1] for site in state.sites):
        raise NoEquilibriumError("a patch has shrunk to nothing")
    if any(site.kind != "patch" and site.modes >= WIDE for site in state.sites):
        order = max(order, _FLUSH_ORDER)
    if state.sites[0].grip is not None:
        state = flushed(setting, obstacle, state)
    return _newton(setting, obstacle, state, order, judged=judged and obstacle.acting is None)


def _newton(setting: Setting, obstacle: Obstacle, state: State, order: int, *, judged: bool = False) -> Equilibrium:
    last, way, held = np.inf, 0.0, False
    flush, settled = any(site.lifts_off for site in state.sites), _settled(setting)
    for iteration in range(_ITERATIONS):
        close = last * last < _SQUARED * settled
        if iteration == 0 and not _fitted(setting, state, order):
            state = state.on(setting.beam(state.sites, order))
        lin, enriched = _linear(setting, obstacle, state, enrich=judged and close)
        state = anchored(state, lin) if iteration == 0 else state
        if close and (last < settled or _left(state, lin) < settled):
            return Equilibrium(state, obstacle, lin, iteration, way, enriched)
        # flush on a flat: how the place of lift-off answers to steps shows only once the fields fit that place
        held = flush and not held and last > _FITS
        dz, dmultipliers, dplaces = kkt_step(state, lin, held=held)
        factor = _shortening(state, dplaces)
        state = advanced(setting, state, (factor * dz, factor * dmultipliers, factor * dplaces))
        length, size = factor * _size(dz), _size(state.z)
        way += length
        last = max(length / (size + _NO_STRAIN), float(held), largest(dplaces))
        if not math.isfinite(last) or size > _WILD or largest(state.multipliers) > _WILD**2:
            raise NoEquilibriumError("Newton's iteration diverged")
    raise NoEquilibriumError(f"Newton's iteration did not converge in {_ITERATIONS} steps")


def polished(setting: Setting, equilibrium: Equilibrium) -> Equilibrium:
    """The equilibrium to round-off, its segments ending where its contacts are: itself, where it is so already.

    A pose is settled as far as its tolerance asks; derivatives magnify what that leaves.

    Raises
    ------
    NoEquilibriumError
        Where Newton's method does not converge: at a limit point.
    """
    state, precise = equilibrium.state, replace(setting, tolerance=min(_PRECISE, setting.tolerance))
    settled = _left(state, equilibrium.linear) < _settled(precise) or _size(state.z) < _NO_STRAIN
    if settled and _fitted(precise, state, state.beam.order):
        return equilibrium
    return settle(precise, equilibrium.obstacle, state, state.beam.order)


def _linear(
    setting: Setting, obstacle: Obstacle, state: State, *, enrich: bool
) -> tuple[Linearisation, tuple[State, Linearisation] | None]:
    """The linearisation at a state; where it is to be enriched, as a part of that."""
    if not enrich or state.sites[0].grip is not None:
        return linearise(state.beam, state.z, setting.outline, obstacle, state.sites, state.multipliers), None
    richer, kept = state.enriched()
    whole = linearise(richer.beam, richer.z, setting.outline, obstacle, state.sites, state.multipliers)
    return whole.keeping(kept), (richer, whole)


def _settled(setting: Setting) -> float:
    """What may be left of an equation, relative."""
    return min(max(_LEFT * setting.tolerance, _LEAST_LEFT), _MOST_LEFT)


def _left(state: State, lin: Linearisation) -> float:
    """The most that is left of an equation: of the stationarity, of the contacts' and of their places', relative."""
    size = _size(state.z) + _NO_STRAIN
    left = _size(state.energy_gradient - lin.load(state.multipliers)) / size
    rows = np.concatenate([lin.gradients, lin.residual_gradients])
    reach = np.sqrt(np.einsum("kn,kn->k", rows, rows)) + _NO_REACH
    off = (np.abs(np.concatenate([lin.values, lin.residuals])) - _ROUND_OFF) / (reach * size)
    return float(off.max(initial=left))


def _size(vector: Array) -> float:
    """Its length: of vectors this short numpy's norm takes longer."""
    return math.sqrt(float(vector @ vector))


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
    return ends_at(beam, breaks, setting.tolerance)
