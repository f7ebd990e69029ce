"""The rows that each contact writes into the equations at a state, with all derivatives that Newton needs."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array, Complex
from gripper.beam.strains import Beam
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import UPPER
from gripper.contact.rates import Passing
from gripper.contact.site import Site, pressure_rule
from gripper.contact.stations import Stations

if TYPE_CHECKING:
    from gripper.contact.rubbing import Rubbing


@functools.cache
def _shifts(modes: int, order: int) -> Array:
    """How far Gauss points on a patch move with its two ends, (2, q)."""
    x = pressure_rule(modes, order)[0]
    return np.array([(1 - x) / 2, (1 + x) / 2])


def _surface(
    obstacle: Obstacle, sites: tuple[Site, ...], points: Complex
) -> tuple[Array, Complex, tuple[Array, Complex]]:
    """G / L and its derivatives; none for corners of the object alone, whose distance to the outline counts."""
    if {site.kind for site in sites} == {"vertex"}:
        none = np.zeros(len(points))
        return none, none + 0j, (none, none + 0j)
    return obstacle.curvature(points)


class System:
    """The arrays of a linearisation while its contacts are written into them."""

    def __init__(self, beam: Beam, sites: tuple[Site, ...], stations: Stations, obstacle: Obstacle) -> None:
        size, self.order = beam.size, beam.order
        m, k, q = sum([s.modes for s in sites]), sum([s.unknowns for s in sites]), len(stations.points)
        self.layout: list[tuple[slice, int, int]] = []  # of each site: its queries, first row, first column
        self.sites, self.stations, self.obstacle = sites, stations, obstacle
        self.gap, self.normal, (self.a, self.b) = _surface(obstacle, sites, stations.points)
        tangents, back = stations.tangents, self.normal.conj()
        self.slope = (back * tangents).real  # dg/du
        self.bent = self._curved(tangents)
        bent = self.bent.conj()
        self.bending = (bent * tangents + back * stations.curvatures).real
        self.pressing = (back[:, None] * stations.gradients).real  # g_z, (q, n)
        # d(dg/du)/dz, (q, n)
        self.sliding = (bent[:, None] * stations.gradients + back[:, None] * stations.tangent_gradients).real
        self.values, self.gradients, self.value_slopes = np.zeros(m), np.zeros((m, size)), np.zeros((m, k))
        self.residuals, self.residual_gradients = np.zeros(k), np.zeros((k, size))
        self.residual_slopes, self.load_slopes = np.zeros((k, k)), np.zeros((size, k))
        self.loads = self.gradients  # friction adds to a copy
        # the object's: n, its turning by z and by u, and the force times the side of the face
        self.corners: dict[int, tuple[complex, Array, float, float]] = {}
        self.rubbing: Rubbing | None = None
        self.anchored: dict[int, float] = {}  # rates of the residuals of contacts that stick
        self.weights = np.zeros(q)  # force along grad g at each query
        self.turns: Complex | None = None  # 1 - i rho at each query: from the normal force to the force
        self.pull = np.zeros(q, dtype=complex)
        self.ahead = np.zeros(q, dtype=complex)  # from each query to where its force acts
        self.levers: list[tuple[slice, Complex]] = []  # of friction that acts at the axis, by its ratio: (queries, n)
        self.extra: Array | None = None  # what corners of the object add to the Hessian
        self.force_gradient = np.zeros(size, dtype=complex)
        self.force_multipliers, self.force_places = np.zeros(m, dtype=complex), np.zeros(k, dtype=complex)

    def rule(self, site: Site) -> tuple[Array, Array]:
        """Where a patch is evaluated, on [-1, 1], and its pressure modes there."""
        return pressure_rule(site.modes, self.order)

    def _curved(self, vectors: Complex) -> Complex:
        """The object's Hessian times vectors."""
        return self.a * vectors + self.b * vectors.conj()

    def stiffened(self) -> Array:
        """sum_i force_i c_z^T H c_z: the part of the Hessian that comes from the object's curvature."""
        gradients = self.stations.gradients
        back, weights = gradients.conj(), self.weights if self.turns is None else self.weights * self.turns
        curved = (weights * self.a)[:, None] * gradients + (weights * self.b)[:, None] * back
        self.force_gradient += curved.sum(axis=0)
        stiffness: Array = (back.T @ curved).real
        return stiffness

    def add_point(self, site: Site, i: int, row: int, column: int, force: float) -> None:
        """Tangent, node, or corner of the outline."""
        self.values[row], self.gradients[row] = self.gap[i], self.pressing[i]
        self.weights[i], self.pull[i] = force, force * self.normal[i]
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

    def add_patch(self, site: Site, span: slice, row: int, column: int, load: Array) -> None:
        """Pressure over [a, b]: the gap's moments vanish, and the gap at the free ends."""
        x, mean = self.rule(site)
        middle = span.start + x.size
        gauss, free = slice(span.start, middle), slice(middle, span.stop)
        rows, columns = slice(row, row + site.modes), slice(column, column + site.unknown_places)
        self.weights[gauss] = forces = load @ mean
        normal = self.normal[gauss]
        self.pull[gauss] = forces * normal
        self.values[rows], self.gradients[rows] = mean @ self.gap[gauss], mean @ self.pressing[gauss]
        self.force_multipliers[rows] = mean @ normal
        shifts = _shifts(site.modes, self.order)[: site.unknown_places]  # how far each point moves with each end
        moved = shifts * forces
        self.value_slopes[rows, columns] = mean @ (shifts * self.slope[gauss]).T
        self.load_slopes[:, columns] = (moved @ self.sliding[gauss]).T
        self.force_places[columns] = moved @ self.bent[gauss]
        if site.lifts_off:
            self._touch_smoothly(middle, column)
            return
        self.residuals[columns], self.residual_gradients[columns] = self.gap[free], self.pressing[free]
        for i, at in enumerate(range(column, columns.stop), start=middle):
            self.residual_slopes[at, at] = self.slope[i]

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
        self.values[row], self.gradients[row] = side * height, push - side * along * turn_z
        self.value_slopes[row, column] = -side * turn_u * along
        self.residuals[column], self.residual_gradients[column] = along, pass_by + height * turn_z
        self.residual_slopes[column, column] = stretch + height * turn_u
        self.load_slopes[:, column] = -force * side * turn_u * (pass_by + height * turn_z)
        self.pull[i] = force * n
        self.force_multipliers[row], self.force_places[column] = n, -force * side * turn_u * t
        self.force_gradient -= force * side * t * turn_z
        mixed = np.outer(pass_by, turn_z)
        self.stiffen(-force * side * (mixed + mixed.T + height * np.outer(turn_z, turn_z)))
        self.corners[i] = n, turn_z, turn_u, force * side

    def stiffen(self, hessian: Array) -> None:
        """Add a part of the Hessian, (n, n)."""
        self.extra = hessian if self.extra is None else self.extra + hessian

    def _carried_slopes(self) -> Array:
        """The loads' slopes by places that carry the ends of their segments along.

        What a force does to the strains at its own section is what these give way with: as the segments' end moves
        with it, V's gradient changes by as much, and both drop out. With friction slip is told by segments held still.
        """
        carried = self.load_slopes
        for site, (span, _, column) in zip(self.sites, self.layout, strict=True):
            if site.on_face and site.kind == "tangent" and site.grip is None:
                carried = carried.copy() if carried is self.load_slopes else carried
                carried[:, column] -= (self.pull[span.start].conj() * self.stations.strained(span.start)).real
        return carried

    def _passing(self) -> Passing:
        """What the rates follow from."""
        stations = self.stations
        return Passing(
            self.obstacle,
            self.order,
            self.sites,
            self.layout,
            stations.points,
            stations.tangents,
            stations.gradients,
            self.normal,
            (self.a, self.b),
            self.weights if self.turns is None else self.weights * self.turns,
            self.corners,
            self.anchored,
            [(span, self.weights[span][:, None] * levers) for span, levers in self.levers],
        )

    def linearisation(self, hessian: Array, queries: list[Array]) -> Linearisation:
        """The finished arrays, with the contact forces point by point."""
        points, forces, places = [], [], []
        for site, (span, *_), u in zip(self.sites, self.layout, queries, strict=True):
            count = len(u) - site.unknown_places if site.spreads else len(u)
            cut = slice(span.start, span.start + count)
            points.append(self.stations.points[cut] + self.ahead[cut])
            forces.append(self.pull[cut])
            places.append(u[:count])
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
            self._passing().rates,
            self.force_gradient,
            self.force_multipliers,
            self.force_places,
            tuple(points),
            tuple(forces),
            tuple(places),
            self.loads,
            self.rubbing,
        )
