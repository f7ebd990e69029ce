"""Strains to shape: a beam with large bending and shear, its strain fields piecewise Legendre polynomials.

Lan & Lee's eqs (1) and (2), corrected: the section turns by psi, the axis runs along psi + gamma,

    V = 1/2 int EI kappa^2 + kappa_s GA gamma^2 ds,   x' = cos(psi + gamma),  y' = sin(psi + gamma).

With stretch (Simo 1985, after Reissner) V has EA eps^2 besides, and the axis another direction
(:mod:`gripper.beam.axis`).

Unknowns are the fields' coefficients on each segment, whitened by the Cholesky factor of their own stiffness:
V = |z|^2 / 2 exactly, whatever the profile. A base that yields adds one more, the last: how far it has turned, times
the root of its stiffness. Order 0 is a chain of circular arcs. Everything is dimensionless
(:mod:`gripper.beam.sections`). Geometry is integrated by Gauss points on each segment; an arbitrary station uses the
integral of the interpolant through them, so that shape, gradient and Hessian belong to one discrete functional.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from scipy.special import eval_legendre

from gripper.arrays import Array, Complex, Index
from gripper.beam.sections import Sections
from gripper.laws import Response

BeamTheory = Literal["bending", "shear", "stretch"]
"""From the cheapest to the richest: kappa, gamma, eps one after the other."""


_FIELDS = {theory: number for number, theory in enumerate(get_args(BeamTheory), start=1)}


@functools.cache
def _before(segments: int) -> Array:
    """Which segments lie before which, (segments, segments, 1)."""
    return np.tri(segments, k=-1)[:, :, None]


def legendre(x: Array, count: int) -> Array:
    """P_0 .. P_(count-1) at x (n,): (n, count)."""
    table: Array = eval_legendre(_degrees(count), x[:, None])
    return table


@functools.cache
def _degrees(count: int) -> Index:
    return np.arange(count)


@functools.cache
def _even(count: int, degrees: int) -> Array:
    """P_0 .. P_(degrees-1) at even distances from -1 to 1: (count, degrees)."""
    return legendre(np.linspace(-1.0, 1.0, count), degrees)


def legendre_integrals(table: Array) -> Array:
    """Integrals from -1 of P_0 .. P_(count-2), from a table (n, count) of P_k: (n, count - 1)."""
    return table @ _integration(table.shape[1] - 1)


@functools.cache
def _differentiation(count: int) -> Array:
    """Legendre coefficients of a series -> those of its derivative, (count, count)."""
    matrix = np.zeros((count, count))
    matrix[: count - 1] = np.polynomial.legendre.legder(np.eye(count), axis=0)
    return matrix


@functools.cache
def _multiplication(count: int) -> Array:
    """Legendre coefficients of a series -> those of x times it, cut off at the same length, (count, count)."""
    k = np.arange(1, count)
    return np.diag(k / (2 * k - 1), -1) + np.diag(k / (2 * k + 1), 1)


@functools.cache
def _integration(count: int) -> Array:
    """Legendre coefficients of a series -> those of its integral from -1, (count + 1, count)."""
    return np.polynomial.legendre.legint(np.eye(count), lbnd=-1, axis=0)


@dataclass(frozen=True, eq=False)
class _Rule:
    """Gauss points on [-1, 1], and what follows from their number and the fields' order."""

    x: Array
    weights: Array
    modes: Array  # P_k at the points, (q, p + 1)
    integrals: Array  # int_-1 P_k at the points, (q, p + 1)
    primitive: Array  # coefficients of a field -> those of its integral from -1, (q + 1, p + 1)
    path: Array  # values at the points -> coefficients of their interpolant's integral from -1, (q + 1, q)
    station: Array  # P_0 .. P_q there -> modes, their integrals, their derivatives, the path: (q + 1, 3m + q)
    grams: Array  # weights times P_i P_j at the points, (q, (p + 1)^2)


@functools.cache
def _rule(order: int, modes: int) -> _Rule:
    q = (
        order + 8
    )  # cos(theta) of a polynomial theta: eight more points leave round-off for turns below a radian a segment
    x, weights = np.polynomial.legendre.leggauss(q)
    table = legendre(x, q)
    shapes = table[:, :modes]
    integrals = legendre(x, modes + 1) @ _integration(modes)
    interpolant = ((2 * np.arange(q) + 1) / 2)[:, None] * (weights * table.T)
    integral = _integration(q)
    path, primitive = integral @ interpolant, integral[:, :modes]
    own = np.eye(q + 1, modes)
    slope = np.zeros((q + 1, modes))
    slope[:modes] = _differentiation(modes)
    station = np.concatenate([own, primitive, slope, path], axis=1)
    grams = (weights[:, None, None] * shapes[:, :, None] * shapes[:, None, :]).reshape(q, -1)
    return _Rule(x, weights, shapes, integrals, primitive, path, station, grams)


@functools.cache
def _shared(segments: int, fields: int, modes: int, first: int, base: bool) -> Index:
    """Which unknowns are of the first modes: of all segments and fields, and the base's."""
    numbers = np.arange(segments * fields * modes).reshape(segments, fields, modes)
    return np.append(numbers[:, :, :first].ravel(), [numbers.size] if base else []).astype(np.intp)


@dataclass(frozen=True, eq=False)
class Rows:
    """Linear maps from the unknowns (n) and from the Gauss points (g) to k stations."""

    position: Array  # (k, g): weights of r' in r
    strains: Array  # (5, k, n): psi, gamma, kappa, kappa', gamma'; with stretch (7, k, n): and eps, eps'


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
        "bending": kappa alone. "shear": kappa and gamma. "stretch": kappa, gamma and eps.
    extra
        Modes more than the order has, at the same Gauss points: the whitened unknowns are hierarchical, those of the
        order being among them.
    """

    def __init__(
        self, sections: Sections, breaks: tuple[float, ...], order: int, theory: BeamTheory, extra: int = 0
    ) -> None:
        self.sections, self.breaks, self.order, self.theory = sections, breaks, order, theory
        self.starts = np.array(breaks[:-1])
        self.lengths = np.array(breaks[1:]) - self.starts
        self._halves = self.lengths / 2
        self.fields = _FIELDS[theory]
        self.stretches = theory == "stretch"
        self.segments = len(breaks) - 1
        self.modes = order + 1 + extra
        self._strains = self.segments * self.fields * self.modes
        self.yields = sections.base is not None
        self.size = self._strains + self.yields
        self._rule = rule = _rule(order, self.modes)
        self.gauss = (self.starts[:, None] + self.lengths[:, None] * (rule.x + 1) / 2).ravel()
        self._upper, self._whiten = self._whitening()
        before = _before(self.segments)
        full = self.lengths[:, None] * self._whiten[0][:, 0, :]
        self._turns = before * full  # psi at a segment's start, from each segment's kappa
        self._gauss_weights = before * (self._halves[:, None] * rule.weights)
        self.theta_map = self._theta_map()

    def _whitening(self) -> tuple[Array, Array]:
        """Cholesky factors of each field's stiffness on each segment, and their inverses: (fields, segments, m, m)."""
        m, shape = self.modes, (self.fields, self.segments, self._rule.x.size)
        stiffness = np.array(self.sections.stiffness(self.gauss)[: self.fields]).reshape(shape)
        grams = ((stiffness * self._halves[:, None]) @ self._rule.grams).reshape(self.fields, self.segments, m, m)
        upper = np.linalg.cholesky(grams).swapaxes(-1, -2)
        return upper, np.linalg.inv(upper)

    def _theta_map(self) -> Array:
        """What r' turns by at the Gauss points: psi + gamma, with stretch psi alone, (g, n)."""
        q, m = self._rule.x.size, self.modes
        theta = np.zeros((self.segments, q, self.segments, self.fields, m))
        theta[:, :, :, 0] = self._turns[:, None]
        own = np.einsum("iqifm->iqfm", theta)  # a view
        own[:, :, 0] += self._halves[:, None, None] * (self._rule.integrals @ self._whiten[0])
        if self.fields == 2:
            own[:, :, 1] = self._rule.modes @ self._whiten[1]
        return self._with_base(theta.reshape(-1, self._strains), 1.0)

    def _with_base(self, maps: Array, turns: float) -> Array:
        """Maps from the strains (..., n) with a column for the base: as far as they turn with it."""
        if self.sections.base is None:
            return maps
        column = np.full((*maps.shape[:-1], 1), turns / np.sqrt(self.sections.base))
        return np.concatenate([maps, column], axis=-1)

    def base_turn(self, z: Array) -> float:
        """How far the base has turned, in rad."""
        return 0.0 if self.sections.base is None else float(z[-1] / np.sqrt(self.sections.base))

    @functools.cached_property
    def rest_angle(self) -> Array | float:
        """How far the unloaded section has turned at the Gauss points, (g,); 0 where the finger is straight at rest."""
        return 0.0 if self.sections.rest is None else self.sections.rest.angle(self.gauss)

    @functools.cached_property
    def strain_maps(self) -> Array:
        """Gamma and eps at the Gauss points, (2, g, n); with stretch alone."""
        q, m, each = self._rule.x.size, self.modes, np.arange(self.segments)
        maps = np.zeros((2, self.segments, q, self.segments, self.fields, m))
        for i in range(2):
            maps[i, each, :, each, i + 1] = self._rule.modes @ self._whiten[i + 1]
        return self._with_base(maps.reshape(2, -1, self._strains), 0.0)

    @functools.cached_property
    def response(self) -> Response | None:
        """What a section law answers at the Gauss points; None under the linear law, which needs no answer."""
        law = self.sections.law
        return None if law is None else Response(law, self.sections, self.gauss, self.fields)

    @functools.cached_property
    def gauss_maps(self) -> Array:
        """The fields at a segment's Gauss points from its own unknowns, (fields, segments, q, p + 1)."""
        return self._rule.modes @ self._whiten

    @functools.cached_property
    def gauss_lengths(self) -> Array:
        """The length that each Gauss point stands for, (g,)."""
        return (self._halves[:, None] * self._rule.weights).ravel()

    def gauss_strains(self, z: Array) -> Array:
        """The strains at the Gauss points, (fields, g)."""
        return (self.coefficients(z) @ self._rule.modes.T).reshape(self.fields, -1)

    def segment_of(self, s: Array, *, left: bool = False) -> Index:
        """The segment of each station; at a break the one after it, or before it with ``left``."""
        found = np.searchsorted(self.breaks, s, side="left" if left else "right") - 1
        return np.clip(found, 0, self.segments - 1)

    def _tables(self, s: Array, segment: Index) -> tuple[Array, Array]:
        """Half the length of each station's segment (k,), and P_0 .. P_q there (k, q + 1)."""
        half = self._halves[segment]
        return half, legendre((s - self.starts[segment]) / half - 1, self._rule.x.size + 1)

    def rows(self, s: Array, segment: Index) -> Rows:
        """The maps to stations s (k,), each read from the polynomials of its segment (k,)."""
        k = s.size
        position = np.empty((k, self.segments, self._rule.x.size))
        strains = np.zeros((7 if self.stretches else 5, k, self.segments, self.fields, self.modes))
        numbers = segment.tolist()
        first = 0
        while first < k:  # neighbours of one segment at once: mostly all
            last = first + 1
            while last < k and numbers[last] == numbers[first]:
                last += 1
            self._fill_rows(s[first:last], numbers[first], position[first:last], strains[:, first:last])
            first = last
        flat = strains.reshape(-1, k, self._strains)
        if self.yields:
            flat = np.concatenate([self._with_base(flat[:1], 1.0), self._with_base(flat[1:], 0.0)])
        return Rows(position.reshape(k, -1), flat)

    def _fill_rows(self, s: Array, segment: int, position: Array, strains: Array) -> None:
        """The maps to stations (k,) of one segment, written into those of all."""
        m, half = self.modes, float(self._halves[segment])
        local = legendre((s - self.starts[segment]) / half - 1, self._rule.x.size + 1) @ self._rule.station
        position[:] = self._gauss_weights[segment]
        position[:, segment] = half * local[:, 3 * m :]
        fields = local[:, : 3 * m].reshape(-1, m) @ self._whiten[:, segment]
        value, whole, slope = fields.reshape(self.fields, -1, 3, m).transpose(2, 0, 1, 3)
        strains[0, :, :, 0] = self._turns[segment]
        strains[0, :, segment, 0] += half * whole[0]
        strains[2, :, segment, 0], strains[3, :, segment, 0] = value[0], slope[0] / half
        for i, (at, rate) in enumerate(((1, 4), (5, 6))[: self.fields - 1], start=1):
            strains[at, :, segment, i], strains[rate, :, segment, i] = value[i], slope[i] / half

    def coefficients(self, z: Array) -> Array:
        """Legendre coefficients of the fields: (fields, segments, p + 1)."""
        blocks = z[: self._strains].reshape(self.segments, self.fields, self.modes).swapaxes(0, 1)
        return (self._whiten @ blocks[..., None])[..., 0]

    def unknowns(self, coefficients: Array, base_turn: float = 0.0) -> Array:
        """Whitened unknowns of given Legendre coefficients (fields, segments, p + 1) and of the base's turn, in rad."""
        blocks = (self._upper @ coefficients[..., None])[..., 0]
        strains = blocks.swapaxes(0, 1).reshape(-1)
        return strains if self.sections.base is None else np.append(strains, base_turn * np.sqrt(self.sections.base))

    def strains(self, z: Array, s: Array, segment: Index) -> Array:
        """Strains at stations s (k,) of given segments: (fields, k)."""
        local = self.coefficients(z)[:, segment]
        x = (s - self.starts[segment]) / (self.lengths[segment] / 2) - 1
        return np.einsum("km,fkm->fk", legendre(x, max(self.modes, 2))[:, : self.modes], local)

    def fit(self, strains: Array, base_turn: float = 0.0) -> Array:
        """The unknowns whose fields are the projections of strains at the Gauss points (fields, g) on each segment."""
        blocks = strains.reshape(self.fields, self.segments, -1) * self._rule.weights
        return self.unknowns((blocks @ self._rule.modes) * (np.arange(self.modes) + 0.5), base_turn)

    def project(self, other: Beam, z: Array) -> Array:
        """The unknowns of this beam whose strains come nearest to those of another beam's z."""
        return self.fit(other.strains(z, self.gauss, other.segment_of(self.gauss)), other.base_turn(z))

    def convection(self, z: Array, moves: Array) -> Array:
        """Change of the fields' coefficients when segments move along a shape that stays: (fields, segments, p + 1).

        Parameters
        ----------
        z
            Unknowns (n,).
        moves
            How far each break moves (or its rate), (segments + 1,).
        """
        slopes = self.coefficients(z) @ _differentiation(self.modes).T / self._halves[:, None]
        middle, spread = (moves[1:] + moves[:-1]) / 2, (moves[1:] - moves[:-1]) / 2
        return middle[:, None] * slopes + spread[:, None] * (slopes @ _multiplication(self.modes).T)

    def richer(self, extra: int) -> tuple[Beam, Index]:
        """A beam with more modes on the same segments and Gauss points, and which of its unknowns are this beam's."""
        richer = Beam(self.sections, self.breaks, self.order, self.theory, extra)
        return richer, _shared(self.segments, self.fields, richer.modes, self.modes, self.yields)

    def embed(self, other: Beam, z: Array) -> Array:
        """The unknowns for the very fields of a beam of lower order, or of a poorer theory, on the same segments."""
        coefficients = np.zeros((self.fields, self.segments, self.modes))
        coefficients[: other.fields, :, : other.modes] = other.coefficients(z)
        return self.unknowns(coefficients, other.base_turn(z))

    def series(self, z: Array, direction: Complex) -> Array:
        """Legendre coefficients of x, y, psi and the strains on each segment: (segments, q + 1, 3 + fields).

        Psi is what the strains turn the section by: the rest shape's part is no polynomial.

        Parameters
        ----------
        z
            Unknowns (n,).
        direction
            r' at the Gauss points, (g,).
        """
        rule, local, half = self._rule, self.coefficients(z), self._halves[:, None]
        runs = direction.reshape(self.segments, -1) * half
        out = np.zeros((self.segments, rule.x.size + 1, 3 + self.fields))
        path = runs @ rule.path.T
        turn = local[0] @ rule.primitive.T * half
        # where a segment ends is where the next one starts: every P_k is 1 at its end
        path[1:, 0] += np.cumsum(path[:-1].sum(axis=1))
        turn[1:, 0] += np.cumsum(turn[:-1].sum(axis=1))
        if self.yields:
            turn[:, 0] += self.base_turn(z)
        out[:, :, 0], out[:, :, 1], out[:, :, 2] = path.real, path.imag, turn
        out[:, : self.modes, 3:] = local.transpose(1, 2, 0)
        return out

    def read(self, series: Array, s: Array, segment: Index) -> Array:
        """Values of :meth:`series` at stations s (k,) of given segments (k,): (k, 3 + fields)."""
        return (self._tables(s, segment)[1][:, None, :] @ series[segment])[:, 0]

    def read_evenly(self, series: Array, count: int) -> Array:
        """Values of :meth:`series` at even distances over each segment, (segments * count, 3 + fields)."""
        read: Array = (_even(count, self._rule.x.size + 1) @ series).reshape(self.segments * count, -1)
        return read

    def slope_bounds(self, fields: Array) -> Array:
        """Upper bounds of abs(kappa'), and of abs(r'') less abs(kappa r'), over each segment: (2, segments).

        From the fields' coefficients, (fields, segments, p + 1).
        """
        sizes = np.abs(fields @ _differentiation(self.modes).T)  # |P_k| <= 1
        bounds = sizes.sum(axis=2) * (2 / self.lengths)
        return np.array([bounds[0], bounds[1:].sum(axis=0)])

    def speed_bounds(self, fields: Array) -> tuple[Array, Array]:
        """A lower and an upper bound of abs(r') over each segment, (segments,) each: 1 where the axis keeps its length.

        From abs(1 + eps + i gamma), with the fields bounded by the sums of their coefficients.
        """
        if not self.stretches:
            return np.ones(self.segments), np.ones(self.segments)
        _, gamma, eps = np.abs(fields).sum(axis=2)  # |P_k| <= 1
        return np.maximum(1 - eps, 0.0), np.hypot(1 + eps, gamma)
