"""The beam's differential equations: how its section moves and turns along a free stretch, or along the object.

With n(s) the contact forces beyond s and m(s) their moment about the section,

    r' = d exp(i psi),  psi' = kappa0 + m / EI,  m' = -r' x n - P x q nu,  n' = -q nu,

where d = 1 in bending, exp(i gamma) with GA gamma = n . i exp(i (psi + gamma)) with shear (inextensible, as the paper),
and 1 + eps + i gamma with stretch: EA eps and GA gamma are n along and across the section. Along a patch the face P
follows the object: c' . nu = 0, whose derivative gives the pressure q. By L and EI(0) (:mod:`gripper.beam.sections`).
"""

from __future__ import annotations

import cmath
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gripper.arrays import Array
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER
from gripper.statics.equilibrium import Setting

_STEP = 2e-3  # of L: for derivatives of the stiffness, by differences of eighth order
_EIGHTH = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
_AROUND = _STEP * np.arange(-4, 5)
X, Y, PSI, M, NX, NY, V, Q, QX, QY = range(10)
"""The state: axis, angle, moment and force; energy; pressure, and its moments, summed up."""


def cross(a: complex, b: complex) -> float:
    """Cross product of two vectors of the plane."""
    return (a.conjugate() * b).imag


def dot(a: complex, b: complex) -> float:
    """Scalar product of two vectors of the plane."""
    return (a.conjugate() * b).real


class Section(NamedTuple):
    """A section under its load: exp(i psi), r', psi' and kappa0; stiffness EI, GA, EA; strains gamma and eps."""

    turn: complex
    along: complex
    bend: float
    rest: float
    EI: float
    GA: float
    EA: float
    gamma: float
    eps: float


class Rates:
    """Right-hand sides for one finger and object.

    Parameters
    ----------
    setting
        Finger and theory.
    obstacle
        The object at its pose.
    """

    def __init__(self, setting: Setting, obstacle: Obstacle) -> None:
        self.setting, self.obstacle = setting, obstacle
        self.theory, self.sections = setting.theory, setting.sections

    def section(self, s: float, y: Array) -> Section:
        """The section at s in this state."""
        psi, n = float(y[PSI]), complex(y[NX], y[NY])
        EI, GA, EA = (float(v[0]) for v in self.sections.stiffness(np.array([s])))
        turn, gamma, eps = cmath.exp(1j * psi), 0.0, 0.0
        local = n * turn.conjugate()
        along = turn
        if self.theory == "shear":
            gamma = _inextensible(GA, local)
            along = turn * cmath.exp(1j * gamma)
        elif self.theory == "stretch":
            eps, gamma = local.real / EA, local.imag / GA
            along = turn * complex(1 + eps, gamma)
        rest = 0.0 if self.sections.rest is None else float(self.sections.rest.curvature(np.array([s]))[0][0])
        return Section(turn, along, rest + float(y[M]) / EI, rest, EI, GA, EA, gamma, eps)

    def of(self, piece: int | None) -> Callable[[float, Array], list[float]]:
        """The right-hand side of a free stretch, or of one along which this face lies on the object."""

        def free(s: float, y: Array) -> list[float]:
            section = self.section(s, y)
            along, energy = section.along, _energy(section, float(y[M]))
            m1 = -cross(along, complex(y[NX], y[NY]))
            return [along.real, along.imag, section.bend, m1, 0.0, 0.0, energy, 0.0, 0.0, 0.0]

        return free if piece is None else lambda s, y: self._lying(s, y, piece)

    def _lying(self, s: float, y: Array, piece: int) -> list[float]:
        """Along the object: the pressure q keeps the face on it."""
        section, n = self.section(s, y), complex(y[NX], y[NY])
        turn, along, kappa = section.turn, section.along, section.bend
        P, P1, P2 = self.offset(piece, s)
        c, c1 = complex(y[X], y[Y]) + P * turn, along + (P1 + 1j * kappa * P) * turn
        nu, bend = self._surface(c, c1)
        EI1, GA1, EA1 = (self._slope(f, s) for f in (self.sections.EI, self.sections.GA, self.sections.EA))
        rest = self.sections.rest
        rest1 = 0.0 if rest is None else float(rest.curvature(np.array([s]))[1][0])

        def change(q: float) -> float:
            """Derivative of c' . nu for this pressure."""
            m1 = -cross(along, n) - cross(P * turn, q * nu)
            kappa1 = rest1 + (m1 - EI1 * (kappa - section.rest)) / section.EI
            c2 = self._curving(section, n, -q * nu, GA1, EA1)
            c2 += (P2 + 2j * kappa * P1 + 1j * kappa1 * P - kappa**2 * P) * turn
            return dot(nu, c2) + bend

        at_rest = change(0.0)
        q = -at_rest / (change(1.0) - at_rest)
        m1 = -cross(along, n) - cross(P * turn, q * nu)
        load = [-q * nu.real, -q * nu.imag, _energy(section, float(y[M])), q, q * c.real, q * c.imag]
        return [along.real, along.imag, kappa, m1, *load]

    def _curving(self, section: Section, n: complex, n1: complex, GA1: float, EA1: float) -> complex:
        """r'' for this change of the force."""
        along, kappa, gamma = section.along, section.bend, section.gamma
        if self.theory == "stretch":
            local1 = (n1 - 1j * kappa * n) * section.turn.conjugate()
            change = complex((local1.real - EA1 * section.eps) / section.EA, (local1.imag - GA1 * gamma) / section.GA)
            return change * section.turn + 1j * kappa * along
        push = dot(n1, 1j * along) - dot(n, along) * kappa - GA1 * gamma
        return 1j * (kappa + push / (section.GA + dot(n, along))) * along

    def _slope(self, stiffness: Callable[[Array], Array], s: float) -> float:
        return float(_EIGHTH @ stiffness(s + _AROUND)) / _STEP

    def offset(self, piece: int, s: float) -> tuple[complex, complex, complex]:
        """A face's place P over the axis, in the section's frame, and its first two derivatives."""
        w, w1, w2 = (float(np.ravel(v)[0]) for v in self.sections.profile(np.array([min(max(s, 0.0), 1.0)])))
        side = (0.5j if piece == UPPER else -0.5j) if piece in (LOWER, UPPER) else 0j
        return side * w, side * w1, side * w2

    def gap(self, c: complex) -> tuple[float, complex]:
        """G of the object at a point, and its unit normal."""
        g, slope = self.obstacle.slope(np.array([c]))
        return float(g[0]), complex(slope[0] / abs(slope[0]))

    def _surface(self, c: complex, c1: complex) -> tuple[complex, float]:
        """The unit normal nu, and nu' . c' along a curve with tangent c'."""
        _, slope, (trace, rest) = self.obstacle.curvature(np.array([c]))
        size = abs(complex(slope[0]))
        nu = complex(slope[0]) / size
        turned = complex(trace[0]) * c1 + complex(rest[0]) * c1.conjugate()
        return nu, (dot(c1, turned) - dot(nu, c1) * dot(nu, turned)) / size


def _inextensible(GA: float, local: complex) -> float:
    """Gamma from GA gamma = Im(n exp(-i (psi + gamma))), the force given in the section's frame."""
    gamma = 0.0
    for _ in range(50):
        along = local * cmath.exp(-1j * gamma)
        change = (along.imag - GA * gamma) / (GA + along.real)
        gamma += change
        if abs(change) < 1e-15:
            break
    return gamma


def _energy(section: Section, m: float) -> float:
    """Strain energy of a unit of length."""
    return (m**2 / section.EI + section.GA * section.gamma**2 + section.EA * section.eps**2) / 2
