"""What makes an equilibrium an answer: nothing pulls, nothing penetrates, and it is stable."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dgeqrf, dormqr, dsyevr

from gripper.arrays import Array
from gripper.beam.legendre import legendre
from gripper.contact.linear import linearise
from gripper.contact.site import NARROW, Site
from gripper.statics.certificate import Survey, survey
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State
from gripper.statics.nearby import least_gaps
from gripper.statics.newton import firmness

_RIPPLE = 3e-2  # of the largest pressure: what a polynomial may leave where the pressure has decayed
_GRAZING = 1e-12  # of L: a gap's round-off
_FLAT = 1e-4  # curvature of the gap, times L: below it a tangent's place is held by the next order
_AT_END = 1e-3  # of L: a patch that ends so near to the corner of its face should end there
_AT_KINK = 1e-6  # of L: how far a fixed place may be from where the gap is least
_LEVEL = 1e-5  # slope of the gap where finger and object conform
NOTHING = 1e-13  # over EI / L^2: the round-off of no force
PULL = 1e-9  # relative: multipliers this negative are round-off


@dataclass(frozen=True, eq=False)
class Verified:
    """An equilibrium and the survey that found it clear."""

    equilibrium: Equilibrium
    survey: Survey
    stability: float = 1.0


def untouched(setting: Setting, free: Verified) -> bool:
    """Whether a finger without contacts is not even grazed."""
    equilibrium, found = free.equilibrium, free.survey
    if found.least > 0 or not found.clear:
        return found.clear
    gaps = least_gaps(setting, equilibrium.obstacle, equilibrium.state, found)
    return min((gap for gap, _ in gaps), default=found.min_gap) >= -_GRAZING


def objection(setting: Setting, equilibrium: Equilibrium) -> str | None:
    """Why an equilibrium of these contacts is none of the real ones, or None: pull, or a contact off its piece."""
    state = equilibrium.state
    largest = float(np.max(np.abs(state.multipliers), initial=0.0))
    if state.sites and largest < NOTHING:
        return "no contact carries anything"
    for site, load in zip(state.sites, state.loads, strict=True):
        pressure = _across(site.modes) @ load
        allowed = PULL * largest if site.modes <= NARROW else _RIPPLE * float(np.max(pressure))
        if float(np.min(pressure)) < -allowed:
            return "a contact would have to pull"
        if site.place and not 0 <= site.place[0] <= site.place[-1] <= setting.outline.pieces[site.piece].length:
            return "a contact has left its face or edge"
        if _doubled(setting, state, site):
            return "a patch ends beside the corner of its face that carries, not in it"
    return None


def _doubled(setting: Setting, state: State, site: Site) -> bool:
    """Whether a patch ends beside a corner that carries, too: the two ask for nearly the same."""
    if site.kind != "patch" or site.place[1] < 1 - _AT_END:
        return False
    corner = setting.outline.tip_corner(site.piece)
    return any(other.piece == corner for other in state.sites)


@functools.cache
def _across(modes: int) -> Array:
    """The pressure modes over a contact, (k, modes)."""
    return legendre(np.linspace(-1.0, 1.0, 17), modes)


def verify(setting: Setting, equilibrium: Equilibrium) -> Verified:
    """The equilibrium with its survey.

    Raises
    ------
    NoEquilibriumError
        Where a contact pulls, lies off its piece, something penetrates elsewhere, or the equilibrium is unstable.
    """
    reason = objection(setting, equilibrium) or _adrift(setting, equilibrium)
    if reason:
        raise NoEquilibriumError(reason)
    found = survey(setting, equilibrium.obstacle, equilibrium.state)
    if not found.clear:
        raise NoEquilibriumError("the object penetrates the finger elsewhere")
    stiffness = stability(equilibrium)
    if stiffness <= 0:
        raise NoEquilibriumError("the equilibrium is unstable")
    return Verified(equilibrium, found, stiffness)


def _adrift(setting: Setting, equilibrium: Equilibrium) -> str | None:
    """Whether a node is held by nothing, in words: its place is a kink of the profile, or the finger conforms there.

    Elsewhere the least gap has a place of its own, and the force would depend on where the node was made.
    """
    state = equilibrium.state
    nodes = [site for site in state.sites if site.kind == "node"]
    loose = [site for site in nodes if all(abs(site.middle - kink) > _AT_KINK for kink in setting.kinks)]
    if not loose:
        return None
    sites = tuple(replace(site, kind="tangent", grip=None) for site in loose)
    lin = linearise(state.beam, state.z, setting.outline, equilibrium.obstacle, sites, np.zeros(len(sites)))
    level = np.maximum(_LEVEL, _AT_KINK * np.abs(np.diag(lin.residual_slopes)))
    return "a contact is not where the gap is least" if np.any(np.abs(lin.residuals) > level) else None


def stability(equilibrium: Equilibrium) -> float:
    """Smallest eigenvalue of the Hessian reduced to the motions that the contacts leave free (V's own, linear: 1).

    With friction or loads that follow the finger, whose stiffness is not symmetric: its :func:`singularity`.
    """
    lin = equilibrium.linear
    if not len(lin.values):
        return 1.0 if lin.push is None else firmness(equilibrium.state, lin)
    if one_sided(equilibrium):
        return singularity(equilibrium)
    # places follow the motion: eliminate them where the gap is curved (points); where it is flat the tangent itself
    # is held; a patch is held by its pressures
    hessian, held = equilibrium.state.energy_hessian - lin.hessian, [lin.gradients]
    column = 0
    for site in equilibrium.state.sites:
        if site.kind in ("tangent", "vertex"):
            slide, curvature = lin.residual_gradients[column], float(lin.residual_slopes[column, column])
            if abs(curvature) < _FLAT:
                held.append(slide[None])
            else:
                hessian += np.outer(lin.load_slopes[:, column], slide) / curvature
        column += site.unknown_places
    return _least(hessian, np.concatenate(held) if len(held) > 1 else held[0])


def _least(hessian: Array, constraints: Array) -> float:
    """The smallest eigenvalue of a Hessian (n, n) over what constraints (m, n) leave free.

    By LAPACK's own routines: numpy's take twice as long on matrices of this size.

    Raises
    ------
    LinAlgError
        Where it is not found.
    """
    held, size = len(constraints), 64 * len(hessian)
    reflectors, scales, _, _ = dgeqrf(constraints.T)
    turned, _, _ = dormqr("L", "T", reflectors, scales, hessian, size)
    turned, _, _ = dormqr("R", "N", reflectors, scales, turned, size)
    reduced = turned[held:, held:]
    values, *_, info = dsyevr((reduced + reduced.T) / 2, compute_v=0, range="I", il=1, iu=1)
    if info:
        raise np.linalg.LinAlgError("no smallest eigenvalue is found")
    return float(values[0])


def one_sided(equilibrium: Equilibrium) -> bool:
    """Whether the stiffness is not symmetric: no energy decides on stability, a determinant's sign does."""
    lin = equilibrium.linear
    return lin.rubbing is not None or (lin.push is not None and not lin.push.conservative)


def singularity(equilibrium: Equilibrium) -> float:
    """How far the tangent stiffness of the free motions is from singular where it is not symmetric.

    It is not with friction, nor with loads that follow the finger. V's own, under the linear law, is 1.

    It is the smallest singular value, less than 0 where the determinant has changed its sign since mu = 0. As mu
    vanishes it becomes the smallest eigenvalue of the reduced Hessian.

    The free motions keep the contacts; what the contact forces may do in reply spans other directions than the
    constraints' gradients, so that the stiffness is taken between the complements of both.
    """
    lin = equilibrium.linear
    hessian = equilibrium.state.energy_hessian - lin.hessian
    rows, columns = list(lin.gradients), list(lin.loads)
    at = 0
    for site in equilibrium.state.sites:
        stuck, turned = at + site.unknown_places, 0.0
        if site.kind in ("tangent", "vertex"):
            slide, curvature = lin.residual_gradients[at], float(lin.residual_slopes[at, at])
            if abs(curvature) < _FLAT:
                rows.append(slide)
                columns.append(lin.load_slopes[:, at])
            else:
                hessian += np.outer(lin.load_slopes[:, at], slide) / curvature
                turned = 1 / curvature
        if site.unknowns > site.unknown_places:
            rolled = turned * lin.residual_slopes[stuck, at] * lin.residual_gradients[at] if turned else 0.0
            rows.append(lin.residual_gradients[stuck] - rolled)
            columns.append(lin.load_slopes[:, stuck])
        at += site.unknowns
    free = np.linalg.qr(np.array(rows).T, mode="complete")[0][:, len(rows) :]
    left = np.linalg.qr(np.array(columns).T, mode="complete")[0][:, len(rows) :]
    stiffness = left.T @ hessian @ free
    sign = np.linalg.slogdet(stiffness)[0] * np.linalg.slogdet(left.T @ free)[0]
    return float(sign * np.min(np.linalg.svd(stiffness, compute_uv=False), initial=1.0))
