"""The queries of an equilibrium: every point at which its contact equations read the outline and the object."""

from __future__ import annotations

import copy
import functools
import itertools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.contact.grip import Anchor
from gripper.contact.outline import UPPER, dot
from gripper.contact.site import Site, pressure_rule
from gripper.sensitivity.bearing import Carried
from gripper.sensitivity.finger_rates import FingerRates
from gripper.sensitivity.geometry import Geometry, Marks
from gripper.sensitivity.jet import NotFormedError, jet, value_of
from gripper.sensitivity.load_rates import LoadRates
from gripper.sensitivity.section_rates import answered
from gripper.statics.equilibrium import Equilibrium, Setting

if TYPE_CHECKING:
    from gripper.contact.obstacle import Obstacle
    from gripper.sensitivity.flow import Change

_CUT = 1e-6  # of L: segments end within this of the contacts that they were cut for


@dataclass(frozen=True, eq=False)
class Span:
    """One contact among the queries, constraints and unknown places."""

    site: Site
    queries: slice
    row: int
    column: int
    sticks: bool
    """Whether its ratio of friction is unknown."""

    @property
    def ratio(self) -> int:
        """The number of its ratio among the unknown places."""
        return self.column + self.site.unknown_places


@dataclass(frozen=True, eq=False)
class Stick:
    """Where the points of a contact that sticks are, from where it began to."""

    anchor: Anchor
    weights: Array  # (q,)
    tangents: Complex  # at the anchor, in the clamp's axes
    starts: Complex
    ways: Array  # along the finger's piece
    stretches: Array


def _unknown(site: Site) -> bool:
    return site.grip is not None and site.grip.unknown


def _query(site: Site, order: int) -> Array:
    if not site.spreads:
        return np.array(site.place or (0.0,))
    a, b = site.place
    gauss = (a + b) / 2 + (b - a) / 2 * pressure_rule(site.modes, order)[0]
    return np.append(gauss, site.place[: site.unknown_places])


class UndifferentiatedError(Exception):
    """An equilibrium has no derivatives here; says why."""


class Touching:
    """An equilibrium read at its contacts.

    Parameters
    ----------
    setting
        Finger, theory and object.
    equilibrium
        Converged, its segments ending at its contacts.
    finger
        Gives what the sections answer, its slope along the finger and its rates.
    loads
        Rates of what else loads the finger.

    Raises
    ------
    UndifferentiatedError
        Where friction goes with the pressure to where both have no moment.
    """

    def __init__(self, setting: Setting, equilibrium: Equilibrium, finger: FingerRates, loads: LoadRates) -> None:
        if any(site.flush for site in equilibrium.state.sites):
            raise UndifferentiatedError("the face lies on a flat along which friction spreads the pressure")
        self.setting, self.equilibrium, self.obstacle = setting, equilibrium, equilibrium.obstacle
        self.rest = setting.sections.rest
        state = equilibrium.state
        self.beam, self.sites = state.beam, state.sites
        self.finger, self.geometry = finger, Geometry(state.beam, state.z)
        self.carried = Carried.of(loads, equilibrium, self.geometry)
        self._lay_out(state.multipliers)
        self._locate()
        rubbing = equilibrium.linear.rubbing
        self.ratio = np.zeros(self.u.size)
        for i, span in enumerate(self.spans):
            if rubbing is not None:
                self.ratio[span.queries] = rubbing.ratios[i]
        self._read(*setting.outline.offsets(self.piece, self.u))

    def _lay_out(self, multipliers: Array) -> None:
        spans, queries, weights = [], [], []
        first = row = column = 0
        for site in self.sites:
            u = _query(site, self.beam.order)
            load = multipliers[row : row + site.multipliers]
            spans.append(Span(site, slice(first, first + len(u)), row, column, _unknown(site)))
            queries.append(u)
            weights.append(self.spread(site, load[None])[0])
            first, row, column = first + len(u), row + site.multipliers, column + site.unknowns
        self.spans, self.rows, self.columns = tuple(spans), row, column
        none = np.zeros(0)
        self.u, self.weights = np.concatenate([none, *queries]), np.concatenate([none, *weights])
        self.piece = np.repeat(
            np.array([site.piece for site in self.sites], dtype=np.intp), [len(u) for u in queries] or 0
        )

    def spread(self, site: Site, load: Array) -> Array:
        """Force along grad g at a contact's queries (d, queries) from its multipliers (d, multipliers)."""
        if not site.spreads:
            return load[:, :1]
        mean = pressure_rule(site.modes, self.beam.order)[1]
        return np.concatenate([load @ mean, np.zeros((len(load), site.unknown_places))], axis=1)

    def _segments(self) -> tuple[Index, Index]:
        """The segments before and after each query (one and the same inside a segment)."""
        breaks, last = np.array(self.beam.breaks), self.beam.segments - 1
        left, right = np.full((2, self.u.size), last)
        for span in self.spans:
            site, at = span.site, span.queries
            if not site.on_face:
                continue
            if site.spreads:
                places = np.clip(self.u[at], site.place[0] + 1e-12, site.place[1] - 1e-12)
                left[at] = right[at] = np.clip(np.searchsorted(breaks, places) - 1, 0, last)
                if site.lifts_off:  # its place tells by the face before it
                    left[at.stop - 1] = right[at.stop - 1] = max(left[at.start] - 1, 0)
                continue
            nearest = int(np.argmin(np.abs(breaks - site.place[0])))
            left[at], right[at] = max(nearest - 1, 0), min(nearest, last)
            if abs(breaks[nearest] - site.place[0]) > _CUT:  # a point that is only looked at
                left[at] = right[at] = np.clip(np.searchsorted(breaks, site.place[0]) - 1, 0, last)
        return left, right

    def _locate(self) -> None:
        """The maps to the queries, each at a fixed place of the segments before and after it."""
        geometry, s = self.geometry, np.where(self.piece <= UPPER, self.u, 1.0)
        left, right = self._segments()
        before, after = (self._local(s, segment) for segment in (left, right))
        self.marks: Marks = geometry.marks(before, left)
        self.actors = self.marks.beside(self.carried.marks)
        beyond = geometry.marks(after, right) if np.any(left != right) else self.marks
        self.sides = (self.marks, beyond)
        self.flexible = (self.piece <= UPPER).astype(float)

    def _read(self, s: Array, P: Complex, P1: Complex, P2: Complex) -> None:
        """Points, tangents, normals and forces at the queries: sections s, and offsets from them."""
        geometry = self.geometry
        strains = geometry.strains.reshape(geometry.fields, -1)
        self.sections = answered(self.finger, geometry.gauss, strains)
        self.s, self.offset, self.offset_slope, self.offset_bend = s, P, P1, P2
        psi = self.marks.turns @ geometry.products + geometry.base_turn
        self.turn = np.exp(1j * (psi if self.rest is None else psi + self.rest.angle(s)))
        self.points = self.marks.places @ geometry.runs + P * self.turn
        axes, self.leans = zip(*(self._along(side) for side in self.sides), strict=True)
        kappa = (self._strain(0, self.sides[0]) + self._strain(0, self.sides[1])) / 2
        self.kappa = self.flexible * (kappa if self.rest is None else kappa + self.rest.curvature(s)[0])
        self.tangents = self.turn * (self.flexible * (axes[0] + axes[1]) / 2 + P1 + 1j * self.kappa * P)
        self.gap, self.normal, (self._a, self._b) = self.obstacle.curvature(self.points)
        self._lean()

    def moved(self, change: Change, row: int, obstacle: Obstacle) -> Touching:
        """The same, carrying the rates of one direction of a change, with the obstacle as it goes that way.

        Raises
        ------
        NotFormedError
            Where that needs what has no second derivatives here.
        """
        missing = {
            "loads": self.carried.count,
            "a coefficient of friction that varies": any(self.middle(span)[1] for span in self.spans),
            "a material's own law": self.setting.sections.law is not None,
            "a finger that is bent at rest": self.rest is not None,
        }
        if any(missing.values()):
            raise NotFormedError(next(part for part, used in missing.items() if used))
        if change.coefficients is None or change.weights is None:
            raise ValueError("change must carry a solution on; got one without")
        moved = copy.copy(self)
        moved.geometry = self.geometry.moved(change.breaks[row], change.coefficients[row], change.base_turns[row])
        moved.obstacle, moved.ratio = obstacle, jet(self.ratio, change.ratios[row])
        moved.u, moved.weights = jet(self.u, change.queries[row]), jet(self.weights, change.weights[row])
        along, bends = change.queries[row], self.finger.bends(self.piece, self.u)
        offsets = self.offset, self.offset_slope, self.offset_bend, bends
        ahead = [jet(value, slope * along) for value, slope in itertools.pairwise(offsets)]
        moved._read(jet(self.s, self.flexible * along), *ahead)
        return moved

    def _local(self, s: Array, segment: Index) -> Array:
        x = (s - self.beam.starts[segment]) / (self.beam.lengths[segment] / 2) - 1
        return np.where(np.abs(np.abs(x) - 1) < 1e-3, np.sign(x), x)

    def _strain(self, field: int, marks: Marks) -> Array:
        if field >= self.geometry.fields:
            return 0.0 * self.flexible
        return np.einsum("km,km->k", marks.modes, self.geometry.coefficients[field][marks.segment])

    def _along(self, side: Marks) -> tuple[Complex, list[Complex]]:
        """Of one side the axis' direction in the section's frame, and its derivatives by gamma and eps."""
        gamma, one = self._strain(1, side), np.ones(self.u.size, dtype=complex)
        if self.geometry.fields < 3:
            direction = np.exp(1j * gamma)
            return direction, [1j * direction][: self.geometry.fields - 1]
        return one + self._strain(2, side) + 1j * gamma, [1j * one, one]

    def unloaded(self, breaks: Array, queries: Array) -> tuple[Array | float, Array | float, Array | float]:
        """How the rest shape changes under Gauss points and queries that move along it.

        Parameters
        ----------
        breaks, queries
            How ends of segments (d, segments + 1) and queries (d, q) move.

        Returns
        -------
        Changes of its angle at the Gauss points (d, g), and of its angle and curvature at the queries (d, q).
        """
        if self.rest is None:
            return 0.0, 0.0, 0.0
        geometry, own = self.geometry, self.rest.curvature(self.s)
        moved = breaks[:, :-1, None] + np.diff(breaks, axis=1)[:, :, None] * geometry.rule.along
        along = queries * self.flexible
        under = self.rest.curvature(geometry.gauss)[0]
        return moved.reshape(len(breaks), -1) * under, along * own[0], along * own[1]

    def _lean(self) -> None:
        """Directions of the forces: along grad g, or the face's normal at a corner of the object, and friction's."""
        self.press = self.normal.copy()
        for span in self.spans:
            if span.site.kind == "vertex":
                at = span.queries.start
                self.press[at] = self.side(span.site) * 1j * self.tangents[at] / abs(self.tangents[at])
        self.incline = 1 - 1j * self.ratio
        self.forces = self.weights * self.incline * self.press

    def stick(self, span: Span) -> Stick:
        """A contact that sticks, and its anchor."""
        grip, frame, at = span.site.grip, self.obstacle.frame, span.queries
        if grip is None or grip.anchor is None:
            raise ValueError("a contact that sticks must have an anchor; got none")
        anchor, weights = grip.anchor.over(self.middle(span)[0])
        turn = np.exp(1j * frame.angle)
        tangents = anchor.tangents * turn
        stretches = (anchor.stretches + dot(tangents, self.tangents[at])) / 2
        starts = anchor.points * turn + frame.origin
        return Stick(anchor, weights, tangents, starts, self.u[at] - anchor.u, stretches)

    def middle(self, span: Span) -> tuple[Array, float]:
        """Weights of a contact's queries in its middle, and the slope of its ratio of friction along the piece."""
        weights = np.zeros(span.queries.stop - span.queries.start)
        if span.site.spreads:
            mean = pressure_rule(span.site.modes, self.beam.order)[1][0]
            weights[: mean.size] = mean
        else:
            weights[0] = 1.0
        if span.site.grip is None:
            return weights, 0.0
        middle = float(weights @ value_of(self.u[span.queries]))
        return weights, span.site.grip.ratios(span.site.piece, middle)[1]

    @staticmethod
    def side(site: Site) -> float:
        """1 where the finger's inside lies left of the piece's tangent, -1 on the upper face."""
        return -1.0 if site.piece == UPPER else 1.0

    def curved(self, vectors: Complex) -> Complex:
        """The Hessian of g at each query times vectors (d, queries)."""
        return self._a * vectors + self._b * vectors.conj()

    @functools.cached_property
    def moves(self) -> tuple[Array, Array, Array]:
        """What each unknown place moves: ends (places, segments + 1), queries and ratios (places, queries)."""
        breaks = np.zeros((self.columns, len(self.beam.breaks)))
        queries, ratios = np.zeros((2, self.columns, self.u.size))
        for span in self.spans:
            site = span.site
            for j in range(site.unknown_places):
                unit = replace(site, place=tuple(float(i == j) for i in range(len(site.place))))
                queries[span.column + j, span.queries] = _query(unit, self.beam.order)
                for mark, rate in zip(site.breaks(), unit.breaks(), strict=True):
                    nearest = int(np.argmin(np.abs(np.array(self.beam.breaks) - mark)))
                    if 0 < nearest < len(self.beam.breaks) - 1:
                        breaks[span.column + j, nearest] += rate
            if site.grip is not None and site.grip.hold == "stick":
                first = site.grip.law.leader(self.sites, self.spans.index(span))
                ratios[self.spans[first].ratio, span.queries] = 1.0
        return breaks, queries, ratios

    def along(self, vectors: Complex) -> Array:
        """Scalar products of vectors (d, queries) with the normals."""
        return dot(self.normal, vectors)
