"""What every jaw promises: a simple polygon for any finger."""

from __future__ import annotations

import numpy as np

from gripper.fingers import Jaw
from gripper.objects.closed import meeting
from gripper.testing.contract import Property, fits, has_the_manners_of_data, require, run, survives_a_scene_file

THICKNESSES = (0.0005, 0.002, 0.02)
"""Of the finger's tip, in m."""


def check_jaw(instance: Jaw) -> None:
    """Check that a jaw keeps all that `gripper.fingers.Jaw` promises; see `check_object` for what is raised."""
    run(instance, JAW_PROPERTIES)


def has_a_polygon_of_finite_points(jaw: Jaw) -> None:
    """At least three of them, the same every time, whatever the finger's thickness."""
    for thickness in THICKNESSES:
        vertices = jaw.polygon(thickness)
        points = np.asarray(vertices, dtype=float)
        right = points.ndim == 2 and points.shape[1:] == (2,) and len(points) >= 3
        require(right, f"write at least 3 vertices (x, y) for a tip of {thickness} m", vertices)
        require(bool(np.isfinite(points).all()), f"write finite vertices, in m, for a tip of {thickness} m", vertices)
        require(jaw.polygon(thickness) == vertices, f"write the same vertices every time for {thickness} m", vertices)


def has_a_simple_polygon(jaw: Jaw) -> None:
    """It does not meet itself, and encloses an area."""
    import shapely

    for thickness in THICKNESSES:
        polygon = shapely.Polygon(jaw.polygon(thickness))
        rule = f"write a polygon that does not meet itself for a tip of {thickness} m"
        require(polygon.is_valid, rule, meeting(polygon))
        require(polygon.area > 0, f"enclose an area, in m^2, for a tip of {thickness} m", polygon.area)


JAW_PROPERTIES: tuple[Property[Jaw], ...] = (
    fits("gripper.jaws"),
    has_the_manners_of_data,
    has_a_polygon_of_finite_points,
    has_a_simple_polygon,
    survives_a_scene_file("gripper.jaws"),
)
"""What `check_jaw` checks, in its order."""
