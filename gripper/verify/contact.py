"""Contact of the finger's real surface with a rigid object: a stiff penalty on g, Coulomb friction by return mapping.

A point of the outline at depth -g > 0 is pushed by N = -k g |grad g| along n = grad g / |grad g|, and dragged by T
along the object's tangent t: trial T = T_old - k (slip since the last pose), cut back to mu N. The stiffness is such
that the depth is negligible; it is reported. Where the object has corners, these are also kept out of the finger
(:mod:`gripper.verify.corners`): they would slip between the points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gripper.objects import Array, Object
from gripper.verify.corners import Corners
from gripper.verify.motion import Frame
from gripper.verify.outline import Index
from gripper.verify.surface import Places
from gripper.verify.touch import History, Mask, Touch, prescribed

_STEEPEST = 4.0  # bound of |grad g| near the outline, where it is about 1: sorts out edges that are far away


@dataclass(frozen=True, eq=False)
class Contact:
    """The finger's outline against one object.

    Parameters
    ----------
    places
        Where the outline may touch.
    corners
        The object's corners.
    edges
        Nodes of the outline's edges (e, 3).
    part
        On which part of the outline these are, (e,).
    body
        The object.
    friction
        Coefficient on each edge, (e,).
    sense
        Sign of T on each edge where it is prescribed, else 0, (e,).
    """

    places: Places
    corners: Corners
    edges: Index
    part: Index
    body: Object
    friction: Array
    sense: Array

    @property
    def count(self) -> int:
        """Places and corners."""
        return len(self.places.edge) + self.corners.count

    @property
    def rough(self) -> bool:
        """Whether there is friction at all."""
        return bool(np.any(self.friction > 0))

    def softened(self, share: float) -> Contact:
        """The same with a share of its stiffness."""
        places = replace(self.places, stiffness=share * self.places.stiffness)
        return replace(self, places=places, corners=self.corners.softened(share))

    def rubbed(self, share: float) -> Contact:
        """The same with a share of its friction."""
        return replace(self, friction=share * self.friction)

    def sliding(self, touch: Touch) -> Contact:
        """The same, prescribed to slip everywhere as these forces do."""
        by_edge = np.bincount(touch.edge, touch.friction, len(self.edges))
        return replace(self, sense=np.sign(np.where(by_edge == 0, touch.friction.sum(), by_edge)))

    def gap(self, positions: Array, frame: Frame) -> float:
        """Smallest g over |grad g| of all places, in m; negative: depth."""
        points = frame.local(self.places.at(positions))
        gaps = self.body.evaluate(points, 0)[0]
        nearest = points[[int(np.argmin(gaps))]]
        slope = float(np.linalg.norm(self.body.evaluate(nearest, 1)[1]))
        return float(gaps.min()) / (slope or 1.0)

    def touch(self, positions: Array, frame: Frame, history: History) -> Touch:
        """Contact forces.

        Parameters
        ----------
        positions
            Of all nodes (n, 2), in m.
        frame
            Of the object.
        history
            The last pose.
        """
        pushed = self._pushed(self._touching(positions, frame), positions, frame, history)
        if not self.corners.count:
            return pushed
        return pushed.joined(
            self.corners.touch(positions, frame, history, (self.friction, self.sense), len(self.places.edge))
        )

    def _touching(self, positions: Array, frame: Frame) -> Index:
        """Numbers of the places with g < 0."""
        nodes = positions[self.edges]
        reach = np.linalg.norm(nodes[:, [0, 2]] - nodes[:, [1]], axis=2).max(axis=1)
        near = self.body.evaluate(frame.local(nodes[:, 1]), 0)[0] < _STEEPEST * reach
        possible = np.flatnonzero(near[self.places.edge])
        points = self.places.pick(possible).at(positions)
        return possible[self.body.evaluate(frame.local(points), 0)[0] < 0] if possible.size else possible

    def _pushed(self, at: Index, positions: Array, frame: Frame, history: History) -> Touch:
        near = self.places.pick(at)
        points = near.at(positions)
        k, turn = near.stiffness, frame.turn
        g, gradient, hessian = self.body.evaluate(frame.local(points), 2)
        gradient, hessian = gradient @ turn.T, turn @ hessian @ turn.T
        size = np.maximum(np.linalg.norm(gradient, axis=1), 1e-30)
        n, normal = gradient / size[:, None], -k * g * size
        forces = normal[:, None] * n
        stiffness = k[:, None, None] * (gradient[:, :, None] * gradient[:, None] + g[:, None, None] * hessian)
        friction, sticking = np.zeros(at.size), np.zeros(at.size, dtype=bool)
        if self.rough:
            rise = -k[:, None] * (size[:, None] * gradient + g[:, None] * np.einsum("kij,kj->ki", hessian, n))
            slid = history.slid(near.nodes, near.shares, points, frame)
            state = history.friction[at], self.friction[near.edge], self.sense[near.edge]
            drag = _dragged(k, *state, normal, rise, n, hessian / size[:, None, None], slid)
            friction, sticking = drag[0], drag[1]
            forces, stiffness = forces + drag[2], stiffness + drag[3]
        on_nodes = near.shares[:, :, None] * forces[:, None]
        blocks = np.einsum("ka,kij,kb->kaibj", near.shares, stiffness, near.shares).reshape(-1, 6, 6)
        energy = k * g**2 / 2
        place = near.edge, near.along, points, n
        return Touch(at, *place, normal, friction, sticking, energy, near.nodes, on_nodes, blocks)


def _dragged(
    k: Array,
    old: Array,
    mu: Array,
    sense: Array,
    normal: Array,
    rise: Array,
    n: Array,
    curvature: Array,
    slid: Array,
) -> tuple[Array, Mask, Array, Array]:
    """Coulomb friction by return mapping.

    Parameters
    ----------
    k, old, mu, sense
        Stiffness, last friction, coefficient and prescribed sign (m,).
    normal, rise
        N and its derivative by the point, (m,) and (m, 2).
    n, curvature
        Normal (m, 2), and the Hessian of g over abs(grad g), (m, 2, 2).
    slid
        Motion of the finger's matter past the object's since the last pose (m, 2).

    Returns
    -------
    T, whether it sticks, the force (m, 2), and its negative derivative by the point (m, 2, 2).
    """
    t = np.stack([-n[:, 1], n[:, 0]], axis=1)
    bend = np.einsum("kij,kj->ki", curvature, t)
    trial = prescribed(sense, old - k * np.einsum("ki,ki->k", t, slid))
    limit = mu * np.maximum(normal, 0)
    sticking = np.abs(trial) < limit
    friction = np.where(sticking, trial, np.sign(trial) * limit)
    stuck = -k[:, None] * (t - np.einsum("ki,ki->k", n, slid)[:, None] * bend)
    slipping = (np.sign(trial) * mu * (normal > 0))[:, None] * rise
    change = np.where(sticking[:, None], stuck, slipping)
    stiffness = -t[:, :, None] * change[:, None] + friction[:, None, None] * n[:, :, None] * bend[:, None]
    return friction, sticking, friction[:, None] * t, stiffness
