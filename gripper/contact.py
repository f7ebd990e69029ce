"""Where finger and object touch, and the equations that hold there.

A contact's place is an unknown of its own and moves between nodes. Its kinds:

``tangent``  a smooth stretch of the object on a face or an edge: g = 0 and dg/du = 0 at u;
``corner``   a corner of the outline on the object: g = 0;
``node``     a fixed place of a face or an edge: g = 0 (where both conform, and no place is singled out);
``vertex``   a corner of the object on a face or an edge: signed distance 0 at the foot of the normal;
``patch``    with shear, a smooth object is touched over [a, b], because gamma drops to zero behind a force: the
             pressure is a polynomial, the gap's moments against it vanish, and so does the gap at both ends;
``tail``     a patch whose far end is known: the tip, where the tip's corner carries the rest, or, where the finger lies
             flush on a flat, a place so far that the pressure has decayed.

Where gamma jumps at a concentrated force, "the" tangent of the face is the mean of both sides: this is what makes
the energy stationary in the place of the force (configurational balance).
"""

from __future__ import annotations

import bisect
import functools
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.axis import Axis
from gripper.beam import Beam, legendre
from gripper.grip import Grip
from gripper.obstacle import Obstacle
from gripper.outline import UPPER, Outline, Stations, dot, second_derivative
from gripper.rubbing import Rubbing, rub

Kind = Literal["tangent", "corner", "node", "vertex", "patch", "tail"]
NARROW, WIDE = 2, 8
"""Fewest and most pressure modes of a patch: short, or long, against the length over which shear decays."""
_CUTS = {6: (0.35,), 8: (0.12, 0.35)}
# parts of a patch with many modes where its segments end: strains of order p carry pressures of order p - 1, and the
# pressure decays from the near end
_AT_BREAK = 0.02  # a force this near to a break is the break's own: its segments were cut there


@dataclass(frozen=True)
class Site:
    """One contact: its kind, the piece of the outline, its place there, and the corner or vertex it belongs to."""

    kind: Kind
    piece: int
    place: tuple[float, ...]
    vertex: int = -1
    modes: int = 1  # of its pressure
    grip: Grip | None = None
    """How it holds; None without friction."""

    @property
    def multipliers(self) -> int:
        """How many multipliers the contact has."""
        return self.modes

    @property
    def unknown_places(self) -> int:
        """How many coordinates of its place are unknown."""
        return {"tangent": 1, "corner": 0, "node": 0, "vertex": 1, "patch": 2, "tail": 1}[self.kind]

    @property
    def unknowns(self) -> int:
        """Unknown coordinates of its place, and the ratio of its friction where that is unknown: the last one."""
        return self.unknown_places + (self.grip is not None and self.grip.unknown)

    @property
    def on_face(self) -> bool:
        """Whether it lies on a flexible face."""
        return self.piece <= UPPER

    @property
    def middle(self) -> float:
        """Its place, or the middle of its patch (0 of a corner)."""
        return sum(self.place) / len(self.place) if self.place else 0.0

    @property
    def coordinates(self) -> Array:
        """Values of its unknowns."""
        ratio = () if self.grip is None or not self.grip.unknown else (self.grip.ratio,)
        return np.array([*self.place[: self.unknown_places], *ratio])

    def moved(self, coordinates: Array) -> Site:
        """The same contact at other values of its unknowns."""
        places = tuple(map(float, coordinates[: self.unknown_places]))
        site = replace(self, place=(*places, self.place[1]) if self.kind == "tail" else places) if places else self
        if self.grip is None or not self.grip.unknown:
            return site
        return replace(site, grip=replace(self.grip, ratio=float(coordinates[-1])))

    def breaks(self) -> tuple[float, ...]:
        """Where the strains have kinks because of it."""
        if not self.on_face or self.modes not in _CUTS:
            return self.place if self.on_face else ()
        a, b = self.place
        return (a, *(a + cut * (b - a) for cut in _CUTS[self.modes]), b)


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
    hessian: Array  # sum lambda C_zz at fixed places, (n, n)
    value_rates: Array  # dC/dq, (m,)
    residual_rates: Array  # dR/dq, (k,)
    load_rates: Array  # d(C_z^T lambda)/dq, (n,)
    force_gradient: Complex  # d(total force on the finger)/dz, (n,)
    force_multipliers: Complex  # the same by the multipliers, (m,)
    force_places: Complex  # the same by the places, (k,)
    points: tuple[Complex, ...]  # per site, where it touches, (j,)
    forces: tuple[Complex, ...]  # per site, force on the finger at those points, (j,)
    stations: tuple[Array, ...]  # per site, the place u of those points, (j,)
    loads: Array  # unit loads of the multipliers on z: C_z, and friction's part, (m, n)
    rubbing: Rubbing | None = None


def linearise(
    beam: Beam,
    z: Array,
    outline: Outline,
    obstacle: Obstacle,
    sites: tuple[Site, ...],
    multipliers: Array,
    *,
    kinks: bool = True,
) -> Linearisation:
    """Evaluate the contact equations of all sites in one pass over outline and object.

    With ``kinks`` a contact at a break takes the mean of both sides; without, its own segment alone.
    """
    if not sites:
        return _nothing(beam.size)
    queries = [_places(site, beam.order) for site in sites]
    u = np.concatenate(queries)
    piece = np.concatenate([np.full(len(q), site.piece) for site, q in zip(sites, queries, strict=True)])
    axis = Axis.of(beam, z)
    stations = _stations(axis, outline, piece, u, sites, queries, kinks)
    system = System(beam, sites, stations, obstacle)
    first = row = column = 0
    for site, places in zip(sites, queries, strict=True):
        span = slice(first, first + len(places))
        load = multipliers[row : row + site.multipliers]
        if site.kind == "vertex":
            system.add_vertex(site, first, row, column, load[0])
        elif site.kind in ("patch", "tail"):
            system.add_patch(site, span, row, column, load)
        else:
            system.add_point(site, first, row, column, load[0])
        system.layout.append((span, row, column))
        first, row, column = span.stop, row + site.multipliers, column + site.unknowns
    if sites[0].grip is not None:
        rub(system, outline, u)
    hessian = second_derivative(axis, stations, system.pull) + system.extra
    hessian += system.stiffened()
    return system.linearisation(hessian, queries)


@functools.cache
def _nothing(size: int) -> Linearisation:
    """The linearisation of a finger that touches nothing."""
    none, wide, square = np.zeros(0), np.zeros((0, size)), np.zeros((0, 0))
    forces = np.zeros(size) + 0j, none + 0j, none + 0j
    whole = np.zeros((size, size))
    return Linearisation(
        none, wide, square, none, wide, square, wide.T, whole, none, none, np.zeros(size), *forces, (), (), (), wide
    )


@functools.cache
def pressure_rule(modes: int, order: int) -> tuple[Array, Array]:
    """Gauss points (q,) of a patch on [-1, 1], and the pressure modes' mean values over it (modes, q).

    More points than the strains have modes: these would resolve the single points else.
    """
    x, weights = np.polynomial.legendre.leggauss(max(modes + 4, order + 3))
    return x, legendre(x, modes).T * weights / 2


def _places(site: Site, order: int) -> Array:
    """Where the outline is evaluated for a contact."""
    if site.kind not in ("patch", "tail"):
        return np.array(site.place or (0.0,))
    a, b = site.place
    gauss = (a + b) / 2 + (b - a) / 2 * pressure_rule(site.modes, order)[0]
    return np.append(gauss, site.place[: site.unknown_places])


def _stations(
    axis: Axis, outline: Outline, piece: Index, u: Array, sites: tuple[Site, ...], queries: list[Array], kinks: bool
) -> Stations:
    beam = axis.beam
    left: list[int] = []
    right: list[int] = []
    for site, places in zip(sites, queries, strict=True):
        if site.modes in _CUTS:
            inner = beam.segment_of(places - 1e-12).tolist()
            left, right = left + inner, right + inner
            continue
        before, after = _segments(beam, site, kinks)
        left += [before] * len(places)
        right += [after] * len(places)
    stations = outline.stations(axis, piece, u, np.array(left))
    if left == right:
        return stations
    other = outline.stations(axis, piece, u, np.array(right))
    return stations.mean(other)


def pointed(site: Site) -> Site:
    """A patch as a point in its middle, without friction."""
    if site.kind in ("patch", "tail"):
        return replace(site, kind="tangent", place=(site.middle,), modes=1, grip=None)
    return replace(site, grip=None)


def own_segment(beam: Beam, site: Site) -> int:
    """The segment that a contact lies on; beyond the faces the last one."""
    if not site.on_face:
        return beam.segments - 1
    return min(max(bisect.bisect_right(beam.breaks, site.middle) - 1, 0), beam.segments - 1)


def _segments(beam: Beam, site: Site, kinks: bool) -> tuple[int, int]:
    """The segments whose polynomials describe the outline before and after a contact."""
    middle, own = site.middle, own_segment(beam, site)
    if not site.on_face or not kinks or site.kind in ("patch", "tail") or beam.segments == 1:
        return own, own
    nearest = min(range(1, beam.segments), key=lambda i: abs(beam.breaks[i] - middle))
    return (nearest - 1, nearest) if abs(beam.breaks[nearest] - middle) < _AT_BREAK else (own, own)


class System:
    """The arrays of a linearisation while its contacts are written into them."""

    def __init__(self, beam: Beam, sites: tuple[Site, ...], stations: Stations, obstacle: Obstacle) -> None:
        size, self.order = beam.size, beam.order
        m, k, q = sum(s.multipliers for s in sites), sum(s.unknowns for s in sites), len(stations.points)
        self.layout: list[tuple[slice, int, int]] = []  # of each site: its queries, first row, first column
        self.sites, self.stations, self.obstacle = sites, stations, obstacle
        self.gap, self.normal, (self.a, self.b) = obstacle.curvature(stations.points)
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
        active = np.flatnonzero(self.weights)
        gradients, weights = self.stations.gradients[active], self.weights[active]
        a, b = (weights * self.a[active])[:, None], (weights * self.b[active])[:, None]
        curved = a * gradients + b * gradients.conj()
        if self.rubbing is not None:
            curved *= np.asarray(self.turns)[active][:, None]
        self.force_gradient += curved.sum(axis=0)
        return gradients.real.T @ curved.real + gradients.imag.T @ curved.imag

    def add_point(self, site: Site, i: int, row: int, column: int, force: float) -> None:
        """Tangent, node, or corner of the outline."""
        self.values[row], self.gradients[row], self.value_rates[row] = self.gap[i], self.pressing[i], self.gap_rate[i]
        self._load(slice(i, i + 1), force)
        self.force_multipliers[row] = self.normal[i]
        if site.kind == "tangent":
            self.force_places[column] = force * self.bent[i]
            self.value_slopes[row, column] = self.residuals[column] = self.slope[i]
            self.residual_gradients[column], self.residual_slopes[column, column] = self.sliding[i], self.bending[i]
            self.load_slopes[:, column] = force * self.sliding[i]
            self.residual_rates[column] = dot(self.normal_rate[i], self.stations.tangents[i])

    def add_patch(self, site: Site, span: slice, row: int, column: int, load: Array) -> None:
        """Pressure over [a, b]: the gap's moments vanish, and the gap at the free ends."""
        x, mean = self.rule(site)
        gauss = slice(span.start, span.start + x.size)
        rows = slice(row, row + site.modes)
        forces = load @ mean
        self.values[rows], self.gradients[rows] = mean @ self.gap[gauss], mean @ self.pressing[gauss]
        self.value_rates[rows] = mean @ self.gap_rate[gauss]
        self._load(gauss, forces)
        self.force_multipliers[rows] = mean @ self.normal[gauss]
        for end, shift in zip(range(site.unknown_places), ((1 - x) / 2, (1 + x) / 2), strict=False):
            i, at = gauss.stop + end, column + end
            self.value_slopes[rows, at] = mean @ (shift * self.slope[gauss])
            self.load_slopes[:, at] = (forces * shift) @ self.sliding[gauss]
            self.force_places[at] = (forces * shift) @ self.bent[gauss]
            self.residuals[at], self.residual_gradients[at] = self.gap[i], self.pressing[i]
            self.residual_slopes[at, at], self.residual_rates[at] = self.slope[i], self.gap_rate[i]

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

    def linearisation(self, hessian: Array, queries: list[Array]) -> Linearisation:
        """The finished arrays, with the contact forces point by point."""
        spans = np.cumsum([0] + [len(q) for q in queries])
        ends = [0 if site.kind not in ("patch", "tail") else site.unknown_places for site in self.sites]
        cuts = [slice(a, b - e) for a, b, e in zip(spans[:-1], spans[1:], ends, strict=True)]
        return Linearisation(
            self.values,
            self.gradients,
            self.value_slopes,
            self.residuals,
            self.residual_gradients,
            self.residual_slopes,
            self.load_slopes,
            hessian,
            self.value_rates,
            self.residual_rates,
            self.load_rates,
            self.force_gradient,
            self.force_multipliers,
            self.force_places,
            tuple(self.stations.points[cut] for cut in cuts),
            tuple(self.pull[cut] for cut in cuts),
            tuple(q[: len(q) - e] for q, e in zip(queries, ends, strict=True)),
            self.loads,
            self.rubbing,
        )
