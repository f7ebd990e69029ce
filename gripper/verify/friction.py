"""Coulomb's coefficient on each edge of the outline: the scene's, or one given in its place."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

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


def of_scene(scene: Scene) -> Any:
    """The scene's own friction where it has any, with `finger`, `along`, `on_jaw`, `sense`; else None."""
    own = getattr(scene, "friction", None)
    return None if own is None or own.absent else own


def is_rough(scene: Scene, friction: Friction | None) -> bool:
    """Whether there is friction at all."""
    if friction is None:
        return of_scene(scene) is not None
    return any(mu > 0 for mu in (friction.values() if isinstance(friction, Mapping) else [friction]))


def coefficients(scene: Scene, friction: Friction | None, mesh: Mesh) -> Array:
    """Coefficient on each edge (k,): of ``friction``, or the scene's where that is None."""
    edges, on_jaw = mesh.outline.edges, mesh.outline.part == JAW
    own = of_scene(scene)
    if friction is None and own is not None:
        length = placed(scene.finger).body.length
        finger, jaw = own.along(np.minimum(mesh.nodes[edges[:, 1], 0], length)), own.on_jaw(length)
    elif isinstance(friction, Mapping):
        finger, jaw = friction.get("finger", 0.0), friction.get("jaw", 0.0)
    else:
        finger = jaw = friction or 0.0
    return np.asarray(np.where(on_jaw, jaw, finger), dtype=float)


def senses(scene: Scene, friction: Friction | None, mesh: Mesh) -> Array:
    """Sign of T that the scene prescribes on each edge (k,), where there is no motion to find it; else 0.

    The force on the object points to the finger's tip where the scene says "tipward": T, on the finger and along the
    object's outline, counter-clockwise around the finger the other way, is positive where an edge runs to the tip.
    """
    edges = mesh.outline.edges
    own = of_scene(scene)
    sense = own.sense if own is not None and friction is None and scene.motion is None else None
    if sense is None:
        return np.zeros(len(edges))
    along = mesh.nodes[edges[:, 2], 0] - mesh.nodes[edges[:, 0], 0]
    to_tip = np.where(along > -1e-9 * mesh.size, 1.0, -1.0)
    return to_tip if sense == "tipward" else -to_tip
