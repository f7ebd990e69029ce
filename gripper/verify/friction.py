"""Coulomb's coefficient on each edge of the outline, as the scene says."""

from __future__ import annotations

import numpy as np

from gripper.friction import Friction
from gripper.objects import Array
from gripper.pose import placed
from gripper.scene import Scene
from gripper.verify.mesh import Mesh
from gripper.verify.outline import JAW


def of_scene(scene: Scene) -> Friction | None:
    """The scene's friction, where it has any."""
    own = scene.friction
    return None if own is None or own.absent else own


def coefficients(scene: Scene, mesh: Mesh) -> Array:
    """Coefficient on each edge (k,)."""
    edges, friction = mesh.outline.edges, of_scene(scene)
    if friction is None:
        return np.zeros(len(edges))
    length = placed(scene.finger).body.length
    finger = friction.along(np.minimum(mesh.nodes[edges[:, 1], 0], length))
    return np.where(mesh.outline.part == JAW, friction.on_jaw(length), finger)


def senses(scene: Scene, mesh: Mesh) -> Array:
    """Sign of T that the scene prescribes on each edge (k,), where there is no motion to find it; else 0.

    The force on the object points to the finger's tip where the scene says "tipward": T, on the finger and along the
    object's outline, counter-clockwise around the finger the other way, is positive where an edge runs to the tip.
    """
    edges, friction = mesh.outline.edges, of_scene(scene)
    if friction is None or friction.sense is None or scene.motion is not None:
        return np.zeros(len(edges))
    along = mesh.nodes[edges[:, 2], 0] - mesh.nodes[edges[:, 0], 0]
    to_tip = np.where(along > -1e-9 * mesh.size, 1.0, -1.0)
    return to_tip if friction.sense == "tipward" else -to_tip
