"""Contact of the finger's real surface with a rigid object: a stiff penalty on g, Coulomb friction by return mapping.

A point of the outline at depth -g > 0 is pushed by N = -k g |grad g| along n = grad g / |grad g|, and dragged by T along
the object's tangent t: trial T = T_old - k (slip since the last pose), cut back to mu N. The stiffness is such that the
depth is negligible; it is reported. Forces and their exact derivative come from the same formulas.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gripper.objects import Array, Object
from gripper.verify.body import Triplets
from gripper.verify.mesh import Index
from gripper.verify.motion import Frame
from gripper.verify.surface import Places

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class History:
    """What the last pose left: positions of all nodes (n, 2), the object's frame, friction (k,) in N at each place."""

    positions: Array
    frame: Frame
    friction: Array


@dataclass(frozen=True, eq=False)
class Touch:
    """Contact forces of a configuration.

    Parameters
    ----------
    at
        Indices of the touching places (m,).
    points, normals
        Where, and out of the object, (m, 2), in the clamp's frame.
    normal, friction
        N and T on the finger, T along the normal turned by a quarter counter-clockwise, (m,), in N.
    sticking
        Whether friction stays below its limit, (m,).
    gap
        The smallest g over |grad g| of the outline, in m.
    energy
        Of the penalty, in J.
    forces
        On the finger at the points (m, 2), in N.
    tangents
        Derivative of ``forces`` by the points, negative (m, 2, 2), in N/m.
    """

    at: Index
    points: Array
    normals: Array
    normal: Array
    friction: Array
    sticking: Mask
    gap: float
    energy: float
    forces: Array
    tangents: Array


class Contact:
    """The finger's outline against one object.

    Parameters
    ----------
    places
        Where the outline may touch.
    body
        The object.
    friction
        Coefficient at each place, (k,).
    """

    def __init__(self, places: Places, body: Object, friction: Array) -> None:
        self.places, self.object, self.friction = places, body, friction
        self.rough = bool(np.any(friction > 0))

    def touch(self, positions: Array, frame: Frame, history: History, frozen: Index | None = None) -> Touch:
        """Contact forces.

        Parameters
        ----------
        positions
            Of all nodes (n, 2), in m.
        frame
            Of the object.
        history
            The last pose.
        frozen
            Places to take as touching, whatever their gap (the tangent predictor).
        """
        points = self.places.at(positions)
        gaps = self.object.evaluate(frame.local(points), 0)[0]
        at = np.flatnonzero(gaps < 0) if frozen is None else frozen
        nearest = int(np.argmin(gaps))
        look = np.append(at, nearest)
        g, gradient, hessian = self.object.evaluate(frame.local(points[look]), 2)
        gradient, hessian = gradient @ frame.turn.T, frame.turn @ hessian @ frame.turn.T
        size = np.linalg.norm(gradient, axis=1)
        gap = float(g[-1] / size[-1]) if size[-1] > 0 else float(g[-1])
        k = self.places.stiffness[at]
        return self._respond(at, points[at], k, (g[:-1], gradient[:-1], hessian[:-1]), gap, frame, history)

    def _respond(
        self,
        at: Index,
        points: Array,
        k: Array,
        jet: tuple[Array, Array, Array],
        gap: float,
        frame: Frame,
        history: History,
    ) -> Touch:
        g, gradient, hessian = jet
        size = np.maximum(np.linalg.norm(gradient, axis=1), 1e-30)
        n = gradient / size[:, None]
        normal = -k * g * size
        forces = normal[:, None] * n
        tangents = k[:, None, None] * (gradient[:, :, None] * gradient[:, None] + g[:, None, None] * hessian)
        friction, sticking = np.zeros(at.size), np.zeros(at.size, dtype=bool)
        if self.rough:
            curved = np.einsum("kij,kj->ki", hessian, n)
            slope = -k[:, None] * (size[:, None] * gradient + g[:, None] * curved)
            slid = points - moved(self.places.pick(at).at(history.positions), history.frame, frame)
            old, mu = history.friction[at], self.friction[at]
            friction, sticking, drag, drag_tangents = _coulomb(k, mu, old, normal, slope, n, hessian / size[:, None, None], slid)
            forces, tangents = forces + drag, tangents + drag_tangents
        energy = float(np.sum(k * g**2) / 2)
        return Touch(at, points, n, normal, friction, sticking, gap, energy, forces, tangents)

    def on_nodes(self, touch: Touch, count: int) -> Array:
        """Contact forces on all nodes (count, 2), in N."""
        near = self.places.pick(touch.at)
        parts = near.shares[:, :, None] * touch.forces[:, None]
        at = near.nodes.ravel()
        return np.stack([np.bincount(at, parts[:, :, i].ravel(), count) for i in range(2)], axis=1)

    def derivative(self, touch: Touch) -> Triplets:
        """Negative derivative of the nodes' forces by the positions."""
        near = self.places.pick(touch.at)
        blocks = np.einsum("ka,kij,kb->kaibj", near.shares, touch.tangents, near.shares)
        dofs = (2 * near.nodes[:, :, None] + np.arange(2)).reshape(-1, 6)
        rows, columns = np.repeat(dofs, 6, axis=1), np.tile(dofs, 6)
        return blocks.reshape(-1), rows.ravel(), columns.ravel()


def moved(points: Array, before: Frame, now: Frame) -> Array:
    """Points (k, 2) carried along with the object from one frame to another."""
    return now.place(before.local(points))


def _coulomb(
    k: Array, mu: Array, old: Array, normal: Array, slope: Array, n: Array, curvature: Array, slid: Array
) -> tuple[Array, Mask, Array, Array]:
    """Return mapping at each place.

    Parameters
    ----------
    k, mu, old
        Stiffness, coefficient and last friction (k,).
    normal, slope
        N and its derivative by the point, (k,) and (k, 2).
    n, curvature
        Normal (k, 2) and the Hessian of g over abs(grad g), (k, 2, 2).
    slid
        Motion of the finger's matter past the object's since the last pose (k, 2).

    Returns
    -------
    T, whether it sticks, its force (k, 2), and that force's negative derivative (k, 2, 2).
    """
    t = np.stack([-n[:, 1], n[:, 0]], axis=1)
    bend = np.einsum("kij,kj->ki", curvature, t)
    trial = old - k * np.einsum("ki,ki->k", t, slid)
    limit = mu * np.maximum(normal, 0)
    sticking = np.abs(trial) < limit
    friction = np.where(sticking, trial, np.sign(trial) * limit)
    stuck = -k[:, None] * (t - np.einsum("ki,ki->k", n, slid)[:, None] * bend)
    sliding = (np.sign(trial) * mu)[:, None] * slope
    change = np.where(sticking[:, None], stuck, sliding)
    tangents = -t[:, :, None] * change[:, None] + friction[:, None, None] * n[:, :, None] * bend[:, None]
    return friction, sticking, friction[:, None] * t, tangents
