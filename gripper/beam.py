"""Strains to shape: a beam with large bending and shear, its strain fields piecewise Legendre polynomials.

Lan & Lee's eqs (1) and (2), corrected: the section turns by psi, the axis runs along psi + gamma,

    V = 1/2 int EI kappa^2 + kappa_s GA gamma^2 ds,   x' = cos(psi + gamma),  y' = sin(psi + gamma).

Unknowns are the fields' coefficients on each segment, whitened by the Cholesky factor of their own stiffness:
V = |z|^2 / 2 exactly, whatever the profile. Order 0 is a chain of circular arcs. Everything is dimensionless
(:mod:`gripper.sections`). Geometry is integrated by Gauss points on each segment; an arbitrary station uses the
integral of the interpolant through them, so that shape, gradient and Hessian belong to one discrete functional.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.special import eval_legendre

from gripper.arrays import Array, Complex, Index
from gripper.sections import Sections

_CARRIED = 0.2  # of a segment's length: polynomials of moderate order continue this far without harm
BeamTheory = Literal["bending", "shear"]


def legendre(x: Array, count: int) -> Array:
    """P_0 .. P_(count-1) at x (n,): (n, count)."""
    table: Array = eval_legendre(_degrees(count), x[:, None])
    return table


@functools.cache
def _degrees(count: int) -> Index:
    return np.arange(count)


def legendre_integrals(table: Array) -> Array:
    """Integrals from -1 of P_0 .. P_(count-2), from a table (n, count) of P_k: (n, count - 1)."""
    count = table.shape[1]
    integrals = np.empty((table.shape[0], count - 1))
    integrals[:, 0] = table[:, 1] + 1
    integrals[:, 1:] = (table[:, 2:] - table[:, :-2]) / (2 * _degrees(count - 1)[1:] + 1)
    return integrals


@functools.cache
def _differentiation(count: int) -> Array:
    """Legendre coefficients of a series -> those of its derivative, (count, count)."""
    matrix = np.zeros((count, count))
    matrix[: count - 1] = np.polynomial.legendre.legder(np.eye(count), axis=0)
    return matrix


@dataclass(frozen=True, eq=False)
class _Rule:
    """Gauss points on [-1, 1], and what follows from their number and the fields' order."""

    x: Array
    weights: Array
    modes: Array  # P_k at the points, (q, p + 1)
    integrals: Array  # int_-1 P_k at the points, (q, p + 1)
    interpolant: Array  # values at the points -> Legendre coefficients of the interpolant, (q, q)
    grams: Array  # weights times P_i P_j at the points, (q, (p + 1)^2)


@functools.cache
def _rule(order: int) -> _Rule:
    q = (
        order + 8
    )  # cos(theta) of a polynomial theta: eight more points leave round-off for turns below a radian a segment
    x, weights = np.polynomial.legendre.leggauss(q)
    table = legendre(x, q)
    modes = table[:, : order + 1]
    integrals = legendre_integrals(legendre(x, order + 2))
    interpolant = ((2 * np.arange(q) + 1) / 2)[:, None] * (weights * table.T)
    grams = (weights[:, None, None] * modes[:, :, None] * modes[:, None, :]).reshape(q, -1)
    return _Rule(x, weights, modes, integrals, interpolant, grams)


@dataclass(frozen=True, eq=False)
class Rows:
    """Linear maps from the unknowns (n) and from the Gauss points (g) to k stations."""

    position: Array  # (k, g): weights of cos theta, sin theta in x, y
    psi: Array  # (k, n)
    gamma: Array  # (k, n)
    kappa: Array  # (k, n)
    table: Array  # (k, >= p + 1): P_k on the station's own segment


class Beam:
    """A discretised finger: segments, fields, and the maps that geometry needs.

    Parameters
    ----------
    sections
        The finger's dimensionless sections.
    breaks
        Ends of the segments, from 0 to 1: contacts, ends of a contact patch, kinks of the profile.
    order
        Order p of the strain fields on each segment.
    theory
        "bending": kappa alone. "shear": kappa and gamma.
    """

    def __init__(self, sections: Sections, breaks: tuple[float, ...], order: int, theory: BeamTheory) -> None:
        self.sections, self.breaks, self.order, self.theory = sections, breaks, order, theory
        self.starts = np.array(breaks[:-1])
        self.lengths = np.diff(breaks)
        self.fields = 1 if theory == "bending" else 2
        self.segments = len(breaks) - 1
        self.modes = order + 1
        self.size = self.segments * self.fields * self.modes
        self._rule = rule = _rule(order)
        self.gauss = (self.starts[:, None] + self.lengths[:, None] * (rule.x + 1) / 2).ravel()
        self._whiten = self._whitening()
        self._before = np.tri(self.segments, k=-1)  # which segments lie before which
        full = self.lengths[:, None] * self._whiten[0][:, 0, :]
        self._turns = self._before[:, :, None] * full  # psi at a segment's start, from each segment's kappa
        self._gauss_weights = self._before[:, :, None] * (self.lengths[:, None] * rule.weights / 2)
        self.theta_map = self._theta_map()

    def _whitening(self) -> Array:
        """Inverse Cholesky factors of each field's stiffness on each segment: (fields, segments, p + 1, p + 1)."""
        q, m = self._rule.x.size, self.modes
        stiffness = [self.sections.EI(self.gauss)]
        if self.fields == 2:
            stiffness.append(self.sections.GA(self.gauss))
        weights = np.reshape(stiffness, (self.fields, self.segments, q)) * (self.lengths / 2)[:, None]
        grams = (weights @ self._rule.grams).reshape(self.fields, self.segments, m, m)
        upper = np.linalg.cholesky(grams).swapaxes(-1, -2)
        return np.linalg.inv(upper)

    def _theta_map(self) -> Array:
        """theta = psi + gamma at the Gauss points, (g, n)."""
        q, m = self._rule.x.size, self.modes
        theta = np.zeros((self.segments, q, self.segments, self.fields, m))
        theta[:, :, :, 0] = self._turns[:, None]
        each = np.arange(self.segments)
        theta[each, :, each, 0] += (self.lengths / 2)[:, None, None] * (self._rule.integrals @ self._whiten[0])
        if self.fields == 2:
            theta[each, :, each, 1] = self._rule.modes @ self._whiten[1]
        return theta.reshape(-1, self.size)

    def segment_of(self, s: Array, *, left: bool = False) -> Index:
        """The segment of each station; at a break the one after it, or before it with ``left``."""
        found = np.searchsorted(self.breaks, s, side="left" if left else "right") - 1
        return np.clip(found, 0, self.segments - 1)

    def rows(self, s: Array, segment: Index) -> Rows:
        """The maps to stations s (k,), each read from the polynomials of its segment (k,)."""
        k, m = s.size, self.modes
        half = self.lengths[segment] / 2
        table = legendre((s - self.starts[segment]) / half - 1, max(self._rule.x.size + 1, m + 1))
        integrals = legendre_integrals(table)
        modes, each = table[:, None, :m], np.arange(k)
        shape = (k, self.segments, self.fields, m)
        psi, gamma, kappa = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        bending = self._whiten[0][segment]
        kappa[each, segment, 0] = (modes @ bending)[:, 0]
        psi[:, :, 0] = self._turns[segment]
        psi[each, segment, 0] += half[:, None] * (integrals[:, None, :m] @ bending)[:, 0]
        if self.fields == 2:
            gamma[each, segment, 1] = (modes @ self._whiten[1][segment])[:, 0]
        position = self._gauss_weights[segment]
        position[each, segment] = half[:, None] * (integrals[:, : self._rule.x.size] @ self._rule.interpolant)
        flat = (k, self.size)
        return Rows(position.reshape(k, -1), psi.reshape(flat), gamma.reshape(flat), kappa.reshape(flat), table)

    def coefficients(self, z: Array) -> Array:
        """Legendre coefficients of the fields: (fields, segments, p + 1)."""
        blocks = z.reshape(self.segments, self.fields, self.modes).swapaxes(0, 1)
        return (self._whiten @ blocks[..., None])[..., 0]

    def unknowns(self, coefficients: Array) -> Array:
        """Whitened unknowns of given Legendre coefficients (fields, segments, p + 1): the inverse of coefficients."""
        blocks = np.linalg.solve(self._whiten, coefficients[..., None])[..., 0]
        return blocks.swapaxes(0, 1).reshape(-1)

    def strains(self, z: Array, s: Array, segment: Index) -> Array:
        """Strains at stations s (k,) of given segments: (fields, k)."""
        local = self.coefficients(z)[:, segment]
        x = (s - self.starts[segment]) / (self.lengths[segment] / 2) - 1
        return np.einsum("km,fkm->fk", legendre(x, max(self.modes, 2))[:, : self.modes], local)

    def fit(self, strains: Array) -> Array:
        """The unknowns whose fields are the projections of strains at the Gauss points (fields, g) on each segment."""
        blocks = strains.reshape(self.fields, self.segments, -1) * self._rule.weights
        return self.unknowns((blocks @ self._rule.modes) * (np.arange(self.modes) + 0.5))

    def project(self, other: Beam, z: Array) -> Array:
        """The unknowns of this beam whose strains come nearest to those of another beam's z."""
        return self.fit(other.strains(z, self.gauss, other.segment_of(self.gauss)))

    def carry(self, other: Beam, z: Array) -> Array:
        """The unknowns of this beam when its segments are those of another beam, their ends moved a little.

        A segment keeps its polynomial, continued beyond its old ends, so that kinks move with the breaks. A segment
        that moves by much of its own length (a patch under way) bridges its neighbours linearly instead.
        """
        count = self.gauss.size // self.segments
        values = other.strains(z, self.gauss, np.repeat(np.arange(self.segments), count))
        ends = np.array([other.breaks, self.breaks])
        shift = np.abs(ends[1] - ends[0])
        for e in range(1, self.segments - 1):
            if max(shift[e], shift[e + 1]) > _CARRIED * other.lengths[e]:
                marks = np.array([self.breaks[e], self.breaks[e + 1]])
                left, right = other.strains(z, marks, np.array([e - 1, e + 1])).T
                along = (self._rule.x + 1) / 2
                values[:, e * count : (e + 1) * count] = left[:, None] + (right - left)[:, None] * along
        return self.fit(values)

    def embed(self, other: Beam, z: Array) -> Array:
        """The unknowns of this beam for the very fields of a beam of lower order on the same segments."""
        coefficients = np.zeros((self.fields, self.segments, self.modes))
        coefficients[:, :, : other.modes] = other.coefficients(z)
        return self.unknowns(coefficients)

    def slopes(self, z: Array, table: Array, segment: Index) -> Array:
        """kappa' and gamma' at stations with a table of P_k (k, count) on their segments: (2, k)."""
        local = self.coefficients(z)[:, segment] @ _differentiation(self.modes).T
        out = np.zeros((2, segment.size))
        out[: self.fields] = np.einsum("km,fkm->fk", table[:, : self.modes], local)
        return out * (2 / self.lengths[segment])

    def values(self, z: Array, direction: Complex, s: Array, segment: Index) -> tuple[Complex, Array, Array, Array]:
        """Position x + iy, psi, theta and kappa (k,) at stations, without their maps.

        Parameters
        ----------
        z
            Unknowns (n,).
        direction
            exp(i theta) at the Gauss points, (g,).
        s, segment
            Stations (k,) and the segments whose polynomials are read (k,).
        """
        m, q = self.modes, self._rule.x.size
        half = self.lengths / 2
        local = self.coefficients(z)
        runs = direction.reshape(self.segments, q) * half[:, None]
        places, turns = np.zeros(self.segments, dtype=complex), np.zeros(self.segments)
        np.cumsum((runs @ self._rule.weights)[:-1], out=places[1:])
        np.cumsum((self.lengths * local[0, :, 0])[:-1], out=turns[1:])
        table = legendre((s - self.starts[segment]) / half[segment] - 1, q + 1)
        integrals = legendre_integrals(table)
        paths = runs @ self._rule.interpolant.T
        position = places[segment] + np.einsum("kq,kq->k", integrals, paths[segment])
        kappas = local[0][segment]
        psi = turns[segment] + half[segment] * np.einsum("km,km->k", integrals[:, :m], kappas)
        kappa = np.einsum("km,km->k", table[:, :m], kappas)
        gamma = np.einsum("km,km->k", table[:, :m], local[1][segment]) if self.fields == 2 else 0.0
        return position, psi, psi + gamma, kappa

    def slope_bounds(self, z: Array) -> Array:
        """Upper bounds of abs(kappa') and abs(gamma') over each segment: (2, segments)."""
        sizes = np.abs(self.coefficients(z) @ _differentiation(self.modes).T)  # |P_k| <= 1
        bounds = np.zeros((2, self.segments))
        bounds[: self.fields] = sizes.sum(axis=2) * (2 / self.lengths)
        return bounds
