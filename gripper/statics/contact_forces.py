"""The forces of an equilibrium at its contacts, dimensionless."""

from __future__ import annotations

import functools

import numpy as np

from gripper.arrays import Complex
from gripper.contact.outline import dot
from gripper.statics.equilibrium import Equilibrium

NO_FORCE = 1e-9
"""Total contact force, over EI / L^2, below which a pose is free (grazing is free)."""


def cross(a: Complex, b: Complex) -> float:
    """Sum of the cross products of vectors."""
    return float(np.sum((a.conj() * b).imag))


def loads(equilibrium: Equilibrium) -> tuple[Complex, Complex]:
    """All contact points and the forces on the finger there."""
    lin, none = equilibrium.linear, np.zeros(0, dtype=complex)
    return np.concatenate([none, *lin.points]), np.concatenate([none, *lin.forces])


def normal_force(equilibrium: Equilibrium, i: int) -> complex:
    """The normal part of the total force on the finger at a contact."""
    lin = equilibrium.linear
    force = complex(lin.forces[i].sum())
    return force if lin.rubbing is None else force / (1 - 1j * lin.rubbing.ratios[i])


@functools.lru_cache(maxsize=8)  # of both ends of a step, for its work and for what is largest
def drive(equilibrium: Equilibrium) -> float:
    """Work that the object puts into the finger per unit of the parameter: -(F . v + M omega)."""
    points, forces = loads(equilibrium)
    return float(np.sum(dot(forces, equilibrium.obstacle.velocities(points))))
