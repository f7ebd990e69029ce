"""The object's corners against the finger's edges: a corner inside the finger is pushed out along the edge's normal."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gripper.objects import Array
from gripper.verify.elements import lagrange
from gripper.verify.mesh import Mesh
from gripper.verify.motion import Frame
from gripper.verify.outline import Index
from gripper.verify.surface import CORNER_STIFFNESS
from gripper.verify.touch import History, Touch, prescribed

_CURVED = np.array([1.0, -2.0, 1.0])  # second derivatives of the shape functions
_TINY = 1e-30  # of a complex step: the derivative is exact to round-off
_ROUNDS = 8


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners of the object that the finger's edges must not swallow.

    Parameters
    ----------
    points
        (c, 2), in m, in the object's frame.
    edges
        Nodes of the outline's edges (e, 3).
    along
        What a report calls their nodes' places (e, 3).
    stiffness
        Force over depth on each edge, in N/m, (e,).
    depth
        Deeper than this a corner is not looked for, in m.
    """

    points: Array
    edges: Index
    along: Array
    stiffness: Array
    depth: float

    @classmethod
    def of(cls, mesh: Mesh, points: Array, youngs_modulus: float, thickness: float) -> Corners:
        """Corners (c, 2) against a mesh's outline; the finger is nowhere thinner than ``thickness``."""
        edges, along = mesh.outline.edges, mesh.outline.along
        stiffness = CORNER_STIFFNESS * youngs_modulus * mesh.width(mesh.nodes[edges[:, 1], 0])
        return cls(points, edges, along, stiffness, thickness / 2)

    @property
    def count(self) -> int:
        """How many."""
        return len(self.points)

    def softened(self, share: float) -> Corners:
        """The same with a share of the stiffness."""
        return replace(self, stiffness=share * self.stiffness)

    def _nearest(self, positions: Array, points: Array) -> tuple[Index, Index, Array, Array]:
        """Corners that stand over or under an edge: their numbers, its number, its coordinate, signed distance."""
        nodes = positions[self.edges]
        chord = nodes[:, 2] - nodes[:, 0]
        reach = np.linalg.norm(chord, axis=1) + self.depth
        corner, edge = np.nonzero(np.linalg.norm(points[:, None] - nodes[None, :, 1], axis=2) < reach)
        xi = np.zeros(corner.size)
        for _ in range(_ROUNDS):
            xi = np.clip(_closer(nodes[edge], points[corner], xi), -1.5, 1.5)
        _, _, distance = _stand(nodes[edge], points[corner], xi)
        over = (np.abs(xi) <= 1) & (np.abs(distance) < self.depth)
        order = np.lexsort((np.abs(distance), ~over, corner))
        order = order[over[order]]
        _, first = np.unique(corner[order], return_index=True)
        chosen = order[first]
        return corner[chosen], edge[chosen], xi[chosen], distance[chosen]

    def touch(self, positions: Array, frame: Frame, history: History, rough: tuple[Array, Array], first: int) -> Touch:
        """Forces of the corners inside the finger.

        Parameters
        ----------
        positions, frame, history
            As `gripper.verify.contact.Contact.touch`.
        rough
            Coefficient and prescribed sign of T on each edge (e,).
        first
            Number of the first corner in ``history.friction``.
        """
        points = frame.place(self.points)
        corner, edge, xi, distance = self._nearest(positions, points)
        chosen = distance < 0
        corner, edge, xi = corner[chosen], edge[chosen], xi[chosen]
        nodes = self.edges[edge]
        back = frame.place(history.frame.local(history.positions[nodes].reshape(-1, 2))).reshape(-1, 3, 2)
        rules = self.stiffness[edge], rough[0][edge], rough[1][edge], history.friction[first + corner]
        push = _Push(points[corner], back, *rules, xi)
        x = positions[nodes]
        forces, normal, friction, sticking = push(x)
        places, n, depth = _stand(x, points[corner], xi)
        along = np.einsum("ka,ka->k", lagrange(xi)[0], self.along[edge])
        energy = self.stiffness[edge] * depth**2 / 2
        state = normal, friction, sticking, energy
        return Touch(first + corner, edge, along, places, -n, *state, nodes, forces, push.stiffness_at(x))


def _rows(weights: Array, x: Array) -> Array:
    return np.einsum("ka,kai->ki", weights, x)


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("ki,ki->k", a, b)


def _closer(x: Array, point: Array, xi: Array) -> Array:
    """One Newton step towards the foot of the perpendicular; also of complex numbers."""
    shares, slopes = lagrange(xi)
    away, tangent = point - _rows(shares, x), _rows(slopes, x)
    return np.asarray(xi + _dot(away, tangent) / (_dot(tangent, tangent) - _dot(away, _CURVED @ x)))


def _stand(x: Array, point: Array, xi: Array) -> tuple[Array, Array, Array]:
    """The foot (m, 2), the outward normal (m, 2), and the distance along it (m,); also of complex numbers."""
    shares, slopes = lagrange(xi)
    foot, tangent = _rows(shares, x), _rows(slopes, x)
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1) / np.sqrt(_dot(tangent, tangent))[:, None]
    return foot, normal, _dot(point - foot, normal)


@dataclass(frozen=True, eq=False)
class _Push:
    """Forces of corners on the three nodes of an edge, as a function of their positions.

    Parameters
    ----------
    point, back
        The corners (m, 2), and where the nodes stood, carried along with the object (m, 3, 2).
    k, mu, sense, old
        Stiffness, coefficient, prescribed sign and last friction (m,).
    xi
        The feet's coordinates (m,).
    """

    point: Array
    back: Array
    k: Array
    mu: Array
    sense: Array
    old: Array
    xi: Array

    def __call__(self, x: Array) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
        """Forces (m, 3, 2), N, T and whether it sticks; of complex positions the first three are complex."""
        xi = _closer(x, self.point, self.xi)
        _, n, distance = _stand(x, self.point, xi)
        normal, shares = -self.k * distance, lagrange(xi)[0]
        t = np.stack([n[:, 1], -n[:, 0]], axis=1)  # along the object, as n points into it
        trial = self.old - self.k * _dot(_rows(shares, x - self.back), t)
        limit = self.mu * np.where(normal.real > 0, normal, 0)
        sign = prescribed(self.sense, trial.real)
        sticking = np.abs(sign) < limit.real
        friction = np.where(sticking, trial, np.sign(sign) * limit)
        force = -normal[:, None] * n + friction[:, None] * t
        return shares[:, :, None] * force[:, None], normal, friction, sticking

    def stiffness_at(self, x: Array) -> Array:
        """Negative derivative of the forces by the positions, (m, 6, 6), by complex steps."""
        columns = []
        for axis in range(6):
            moved = x.astype(complex)
            moved[:, axis // 2, axis % 2] += 1j * _TINY
            columns.append(-self(moved)[0].imag.reshape(-1, 6) / _TINY)
        return np.stack(columns, axis=2)
