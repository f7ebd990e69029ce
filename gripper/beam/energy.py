"""Strain energy of a discretised finger, V(z), with its gradient and Hessian, over EI(0) / L.

The linear law's is |z|^2 / 2 by the choice of the unknowns (:mod:`gripper.beam.strains`). Any other law of the sections
(:mod:`gripper.laws`) gives its energy per length W(kappa, gamma, eps), which Gauss points of the same rule integrate:
where strains are small, and no section tapers, |z|^2 / 2 is left.
"""

from __future__ import annotations

import functools

import numpy as np

from gripper.arrays import Array
from gripper.beam.strains import Beam


def energy(beam: Beam, z: Array) -> float:
    """V(z)."""
    if beam.response is None:
        return float(z @ z) / 2
    density = beam.response.energy(beam.gauss_strains(z))
    return float(density @ beam.gauss_lengths) + (float(z[-1]) ** 2 / 2 if beam.yields else 0.0)


def energy_gradient(beam: Beam, z: Array) -> Array:
    """dV/dz (n,): z itself under the linear law."""
    if beam.response is None:
        return z
    q = beam.gauss_lengths * beam.response.stress(beam.gauss_strains(z))
    blocks = np.einsum("feq,feqm->efm", q.reshape(beam.fields, beam.segments, -1), beam.gauss_maps)
    return np.append(blocks, z[-1:]) if beam.yields else blocks.reshape(-1)


@functools.cache
def _identity(size: int) -> Array:
    identity = np.eye(size)
    identity.flags.writeable = False
    return identity


def energy_hessian(beam: Beam, z: Array) -> Array:
    """d2V/dz2 (n, n): the identity under the linear law."""
    if beam.response is None:
        return _identity(z.size)
    tangent = beam.gauss_lengths * beam.response.stiffness(beam.gauss_strains(z))
    wide = tangent.reshape(beam.fields, beam.fields, beam.segments, -1)
    blocks = np.einsum("fgeq,feqm,geqk->efmgk", wide, beam.gauss_maps, beam.gauss_maps, optimize=True)
    each, own = np.arange(beam.segments), beam.fields * beam.modes
    hessian = np.zeros((beam.segments, own, beam.segments, own))
    hessian[each, :, each] = blocks.reshape(-1, own, own)
    count = beam.segments * own
    whole = np.eye(z.size)  # of a base that yields, the last unknown
    whole[:count, :count] = hessian.reshape(count, count)
    return whole
