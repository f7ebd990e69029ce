"""The rows that each contact writes into the equations at a state, with all derivatives that Newton needs."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.strains import Beam
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import UPPER, Stations, dot
from gripper.contact.site import Site, pressure_rule

if TYPE_CHECKING:
    from gripper.contact.rubbing import Rubbing
    from gripper.statics.acting import Push


@dataclass(frozen=True, eq=False)
class Linearisation:
    """The contact equations at a state, with all first derivatives and the second ones that Newton needs.

    m constraints, k unknown places, n unknowns of the beam.
    """

    values: Array  # C, (m,)
    gradients: Array  # C_z, (m, n)
    value_slopes: Array  # C_u, (m, k)
    residuals: Array  # equations of the places R, (k,)
    residual_gradients: Array  # R_z, (k, n)
    residual_slopes: Array  # R_u, (k, k)
    load_slopes: Array  # d(C_z^T lambda)/du, (n, k)
    carried_slopes: Array  # the same with V's part, where the ends of the segments are carried along by the places
    hessian: Array  # sum lambda C_zz at fixed places, (n, n)
    value_rates: Array  # dC/dq, (m,)
    residual_rates: Array  # dR/dq, (k,)
    load_rates: Array  # d(C_z^T lambda)/dq, (n,)
    force_gradient: Complex  # d(total force on the finger)/dz, (n,)
    force_multipliers: Complex  # the same by the multipliers, (m,)
    force_places: Complex  # the same by the places, (k,)
    points: tuple[Complex, ...]  # per site, where its force acts, (j,)
    forces: tuple[Complex, ...]  # per site, force on the finger at those points, (j,)
    stations: tuple[Array, ...]  # per site, the place u of those points, (j,)
    loads: Array  # unit loads of the multipliers on z: C_z, and friction's part, (m, n)
    rubbing: Rubbing | None = None
    push: Push | None = None  # what else loads the finger; its part is in hessian and load_rates

    def pushed(self, push: Push) -> Linearisation:
        """The same with what else loads the finger."""
        hessian, rates = self.hessian + push.slopes, self.load_rates + push.rates
        return replace(self, hessian=hessian, load_rates=rates, push=push)

    def keeping(self, kept: Index) -> Linearisation:
        """The same without friction and other loads, in some of the beam's unknowns only."""
        gradients = self.gradients[:, kept]
        return replace(
            self,
            gradients=gradients,
            residual_gradients=self.residual_gradients[:, kept],
            load_slopes=self.load_slopes[kept],
            carried_slopes=self.carried_slopes[kept],
            hessian=self.hessian[kept[:, None], kept],
            load_rates=self.load_rates[kept],
            force_gradient=self.force_gradient[kept],
            loads=gradients,
        )

    def load(self, multipliers: Array) -> Array:
        """All that bends the finger: generalised forces on z, (n,)."""
        contacts: Array = self.loads.T @ multipliers
        return contacts if self.push is None else contacts + self.push.force


@functools.cache
def _shifts(modes: int, order: int) -> Array:
    """How far Gauss points on a patch move with its two ends, (2, q)."""
    x = pressure_rule(modes, order)[0]
    return np.array([(1 - x) / 2, (1 + x) / 2])


def _surface(
    obstacle: Obstacle, sites: tuple[Site, ...], points: Complex
) -> tuple[Array, Complex, tuple[Array, Complex]]:
    """G / L and its derivatives; none for corners of the object alone, whose distance to the outline counts."""
    if all(site.kind == "vertex" for site in sites):
        none = np.zeros(len(points))
        return none, none + 0j, (none, none + 0j)
    return obstacle.curvature(points)


class System:
    """The arrays of a linearisation while its contacts are written into them."""

    def __init__(self, beam: Beam, sites: tuple[Site, ...], stations: Stations, obstacle: Obstacle) -> None:
        size, self.order = beam.size, beam.order
        m, k, q = sum(s.multipliers for s in sites), sum(s.unknowns for s in sites), len(stations.points)
        self.layout: list[tuple[slice, int, int]] = []  # of each site: its queries, first row, first column
        self.sites, self.stations, self.obstacle = sites, stations, obstacle
        self.gap, self.normal, (self.a, self.b) = _surface(obstacle, sites, stations.points)
        tangents = stations.tangents
        self.slope = dot(self.normal, tangents)  # dg/du
        back = self.normal.conj()[:, None]
        self.pressing = (back * stations.gradients).real  # g_z, (q, n)
        self.bent = bent = self._curved(tangents)
        # d(dg/du)/dz, (q, n)
        self.sliding = (bent.conj()[:, None] * stations.gradients + back * stations.tangent_gradients).real
        self.bending = dot(bent, tangents) + dot(self.normal, stations.curvatures)
        passing = -obstacle.velocities(stations.points)
        self.gap_rate = dot(self.normal, passing)
        self.normal_rate = self._curved(passing) + 1j * obstacle.frame.spin * self.normal
        self.values, self.gradients, self.value_slopes = np.zeros(m), np.zeros((m, size)), np.zeros((m, k))
        self.residuals, self.residual_gradients = np.zeros(k), np.zeros((k, size))
        self.residual_slopes, self.load_slopes = np.zeros((k, k)), np.zeros((size, k))
        self.value_rates, self.residual_rates, self.load_rates = np.zeros(m), np.zeros(k), np.zeros(size)
        self.loads = self.gradients  # friction adds to a copy
        self.corners: dict[int, tuple[complex, Array, float]] = {}  # the object's: n, and its turning by z and by u
        self.rubbing: Rubbing | None = None
        self.weights = np.zeros(q)  # force along grad g at each query
        self.turns: Complex | float = 1.0  # 1 - i rho at each query: from the normal force to the force
        self.pull = np.zeros(q, dtype=complex)
        self.ahead = np.zeros(q, dtype=complex)  # from each query to where its force acts
        self.extra = np.zeros((size, size))
        self.force_gradient = np.zeros(size, dtype=complex)
        self.force_multipliers, self.force_places = np.zeros(m, dtype=complex), np.zeros(k, dtype=complex)

    def rule(self, site: Site) -> tuple[Array, Array]:
        """Where a patch is evaluated, on [-1, 1], and its pressure modes there."""
        return pressure_rule(site.modes, self.order)

    def _curved(self, vectors: Complex) -> Complex:
        """The object's Hessian times vectors."""
        return self.a * vectors + self.b * vectors.conj()

    def _load(self, queries: slice, forces: Array | float) -> None:
        """Forces along grad g enter the Hessian and the loads' rate."""
        self.weights[queries] = forces
        self.pull[queries] = forces * self.normal[queries]
        turned = forces * self.normal_rate[queries].conj()
        self.load_rates += (turned @ self.stations.gradients[queries]).real

    def stiffened(self) -> Array:
        """sum_i force_i c_z^T H c_z: the part of the Hessian that comes from the object's curvature."""
        gradients = self.stations.gradients
        back = gradients.conj()
        curved = (self.weights * self.a)[:, None] * gradients + (self.weights * self.b)[:, None] * back
        if self.rubbing is not None:
            curved *= np.asarray(self.turns)[:, None]
        self.force_gradient += curved.sum(axis=0)
        stiffness: Array = (back.T @ curved).real
        return stiffness

    def add_point(self, site: Site, i: int, row: int, column: int, force: float) -> None:
        """Tangent, node, or corner of the outline."""
        self.values[row], self.gradients[row], self.value_rates[row] = self.gap[i], self.pressing[i], self.gap_rate[i]
        self._load(slice(i, i + 1), force)
        self.force_multipliers[row] = self.normal[i]
        if site.kind == "tangent":
            self.force_places[column] = force * self.bent[i]
            self.value_slopes[row, column] = self.slope[i]
            self.load_slopes[:, column] = force * self.sliding[i]
            self._touch_smoothly(i, column)

    def _touch_smoothly(self, i: int, column: int) -> None:
        """Equation of a place: there dg/du = 0."""
        self.residuals[column], self.residual_gradients[column] = self.slope[i], self.sliding[i]
        self.residual_slopes[column, column] = self.bending[i]
        self.residual_rates[column] = dot(self.normal_rate[i], self.stations.tangents[i])

    def add_patch(self, site: Site, span: slice, row: int, column: int, load: Array) -> None:
        """Pressure over [a, b]: the gap's moments vanish, and the gap at the free ends."""
        x, mean = self.rule(site)
        gauss, free = slice(span.start, span.start + x.size), slice(span.start + x.size, span.stop)
        rows, columns = slice(row, row + site.modes), slice(column, column + site.unknown_places)
        forces = load @ mean
        self.values[rows], self.gradients[rows] = mean @ self.gap[gauss], mean @ self.pressing[gauss]
        self.value_rates[rows] = mean @ self.gap_rate[gauss]
        self._load(gauss, forces)
        self.force_multipliers[rows] = mean @ self.normal[gauss]
        shifts = _shifts(site.modes, self.order)[: site.unknown_places]  # how far each point moves with each end
        moved = shifts * forces
        self.value_slopes[rows, columns] = mean @ (shifts * self.slope[gauss]).T
        self.load_slopes[:, columns] = (moved @ self.sliding[gauss]).T
        self.force_places[columns] = moved @ self.bent[gauss]
        if site.lifts_off:
            self._touch_smoothly(free.start, column)
            return
        self.residuals[columns], self.residual_gradients[columns] = self.gap[free], self.pressing[free]
        self.residual_slopes[columns, columns] = np.diag(self.slope[free])
        self.residual_rates[columns] = self.gap_rate[free]

    def add_vertex(self, site: Site, i: int, row: int, column: int, force: float) -> None:
        """Corner v of the object at the foot u of its normal: n . (c - v) = 0, (c - v) . t = 0."""
        stations, vertex = self.stations, self.obstacle.corners[site.vertex]
        side = (
            -1.0 if site.piece == UPPER else 1.0
        )  # the finger's inside is left of the tangent, on the upper face right
        stretch = float(abs(stations.tangents[i]))
        t = complex(stations.tangents[i]) / stretch
        across = 1j * t
        n = side * across
        # the tangent turns by phi (phi_z, phi_u), and n by -side t phi
        turn_z = (across.conjugate() * stations.tangent_gradients[i]).real / stretch
        turn_u = (across.conjugate() * complex(stations.curvatures[i])).real / stretch
        local = t.conjugate() * (stations.points[i] - vertex)
        along, height = float(local.real), float(local.imag)
        moving = t.conjugate() * stations.gradients[i]
        pass_by, push = moving.real, side * moving.imag
        velocity = complex(self.obstacle.velocities(vertex))
        slipping, pushing = (t.conjugate() * velocity).real, (n.conjugate() * velocity).real
        self.values[row], self.gradients[row] = side * height, push - side * along * turn_z
        self.value_slopes[row, column] = -side * turn_u * along
        self.value_rates[row] = -pushing
        self.residuals[column], self.residual_gradients[column] = along, pass_by + height * turn_z
        self.residual_slopes[column, column] = stretch + height * turn_u
        self.residual_rates[column] = -slipping
        self.load_slopes[:, column] = -force * side * turn_u * (pass_by + height * turn_z)
        self.load_rates += force * side * slipping * turn_z
        self.pull[i] = force * n
        self.force_multipliers[row], self.force_places[column] = n, -force * side * turn_u * t
        self.force_gradient -= force * side * t * turn_z
        mixed = np.outer(pass_by, turn_z)
        self.extra -= force * side * (mixed + mixed.T + height * np.outer(turn_z, turn_z))
        self.corners[i] = n, turn_z, turn_u

    def _carried_slopes(self) -> Array:
        """The loads' slopes by places that carry the ends of their segments along.

        What a force does to the strains at its own section is what these give way with: as the segments' end moves
        with it, V's gradient changes by as much, and both drop out. With friction slip is told by segments held still.
        """
        carried = self.load_slopes
        for site, (span, _, column) in zip(self.sites, self.layout, strict=True):
            if site.on_face and site.kind == "tangent" and site.grip is None:
                carried = carried.copy() if carried is self.load_slopes else carried
                carried[:, column] -= dot(self.pull[span.start], self.stations.strained[span.start])
        return carried

    def linearisation(self, hessian: Array, queries: list[Array]) -> Linearisation:
        """The finished arrays, with the contact forces point by point."""
        ends = [site.unknown_places if site.spreads else 0 for site in self.sites]
        cuts = [slice(span.start, span.stop - e) for (span, *_), e in zip(self.layout, ends, strict=True)]
        return Linearisation(
            self.values,
            self.gradients,
            self.value_slopes,
            self.residuals,
            self.residual_gradients,
            self.residual_slopes,
            self.load_slopes,
            self._carried_slopes(),
            hessian,
            self.value_rates,
            self.residual_rates,
            self.load_rates,
            self.force_gradient,
            self.force_multipliers,
            self.force_places,
            tuple(self.stations.points[cut] + self.ahead[cut] for cut in cuts),
            tuple(self.pull[cut] for cut in cuts),
            tuple(q[: len(q) - e] for q, e in zip(queries, ends, strict=True)),
            self.loads,
            self.rubbing,
        )
