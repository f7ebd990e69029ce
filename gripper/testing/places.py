"""Where an object is looked at: points around it, discs, lines across it."""

from __future__ import annotations

import numpy as np

from gripper.objects import Array, Box, Object

HAND = 0.1  # m: what is looked at of an outline without bounds


def window(surface: Object) -> Box:
    """The box of the outline, or a hand's breadth about the origin where it has no bounds, in m."""
    if np.isfinite(surface.box).all():
        return surface.box
    return (-HAND, -HAND, HAND, HAND)


def size_of(surface: Object) -> float:
    """The window's larger side, in m."""
    xmin, ymin, xmax, ymax = window(surface)
    return max(xmax - xmin, ymax - ymin)


def around(surface: Object, count: int = 200, margin: float = 0.5) -> Array:
    """Points (count, 2), in m, in and around the outline."""
    low, high = np.reshape(window(surface), (2, 2))
    return np.random.default_rng(0).uniform(low - margin * (high - low), high + margin * (high - low), (count, 2))


def segments(surface: Object, count: int = 400) -> list[Array]:
    """Both ends (count, 2), in m, of lines in and around the outline."""
    points = around(surface, 2 * count)
    return [points[:count], points[count:]]


def in_discs(centers: Array, radius: float, seed: int, count: int = 12) -> Array:
    """Points (n, count, 2) in the discs about centers (n, 2), in m."""
    random = np.random.default_rng(seed)
    angle = random.uniform(0, 2 * np.pi, (len(centers), count))
    reach = radius * np.sqrt(random.uniform(0, 1, (len(centers), count)))
    return np.asarray(centers[:, None] + np.stack([reach * np.cos(angle), reach * np.sin(angle)], axis=-1))


def drawn(surface: Object) -> list[Array]:
    """Its outline, within the window."""
    return surface.outline(window(surface))


def largest(values: Array) -> Array:
    """The largest modulus (n,) among each point's values."""
    return np.abs(values).reshape(len(values), -1).max(axis=1)
