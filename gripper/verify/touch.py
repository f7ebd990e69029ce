"""Contact forces as data, and what a pose leaves to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gripper.objects import Array
from gripper.verify.body import Triplets
from gripper.verify.motion import Frame
from gripper.verify.outline import Index

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class History:
    """What the last pose left.

    Parameters
    ----------
    positions
        Of all nodes (n, 2), in m.
    frame
        Of the object.
    friction
        T (k,), in N, at each place of the finger and each corner of the object.
    """

    positions: Array
    frame: Frame
    friction: Array

    def slid(self, nodes: Index, shares: Array, points: Array, frame: Frame) -> Array:
        """How far the finger's matter at points (m, 2) moved past the object's since then, (m, 2)."""
        before = np.einsum("ka,kai->ki", shares, self.positions[nodes])
        return np.asarray(points - frame.place(self.frame.local(before)))


@dataclass(frozen=True, eq=False)
class Touch:
    """Contact forces of a configuration, one row a touching point.

    Parameters
    ----------
    at
        Number of the place, or of the object's corner behind the last place, (m,).
    edge, along
        On which edge of the outline, and what a report calls the place (m,).
    points, normals
        Where, and out of the object, (m, 2), in the clamp's frame.
    normal, friction
        N and T on the finger, T along the normal turned by a quarter counter-clockwise, (m,), in N.
    sticking
        Whether friction stays below its limit, (m,).
    energy
        Of the penalty, in J, (m,).
    nodes
        That carry the force, (m, 3).
    forces, stiffness
        On them (m, 3, 2), in N, and the negative derivative by their positions (m, 6, 6), in N/m.
    """

    at: Index
    edge: Index
    along: Array
    points: Array
    normals: Array
    normal: Array
    friction: Array
    sticking: Mask
    energy: Array
    nodes: Index
    forces: Array
    stiffness: Array

    def joined(self, other: Touch) -> Touch:
        """Both."""
        names = self.__dataclass_fields__
        return Touch(*(np.concatenate([getattr(self, name), getattr(other, name)]) for name in names))

    def on_nodes(self, count: int) -> Array:
        """Forces on all nodes (count, 2), in N."""
        at, forces = self.nodes.ravel(), self.forces.reshape(-1, 2)
        return np.stack([np.bincount(at, forces[:, i], count) for i in range(2)], axis=1)

    def derivative(self) -> Triplets:
        """Negative derivative of the nodes' forces by all positions."""
        dofs = (2 * self.nodes[:, :, None] + np.arange(2)).reshape(-1, 6)
        rows, columns = np.repeat(dofs, 6, axis=1), np.tile(dofs, 6)
        return self.stiffness.ravel(), rows.ravel(), columns.ravel()

    def slip(self, history: History, frame: Frame, groups: Index) -> Array:
        """Mean slip past the object since the last pose, weighted by N, of each group of points: in m, (4,).

        Parameters
        ----------
        history, frame
            The last pose, and where the object is now.
        groups
            Number of each point's group (m,), from 0 to 3; one without points gives 0.
        """
        force = self.forces.sum(axis=1)
        shares = np.einsum("kai,ki->ka", self.forces, force) / np.sum(force**2, axis=1)[:, None]
        slid = history.slid(self.nodes, shares, self.points, frame)
        along = self.normals[:, 0] * slid[:, 1] - self.normals[:, 1] * slid[:, 0]
        weight = np.bincount(groups, self.normal, 4)
        return np.bincount(groups, self.normal * along, 4) / np.where(weight > 0, weight, 1.0)

    def elsewhere(self, before: Touch, part: Index, places: int, step: float) -> bool:
        """Whether it touches where nothing touched before a step of the object, in m.

        A place of contact goes along the finger about as far as the object does; one that is twice as far away, or on
        another part, is new. So is a corner of the object (behind the ``places`` of the finger) that did not touch,
        unless one close by did. ``part`` is that of every edge.
        """
        corner = self.at >= places
        reach = np.where(corner, np.where(np.isin(self.at, before.at), np.inf, step / 2), 2 * step)
        same = part[self.edge][:, None] == part[before.edge]
        away = np.where(same, np.abs(self.along[:, None] - before.along), np.inf)
        return bool(np.any(away.min(axis=1, initial=np.inf) > reach))

    @property
    def on_object(self) -> Array:
        """Force of the finger on the object (2,), in N, in the clamp's frame."""
        return -np.sum(self.forces, axis=(0, 1))

    @property
    def size(self) -> float:
        """Sum of the forces' sizes, in N."""
        return float(np.sum(np.linalg.norm(self.forces.sum(axis=1), axis=1)))


def prescribed(sense: Array, trial: Array) -> Array:
    """Trial friction (m,), beyond any limit where its sign is prescribed (m,)."""
    return np.where(sense == 0, trial, np.copysign(np.inf, sense))
