"""What every closed outline must satisfy, with the words of its errors."""

from __future__ import annotations

from typing import Any

import numpy as np

from gripper.objects.base import Array

NEAR = 1e-9  # of the outline's size: points closer than that are one
FLAT = 1e-12  # of the square of its size: less than that is no area


def closed_points(name: str, points: tuple[tuple[float, float], ...]) -> Array:
    """Return the points (m, 2) of a closed outline, in m: three or more, not on one line, none repeated.

    Raises
    ------
    ValueError
        Names the argument.
    """
    array = np.array(points, dtype=float).reshape(-1, 2)
    if len(array) < 3:
        raise ValueError(f"{name} must hold at least 3 points, in m; got {len(array)}")
    gaps = np.linalg.norm(np.roll(array, -1, axis=0) - array, axis=1)
    if gaps.min() <= NEAR * np.ptp(array, axis=0).max():
        twice = tuple(array[gaps.argmin()].tolist())
        raise ValueError(f"{name} must not repeat a point (the outline closes by itself), in m; got {twice} twice")
    spread = np.linalg.svd(array - array.mean(axis=0), compute_uv=False)
    if spread[1] <= NEAR * spread[0]:
        raise ValueError(f"{name} must enclose an area, in m^2; got points on one line")
    return array


def check_pieces(name: str, coefficients: Array) -> None:
    """Refuse pieces (m, degree + 1, 2), in m, that do not make a closed chain.

    Raises
    ------
    ValueError
        Names the argument.
    """
    if coefficients.ndim != 3 or coefficients.shape[1] < 2 or coefficients.shape[2] != 2:
        raise ValueError(f"{name} must make pieces of shape (m, degree + 1, 2); got {coefficients.shape}")
    if not np.isfinite(coefficients).all():
        raise ValueError(f"{name} must make finite pieces, in m; got {coefficients.tolist()}")
    size = np.abs(coefficients[:, 1:]).sum(axis=1).max()
    slowest = np.linalg.norm([coefficients[:, 1], np.arange(coefficients.shape[1]) @ coefficients], axis=2).min()
    if slowest <= NEAR * size:
        raise ValueError(f"{name} must make pieces with a tangent at both ends, in m; got |q'| = {slowest}")
    off = np.abs(coefficients.sum(axis=1) - np.roll(coefficients[:, 0], -1, axis=0)).max()
    if off > NEAR * size:
        raise ValueError(f"{name} must make pieces that each end where the next begins, in m; got {off} between them")


def check_simple(name: str, polygon: Any) -> None:
    """Refuse a shapely polygon that meets itself or encloses nothing.

    Raises
    ------
    ValueError
        Names the argument.
    """
    xmin, ymin, xmax, ymax = polygon.bounds
    if polygon.area <= FLAT * max(xmax - xmin, ymax - ymin) ** 2:
        raise ValueError(f"{name} must enclose an area, in m^2; got {polygon.area}")
    if not polygon.exterior.is_simple:
        raise ValueError(f"{name} must not make an outline that meets itself; got {meeting(polygon)}")


def meeting(polygon: Any) -> str:
    """Say where a shapely polygon meets itself."""
    from shapely.validation import explain_validity

    _, _, place = explain_validity(polygon).partition("[")  # its words, then [x y] where it knows the place
    x, _, y = place.rstrip("]").partition(" ")
    return f"one that does at ({float(x):.6g}, {float(y):.6g}), in m" if place else "one that does"


def closed_polygon(name: str, points: tuple[tuple[float, float], ...]) -> Array:
    """Return the vertices (m, 2) of a polygon, in m, that does not meet itself and encloses an area.

    Raises
    ------
    ValueError
        Names the argument.
    """
    import shapely

    array = closed_points(name, points)
    check_simple(name, shapely.Polygon(array))
    return array
