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
import itertools
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from gripper.arrays import Array, Index
from gripper.beam.legendre import differentiation, legendre, multiplication, rule
from gripper.beam.sections import Sections
from gripper.beam.segments import Segments, shared, turning
from gripper.laws import Response

BeamTheory = Literal["bending", "shear", "stretch"]
"""From the cheapest to the richest: kappa, gamma, eps one after the other."""


_FIELDS = {theory: number for number, theory in enumerate(get_args(BeamTheory), start=1)}
_MORE = 2  # modes for which the whitening is ready: those that judge an answer


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
    parts
        These segments, where they are known.
    """

    def __init__(
        self,
        sections: Sections,
        breaks: tuple[float, ...],
        order: int,
        theory: BeamTheory,
        extra: int = 0,
        parts: Segments | None = None,
    ) -> None:
        self.sections, self.breaks, self.order, self.theory = sections, breaks, order, theory
        self.fields, self.modes = _FIELDS[theory], order + 1 + extra
        self.stretches, self.yields = theory == "stretch", sections.base is not None
        if parts is None or parts.modes < self.modes:
            parts = Segments(sections, breaks, order, self.fields, order + 1 + max(extra, _MORE))
        self._parts, self.rule = parts, rule(order, self.modes)
        self.starts, self.lengths, self.halves, self.segments = parts.starts, parts.lengths, parts.halves, parts.count
        self.gauss, self._weights = parts.gauss, parts.weights
        self._upper, self._whiten = (factor[:, :, : self.modes, : self.modes] for factor in (parts.upper, parts.whiten))
        self._strains = self.segments * self.fields * self.modes
        self.size = self._strains + self.yields
        self.theta_map = self._theta_map()

    def _theta_map(self) -> Array:
        """What r' turns by at the Gauss points: psi + gamma, with stretch psi alone, (g, n)."""
        scaled = self._whiten.copy()
        scaled[0] *= self.halves[:, None, None]
        theta = np.empty((self.gauss.size, self.segments, self.fields, self.modes))
        turns = turning(self.segments, self.fields, self.order, self.modes)
        np.matmul(turns, scaled, out=theta.transpose(2, 1, 0, 3))
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
        q, m, each = self.rule.x.size, self.modes, np.arange(self.segments)
        maps = np.zeros((2, self.segments, q, self.segments, self.fields, m))
        for i in range(2):
            maps[i, each, :, each, i + 1] = self.rule.modes @ self._whiten[i + 1]
        return self._with_base(maps.reshape(2, -1, self._strains), 0.0)

    @functools.cached_property
    def response(self) -> Response | None:
        """What a section law answers at the Gauss points; None under the linear law, which needs no answer."""
        law = self.sections.law
        return None if law is None else Response(law, self.sections, self.gauss, self.fields)

    @functools.cached_property
    def gauss_maps(self) -> Array:
        """The fields at a segment's Gauss points from its own unknowns, (fields, segments, q, p + 1)."""
        return self.rule.modes @ self._whiten

    @functools.cached_property
    def gauss_lengths(self) -> Array:
        """The length that each Gauss point stands for, (g,)."""
        return self._weights.ravel()

    def gauss_strains(self, z: Array) -> Array:
        """The strains at the Gauss points, (fields, g)."""
        return (self.coefficients(z) @ self.rule.modes.T).reshape(self.fields, -1)

    def segment_of(self, s: Array, *, left: bool = False) -> Index:
        """The segment of each station; at a break the one after it, or before it with ``left``."""
        found = self._parts.marks.searchsorted(s, side="left" if left else "right") - 1
        inside: Index = np.minimum(np.maximum(found, 0), self.segments - 1)
        return inside

    def table(self, s: Array, segment: Index) -> Array:
        """P_0 .. P_q at stations s (k,) of given segments (k,): (k, q + 1)."""
        return legendre((s - self.starts[segment]) / self.halves[segment] - 1, self.rule.x.size + 1)

    def rows(self, s: Array, segment: Index) -> Rows:
        """The maps to stations s (k,), each read from the polynomials of its segment (k,)."""
        k = s.size
        position = np.zeros((k, self.segments, self.rule.x.size))
        strains = np.zeros((7 if self.stretches else 5, k, self.segments, self.fields, self.modes))
        first = 0
        for number, alike in itertools.groupby(segment.tolist()):  # neighbours of one segment at once: mostly all
            run = slice(first, first + len(list(alike)))
            self._fill_rows(s[run], number, position[run], strains[:, run])
            first = run.stop
        flat = strains.reshape(-1, k, self._strains)
        if self.yields:
            flat = np.concatenate([self._with_base(flat[:1], 1.0), self._with_base(flat[1:], 0.0)])
        return Rows(position.reshape(k, -1), flat)

    def _fill_rows(self, s: Array, segment: int, position: Array, strains: Array) -> None:
        """The maps to stations (k,) of one segment, written into those of all."""
        m, half = self.modes, float(self.halves[segment])
        local = legendre((s - float(self.starts[segment])) / half - 1, self.rule.x.size + 1) @ self.rule.station
        position[:, :segment] = self._weights[:segment]
        position[:, segment] = half * local[:, 3 * m :]
        fields = (local[:, : 3 * m].reshape(-1, m) @ self._whiten[:, segment]).reshape(self.fields, -1, 3, m)
        slopes = fields[:, :, 2] / half
        strains[0, :, :segment, 0] = self._full[:segment]
        strains[0, :, segment, 0] = half * fields[0, :, 1]
        for i, (at, rate) in enumerate(((2, 3), (1, 4), (5, 6))[: self.fields]):
            strains[at, :, segment, i], strains[rate, :, segment, i] = fields[i, :, 0], slopes[i]

    @functools.cached_property
    def _full(self) -> Array:
        """What each segment's kappa turns the sections beyond it by, (segments, p + 1)."""
        return self.lengths[:, None] * self._whiten[0, :, 0]

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
        x = (s - self.starts[segment]) / self.halves[segment] - 1
        return np.einsum("km,fkm->fk", legendre(x, self.modes), local)

    def fit(self, strains: Array, base_turn: float = 0.0) -> Array:
        """The unknowns whose fields are the projections of strains at the Gauss points (fields, g) on each segment."""
        blocks = strains.reshape(self.fields, self.segments, -1) * self.rule.weights
        return self.unknowns((blocks @ self.rule.modes) * (np.arange(self.modes) + 0.5), base_turn)

    def project(self, other: Beam, z: Array) -> Array:
        """The unknowns of this beam whose strains come nearest to those of another beam's z."""
        return self.fit(other.strains(z, self.gauss, other.segment_of(self.gauss)), other.base_turn(z))

    def convection(self, fields: Array, moves: Array) -> Array:
        """Change of the fields' coefficients when segments move along a shape that stays: (fields, segments, p + 1).

        Parameters
        ----------
        fields
            The fields' coefficients, (fields, segments, p + 1).
        moves
            How far each break moves (or its rate), (segments + 1,).
        """
        slopes = fields @ differentiation(self.modes).T / self.halves[:, None]
        middle, spread = (moves[1:] + moves[:-1]) / 2, (moves[1:] - moves[:-1]) / 2
        return middle[:, None] * slopes + spread[:, None] * (slopes @ multiplication(self.modes).T)

    def richer(self, extra: int) -> tuple[Beam, Index]:
        """A beam with more modes on the same segments and Gauss points, and which of its unknowns are this beam's."""
        richer = Beam(self.sections, self.breaks, self.order, self.theory, extra, self._parts)
        return richer, shared(self.segments, self.fields, richer.modes, self.modes, self.yields)

    def embed(self, other: Beam, z: Array) -> Array:
        """The unknowns for the very fields of a beam of lower order, or of a poorer theory, on the same segments."""
        coefficients = np.zeros((self.fields, self.segments, self.modes))
        coefficients[: other.fields, :, : other.modes] = other.coefficients(z)
        return self.unknowns(coefficients, other.base_turn(z))

    def slope_bounds(self, fields: Array) -> Array:
        """Upper bounds of abs(kappa'), and of abs(r'') less abs(kappa r'), over each segment: (2, segments).

        From the fields' coefficients, (fields, segments, p + 1).
        """
        sizes = np.abs(fields @ differentiation(self.modes).T)  # |P_k| <= 1
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
