"""The NCO problem at one pose: minimise the strain energy subject to gaps >= 0.

The gaps are few: the minima of g along stretches of the outline that are near the object, found between nodes
(their gradient is that of the minimum: envelope theorem), the gaps of the outline's corners, and the signed
distances of the object's corners to the faces. Unknowns and gaps reach SciPy scaled, so that the energy is
|x|^2 / 2 and its first, unit Hessian is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from gripper.arrays import Array, Index
from gripper.beam.axis import Axis
from gripper.beam.energy import energy, energy_gradient, energy_hessian
from gripper.contact.linear import linearise
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import UPPER, dot, outward
from gripper.contact.site import Site, own_segment
from gripper.result import LeftOut
from gripper.statics.acting import LoadEnergy
from gripper.statics.equilibrium import Setting, State

_SAMPLES = 9
_REFINEMENTS = 2
_MOST_REFINEMENTS = 60
_HIDDEN = 1e-5  # of L: a minimum above the least sample by more is another one
_CLOSER = np.linspace(0.0, 1.0, 65)
_LOWER = 1e-6  # of L: twice what g may still fall below where it is taken to be least
_GRAZING = 1e-9  # of L: the least deflection that unknowns are scaled to


@dataclass(frozen=True)
class Candidate:
    """Where finger and object may touch: a stretch of a piece, a corner of the outline, or one of the object's."""

    kind: Literal["stretch", "corner", "node", "vertex"]
    piece: int
    start: float = 0.0
    stop: float = 0.0
    vertex: int = -1


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
        if not sites:
            return np.zeros(0), np.zeros((0, self.size))
        piece = np.array([site.piece for site in sites])
        u = np.array([site.place[0] if site.place else 0.0 for site in sites])
        segment = np.array([own_segment(self.beam, site) for site in sites])
        points, moving = self.setting.outline.movable(axis, piece, u, segment)
        corner = np.array([site.kind == "vertex" for site in sites])
        g, normal = (np.zeros(u.shape), np.zeros(u.shape) + 0j) if corner.all() else self.obstacle.slope(points)
        if corner.any():
            tangents = self.setting.outline.trace(axis, piece, u, segment)[1][corner]
            normal[corner] = -outward(piece[corner], tangents)
            away = points[corner] - self.obstacle.corners[[site.vertex for site in sites if site.kind == "vertex"]]
            g[corner] = dot(away, normal[corner])
        return self._signed(g, sites), (normal.conj()[:, None] * moving).real

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
        vertex = self._vertex[row]
        g, normal = (np.zeros(u.shape), np.zeros(u.shape) + 0j) if vertex.all() else self.obstacle.slope(points)
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
        places, hides = self._least(axis, rows, self._u, self._segment)
        hidden = np.flatnonzero(hides)
        if hidden.size:  # look closer
            step = self._u[hidden, 1] - self._u[hidden, 0]
            low, high = (np.clip(places[hidden] + way * step, *self._u[hidden][:, [0, -1]].T) for way in (-1.0, 1.0))
            closer = low[:, None] + (high - low)[:, None] * _CLOSER
            segments = self._segments(np.repeat(self._piece[hidden, :1], _CLOSER.size, axis=1), closer)
            places[hidden] = self._least(axis, hidden, closer, segments)[0]
        return places

    def _least(self, axis: Axis, rows: Index, u: Array, segments: Index) -> tuple[Array, Array]:
        """On stretches with samples u (k, j): where the gap is least, and whether a lower minimum hides beside it (k,).

        It does where the bracket held two minima and the root is the higher one's, or one and a crest behind it.
        """
        count, each = u.shape[1], np.arange(len(rows))
        pieces = np.repeat(self._piece[rows, 0], count)
        known = self._slope(axis, u.ravel(), pieces, segments.ravel(), np.repeat(rows, count))
        g, slope = (v.reshape(-1, count) for v in known)
        least = np.argmin(g, axis=1)
        # the minimum lies beside the least sample, towards where g falls
        other = np.clip(np.where(slope[each, least] > 0, least - 1, least + 1), 0, count - 1)
        a, b = u[each, least], u[each, other]
        fa, fb = slope[each, least], slope[each, other]
        lowest, sampled = g[each, least], g[each, least]
        inner, crest = (other != least) & (fa * fb < 0), (other != least) & (fa * fb > 0)
        piece, segment = self._piece[rows, 0], segments[each, least]
        for refinement in range(_MOST_REFINEMENTS):
            rise = np.where(inner, fb - fa, 1.0)
            if refinement >= _REFINEMENTS and not np.any(inner & (np.abs(fa**2 * (b - a) / rise) > _LOWER)):
                break
            c = np.where(inner, a - fa * (b - a) / rise, a)
            there, fc = self._slope(axis, c, piece, segment, rows)
            lowest, fc = np.where(inner, there, lowest), np.where(inner, fc, 0.0)
            keep = fa * fc < 0  # the root lies between a and c
            # an end that stays counts for half (the Illinois rule): a sharp object is found as surely as a round one
            stays = np.where(refinement < _REFINEMENTS, 1.0, 0.5)
            a, fa, b, fb = c, fc, np.where(keep, a, b), np.where(keep, fa, fb * stays)
            inner &= np.abs(fa) > 1e-14
        places = np.where(inner, a - fa * (b - a) / np.where(inner, fb - fa, 1.0), a)
        return places, crest | (lowest > sampled + _HIDDEN)
