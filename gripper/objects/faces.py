"""The region that a g with several parts encloses, as polygons: traced from the parts' own outlines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gripper.objects.base import Array, Box

HAIR = 1e-12  # of the window's size: lines closer than that are one
SLIVER = 1e-9  # of the window's area: smaller faces are what two polylines of one outline leave between them


def enclosed(lines: Sequence[Array], window: Box, gap: Callable[[Array], Array]) -> list[Any]:
    """Find the shapely polygons, holes included, in which g is negative, within a window.

    Parameters
    ----------
    lines
        Polylines (m, 2), in m, on which all of g = 0 lies.
    window
        (xmin, ymin, xmax, ymax), in m.
    gap
        G (n,), in m, at points (n, 2), in m.
    """
    import shapely

    frame = shapely.box(*window)
    drawn = shapely.multilinestrings([shapely.linestrings(line) for line in lines])
    hair = HAIR * max(window[2] - window[0], window[3] - window[1])
    noded = shapely.unary_union([shapely.intersection(drawn, frame), frame.exterior], grid_size=hair)
    faces = [face for face in shapely.polygonize([noded]).geoms if face.area > SLIVER * frame.area]
    if not faces:
        return []
    places = np.array([shapely.point_on_surface(face).coords[0] for face in faces])
    whole = shapely.unary_union([face for face, g in zip(faces, gap(places), strict=True) if g < 0])
    return [part for part in shapely.get_parts(whole) if not part.is_empty]


def rings(polygons: Sequence[Any]) -> list[Array]:
    """Vertices (m, 2), the first one repeated, of all borders: counter-clockwise, holes clockwise."""
    import shapely

    turned = [shapely.geometry.polygon.orient(polygon) for polygon in polygons]
    return [shapely.get_coordinates(ring) for polygon in turned for ring in (polygon.exterior, *polygon.interiors)]


def room(polygons: Sequence[Any], size: float) -> tuple[Array, float]:
    """Centre (2,) of the largest disc inside, and the radius of that of the smallest part, in m."""
    import shapely

    discs = [shapely.maximum_inscribed_circle(polygon, tolerance=1e-4 * size) for polygon in polygons]
    radii = [float(disc.length) for disc in discs]
    return np.array(discs[int(np.argmax(radii))].coords[0]), min(radii)
