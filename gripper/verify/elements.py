"""Nine-node quadrilaterals, total Lagrangian: internal forces and their derivative, all elements at once."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from gripper.objects import Array
from gripper.verify.material import InvertedError, Law, squared_lengths
from gripper.verify.mesh import Mesh


def lagrange(x: Array) -> tuple[Array, Array]:
    """Quadratic shape functions of a line with nodes -1, 0, 1, and their slopes: (n, 3) each, at x (n,)."""
    values = np.stack([x * (x - 1) / 2, 1 - x**2, x * (x + 1) / 2], axis=-1)
    return values, np.stack([x - 0.5, -2 * x, x + 0.5], axis=-1)


@functools.cache
def _square(along: tuple[float, ...]) -> tuple[Array, Array]:
    """Shape functions (n, 9) and gradients (n, 9, 2) on the square, at all pairs of these coordinates."""
    x = np.array(along)
    n, dn = lagrange(x)
    k = x.size**2
    values = np.einsum("ia,jb->ijab", n, n).reshape(k, 9)
    slopes = np.stack([np.einsum("ia,jb->ijab", dn, n), np.einsum("ia,jb->ijab", n, dn)], axis=-1)
    return values, slopes.reshape(k, 9, 2)


class Elements:
    """The finger's elements in their undeformed state.

    Parameters
    ----------
    mesh
        Nodes and elements.
    law
        Material law.
    """

    def __init__(self, mesh: Mesh, law: Law) -> None:
        self.law, self.nodes, self.count = law, mesh.elements, len(mesh.nodes)
        x, w = np.polynomial.legendre.leggauss(3)
        values, _ = _square(tuple(x))
        self._gradients, volume = self._mapped(mesh, tuple(x))
        width = mesh.width(np.einsum("ga,ea->eg", values, mesh.nodes[self.nodes, 0]))
        self._weights = volume * np.outer(w, w).ravel() * width
        self._at_nodes, _ = self._mapped(mesh, (-1.0, 0.0, 1.0))
        self._gauged = _gauged(mesh)
        dofs = (2 * self.nodes[:, :, None] + np.arange(2)).reshape(len(self.nodes), 18)
        self.rows = np.repeat(dofs, 18, axis=1).ravel()
        self.columns = np.tile(dofs, 18).ravel()

    def _mapped(self, mesh: Mesh, along: tuple[float, ...]) -> tuple[Array, Array]:
        """Gradients of the shape functions in the undeformed finger (e, g, 9, 2), and the map's determinant (e, g)."""
        _, slopes = _square(along)
        jacobian = np.einsum("eai,gaj->egij", mesh.nodes[self.nodes], slopes)
        return np.asarray(slopes @ np.linalg.inv(jacobian)), np.linalg.det(jacobian)

    def _deformation(self, positions: Array, gradients: Array) -> Array:
        """F (e, g, 2, 2) of node positions (n, 2)."""
        places = positions[self.nodes].swapaxes(1, 2)[:, None]
        return np.asarray(places @ gradients)

    def forces(self, positions: Array) -> tuple[float, Array]:
        """Strain energy, in J, and its derivative by the positions (n, 2), in N.

        Raises
        ------
        InvertedError
            Where an element is inverted.
        """
        energy, stress, _ = self._respond(positions)
        return energy, self._scatter(stress)

    def tangent(self, positions: Array) -> tuple[Array, Array]:
        """Forces (n, 2), in N, and their derivative, in N/m, as the values at ``rows`` and ``columns``."""
        _, stress, moduli = self._respond(positions)
        e, g = stress.shape[:2]
        moduli = (moduli * self._weights.reshape(-1, 1, 1)).reshape(e, g, 2, 2, 2, 2)
        right = np.einsum("egiJkL,egbL->egJikb", moduli, self._gradients, optimize=True).reshape(e, 2 * g, 36)
        left = self._gradients.transpose(0, 2, 1, 3).reshape(e, 9, 2 * g)
        blocks = (left @ right).reshape(e, 9, 2, 2, 9).transpose(0, 1, 2, 4, 3)
        return self._scatter(stress), blocks.reshape(-1)

    def _respond(self, positions: Array) -> tuple[float, Array, Array]:
        deformation = self._deformation(positions, self._gradients)
        energy, stress, moduli = self.law.respond(deformation.reshape(-1, 4))
        weighted = stress.reshape(deformation.shape) * self._weights[:, :, None, None]
        return float(energy @ self._weights.ravel()), weighted, moduli

    def _scatter(self, stress: Array) -> Array:
        """Nodal forces (n, 2) of weighted stresses (e, g, 2, 2)."""
        local = np.einsum("egiJ,egaJ->eai", stress, self._gradients, optimize=True)
        at = self.nodes.ravel()
        return np.stack([np.bincount(at, local[:, :, i].ravel(), self.count) for i in range(2)], axis=1)

    def largest_strain(self, positions: Array) -> float:
        """Largest abs(principal stretch - 1) at the elements' nodes, away from the corners of clamped ends.

        Raises
        ------
        InvertedError
            Where an element is inverted at a node.
        """
        deformation = self._deformation(positions, self._at_nodes)
        a, b = (np.sqrt(v) for v in squared_lengths(deformation.reshape(-1, 4)))
        if not np.all(a > b):
            raise InvertedError("an element is inverted at a node")
        strain = np.maximum(np.abs((a + b) / 2 - 1), np.abs((a - b) / 2 - 1))
        return float(strain.reshape(deformation.shape[:2])[self._gauged].max())


def _gauged(mesh: Mesh) -> NDArray[np.bool_]:
    """Elements' nodes (e, 9) a quarter of the thickness or more from the clamp and, with a jaw, from the end section.

    At the corners of these the strain has no limit: it grows as the mesh is refined.
    """
    ends = [(0.0, 0)] if not mesh.jawed else [(0.0, 0), (mesh.nodes[mesh.tip, 0], mesh.tip - mesh.across // 2)]
    s = mesh.nodes[mesh.elements, 0]
    kept = np.ones(s.shape, dtype=bool)
    for place, first in ends:
        margin = (mesh.nodes[first + mesh.across - 1, 1] - mesh.nodes[first, 1]) / 4
        kept &= (s >= margin) if first == 0 else (s <= place - margin)
    return kept if kept.any() else np.ones(s.shape, dtype=bool)
