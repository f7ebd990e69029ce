"""Scene to NCO problem: minimise the strain energy subject to gaps >= 0, with only what the scene needs.

The gaps are few: the minima of g along stretches of the outline that are near the object, found between nodes
(their gradient is that of the minimum: envelope theorem), the gaps of the outline's corners, and the signed
distances of the object's corners to the faces. Unknowns and gaps reach SciPy scaled, so that the energy is
|x|^2 / 2 and its first, unit Hessian is exact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gripper.acting import LoadEnergy
from gripper.arrays import Array, Index
from gripper.axis import Axis
from gripper.beam import BeamTheory
from gripper.certificate import Survey, survey
from gripper.compiled_loads import compiled_loads
from gripper.contact import linearise
from gripper.energy import energy, energy_gradient, energy_hessian
from gripper.equilibrium import Setting, State
from gripper.kinematics import Kinematics
from gripper.obstacle import Obstacle
from gripper.outline import LOWER, UPPER, Outline, dot
from gripper.pose import placed
from gripper.result import LeftOut
from gripper.scene import Scene
from gripper.sections import sections
from gripper.site import Site, own_segment

if TYPE_CHECKING:
    from gripper.law import Law

_SAMPLES = 9
_FEET = 6  # Newton steps to the foot of a normal
_GRAZED = 0.05  # of L: how much wider than the least sampled gap is looked at
_REFINEMENTS = 2
_MOST_REFINEMENTS = 60
_LOWER = 1e-6  # of L: twice what g may still fall below where it is taken to be least
_GRAZING = 1e-9  # of L: the least deflection that unknowns are scaled to
_ARCS = np.concatenate([[0.0], np.geomspace(0.02, 3.0, 24)])
_ORDERS = ((1e-2, 2), (1e-3, 3), (1e-4, 4), (1e-6, 5), (1e-8, 7), (0.0, 9))


@dataclass(frozen=True)
class Candidate:
    """Where finger and object may touch: a stretch of a piece, a corner of the outline, or one of the object's."""

    kind: Literal["stretch", "corner", "node", "vertex"]
    piece: int
    start: float = 0.0
    stop: float = 0.0
    vertex: int = -1


def setting(scene: Scene, theory: BeamTheory | None = None) -> Setting:
    """What stays the same over all poses of a scene: compiled once a finger and once an object.

    Parameters
    ----------
    scene
        What is given.
    theory
        In place of the scene's; "auto" is shear where nobody chooses.
    """
    finger = placed(scene.finger).body
    profile = sections(finger)
    chosen = theory or ("shear" if scene.theory == "auto" else scene.theory)
    outline = Outline(profile)
    friction = _law(scene, outline, profile.length)
    loads = compiled_loads(scene, profile) if scene.loads else None
    return Setting(profile, outline, chosen, placed(scene.object).body, scene.tolerance, friction, loads)


def _law(scene: Scene, outline: Outline, length: float) -> Law | None:
    """Friction in equilibrium, where there is any: mu = 0 leaves all of it out."""
    friction = scene.friction
    if friction is None or friction.absent or friction.published:
        return None
    from gripper.law import Law

    return Law.of(friction, outline, length)


def first_order(tolerance: float) -> int:
    """The order of the strain fields to start from; the error estimate decides whether it stays."""
    return next(order for limit, order in _ORDERS if tolerance >= limit)


def left_out(scene: Scene, theory: BeamTheory) -> tuple[LeftOut, ...]:
    """What this scene does not need, and why."""
    finger = placed(scene.finger).body
    out = []
    if scene.friction is None or scene.friction.absent:
        out.append(LeftOut(what="friction", why="coefficient is 0" if scene.friction else "none is given"))
    why = f"it changes forces by less than {scene.theory_tolerance:.2g}" if scene.theory == "auto" else "as asked"
    missing = {"bending": ("shear strain", "stretch of the axis"), "shear": ("stretch of the axis",), "stretch": ()}
    out += [LeftOut(what=what, why=f"theory is {theory}: {why}") for what in missing[theory]]
    if finger.jaw is None:
        out.append(LeftOut(what="jaw", why="the finger has none"))
    return tuple(out)


class Problem:
    """Minimise the strain energy over x subject to gaps(x) >= 0, at one pose.

    ``scipy.optimize.minimize(**problem.scipy())`` solves it. ``x`` are the strain fields' coefficients, scaled.

    Parameters
    ----------
    setting, obstacle
        Finger, theory and the object at its pose.
    start
        Where to start from; its beam is the discretisation.
    candidates
        Where they may touch.
    """

    def __init__(self, setting: Setting, obstacle: Obstacle, start: State, candidates: tuple[Candidate, ...]) -> None:
        self.setting, self.obstacle, self.beam = setting, obstacle, start.beam
        self.candidates = candidates
        self.left_out: tuple[LeftOut, ...] = ()
        self._grid()
        self._last: tuple[bytes, tuple[Site, ...], Array, Array] | None = None
        deepest = float(np.min(self._evaluate(start.z)[1], initial=0.0)) if candidates else 0.0
        # |z| of a cantilever whose tip is deflected by d is sqrt(3) d: unknowns and gaps of the size they will have
        self._pull = None if obstacle.acting is None else LoadEnergy(obstacle.acting, start)
        bent = start.z if self._pull is None else start.energy_gradient + self._pull.slope(start.z)  # by contacts alone
        self.scale = max(float(np.linalg.norm(bent)), -np.sqrt(3.0) * deepest, _GRAZING)
        self.gap_scale = self.scale / np.sqrt(3.0)
        self.x0 = start.z / self.scale

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.beam.size

    @property
    def energy_unit(self) -> float:
        """J per unit of the scaled energy."""
        return self.scale**2 * self.setting.sections.energy_scale

    def scaled_energy(self, x: Array) -> tuple[float, Array]:
        """What SciPy minimises, and its gradient (n,): |x|^2 / 2 and x under the linear law, without loads."""
        if self.beam.response is None and self._pull is None:
            return float(x @ x) / 2, x
        z = x * self.scale
        stored, stress = energy(self.beam, z), energy_gradient(self.beam, z)
        if self._pull is not None:
            stored, stress = stored + self._pull.energy(z), stress + self._pull.slope(z)
        return stored / self.scale**2, stress / self.scale

    def energy(self, x: Array) -> float:
        """Strain energy (Lan & Lee eq 1) and the loads' potential, in J."""
        return self.scaled_energy(np.asarray(x))[0] * self.energy_unit

    def energy_gradient(self, x: Array) -> Array:
        """Gradient of the energy (n,), in J."""
        return self.energy_unit * self.scaled_energy(np.asarray(x))[1]

    def energy_hessian(self, x: Array) -> Array:
        """Hessian of the energy (n, n), in J: a multiple of the identity under the linear law, without loads."""
        z = np.asarray(x) * self.scale
        pull = 0.0 if self._pull is None else self._pull.curvature(z)
        return self.energy_unit * (energy_hessian(self.beam, z) + pull)

    def gaps(self, x: Array) -> Array:
        """Gap at each candidate (m,), in m: at least 0 where nothing penetrates (Lan & Lee eq 3)."""
        return self._evaluate(np.asarray(x) * self.scale)[1] * self.setting.sections.length

    def gap_gradients(self, x: Array) -> Array:
        """Gradients of the gaps (m, n), in m."""
        return self._evaluate(np.asarray(x) * self.scale)[2] * (self.setting.sections.length * self.scale)

    def gap_hessian(self, x: Array, weights: Array) -> Array:
        """Hessian of weights . gaps (n, n), in m: the places of contact move with x."""
        z = np.asarray(x) * self.scale
        sites = self._evaluate(z)[0]
        lin = linearise(self.beam, z, self.setting.outline, self.obstacle, sites, np.asarray(weights), kinks=False)
        slope = np.diag(lin.residual_slopes).copy()
        free = np.array([self._inside(site, c) for site, c in self._placed(sites) if site.unknown_places], dtype=bool)
        moving = np.where(free & (np.abs(slope) > 1e-12), slope, np.inf)
        hessian = lin.hessian - lin.load_slopes @ (lin.residual_gradients / moving[:, None])
        return hessian * (self.setting.sections.length * self.scale**2)

    def sites(self, x: Array) -> tuple[Site, ...]:
        """The place of each candidate's gap."""
        return self._evaluate(np.asarray(x) * self.scale)[0]

    def state(self, x: Array) -> State:
        """The deflected finger."""
        return State(self.beam, np.asarray(x) * self.scale)

    def forces(self, x: Array, multipliers: Array) -> Array:
        """Force of the finger on the object at each candidate (m, 2), in N, clamp frame.

        Parameters
        ----------
        x
            Unknowns (n,).
        multipliers
            Of the scaled problem, as ``scipy.optimize.minimize`` returns them (m,).
        """
        sites = self.sites(x)
        load = np.asarray(multipliers) * self.scale**2 / self.gap_scale
        lin = linearise(
            self.beam, np.asarray(x) * self.scale, self.setting.outline, self.obstacle, sites, load, kinks=False
        )
        forces = -np.array([f.sum() for f in lin.forces]) * self.setting.sections.force_scale
        return np.column_stack([forces.real, forces.imag])

    def scipy(self, tolerance: float = 1e-10, iterations: int = 200) -> dict[str, Any]:
        """Arguments for ``scipy.optimize.minimize``: SLSQP on the scaled problem.

        Parameters
        ----------
        tolerance
            SLSQP's ``ftol``; absolute, which is sound because the energy is scaled.
        iterations
            Its ``maxiter``.
        """
        constraint = {
            "type": "ineq",
            "fun": lambda x: self._evaluate(x * self.scale)[1] / self.gap_scale,
            "jac": lambda x: self._evaluate(x * self.scale)[2] * (self.scale / self.gap_scale),
        }
        return {
            "fun": self.scaled_energy,
            "x0": self.x0,
            "jac": True,
            "method": "SLSQP",
            "constraints": [constraint] if self.candidates else [],
            "options": {"ftol": tolerance, "maxiter": iterations},
        }

    def _grid(self) -> None:
        """Samples along each stretch, and along the whole piece for each of the object's corners."""
        u, piece, owner = [], [], []
        for i, candidate in enumerate(self.candidates):
            if candidate.kind in ("stretch", "vertex"):
                u.append(np.linspace(candidate.start, candidate.stop, _SAMPLES))
                piece.append(np.full(_SAMPLES, candidate.piece))
                owner.append(i)
        self._owners = np.array(owner, dtype=np.intp)
        self._u = np.array(u).reshape(-1, _SAMPLES)
        self._piece = np.array(piece, dtype=np.intp).reshape(-1, _SAMPLES)
        self._segment = self._segments(self._piece, self._u)
        self._vertex = np.array([self.candidates[i].kind == "vertex" for i in owner], dtype=bool)

    def _segments(self, piece: Index, u: Array) -> Index:
        """The segment that each place lies in; the middle of its stretch decides at a break."""
        middle = (u[:, :1] + u[:, -1:]) / 2 if u.ndim == 2 else u
        inward = u + 1e-9 * np.sign(middle - u)
        return np.where(piece <= UPPER, self.beam.segment_of(np.clip(inward, 0, 1)), self.beam.segments - 1)

    def _evaluate(self, z: Array) -> tuple[tuple[Site, ...], Array, Array]:
        """Sites, gaps and gradients, by L (kept for the call that asks for the other)."""
        key = np.ascontiguousarray(z).tobytes()
        if self._last is None or self._last[0] != key:
            axis = Axis.of(self.beam, z)
            sites = self._locate(axis)
            self._last = key, sites, *self._gaps(axis, sites)
        return self._last[1:]

    def _gaps(self, axis: Axis, sites: tuple[Site, ...]) -> tuple[Array, Array]:
        """Gaps and their gradients at places that are found: these may move, which changes no least gap."""
        if not sites or any(site.kind == "vertex" for site in sites):
            none = np.zeros(len(sites))
            lin = linearise(self.beam, axis.z, self.setting.outline, self.obstacle, sites, none, kinks=False)
            return self._signed(lin.values, sites), lin.gradients
        piece = np.array([site.piece for site in sites])
        u = np.array([site.place[0] if site.place else 0.0 for site in sites])
        segment = np.array([own_segment(self.beam, site) for site in sites])
        points, moving = self.setting.outline.movable(axis, piece, u, segment)
        g, normal = self.obstacle.slope(points)
        return g, (normal.conj()[:, None] * moving).real

    def _signed(self, values: Array, sites: tuple[Site, ...]) -> Array:
        """A corner of the object that has passed the end of the piece is clear of it."""
        past = [c.kind == "vertex" and not c.start < s.place[0] < c.stop for s, c in self._placed(sites)]
        return np.where(past, np.abs(values) + 1.0, values)

    def _placed(self, sites: tuple[Site, ...]) -> list[tuple[Site, Candidate]]:
        return list(zip(sites, self.candidates, strict=True))

    @staticmethod
    def _inside(site: Site, candidate: Candidate) -> bool:
        return candidate.start < site.place[0] < candidate.stop

    def _slope(self, axis: Axis, u: Array, piece: Index, segment: Index, row: Array) -> tuple[Array, Array]:
        """What is least at the place, and its slope along the piece: g, or the distance to the object's corner."""
        points, tangents, _ = self.setting.outline.trace(axis, piece, u, segment)
        g, normal = self.obstacle.slope(points)
        vertex = self._vertex[row]
        if vertex.any():
            corners = self.obstacle.corners[[self.candidates[i].vertex for i in self._owners[row[vertex]]]]
            away = points[vertex] - corners
            g[vertex], normal[vertex] = np.abs(away) ** 2 / 2, away
        return g, dot(normal, tangents)

    def _locate(self, axis: Axis) -> tuple[Site, ...]:
        """The least gap of each stretch: the least sample, then the root of the slope beside it, by secants."""
        places = np.zeros(len(self._owners))
        if len(places):
            places = self._minima(axis)
        sites: list[Site] = []
        found = dict(zip(self._owners.tolist(), places.tolist(), strict=True))
        for i, c in enumerate(self.candidates):
            if c.kind == "corner":
                sites.append(Site("corner", c.piece, ()))
            elif c.kind == "node":
                sites.append(Site("node", c.piece, (c.start,)))
            else:
                sites.append(Site("vertex" if c.kind == "vertex" else "tangent", c.piece, (found[i],), c.vertex))
        return tuple(sites)

    def _minima(self, axis: Axis) -> Array:
        rows = np.arange(len(self._owners))
        flat = (self._u.ravel(), self._piece.ravel(), self._segment.ravel(), np.repeat(rows, _SAMPLES))
        g, slope = (v.reshape(-1, _SAMPLES) for v in self._slope(axis, flat[0], flat[1], flat[2], flat[3]))
        least = np.argmin(g, axis=1)
        # the minimum lies beside the least sample, towards where g falls
        other = np.clip(np.where(slope[rows, least] > 0, least - 1, least + 1), 0, _SAMPLES - 1)
        a, b = self._u[rows, least], self._u[rows, other]
        fa, fb = slope[rows, least], slope[rows, other]
        inner = (other != least) & (fa * fb < 0)
        piece, segment = self._piece[:, 0], self._segment[rows, least]
        for refinement in range(_MOST_REFINEMENTS):
            rise = np.where(inner, fb - fa, 1.0)
            if refinement >= _REFINEMENTS and not np.any(inner & (np.abs(fa**2 * (b - a) / rise) > _LOWER)):
                break
            c = np.where(inner, a - fa * (b - a) / rise, a)
            fc = np.where(inner, self._slope(axis, c, piece, segment, rows)[1], 0.0)
            keep = fa * fc < 0  # the root lies between a and c
            # an end that stays counts for half (the Illinois rule): a sharp object is found as surely as a round one
            stays = np.where(refinement < _REFINEMENTS, 1.0, 0.5)
            a, fa, b, fb = c, fc, np.where(keep, a, b), np.where(keep, fa, fb * stays)
            inner &= np.abs(fa) > 1e-14
        return np.where(inner, a - fa * (b - a) / np.where(inner, fb - fa, 1.0), a)


def least_gaps(setting: Setting, obstacle: Obstacle, state: State, found: Survey) -> list[tuple[float, Site]]:
    """The gaps of the places that come nearest to the object, by L: negative where it penetrates, however little."""
    unseen = (
        float(np.max(found.pieces.u1 - found.pieces.u0)) / 2
    )  # what lies between two samples may be that much nearer
    candidates = near(setting, obstacle, state, found, max(found.min_gap, 0.0) + _GRAZED + unseen)
    if not candidates:
        return []
    problem = Problem(setting, obstacle, state, candidates)
    gaps = problem.gaps(problem.x0) / setting.sections.length
    return list(zip(gaps.tolist(), problem.sites(problem.x0), strict=True))


def near(setting: Setting, obstacle: Obstacle, state: State, found: Survey, reach: float) -> tuple[Candidate, ...]:
    """Candidates within reach (by L) of the object: stretches segment by segment, corners on both sides."""
    cornered = len(obstacle.corners) > 0
    candidates = [] if cornered else _stretches(setting, state, found, reach)
    axis = state.axis
    outline = setting.outline
    numbers = np.array([outline.corner_piece(i) for i in range(len(outline.corners))], dtype=np.intp)
    if len(numbers):
        last = np.full(len(numbers), state.beam.segments - 1)
        points, *_ = outline.trace(axis, numbers, np.zeros(len(numbers)), last)
        gaps = obstacle.gap(points)
        candidates += [Candidate("corner", int(n)) for n, gap in zip(numbers, gaps, strict=True) if gap < reach]
    return tuple(candidates) + (_vertices(setting, obstacle, axis, found, reach) if cornered else ())


def _stretches(setting: Setting, state: State, found: Survey, reach: float) -> list[Candidate]:
    pieces, least = found.pieces, np.minimum(found.gaps, found.depths).min(axis=0)
    out: dict[tuple[int, int], Candidate] = {}
    for i in np.flatnonzero(least < reach):
        piece, segment = int(pieces.piece[i]), int(pieces.segment[i])
        if piece <= UPPER:
            ends = state.beam.breaks[segment], state.beam.breaks[segment + 1]
        else:
            segment, ends = -1, (0.0, setting.outline.pieces[piece].length)
        out[piece, segment] = Candidate("stretch", piece, *ends)
    return list(out.values())


def _vertices(setting: Setting, obstacle: Obstacle, axis: Axis, found: Survey, reach: float) -> tuple[Candidate, ...]:
    """The object's corners that come nearest to a piece: lower than both their neighbours on the object."""
    out: list[Candidate] = []
    for piece, heights in vertex_heights(setting, obstacle, axis, found).items():
        lowest = (heights <= np.roll(heights, 1)) & (heights <= np.roll(heights, -1)) & (heights < reach)
        length = setting.outline.pieces[piece].length
        out += [Candidate("vertex", piece, 0.0, length, int(number)) for number in np.flatnonzero(lowest)]
    return tuple(out)


def vertex_heights(setting: Setting, obstacle: Obstacle, axis: Axis, found: Survey) -> dict[int, Array]:
    """Distance of each of the object's corners outside each piece, by L: negative where it has sunk through it.

    Infinite for a corner that has sunk so deep, or is behind a piece so far, that it belongs to another one.
    """
    pieces = found.pieces
    points, tangents, _ = setting.outline.trace(axis, pieces.piece, pieces.u0, pieces.segment)
    along = tangents / np.abs(tangents)
    away = obstacle.corners[:, None] - points[None, :]
    foot = np.clip(dot(away, along), 0.0, (pieces.u1 - pieces.u0) * np.abs(tangents))
    distances = np.abs(away - foot * along)
    heights = dot(away, -1j * along * np.where(pieces.piece == UPPER, -1.0, 1.0))
    nearest, each = pieces.piece[np.argmin(distances, axis=1)], np.arange(len(away))
    out = {}
    for piece in np.unique(pieces.piece).tolist():
        mine = np.flatnonzero(pieces.piece == piece)
        closest = mine[np.argmin(distances[:, mine], axis=1)]
        height = heights[each, closest]
        deepest = _half_thickness(setting, piece, pieces.u0[closest])
        sunk = np.where((nearest == piece) & (-height < deepest), height, np.inf)
        out[piece] = np.where(height < 0, sunk, distances[each, closest])
    return out


def vertex_height(setting: Setting, obstacle: Obstacle, axis: Axis, site: Site) -> float:
    """How far one of the object's corners is outside a piece, by L, near a place there; negative: sunk in."""
    piece, u, corner = np.array([site.piece]), np.array(site.place), obstacle.corners[site.vertex]
    end = setting.outline.pieces[site.piece].length
    place, tangent = 0j, 1 + 0j
    for _ in range(_FEET):
        segment = axis.beam.segment_of(u) if site.on_face else np.array([axis.beam.segments - 1])
        place, tangent = (complex(v[0]) for v in setting.outline.trace(axis, piece, u, segment)[:2])
        u = np.clip(u + ((corner - place) * tangent.conjugate()).real / abs(tangent) ** 2, 0.0, end)
    outward = -1j * tangent / abs(tangent) * (-1.0 if site.piece == UPPER else 1.0)
    return float(((corner - place) * outward.conjugate()).real)


def _half_thickness(setting: Setting, piece: int, u: Array) -> Array:
    """How deep a corner may have sunk through a piece and still belong to it."""
    if piece in (LOWER, UPPER):
        return setting.sections.thickness(u) / 2
    return np.full(u.shape, setting.outline.pieces[piece].length / 2)


def assemble(scene: Scene, parameter: float | None = None) -> Problem:
    """The NCO problem of a scene at one pose, ready for SciPy.

    It starts from the least circular arc that clears the object on the side that the object comes from.

    Parameters
    ----------
    scene
        What is given.
    parameter
        Value of the motion's parameter; its first value by default. None in a scene without motion.

    Raises
    ------
    ValueError
        A parameter in a scene without motion, or a pose that is not finite there.
    """
    if parameter is not None and scene.motion is None:
        raise ValueError(f"parameter must be None in a scene without motion; got {parameter!r}")
    fixed = setting(scene)
    at = parameter if parameter is not None else (scene.motion.values[0] if scene.motion else 0.0)
    obstacle = fixed.obstacle(Kinematics(scene, fixed.sections.length).frame(at))
    order = first_order(scene.tolerance)
    bend = 1.0 if scene.approach[1] >= 0 else -1.0
    start, found = _clear_arc(fixed, obstacle, order, bend)
    touching = found.pieces.piece <= UPPER
    least = np.where(touching, found.gaps.min(axis=0), np.inf)
    place = float((found.pieces.u0 + found.pieces.u1)[np.argmin(least)] / 2)
    start = start.on(fixed.beam((Site("tangent", LOWER, (place,)),), order))
    found = survey(fixed, obstacle, start)
    problem = Problem(fixed, obstacle, start, near(fixed, obstacle, start, found, reach=0.1))
    problem.left_out = left_out(scene, fixed.theory)
    return problem


def _clear_arc(fixed: Setting, obstacle: Obstacle, order: int, bend: float) -> tuple[State, Survey]:
    """The least arc that clears the object (the straight finger where none does)."""
    beam = fixed.beam((), order)
    straight = State(beam, np.zeros(beam.size))
    for curvature in _ARCS:
        strains = np.zeros((beam.fields, beam.gauss.size))
        strains[0] = bend * curvature
        state = replace(straight, z=beam.fit(strains))
        found = survey(fixed, obstacle, state)
        if found.min_gap >= 0 and not found.engulfed:
            return state, found
    return straight, survey(fixed, obstacle, straight)
