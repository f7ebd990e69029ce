"""Coulomb's coefficient on each edge of the outline: the scene's, or one given in its place."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from gripper.objects import Array
from gripper.pose import placed
from gripper.scene import Scene
from gripper.verify.mesh import Mesh
from gripper.verify.outline import JAW

Friction = float | Mapping[str, float]
"""A coefficient, or one for "finger" and one for "jaw"."""


def check(friction: Friction) -> None:
    """Refuse what is no coefficient.

    Raises
    ------
    LookupError
        An unknown part of the finger.
    ValueError
        A coefficient below 0.
    """
    for name, value in (friction if isinstance(friction, Mapping) else {"finger": friction}).items():
        if name not in ("finger", "jaw"):
            raise LookupError(f"unknown part {name!r} of friction; known: finger, jaw")
        if not (math.isfinite(value) and value >= 0):
            raise ValueError(f"friction must be a coefficient, at least 0; got {value!r}")


def coefficients(scene: Scene, friction: Friction | None, mesh: Mesh) -> Array:
    """Coefficient on each edge (k,): of ``friction``, or the scene's where that is None."""
    edges, on_jaw = mesh.outline.edges, mesh.outline.part == JAW
    if friction is None:
        if scene.friction is None or scene.friction.absent:
            return np.zeros(len(edges))
        length = placed(scene.finger).body.length
        s = np.minimum(mesh.nodes[edges[:, 1], 0], length)
        return np.where(on_jaw, scene.friction.on_jaw(length), scene.friction.along(s))
    if not isinstance(friction, Mapping):
        return np.full(len(edges), float(friction))
    return np.where(on_jaw, friction.get("jaw", 0.0), friction.get("finger", 0.0))


def senses(scene: Scene, friction: Friction | None, mesh: Mesh) -> Array:
    """Sign of T that the scene prescribes on each edge (k,), where there is no motion to find it; else 0.

    The force on the object points to the finger's tip where the scene says "tipward": T, on the finger and along the
    object's outline, counter-clockwise around the finger the other way, is positive where an edge runs to the tip.
    """
    edges = mesh.outline.edges
    sense = scene.friction.sense if scene.friction and friction is None and not scene.motion else None
    if sense is None:
        return np.zeros(len(edges))
    along = mesh.nodes[edges[:, 2], 0] - mesh.nodes[edges[:, 0], 0]
    to_tip = np.where(along > -1e-9 * mesh.size, 1.0, -1.0)
    return to_tip if sense == "tipward" else -to_tip
