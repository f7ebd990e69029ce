"""Points of the outline where contacts are looked at, with all derivatives that Newton's method needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.axis import Axis, course
from gripper.contact.outline import UPPER, Outline


@dataclass(frozen=True, eq=False)
class Stations:
    """Points c of the outline and their derivatives: ' along the piece, _z in the unknowns."""

    points: Complex  # (k,)
    tangents: Complex  # c', (k,)
    curvatures: Complex  # c'', (k,)
    gradients: Complex  # c_z, (k, n)
    tangent_gradients: Complex  # c'_z, (k, n)
    position: Array  # (k, g)
    offsets: Complex  # P exp(i psi), (k,)
    psi: Array  # (k, n)

    def folded(self) -> Stations:
        """The mean of two readings of the same places, one after the other."""
        k = len(self.points) // 2
        values = (getattr(self, name) for name in self.__dataclass_fields__)
        return Stations(*((value[:k] + value[k:]) / 2 for value in values))

    def strained(self, i: int) -> Complex:
        """The part of c'_z (n,) at a point that comes of the strains at the section itself."""
        part: Complex = self.tangent_gradients[i] - 1j * self.tangents[i] * self.psi[i]
        return part

    def second_derivative(self, axis: Axis, forces: Complex) -> Array:
        """sum_i f_i . d2c_i/dz2, (n, n), for vectors f (k,) at the points, which are of this axis."""
        turn = (forces.conj() * self.offsets).real
        return axis.second_derivative(forces @ self.position) - self.psi.T @ (turn[:, None] * self.psi)


def stations(outline: Outline, axis: Axis, piece: Index, u: Array, segment: Index) -> Stations:
    """Points and derivatives at u (k,) along pieces (k,), read from the given segments' polynomials (k,)."""
    s, P, P1, P2 = outline.offsets(piece, u)
    rows = axis.beam.rows(s, segment)
    psi, *strains = rows.strains @ axis.z
    rest = outline.sections.rest
    if rest is not None:
        bent = rest.curvature(s)
        psi, strains[1], strains[2] = psi + rest.angle(s), strains[1] + bent[0], strains[2] + bent[1]
    turn = np.exp(1j * psi)
    own = course(turn, strains)
    e0, e1 = P * turn, P1 * turn
    across = 1j * e0
    along, bend, kappa, kappa1 = own.along, own.bend, strains[1], strains[2]
    by_strain, maps = [own.by_shear, across], rows.strains[:3]  # dc'/d(gamma, kappa), and by eps
    if own.by_stretch is not None:
        by_strain.append(own.by_stretch)
        maps = rows.strains[[0, 1, 2, 5]]
    flexible = piece <= UPPER
    if not np.logical_and.reduce(flexible):  # what the strains at the section do is nothing to a rigid piece
        along, bend, kappa, kappa1, *by_strain = (
            value * flexible for value in (along, bend, kappa, kappa1, *by_strain)
        )
    turned = e1 + kappa * across  # the offset's part of c'
    tangents = along + turned
    position, moving = axis.integrated(rows.position)
    return Stations(
        position + e0,
        tangents,
        bend + P2 * turn + 1j * (kappa * (turned + e1) + kappa1 * e0),
        moving + across[:, None] * rows.strains[0],
        np.einsum("ck,ckn->kn", np.array([1j * tangents, *by_strain]), maps),
        rows.position,
        e0,
        rows.strains[0],
    )
