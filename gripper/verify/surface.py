"""Places of the finger's outline that may touch: points along every edge, and its corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.objects import Array
from gripper.verify.elements import lagrange
from gripper.verify.mesh import Mesh
from gripper.verify.outline import Index

FACE_STIFFNESS = 200.0  # pressure over depth, by E / thickness: depths stay near 1e-5 of the length
CORNER_STIFFNESS = 100.0  # force over depth, by E b
SPACING = 600.0  # points of the outline a thickness: the narrow patch of a stiff finger still holds several


@dataclass(frozen=True, eq=False)
class Places:
    """Points of the outline, fixed in the finger's matter.

    Parameters
    ----------
    edge
        On which edge, (k,).
    nodes, shares
        Three nodes each and their shape functions, (k, 3).
    stiffness
        Force over depth, in N/m, (k,).
    along
        What a report calls the place (k,), in m.
    """

    edge: Index
    nodes: Index
    shares: Array
    stiffness: Array
    along: Array

    def at(self, positions: Array) -> Array:
        """Where the points are (k, 2), of positions of all nodes (n, 2)."""
        return np.einsum("ka,kai->ki", self.shares, positions[self.nodes])

    def pick(self, wanted: Index) -> Places:
        """Some of them."""
        return Places(*(getattr(self, name)[wanted] for name in self.__dataclass_fields__))


def places(mesh: Mesh, youngs_modulus: float, thickness: float) -> Places:
    """Points along every edge (trapezoidal rule, ends included), then the convex corners.

    Parameters
    ----------
    mesh
        The finger.
    youngs_modulus
        E, in Pa.
    thickness
        That sets the points' spacing and stiffness, in m.
    """
    edges, corners = mesh.outline.edges, mesh.outline.corners
    ends = mesh.nodes[edges[:, [0, 2]]]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    counts = np.maximum(4, np.ceil(lengths * SPACING / thickness)).astype(int)
    edge = np.repeat(np.arange(len(counts)), counts + 1)
    step = np.concatenate([np.arange(n + 1) / n for n in counts])
    weight = lengths[edge] / counts[edge] * np.where((step == 0) | (step == 1), 0.5, 1.0)
    corner_edge = np.array([np.flatnonzero(edges[:, 0] == node)[0] for node in corners], dtype=np.intp)
    corner_shares = np.tile([1.0, 0.0, 0.0], (len(corner_edge), 1))
    edge, shares = np.append(edge, corner_edge), np.concatenate([lagrange(2 * step - 1)[0], corner_shares])
    stiffness = np.append(FACE_STIFFNESS / thickness * weight, np.full(len(corner_edge), CORNER_STIFFNESS))
    nodes = edges[edge]
    along = np.einsum("ka,ka->k", shares, mesh.outline.along[edge])
    return Places(edge, nodes, shares, youngs_modulus * mesh.width(mesh.nodes[nodes[:, 1], 0]) * stiffness, along)
