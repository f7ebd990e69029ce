"""Jaws: rigid polygons at the finger's end."""

from gripper_plugins.jaws.polygon import PolygonJaw
from gripper_plugins.jaws.triangle import Triangle

__all__ = ["PolygonJaw", "Triangle"]
