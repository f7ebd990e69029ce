"""The finger as a system of equations: clamp, rigid jaw, and one sparse linear system."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from gripper.objects import Array
from gripper.verify.elements import Elements
from gripper.verify.mesh import Mesh
from gripper.verify.outline import Index

Triplets = tuple[Array, Index, Index]
"""Values, rows and columns of a derivative of forces by positions, both numbered 2 node + axis."""


class Body:
    """Unknowns of a finger: positions of its free nodes, column by column, then shift and angle of a rigid jaw.

    A rigid node stands at tip + shift + R(angle) r. It is eliminated exactly.

    Parameters
    ----------
    mesh
        The finger.
    elements
        Its elements.
    """

    def __init__(self, mesh: Mesh, elements: Elements) -> None:
        self.mesh, self.elements = mesh, elements
        fixed = np.zeros(len(mesh.nodes), dtype=bool)
        fixed[: mesh.across] = True
        fixed[mesh.rigid] = True
        self._free = np.flatnonzero(~fixed)
        self._pivot = mesh.nodes[mesh.tip]
        self._arms = mesh.nodes[mesh.rigid] - self._pivot
        self.moves_jaw = mesh.rigid.size > 0
        self.size = 2 * self._free.size + 3 * self.moves_jaw
        self.start = np.concatenate([mesh.nodes[self._free].ravel(), np.zeros(3 * self.moves_jaw)])

    def positions(self, unknowns: Array) -> Array:
        """All nodes (n, 2), in m."""
        places = self.mesh.nodes.copy()
        places[self._free] = unknowns[: 2 * self._free.size].reshape(-1, 2)
        if self.moves_jaw:
            shift, angle = unknowns[-3:-1], unknowns[-1]
            places[self.mesh.rigid] = self._pivot + shift + self._turned(angle)
        return places

    def _turned(self, angle: float) -> Array:
        c, s = np.cos(angle), np.sin(angle)
        return np.asarray(self._arms @ np.array([[c, s], [-s, c]]))

    def reduced(self, forces: Array, unknowns: Array) -> Array:
        """Forces on the unknowns (size,), of forces on all nodes (n, 2)."""
        own = forces[self._free].ravel()
        if not self.moves_jaw:
            return own
        on_jaw, arms = forces[self.mesh.rigid], self._turned(unknowns[-1])
        moment = np.sum(arms[:, 0] * on_jaw[:, 1] - arms[:, 1] * on_jaw[:, 0])
        return np.concatenate([own, on_jaw.sum(axis=0), [moment]])

    def _map(self, unknowns: Array) -> sparse.csr_array:
        """Derivative of all positions by the unknowns."""
        m = self._free.size
        dofs = (2 * self._free[:, None] + np.arange(2)).ravel()
        rows, columns, values = [dofs], [np.arange(2 * m)], [np.ones(2 * m)]
        if self.moves_jaw:
            arms, x, y = self._turned(unknowns[-1]), 2 * self.mesh.rigid, 2 * self.mesh.rigid + 1
            ones = np.ones(x.size)
            rows += [x, y, x, y]
            columns += [np.full(x.size, 2 * m + k) for k in (0, 1, 2, 2)]
            values += [ones, ones, -arms[:, 1], arms[:, 0]]
        shape = (2 * len(self.mesh.nodes), self.size)
        return sparse.csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)

    def matrix(self, blocks: list[Triplets], forces: Array, unknowns: Array) -> sparse.csc_array:
        """The system's matrix, of the parts of the derivative of all forces.

        Parameters
        ----------
        blocks
            Derivatives of the forces by the positions.
        forces
            Total forces on all nodes (n, 2): a rigid jaw's turning couples to them.
        unknowns
            Where.
        """
        count = 2 * len(self.mesh.nodes)
        values, rows, columns = (np.concatenate(part) for part in zip(*blocks, strict=True))
        whole = sparse.csr_array((values, (rows, columns)), shape=(count, count))
        change = self._map(unknowns)
        system = (change.T @ whole @ change).tocsc()
        if self.moves_jaw:
            system[-1, -1] -= np.sum(forces[self.mesh.rigid] * self._turned(unknowns[-1]))
        return system


def solve(matrix: sparse.csc_array, right: Array) -> Array:
    """Solve a system. SuperLU rather than LAPACK's banded solver: it does not start BLAS threads.

    Raises
    ------
    ArithmeticError
        The matrix is singular.
    """
    try:
        return np.asarray(splu(matrix, permc_spec="MMD_AT_PLUS_A").solve(right))
    except RuntimeError as error:
        raise ArithmeticError("the system is singular") from error


def positive(matrix: sparse.csc_array) -> bool:
    """Whether a symmetric matrix is positive definite: the signs of its pivots, taken from the diagonal."""
    try:
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        return False
    return bool(np.array_equal(factors.perm_r, factors.perm_c) and np.all(factors.U.diagonal() > 0))
