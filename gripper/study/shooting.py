"""An independent answer: the beam's differential equations, shot from the clamp, for contacts that are known.

Shares the profile and g with the solver, and takes from its answer which places touch and where to start; no
polynomial, no energy, no optimiser. Loads and places are found by SciPy's root finder.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from gripper.arrays import Array
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER
from gripper.contact.site import Site
from gripper.statics.equilibrium import Equilibrium, Setting
from gripper.study.rates import NX, NY, PSI, QX, QY, M, Q, Rates, V, X, Y, cross, dot
from gripper.study.shot import MARKS, NoReferenceError, Shot

_FINE, _COARSE = 3e-14, 3e-12  # of the integrator, relative
_SETTLED = 1e-10


class Shooting:
    """The boundary value problem of one pose with known contacts.

    Parameters
    ----------
    setting, obstacle
        Finger, theory and the object at its pose.
    sites
        The contacts.

    Raises
    ------
    NoReferenceError
        Friction, a nonlinear law, or a kind of contact that shooting does not have.
    """

    def __init__(self, setting: Setting, obstacle: Obstacle, sites: tuple[Site, ...]) -> None:
        if setting.friction is not None:
            raise NoReferenceError("shooting has no friction")
        if setting.sections.law is not None:
            raise NoReferenceError("shooting knows the linear law alone")
        if any(site.kind in ("tail", "node") for site in sites):
            raise NoReferenceError("the finger lies flush on a flat: shooting knows points and patches on curves")
        if setting.theory == "bending" and any(site.kind == "patch" for site in sites):
            raise NoReferenceError("the finger lies along the object: in bending shooting knows points alone")
        self.setting, self.obstacle, self.rates = setting, obstacle, Rates(setting, obstacle)
        self.faces = sorted((s for s in sites if s.on_face), key=lambda s: s.place[0])
        self.ends = [s for s in sites if not s.on_face]
        self.tolerance = _FINE

    def guess(self, equilibrium: Equilibrium) -> Array:
        """Unknowns that start from another answer: m, n at the clamp; places and normal forces."""
        lin = equilibrium.linear
        points, forces = np.concatenate(lin.points), np.concatenate(lin.forces)
        n = complex(forces.sum())
        sizes = {id(site): abs(complex(f.sum())) for site, f in zip(equilibrium.state.sites, lin.forces, strict=True)}
        out = [float(np.sum((points.conj() * forces).imag)), n.real, n.imag]
        for site in (*self.faces, *self.ends):
            out += [*site.place[: site.unknown_places], *([] if site.kind == "patch" else [sizes[id(site)]])]
        return np.array(out)

    def _split(self, unknowns: Array) -> list[list[float]]:
        """Each contact's unknowns, faces first."""
        out, at = [], 3
        for site in (*self.faces, *self.ends):
            count = site.unknown_places + (site.kind != "patch")
            out.append([float(v) for v in unknowns[at : at + count]])
            at += count
        return out

    def shoot(self, unknowns: Array) -> tuple[Array, Shot]:
        """Residuals of the boundary value problem, and what the shot gives."""
        run = _Run(self, unknowns)
        own = self._split(unknowns)
        residuals: list[float] = []
        for site, values in zip(self.faces, own, strict=False):
            run.to(values[0], None)
            if site.kind == "patch":
                residuals += self._entry(site, run)
                run.to(values[1], site.piece)
            else:
                residuals += self._point(site, values[-1], run)
        run.to(1.0, None)
        for site, values in zip(self.ends, own[len(self.faces) :], strict=True):
            residuals += self._end(site, values, run)
        left = [float(v) for v in run.y[[NX, NY, M]]]
        return np.array([*left, *residuals]), run.shot(float(np.max(np.abs([*left, *residuals]))))

    def _face(self, site: Site, run: _Run) -> tuple[complex, complex, complex]:
        """Point c, tangent c' and arm of a face where the run is."""
        section, r = self.rates.section(run.s, run.y), complex(run.y[X], run.y[Y])
        P, P1, _ = self.rates.offset(site.piece, run.s)
        arm = P * section.turn
        return r + arm, section.along + (P1 + 1j * section.bend * P) * section.turn, arm

    def _entry(self, site: Site, run: _Run) -> list[float]:
        c, c1, _ = self._face(site, run)
        g, nu = self.rates.gap(c)
        return [g, dot(nu, c1)]

    def _point(self, site: Site, size: float, run: _Run) -> list[float]:
        """A force at a point; the tangent that counts is the mean of both sides."""
        c, before, arm = self._face(site, run)
        vertex = site.kind == "vertex"
        inward = 1j if site.piece == LOWER else -1j
        g, nu = (0.0, inward * before / abs(before)) if vertex else self.rates.gap(c)
        run.load(c, arm, size * nu)
        mean = (before + self._face(site, run)[1]) / 2
        if not vertex:
            return [g, dot(nu, mean)]
        away = c - complex(self.obstacle.corners[site.vertex])
        return [away.real, away.imag]

    def _end(self, site: Site, values: list[float], run: _Run) -> list[float]:
        r, turn = complex(run.y[X], run.y[Y]), complex(np.exp(1j * run.y[PSI]))
        outline = self.setting.outline
        u = np.array(values[:1]) if site.unknown_places else np.zeros(1)
        _, P, P1, _ = outline.offsets(np.array([site.piece]), u)
        c, tangent = r + complex(P[0]) * turn, complex(P1[0]) * turn
        if site.kind == "vertex":
            away = c - complex(self.obstacle.corners[site.vertex])
            run.load(c, c - r, values[-1] * 1j * tangent)
            return [away.real, away.imag]
        g, nu = self.rates.gap(c)
        run.load(c, c - r, values[-1] * nu)
        return [g, dot(nu, tangent)] if site.kind == "tangent" else [g]

    def solve(self, start: Array) -> Shot:
        """The answer.

        Raises
        ------
        NoReferenceError
            Where the root finder does not settle.
        """
        found = root(lambda v: self.shoot(v)[0], start, method="hybr", options={"xtol": 1e-13})
        shot = self.shoot(found.x)[1]
        if not shot.residual < _SETTLED:
            raise NoReferenceError(f"shooting did not settle: {shot.residual:.1e} is left of its equations")
        return shot


class _Run:
    """One integration from the clamp, stretch by stretch."""

    def __init__(self, problem: Shooting, unknowns: Array) -> None:
        self.problem, self.s = problem, 0.0
        self.y = np.zeros(10)
        self.y[[M, NX, NY]] = unknowns[:3]
        self.force, self.weights = complex(unknowns[1], unknowns[2]), [(0.0, 0j)]
        self.samples = [0j]

    def to(self, stop: float, piece: int | None) -> None:
        """Integrate to a station: free, or along a face that lies on the object."""
        stop = min(max(stop, 0.0), 1.0)
        kinks = [k for k in self.problem.setting.sections.kinks if self.s < k < stop]
        rates = self.problem.rates.of(piece)
        for start, end in pairwise([self.s, *kinks, stop]):
            if end <= start:
                continue
            marks = MARKS[(start < MARKS) & (end >= MARKS)]
            t_eval = marks if len(marks) and marks[-1] == end else np.append(marks, end)
            tolerance = self.problem.tolerance
            found = solve_ivp(rates, (start, end), self.y, "DOP853", t_eval, rtol=tolerance, atol=tolerance / 10)
            if not found.success:
                raise NoReferenceError(f"shooting: {found.message}")
            self.samples += [complex(found.y[X, i], found.y[Y, i]) for i in range(len(marks))]
            self.y, self.s = found.y[:, -1].copy(), end

    def load(self, point: complex, arm: complex, force: complex) -> None:
        """Pass a force at a point of this section."""
        self.y[[M, NX, NY]] -= [cross(arm, force), force.real, force.imag]
        self.weights.append((abs(force), abs(force) * point))

    def shot(self, residual: float) -> Shot:
        """What came out."""
        size = sum(w for w, _ in self.weights) + float(self.y[Q])
        moment = sum((p for _, p in self.weights), 0j) + complex(self.y[QX], self.y[QY])
        return Shot(
            force=self.force,
            place=moment / size if size else 0j,
            energy=float(self.y[V]),
            axis=np.array(self.samples),
            residual=residual,
        )


def shooting(setting: Setting, equilibrium: Equilibrium) -> tuple[Shot, Shot]:
    """The answer for an equilibrium's contacts, and one a hundred times coarser: their distance is its uncertainty.

    Raises
    ------
    NoReferenceError
        No contact at all, contacts that shooting does not have, or no convergence.
    """
    if not equilibrium.state.sites:
        raise NoReferenceError("nothing touches at this pose: there is no force to compare")
    problem = Shooting(setting, equilibrium.obstacle, equilibrium.state.sites)
    problem.tolerance = _COARSE
    start = problem.guess(equilibrium)
    coarse = problem.solve(start)
    problem.tolerance = _FINE
    return problem.solve(start), coarse
