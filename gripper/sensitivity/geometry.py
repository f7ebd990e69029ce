"""A deflected finger read in its segments' own coordinates, and how that reading changes.

At a fixed place of a segment (x in [-1, 1]) a strain of given Legendre coefficients c does not change when the
segment's ends move: section rotations are bilinear in the segments' lengths h and c, and positions are linear in h.
Contacts lie at ends of segments, or at fixed x in the segment of their patch. So a discretisation whose segments end
at the contacts is differentiated with its ends moving: nothing is held still that a solution would move.

Every change is one of a batch of d directions: the leading axis.
"""

from __future__ import annotations

import copy
import functools
from dataclasses import dataclass, fields

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.legendre import legendre, legendre_integrals
from gripper.beam.strains import Beam
from gripper.sensitivity.jet import jet


@dataclass(frozen=True, eq=False)
class _Rule:
    """Gauss points (q,) of a segment and what belongs to them."""

    weights: Array  # (q,)
    along: Array  # (x + 1) / 2, (q,)
    modes: Array  # P_k, (q, m)
    integrals: Array  # int_-1 P_k, (q, m)
    interpolant: Array  # values at the points -> Legendre coefficients, (q, q)


@functools.cache
def _rule(count: int, modes: int) -> _Rule:
    x, weights = np.polynomial.legendre.leggauss(count)
    table = legendre(x, count)
    interpolant = ((2 * np.arange(count) + 1) / 2)[:, None] * (weights * table.T)
    integrals = legendre_integrals(legendre(x, modes + 1))
    return _Rule(weights, (x + 1) / 2, table[:, :modes], integrals, interpolant)


@dataclass(frozen=True, eq=False)
class Marks:
    """Linear maps to k stations, each at a fixed x of its segment."""

    turns: Array  # psi = turns . (h c), (k, segments * modes)
    places: Array  # position = places . (h / 2 r'), (k, g)
    modes: Array  # P_k at the station, (k, modes)
    segment: Index  # (k,)

    def beside(self, other: Marks) -> Marks:
        """These stations and others after them."""
        return Marks(*(np.concatenate([getattr(m, f.name) for m in (self, other)]) for f in fields(self)))


@dataclass(frozen=True, eq=False)
class Bending:
    """Changes of a finger: of its segments' lengths, coefficients and, at the Gauss points, of its axis' direction."""

    lengths: Array  # (d, segments)
    products: Array  # of h c, bending alone, (d, segments * modes)
    steps: Complex  # of h / 2 exp(i theta), (d, g)
    runs: Complex  # of h / 2 r', (d, g)


class Geometry:
    """A beam of given unknowns, in its segments' own coordinates."""

    def __init__(self, beam: Beam, z: Array) -> None:
        self.beam = beam
        self.segments, self.modes, self.fields = beam.segments, beam.modes, beam.fields
        self.count = beam.gauss.size // beam.segments
        self.rule = _rule(self.count, self.modes)
        self.turns = self._turns()
        self._read(beam.lengths, beam.gauss, beam.coefficients(z), beam.base_turn(z))

    def moved(self, breaks: Array, coefficients: Array, base_turn: float) -> Geometry:
        """The same of a finger straight at rest, carrying rates of segments' ends, coefficients and base's turn."""
        moved, lengths = copy.copy(self), np.diff(breaks)
        along = (breaks[:-1, None] + lengths[:, None] * self.rule.along).ravel()
        moved._read(
            jet(self.lengths, lengths),
            jet(self.gauss, along),
            jet(self.coefficients, coefficients),
            jet(self.base_turn, base_turn),
        )
        return moved

    def _read(self, lengths: Array, gauss: Array, coefficients: Array, base_turn: Array | float) -> None:
        self.lengths, self.gauss, self.coefficients, self.base_turn = lengths, gauss, coefficients, base_turn
        self.strains = self.coefficients @ self.rule.modes.T  # at the Gauss points, (fields, segments, q)
        self.products = (self.lengths[:, None] * self.coefficients[0]).ravel()
        theta = self.turns @ self.products + self.beam.rest_angle + self.base_turn
        if self.fields == 2:
            theta = theta + self.strains[1].ravel()
        self.direction = np.exp(1j * theta)  # with stretch that of the section, else r'
        self.halves = np.repeat(self.lengths / 2, self.count)
        self.steps = self.halves * self.direction
        self.drawn: Complex | float = 1.0  # r' in the section's frame
        if self.beam.stretches:
            self.drawn = 1 + self.strains[2].ravel() + 1j * self.strains[1].ravel()
        self.runs = self.steps * self.drawn

    def _turns(self) -> Array:
        """psi at the Gauss points = turns . (h c), (g, segments * modes)."""
        turns = np.zeros((self.segments, self.count, self.segments, self.modes))
        turns[:, :, :, 0] = np.tri(self.segments, k=-1)[:, None, :]
        each = np.arange(self.segments)
        turns[each, :, each, :] += self.rule.integrals / 2
        return turns.reshape(self.segments * self.count, -1)

    @functools.cached_property
    def whitening(self) -> Array:
        """From unknowns to coefficients, block by block: (fields, segments, modes, modes)."""
        columns = np.eye(self.modes)[:, None, None, :]
        units = np.broadcast_to(columns, (self.modes, self.segments, self.fields, self.modes))
        return np.stack([self.beam.coefficients(unit.ravel()) for unit in units], axis=-1)

    @property
    def base(self) -> float | None:
        """Rotational stiffness of what holds the finger, dimensionless; None where it is rigid."""
        return self.beam.sections.base

    def pulled(self, covectors: Array, turning: Array) -> Array:
        """Derivatives by coefficients (d, fields, segments, modes) and base's turn (d,) as those by the unknowns."""
        out = np.einsum("fekj,dfek->defj", self.whitening, covectors)
        flat: Array = out.reshape(len(covectors), -1)
        return flat if self.base is None else np.column_stack([flat, turning / np.sqrt(self.base)])

    def pushed(self, unknowns: Array) -> tuple[Array, Array]:
        """Changes of the unknowns (d, n) as changes of coefficients (d, fields, segments, modes) and base's turn."""
        strains = unknowns if self.base is None else unknowns[:, :-1]
        blocks = strains.reshape(-1, self.segments, self.fields, self.modes)
        turns = np.zeros(len(unknowns)) if self.base is None else unknowns[:, -1] / np.sqrt(self.base)
        return np.einsum("fekj,defj->dfek", self.whitening, blocks), turns

    def marks(self, x: Array, segment: Index) -> Marks:
        """The maps to stations x (k,) in [-1, 1] of segments (k,)."""
        k, each = x.size, np.arange(x.size)
        table = legendre(x, max(self.count, self.modes) + 1)
        integrals = legendre_integrals(table)
        before = (np.arange(self.segments) < segment[:, None]).astype(float)
        turns = np.zeros((k, self.segments, self.modes))
        turns[:, :, 0] = before
        turns[each, segment] += integrals[:, : self.modes] / 2
        places = before[:, :, None] * self.rule.weights
        places[each, segment] = integrals[:, : self.count] @ self.rule.interpolant
        return Marks(
            turns.reshape(k, self.products.size), places.reshape(k, self.runs.size), table[:, : self.modes], segment
        )

    def bent(self, lengths: Array, coefficients: Array | None, rest: Array | float) -> Bending:
        """The changes that follow from others.

        Parameters
        ----------
        lengths
            Of the segments, (d, segments).
        coefficients
            Of the strains, (d, fields, segments, modes).
        rest
            Of the angle of the unloaded section at the Gauss points, with the base's, (d, g).
        """
        products = lengths[:, :, None] * self.coefficients[0]
        if coefficients is not None:
            products = products + self.lengths[:, None] * coefficients[:, 0]
        flat = products.reshape(len(lengths), self.products.size)
        theta = flat @ self.turns.T + rest
        strained = [] if coefficients is None else list((coefficients[:, 1:] @ self.rule.modes.T).swapaxes(0, 1))
        gamma, *eps = (strain.reshape(theta.shape) for strain in strained) if strained else (0.0,)
        if self.fields == 2:
            theta = theta + gamma
        steps = self.direction * (np.repeat(lengths / 2, self.count, axis=1) + 1j * self.halves * theta)
        runs = steps * self.drawn
        if eps:
            runs = runs + self.steps * (eps[0] + 1j * gamma)
        return Bending(lengths, flat, steps, runs)
