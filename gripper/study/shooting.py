"""An independent answer: the beam's differential equations, shot from the clamp, for contacts that are known.

Shares the profile and g with the solver, and takes from its answer which places touch and where to start; no
polynomial, no energy, no optimiser. With n(s) the contact forces beyond s and m(s) their moment about the section,

    r' = d exp(i psi),  psi' = m / EI,  m' = -r' x n - P x q nu,  n' = -q nu,

where d = exp(i gamma) and GA gamma = n . i exp(i (psi + gamma)) (inextensible, as the paper), or d = 1 in bending.
Along a patch the face follows the object: c' . nu = 0, whose derivative gives the pressure q. Loads and places are
found by SciPy's root finder. Lengths by L, forces by EI(0) / L^2 (:mod:`gripper.sections`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from gripper.arrays import Array, Complex
from gripper.equilibrium import Equilibrium, Setting
from gripper.obstacle import Obstacle
from gripper.outline import LOWER, UPPER
from gripper.site import Site

MARKS = np.linspace(0.0, 1.0, 65)
"""Stations (by L) at which shapes are compared."""
_KNOWN = {"bending", "shear"}
_FINE, _COARSE = 3e-14, 3e-12  # of the integrator, relative
_SETTLED = 1e-10
_STEP = 2e-3  # of L: for derivatives of the stiffness, by differences of eighth order
_EIGHTH = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
_X, _Y, _PSI, _M, _NX, _NY, _V, _Q, _QX, _QY = range(10)


class NoReferenceError(Exception):
    """Shooting cannot, or does not, answer this pose; says why."""


@dataclass(frozen=True, eq=False)
class Shot:
    """An answer by shooting: lengths by L, forces by EI(0) / L^2, in the clamp's axes.

    Parameters
    ----------
    force
        On the finger, x + iy.
    place
        Mean of the points of contact, weighted by the sizes of their forces.
    energy
        Strain energy.
    axis, psi
        At ``MARKS``.
    residual
        What is left of the equations.
    """

    force: complex
    place: complex
    energy: float
    axis: Complex
    psi: Array
    residual: float


def cross(a: complex, b: complex) -> float:
    """Cross product of two vectors of the plane."""
    return (a.conjugate() * b).imag


def dot(a: complex, b: complex) -> float:
    """Scalar product of two vectors of the plane."""
    return (a.conjugate() * b).real


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
        Friction, a theory, or a kind of contact that shooting does not have.
    """

    def __init__(self, setting: Setting, obstacle: Obstacle, sites: tuple[Site, ...]) -> None:
        if setting.friction is not None or setting.theory not in _KNOWN:
            raise NoReferenceError(f"shooting has neither friction nor other theories than {', '.join(sorted(_KNOWN))}")
        if setting.sections.rest is not None:
            raise NoReferenceError("shooting knows fingers that are straight at rest alone")
        if setting.sections.law is not None:
            raise NoReferenceError("shooting knows the linear law alone")
        if any(site.kind in ("tail", "node") for site in sites):
            raise NoReferenceError("the finger lies flush on a flat: shooting knows points and patches on curves")
        self.setting, self.obstacle = setting, obstacle
        self.faces = sorted((s for s in sites if s.on_face), key=lambda s: s.place[0])
        self.ends = [s for s in sites if not s.on_face]
        self.tolerance = _FINE

    # the finger

    def _stiffness(self, s: float) -> tuple[float, float, float, float]:
        """EI, GA and their slopes."""
        at = np.array([s])
        EI, GA = self.setting.sections.EI, self.setting.sections.GA
        slopes = [0.0, 0.0]
        if self._in_patch:
            around = s + _STEP * np.arange(-4, 5)
            slopes = [float(_EIGHTH @ f(around)) / _STEP for f in (EI, GA)]
        return float(EI(at)[0]), float(GA(at)[0]), slopes[0], slopes[1]

    def _shear(self, GA: float, psi: float, n: complex) -> float:
        """Gamma from GA gamma = n . i exp(i (psi + gamma))."""
        if self.setting.theory == "bending":
            return 0.0
        local, gamma = n * complex(np.exp(-1j * psi)), 0.0
        for _ in range(50):
            along = local * complex(np.exp(-1j * gamma))
            change = (along.imag - GA * gamma) / (GA + along.real)
            gamma += change
            if abs(change) < 1e-15:
                break
        return gamma

    def _rates(self, piece: int | None) -> Callable[[float, Array], list[float]]:
        """The right-hand side of a free stretch, or of one along which this face lies on the object."""
        self._in_patch = piece is not None

        def rates(s: float, y: Array) -> list[float]:
            psi, m, n = float(y[_PSI]), float(y[_M]), complex(y[_NX], y[_NY])
            EI, GA, EI1, GA1 = self._stiffness(s)
            gamma, kappa, turn = self._shear(GA, psi, n), m / EI, complex(np.exp(1j * psi))
            along = complex(np.exp(1j * gamma)) * turn
            energy = (m * kappa + GA * gamma**2) / 2
            if piece is None:
                return [along.real, along.imag, kappa, -cross(along, n), 0.0, 0.0, energy, 0.0, 0.0, 0.0]
            P, P1, P2 = self._offset(piece, s)
            c, c1 = complex(y[_X], y[_Y]) + P * turn, along + (P1 + 1j * kappa * P) * turn
            nu, bend = self._surface(c, c1)

            def change(q: float) -> float:
                """Derivative of c' . nu for this pressure."""
                kappa1 = (-cross(along, n) - cross(P * turn, q * nu) - EI1 * kappa) / EI
                push = dot(-q * nu, 1j * along) - dot(n, along) * kappa - GA1 * gamma
                gamma1 = push / (GA + dot(n, along))
                c2 = 1j * (kappa + gamma1) * along
                c2 += (P2 + 2j * kappa * P1 + 1j * kappa1 * P - kappa**2 * P) * turn
                return dot(nu, c2) + bend

            at_rest = change(0.0)
            q = -at_rest / (change(1.0) - at_rest)
            m1 = -cross(along, n) - cross(P * turn, q * nu)
            load = [-q * nu.real, -q * nu.imag, energy, q, q * c.real, q * c.imag]
            return [along.real, along.imag, kappa, m1, *load]

        return rates

    def _offset(self, piece: int, s: float) -> tuple[complex, complex, complex]:
        w, w1, w2 = (float(np.ravel(v)[0]) for v in self.setting.sections.profile(np.array([min(max(s, 0.0), 1.0)])))
        side = (0.5j if piece == UPPER else -0.5j) if piece in (LOWER, UPPER) else 0j
        return side * w, side * w1, side * w2

    # the object

    def _gap(self, c: complex) -> tuple[float, complex]:
        """G and the unit normal."""
        g, slope = self.obstacle.slope(np.array([c]))
        return float(g[0]), complex(slope[0] / abs(slope[0]))

    def _surface(self, c: complex, c1: complex) -> tuple[complex, float]:
        """The unit normal nu, and nu' . c' along a curve with tangent c'."""
        _, slope, (trace, rest) = self.obstacle.curvature(np.array([c]))
        size = abs(complex(slope[0]))
        nu = complex(slope[0]) / size
        turned = complex(trace[0]) * c1 + complex(rest[0]) * c1.conjugate()
        return nu, (dot(c1, turned) - dot(nu, c1) * dot(nu, turned)) / size

    # the problem

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
        y = run.y
        left = [float(y[_NX]), float(y[_NY]), float(y[_M])]
        return np.array([*left, *residuals]), run.shot(float(np.max(np.abs([*left, *residuals]))))

    def _section(self, run: _Run) -> tuple[complex, complex, complex, float]:
        """Position, exp(i psi), d exp(i psi) and kappa where the run is."""
        y = run.y
        psi, n = float(y[_PSI]), complex(y[_NX], y[_NY])
        EI, GA, *_ = self._stiffness(run.s)
        turn = complex(np.exp(1j * psi))
        along = turn * complex(np.exp(1j * self._shear(GA, psi, n)))
        return complex(y[_X], y[_Y]), turn, along, float(y[_M]) / EI

    def _face(self, site: Site, run: _Run) -> tuple[complex, complex, complex]:
        """Point c, tangent c' and arm of a face where the run is."""
        r, turn, along, kappa = self._section(run)
        P, P1, _ = self._offset(site.piece, run.s)
        return r + P * turn, along + (P1 + 1j * kappa * P) * turn, P * turn

    def _entry(self, site: Site, run: _Run) -> list[float]:
        c, c1, _ = self._face(site, run)
        g, nu = self._gap(c)
        return [g, dot(nu, c1)]

    def _point(self, site: Site, size: float, run: _Run) -> list[float]:
        """A force at a point; the tangent that counts is the mean of both sides."""
        c, before, arm = self._face(site, run)
        vertex = site.kind == "vertex"
        inward = 1j if site.piece == LOWER else -1j
        g, nu = (0.0, inward * before / abs(before)) if vertex else self._gap(c)
        run.load(c, arm, size * nu)
        mean = (before + self._face(site, run)[1]) / 2
        if not vertex:
            return [g, dot(nu, mean)]
        away = c - complex(self.obstacle.corners[site.vertex])
        return [away.real, away.imag]

    def _end(self, site: Site, values: list[float], run: _Run) -> list[float]:
        r, turn, *_ = self._section(run)
        outline = self.setting.outline
        u = np.array(values[:1]) if site.unknown_places else np.zeros(1)
        _, P, P1, _ = outline.offsets(np.array([site.piece]), u)
        c, tangent = r + complex(P[0]) * turn, complex(P1[0]) * turn
        if site.kind == "vertex":
            away = c - complex(self.obstacle.corners[site.vertex])
            run.load(c, c - r, values[-1] * 1j * tangent)
            return [away.real, away.imag]
        g, nu = self._gap(c)
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
        self.y[[_M, _NX, _NY]] = unknowns[:3]
        self.force, self.weights = complex(unknowns[1], unknowns[2]), [(0.0, 0j)]
        self.samples: list[tuple[float, complex, float]] = [(0.0, 0j, 0.0)]

    def to(self, stop: float, piece: int | None) -> None:
        """Integrate to a station: free, or along a face that lies on the object."""
        stop = min(max(stop, 0.0), 1.0)
        kinks = [k for k in self.problem.setting.sections.kinks if self.s < k < stop]
        rates = self.problem._rates(piece)
        for start, end in pairwise([self.s, *kinks, stop]):
            if end <= start:
                continue
            marks = MARKS[(start < MARKS) & (end >= MARKS)]
            t_eval = marks if len(marks) and marks[-1] == end else np.append(marks, end)
            tolerance = self.problem.tolerance
            found = solve_ivp(rates, (start, end), self.y, "DOP853", t_eval, rtol=tolerance, atol=tolerance / 10)
            if not found.success:
                raise NoReferenceError(f"shooting: {found.message}")
            for i in range(len(marks)):
                y = found.y[:, i]
                self.samples.append((float(marks[i]), complex(y[_X], y[_Y]), float(y[_PSI])))
            self.y, self.s = found.y[:, -1].copy(), end

    def load(self, point: complex, arm: complex, force: complex) -> None:
        """Pass a force at a point of this section."""
        self.y[[_M, _NX, _NY]] -= [cross(arm, force), force.real, force.imag]
        self.weights.append((abs(force), abs(force) * point))

    def shot(self, residual: float) -> Shot:
        """What came out."""
        size = sum(w for w, _ in self.weights) + float(self.y[_Q])
        moment = sum((p for _, p in self.weights), 0j) + complex(self.y[_QX], self.y[_QY])
        return Shot(
            force=self.force,
            place=moment / size if size else 0j,
            energy=float(self.y[_V]),
            axis=np.array([c for _, c, _ in self.samples]),
            psi=np.array([p for *_, p in self.samples]),
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
